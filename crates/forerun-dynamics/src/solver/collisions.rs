//! Collisions: impulses with restitution on the velocities before gravity (Guendelman et al. 2003, section 7; dissertation 2.4.4).
//!
//! A contact collides when it approaches and will close within the substep. A body at rest has no velocity before gravity, so that it
//! does not bounce, whatever its restitution. What gravity adds in one frame counts as rest: a speed that shrinks with the frame, no threshold of its own.

use std::cell::Cell;

use super::blocks::{Block, BlocksOf, Detail, DetailsOf};
use super::impulses::{self, Sums};
use super::points::{Kind, Point, sum};
use super::sides::Sides;
use super::sweep::{coupling, friction, slip};
use crate::lanes::{LaneMask, Lanes, Portable, Row, dispatched, recast};

/// A collision may cause the next one within the same substep (a row of balls), at most so many in a row.
const COLLISION_ROUNDS: usize = 4;
/// Rounds over the points of one contact: a flat landing bounces flat.
const POINT_ROUNDS: usize = 2;

/// Velocities and displacements of the bodies, and what the substep will add.
pub(crate) struct Moving<'a> {
    pub(crate) velocities: &'a [Cell<Row>],
    pub(crate) ahead: Ahead<'a>,
    /// Where bounces are added up; empty where nobody asks.
    pub(crate) bounced: Sums<'a>,
}

/// How far the bodies have come, and what will move them.
#[derive(Clone, Copy)]
pub(crate) struct Ahead<'a> {
    pub(crate) displacements: &'a [Row],
    /// Mass-scaled change of velocity that gravity and forces will make in the substep.
    pub(crate) kicks: &'a [Row],
    pub(crate) substep_seconds: f32,
    /// How many substeps a frame has.
    pub(crate) substeps: f32,
    /// Whether any contact may bounce.
    pub(crate) bounces: bool,
    /// Whether any body turns of its own accord.
    pub(crate) carries: bool,
}

dispatched! {
    /// Bounces every contact that collides in this substep.
    pub(crate) fn resolve_collisions<K: Kind>(
        blocks: &[Block<Portable, K>],
        details: &[Detail<Portable>],
        moving: &mut Moving,
    ) => resolve_lanes
}

#[inline(always)]
fn resolve_lanes<F: Lanes, K: Kind>(
    blocks: &[Block<Portable, K>],
    details: &[Detail<Portable>],
    moving: &mut Moving,
) {
    let blocks = recast::<F, BlocksOf<K>>(blocks);
    let details = recast::<F, DetailsOf>(details);
    for _ in 0..COLLISION_ROUNDS {
        let mut any = false;
        for (block, detail) in blocks.iter().zip(details) {
            if detail.restitution.gt(F::zero()).any() {
                any |= collide(block, detail, moving);
            }
        }
        if !any {
            break;
        }
    }
}

/// Returns whether any contact of the block collided.
#[inline(always)]
fn collide<F: Lanes, K: Kind>(block: &Block<F, K>, detail: &Detail<F>, moving: &mut Moving) -> bool {
    let mut v = Sides::gather(block, moving.velocities);
    let relative = v.relative(block);
    let moved = Sides::gather_still(block, moving.ahead.displacements).relative(block);
    let kick = Sides::gather_still(block, moving.ahead.kicks).relative(block);
    let h = F::splat(moving.ahead.substep_seconds);
    let mut lacking = [F::zero(); 4];
    let mut hits = [F::zero(); 4];
    let (mut all, mut any) = (F::one(), F::zero());
    for q in 0..4 {
        let point = &block.points[q];
        let separation = detail.separation[q] + point.speed(&moved);
        let speed = point.speed(&relative);
        let kicked = point.speed(&kick);
        let ahead = separation + h * (speed + kicked);
        // Slower is what gravity does in a frame to a body that rests on the other: contact, not collision. Two that fall alike have none of it.
        let fall = (-kicked).max(F::zero()) * F::splat(moving.ahead.substeps);
        let is_point = block.is_point(q);
        let hit = is_point & speed.lt(-fall) & ahead.lt(F::zero()) & detail.restitution.gt(F::zero());
        hits[q] = hit.select(F::one(), F::zero());
        all = is_point.select(all.min(hits[q]), all);
        any = any.max(hits[q]);
        lacking[q] = is_point.select(-(detail.restitution * speed) - speed, F::zero());
    }
    if !any.gt(F::zero()).any() {
        return false;
    }
    let impulses = bounce(block, &hits, all, &mut lacking);
    if !moving.bounced.normal.is_empty() {
        impulses::add(moving.bounced.normal, &detail.source, &impulses);
    }
    // Friction of the collision alone: the impulses of the contacts are kept apart.
    let slip = slip(block, &relative, &impulses);
    let rubbed = friction(&block.friction, &slip, sum(&impulses), &[F::zero(); 3]);
    if !moving.bounced.friction.is_empty() {
        impulses::add_friction(moving.bounced.friction, (block, &detail.source), &rubbed);
    }
    let mut push = Point::push(&block.points, &impulses);
    push.rub([rubbed[0], rubbed[1]], rubbed[2]);
    v.push(block, &push);
    v.scatter(block, moving.velocities);
    true
}

/// Normal impulses of the points that collide (`hits` is 1), towards speeds that `lacking` is away from. `all` is 1 where every point of the contact
/// collides: a flat landing.
#[inline(always)]
fn bounce<F: Lanes, K: Kind>(block: &Block<F, K>, hits: &[F; 4], all: F, lacking: &mut [F; 4]) -> [F; 4] {
    let flat = all.gt(F::splat(0.5)).select((block.mean_gain * sum(lacking)).max(F::zero()), F::zero());
    let mut impulses = [F::zero(); 4];
    for q in 0..4 {
        impulses[q] = hits[q] * flat;
        lacking[q] -= block.row_sums[q] * flat;
    }
    for _ in 0..POINT_ROUNDS {
        for q in 0..4 {
            let inverse_k = block.inverse_k[q];
            let impulse = (impulses[q] + hits[q] * inverse_k * lacking[q]).max(F::zero());
            let change = impulse - impulses[q];
            impulses[q] = impulse;
            for p in 0..4 {
                let k = if p == q {
                    F::one() / block.is_point(q).select(inverse_k, F::one())
                } else {
                    block.coupling[coupling(p, q)]
                };
                lacking[p] -= k * change;
            }
        }
    }
    impulses
}
