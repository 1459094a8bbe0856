//! Shock propagation: remaining overlap is pushed out level by level, the lower body moving less than its mass says.
//!
//! The classic form (Guendelman et al. 2003, section 8; dissertation 2.4.7) gives what is below infinite mass and acts on velocities; measured, it makes
//! wide pyramids explode. This one acts on positions alone, so that it adds no velocity.

use super::blocks::Block;
use super::sweep::{Jacobian, Sides};
use crate::StepSettings;
use crate::lanes::{F8, Row, dispatched};

dispatched! {
    /// One pass over all blocks, on the displacements. `push_max` is the most overlap it removes, in metres.
    pub(crate) fn propagate_shock(
        blocks: &[Block],
        displacements: &mut [Row],
        settings: &StepSettings,
        push_max: f32,
    ) {
        let part = F8::splat(settings.overlap_recovery);
        let allowed = F8::splat(settings.overlap_allowed_m);
        let most = F8::splat(push_max);
        for block in blocks {
            push_out(block, displacements, part, allowed, most);
        }
    }
}

#[inline(always)]
fn push_out(block: &Block, displacements: &mut [Row], part: F8, allowed: F8, most: F8) {
    let mut d = Sides::gather(block, displacements);
    let mut push = [F8::ZERO; 4];
    let mut target = [F8::ZERO; 4];
    let mut sum = F8::ZERO;
    for q in 0..4 {
        let point = &block.points[q];
        let separation = point.separation + d.along(block, &point.jacobian());
        let excess = (-(separation + allowed)).max(F8::ZERO);
        let is_point = point.inverse_k.gt(F8::ZERO);
        push[q] = is_point.select((part * excess).min(most), F8::ZERO);
        target[q] = separation + push[q];
        sum += push[q];
    }
    if !sum.gt(F8::ZERO).any() {
        return;
    }
    let row = block.centre_jacobian();
    let length2 = row.direction.dot(row.direction);
    let inverse_k = F8::ONE / yielding_k(block, &row, length2);
    let flat = inverse_k * (sum * block.centre.inverse_count);
    apply(block, &mut d, &row, flat);
    for q in 0..4 {
        let point = &block.points[q];
        let row = point.jacobian();
        let separation = point.separation + d.along(block, &row);
        let lacks = separation.lt(target[q]) & push[q].gt(F8::ZERO);
        let impulse = (target[q] - separation) / yielding_k(block, &row, F8::ONE);
        apply(block, &mut d, &row, lacks.select(impulse, F8::ZERO));
    }
    d.scatter(block, displacements);
}

/// J Jᵀ with each side's yield.
#[inline(always)]
fn yielding_k(block: &Block, row: &Jacobian, length2: F8) -> F8 {
    let (sa, sb) = (block.first_scale, block.second_scale);
    let a = block.first_answers * block.first_yields * (sa * sa * length2 + row.first.dot(row.first));
    let b = block.second_answers * block.second_yields * (sb * sb * length2 + row.second.dot(row.second));
    a + b + F8::splat(1e-12)
}

#[inline(always)]
fn apply(block: &Block, d: &mut Sides, row: &Jacobian, impulse: F8) {
    let on_first = impulse * block.first_answers * block.first_yields;
    let on_second = impulse * block.second_answers * block.second_yields;
    d.push(block, row, (on_first, on_second));
}
