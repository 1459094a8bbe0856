//! Shock propagation: remaining overlap is pushed out level by level, the lower body moving less than its mass says.
//!
//! The classic form (Guendelman et al. 2003, section 8; dissertation 2.4.7) gives what is below infinite mass and acts on velocities; it is here for
//! comparison, see [`ShockPropagation`](crate::ShockPropagation). The usual one acts on positions alone, so that it adds no velocity.

use std::cell::Cell;

use super::blocks::{Block, BlocksOf, Detail, DetailsOf};
use super::points::{Kind, Point};
use super::sides::{Jacobian, Sides};
use crate::StepSettings;
use crate::lanes::{LaneMask, Lanes, Portable, Row, V8, dispatched, recast};

dispatched! {
    /// One pass over all blocks, on the displacements.
    pub(crate) fn propagate_shock<K: Kind>(
        blocks: &[Block<Portable, K>],
        details: &[Detail<Portable>],
        displacements: &[Cell<Row>],
        settings: &StepSettings,
    ) => propagate_lanes
}

#[inline(always)]
fn propagate_lanes<F: Lanes, K: Kind>(
    blocks: &[Block<Portable, K>],
    details: &[Detail<Portable>],
    displacements: &[Cell<Row>],
    settings: &StepSettings,
) {
    // The most overlap that a frame or slice removes.
    let push_max = settings.recovery_speed_max * settings.frame_seconds;
    let blocks = recast::<F, BlocksOf<K>>(blocks);
    for (block, detail) in blocks.iter().zip(recast::<F, DetailsOf>(details)) {
        let mut d = Sides::gather(block, displacements);
        let Some(wanted) = Wanted::of(block, detail, &d, settings, push_max) else {
            continue;
        };
        push_out(block, detail, &mut d, &wanted);
        d.scatter(block, displacements);
    }
}

/// The classic form: one pass over the velocities, by rising level, as if the lower body of every contact had infinite mass. For comparison, and so not
/// compiled for any instruction set.
pub(crate) fn propagate_classic<K: Kind>(
    blocks: &[Block<Portable, K>],
    details: &[Detail<Portable>],
    velocities: &[Cell<Row>],
    displacements: &[Row],
    substep_seconds: f32,
) {
    type F = Portable;
    let per_second = F::splat(1.0 / substep_seconds);
    for (block, detail) in blocks.iter().zip(details) {
        // The side that yields less than the other is the lower one.
        let lower = |own: F, other: F| own.lt(other).select(F::zero(), F::one());
        let on_first = detail.first_answers * lower(detail.first_yields, detail.second_yields);
        let on_second = detail.second_answers * lower(detail.second_yields, detail.first_yields);
        let mut v = Sides::gather(block, velocities);
        let moved: Sides<F> = Sides::gather_still(block, displacements);
        for q in 0..4 {
            let row = block.jacobian(q);
            let gap = (detail.separation[q] + moved.along(block, &row)).max(F::zero());
            let lacking = -(v.along(block, &row) + gap * per_second);
            let k = yielding_k(block, &row, (on_first, on_second));
            let impulse = block.is_point(q).select((lacking / k).max(F::zero()), F::zero());
            v.apply(block, &row, (impulse * on_first, impulse * on_second));
        }
        v.scatter(block, velocities);
    }
}

/// How far the points of a contact are to be pushed out, and to which separation.
struct Wanted<F> {
    push: [F; 4],
    separation: [F; 4],
    /// Sum of the pushes.
    sum: F,
}

impl<F: Lanes> Wanted<F> {
    /// None where no contact overlaps too deep.
    #[inline(always)]
    fn of<K: Kind>(
        block: &Block<F, K>,
        detail: &Detail<F>,
        d: &Sides<F>,
        settings: &StepSettings,
        push_max: f32,
    ) -> Option<Self> {
        let (part, most) = (F::splat(settings.overlap_recovery), F::splat(push_max));
        let allowed = F::splat(settings.overlap_allowed_m);
        let moved = d.relative(block);
        let mut wanted = Wanted { push: [F::zero(); 4], separation: [F::zero(); 4], sum: F::zero() };
        for q in 0..4 {
            let separation = detail.separation[q] + block.points[q].speed(&moved);
            let excess = (-(separation + allowed)).max(F::zero());
            let push = block.is_point(q).select((part * excess).min(most), F::zero());
            wanted.push[q] = push;
            wanted.separation[q] = separation + push;
            wanted.sum += push;
        }
        wanted.sum.gt(F::zero()).any().then_some(wanted)
    }
}

#[inline(always)]
fn push_out<F: Lanes, K: Kind>(
    block: &Block<F, K>,
    detail: &Detail<F>,
    d: &mut Sides<F>,
    wanted: &Wanted<F>,
) {
    let yields = (detail.first_answers * detail.first_yields, detail.second_answers * detail.second_yields);
    let row = mean(block, detail);
    let flat = (wanted.sum * detail.inverse_count) / yielding_k(block, &row, yields);
    d.apply(block, &row, (flat * yields.0, flat * yields.1));
    for q in 0..4 {
        let row = block.jacobian(q);
        let separation = detail.separation[q] + d.along(block, &row);
        let lacks = separation.lt(wanted.separation[q]) & wanted.push[q].gt(F::zero());
        let impulse = (wanted.separation[q] - separation) / yielding_k(block, &row, yields);
        let impulse = lacks.select(impulse, F::zero());
        d.apply(block, &row, (impulse * yields.0, impulse * yields.1));
    }
}

/// The mean of the points' rows.
#[inline(always)]
fn mean<F: Lanes, K: Kind>(block: &Block<F, K>, detail: &Detail<F>) -> Jacobian<F> {
    let mut mean = Jacobian { direction: V8::zero(), first: V8::zero(), second: V8::zero() };
    for q in 0..4 {
        let share = block.is_point(q).select(detail.inverse_count, F::zero());
        let row = block.jacobian(q);
        mean.direction = mean.direction + row.direction * share;
        mean.first = mean.first + row.first * share;
        mean.second = mean.second + row.second * share;
    }
    mean
}

/// J Jᵀ with each side's yield.
#[inline(always)]
fn yielding_k<F: Lanes, K: Kind>(block: &Block<F, K>, row: &Jacobian<F>, yields: (F, F)) -> F {
    let length2 = row.direction.dot(row.direction);
    let (sa, sb) = (block.first.scale, block.second.scale);
    yields.0 * (sa * sa * length2 + row.first.dot(row.first))
        + yields.1 * (sb * sb * length2 + row.second.dot(row.second))
        + F::splat(1e-12)
}
