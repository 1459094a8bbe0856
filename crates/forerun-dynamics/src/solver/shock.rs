//! Shock propagation: remaining overlap is pushed out level by level, the lower body moving less than its mass says.
//!
//! The classic form (Guendelman et al. 2003, section 8; dissertation 2.4.7) gives what is below infinite mass and acts on velocities; it is here for
//! comparison, see [`ShockPropagation`](crate::ShockPropagation). The usual one acts on positions alone, so that it adds no velocity.

use super::blocks::{Block, Contacts};
use super::sweep::{Jacobian, Sides};
use crate::StepSettings;
use crate::lanes::{LaneMask, Lanes, Portable, Row, dispatched, recast};

dispatched! {
    /// One pass over all blocks, on the displacements. `push_max` is the most overlap it removes, in metres.
    pub(crate) fn propagate_shock(
        blocks: &mut [Block<Portable>],
        displacements: &mut [Row],
        settings: &StepSettings,
        push_max: f32,
    ) => propagate_lanes
}

#[inline(always)]
fn propagate_lanes<F: Lanes>(
    blocks: &mut [Block<Portable>],
    displacements: &mut [Row],
    settings: &StepSettings,
    push_max: f32,
) {
    let blocks = recast::<F, Contacts>(blocks);
    let part = F::splat(settings.overlap_recovery);
    let allowed = F::splat(settings.overlap_allowed_m);
    let most = F::splat(push_max);
    for block in blocks {
        push_out(block, displacements, part, allowed, most);
    }
}

dispatched! {
    /// The classic form: one pass over the velocities, by rising level, as if the lower body of every contact had infinite mass.
    pub(crate) fn propagate_classic(
        blocks: &mut [Block<Portable>],
        velocities: &mut [Row],
        displacements: &[Row],
        substep_seconds: f32,
    ) => classic_lanes
}

#[inline(always)]
fn classic_lanes<F: Lanes>(
    blocks: &mut [Block<Portable>],
    velocities: &mut [Row],
    displacements: &[Row],
    substep_seconds: f32,
) {
    let blocks = recast::<F, Contacts>(blocks);
    let per_second = F::splat(1.0 / substep_seconds);
    for block in blocks {
        // The side that yields less than the other is the lower one.
        let lower = |own: F, other: F| own.lt(other).select(F::zero(), F::one());
        let on_first = block.first_answers * lower(block.first_yields, block.second_yields);
        let on_second = block.second_answers * lower(block.second_yields, block.first_yields);
        let mut v = Sides::gather(block, velocities);
        let moved: Sides<F> = Sides::gather(block, displacements);
        for point in &block.points {
            let row = point.jacobian();
            let gap = (point.separation + moved.along(block, &row)).max(F::zero());
            let lacking = -(v.along(block, &row) + gap * per_second);
            let (sa, sb) = (block.first_scale, block.second_scale);
            let k = on_first * (sa * sa + row.first.dot(row.first))
                + on_second * (sb * sb + row.second.dot(row.second))
                + F::splat(1e-12);
            let is_point = point.inverse_k.gt(F::zero());
            let impulse = is_point.select((lacking / k).max(F::zero()), F::zero());
            v.push(block, &row, (impulse * on_first, impulse * on_second));
        }
        v.scatter(block, velocities);
    }
}

#[inline(always)]
fn push_out<F: Lanes>(block: &Block<F>, displacements: &mut [Row], part: F, allowed: F, most: F) {
    let mut d = Sides::gather(block, displacements);
    let mut push = [F::zero(); 4];
    let mut target = [F::zero(); 4];
    let mut sum = F::zero();
    for q in 0..4 {
        let point = &block.points[q];
        let separation = point.separation + d.along(block, &point.jacobian());
        let excess = (-(separation + allowed)).max(F::zero());
        let is_point = point.inverse_k.gt(F::zero());
        push[q] = is_point.select((part * excess).min(most), F::zero());
        target[q] = separation + push[q];
        sum += push[q];
    }
    if !sum.gt(F::zero()).any() {
        return;
    }
    let row = block.centre_jacobian();
    let length2 = row.direction.dot(row.direction);
    let inverse_k = F::one() / yielding_k(block, &row, length2);
    let flat = inverse_k * (sum * block.centre.inverse_count);
    apply(block, &mut d, &row, flat);
    for q in 0..4 {
        let point = &block.points[q];
        let row = point.jacobian();
        let separation = point.separation + d.along(block, &row);
        let lacks = separation.lt(target[q]) & push[q].gt(F::zero());
        let impulse = (target[q] - separation) / yielding_k(block, &row, F::one());
        apply(block, &mut d, &row, lacks.select(impulse, F::zero()));
    }
    d.scatter(block, displacements);
}

/// J Jᵀ with each side's yield.
#[inline(always)]
fn yielding_k<F: Lanes>(block: &Block<F>, row: &Jacobian<F>, length2: F) -> F {
    let (sa, sb) = (block.first_scale, block.second_scale);
    let a = block.first_answers * block.first_yields * (sa * sa * length2 + row.first.dot(row.first));
    let b = block.second_answers * block.second_yields * (sb * sb * length2 + row.second.dot(row.second));
    a + b + F::splat(1e-12)
}

#[inline(always)]
fn apply<F: Lanes>(block: &Block<F>, d: &mut Sides<F>, row: &Jacobian<F>, impulse: F) {
    let on_first = impulse * block.first_answers * block.first_yields;
    let on_second = impulse * block.second_answers * block.second_yields;
    d.push(block, row, (on_first, on_second));
}
