//! Collisions: impulses with restitution on the velocities before gravity (Guendelman et al. 2003, section 7; dissertation 2.4.4).
//!
//! A contact collides when it approaches and will close within the substep. A body at rest has no velocity before gravity, so that it
//! does not bounce, whatever its restitution. What gravity adds in one frame counts as rest: a speed that shrinks with the frame, no threshold of its own.

use super::blocks::{Block, Contacts};
use super::impulses;
use super::sweep::{Sides, friction};
use crate::lanes::{LaneMask, Lanes, Portable, Row, dispatched, recast};

/// A collision may cause the next one within the same substep (a row of balls), at most so many in a row.
const COLLISION_ROUNDS: usize = 4;
/// Rounds over the points of one contact: a flat landing bounces flat.
const POINT_ROUNDS: usize = 2;

/// Velocities and displacements of the bodies, and what the substep will add.
pub(crate) struct Moving<'a> {
    pub(crate) velocities: &'a mut [Row],
    pub(crate) displacements: &'a [Row],
    /// Mass-scaled change of velocity that gravity and forces will make in the substep.
    pub(crate) kicks: &'a [Row],
    pub(crate) substep_seconds: f32,
    /// How many substeps a frame has.
    pub(crate) substeps: f32,
    /// Where bounces are added up; empty where nobody asks.
    pub(crate) bounced: &'a mut [[f32; 4]],
}

dispatched! {
    /// Bounces every contact that collides in this substep.
    pub(crate) fn resolve_collisions(blocks: &mut [Block<Portable>], moving: &mut Moving) => resolve_lanes
}

#[inline(always)]
fn resolve_lanes<F: Lanes>(blocks: &mut [Block<Portable>], moving: &mut Moving) {
    let blocks = recast::<F, Contacts>(blocks);
    for _ in 0..COLLISION_ROUNDS {
        let mut any = false;
        for block in blocks.iter_mut() {
            if block.restitution.gt(F::zero()).any() {
                any |= collide(block, moving);
            }
        }
        if !any {
            break;
        }
    }
}

/// Returns whether any contact of the block collided.
#[inline(always)]
fn collide<F: Lanes>(block: &mut Block<F>, moving: &mut Moving) -> bool {
    let mut v = Sides::gather(block, moving.velocities);
    let moved: Sides<F> = Sides::gather(block, moving.displacements);
    let kick: Sides<F> = Sides::gather(block, moving.kicks);
    let h = F::splat(moving.substep_seconds);
    let mut target = [F::zero(); 4];
    let mut hits = [F::zero(); 4];
    let (mut all, mut target_sum, mut any) = (F::one(), F::zero(), F::zero());
    for q in 0..4 {
        let point = &block.points[q];
        let row = point.jacobian();
        let separation = point.separation + moved.along(block, &row);
        let speed = v.along(block, &row);
        let kicked = kick.along(block, &row);
        let ahead = separation + h * (speed + kicked);
        // Slower is what gravity does in a frame to a body that rests on the other: contact, not collision. Two that fall alike have none of it.
        let fall = (-kicked).max(F::zero()) * F::splat(moving.substeps);
        let is_point = point.inverse_k.gt(F::zero());
        let hit = is_point & speed.lt(-fall) & ahead.lt(F::zero()) & block.restitution.gt(F::zero());
        hits[q] = hit.select(F::one(), F::zero());
        target[q] = -(block.restitution * speed);
        all = is_point.select(all.min(hits[q]), all);
        any = any.max(hits[q]);
        target_sum += is_point.select(target[q], F::zero());
    }
    if !any.gt(F::zero()).any() {
        return false;
    }
    let targets = Targets { hits, speeds: target, sum: target_sum, all };
    let impulses = bounce(block, &mut v, &targets);
    if !moving.bounced.is_empty() {
        impulses::add(moving.bounced, &block.source, &impulses);
    }
    let sum = impulses[0] + impulses[1] + impulses[2] + impulses[3];
    // Friction of the collision alone: the impulses of the contacts are kept apart.
    let (tangents, twist) = (block.friction.impulses, block.friction.twist_impulse);
    block.friction.impulses = [F::zero(); 2];
    block.friction.twist_impulse = F::zero();
    friction(block, &mut v, sum);
    block.friction.impulses = tangents;
    block.friction.twist_impulse = twist;
    v.scatter(block, moving.velocities);
    true
}

/// What the points of a contact are to bounce to.
struct Targets<F> {
    /// 1 for the points that collide.
    hits: [F; 4],
    speeds: [F; 4],
    sum: F,
    /// 1 where all points of the contact collide: a flat landing.
    all: F,
}

/// Normal impulses towards the target speeds.
#[inline(always)]
fn bounce<F: Lanes>(block: &Block<F>, v: &mut Sides<F>, targets: &Targets<F>) -> [F; 4] {
    let Targets { hits, speeds: target, .. } = targets;
    let row = block.centre_jacobian();
    let centre = &block.centre;
    let lacking = targets.sum * centre.inverse_count - v.along(block, &row);
    let flat = targets.all.gt(F::splat(0.5)).select((centre.inverse_k * lacking).max(F::zero()), F::zero());
    v.apply(block, &row, flat);
    let mut impulses = [F::zero(); 4];
    for q in 0..4 {
        impulses[q] = hits[q] * flat * centre.inverse_count;
    }
    for _ in 0..POINT_ROUNDS {
        for q in 0..4 {
            let point = &block.points[q];
            let row = point.jacobian();
            let change = hits[q] * point.inverse_k * (target[q] - v.along(block, &row));
            let impulse = (impulses[q] + change).max(F::zero());
            v.apply(block, &row, impulse - impulses[q]);
            impulses[q] = impulse;
        }
    }
    impulses
}
