//! Reduction: a few manifolds that stand for many candidates.
//!
//! Sides of the contact are found by normal: the deepest candidate left and all whose normals are within 60 degrees of
//! its own. Of each side up to eight points are kept that are far apart, deep ones first.

use forerun_lanes::{LaneMask, Lanes, Portable, dispatched};

use super::candidates::{Candidate, Candidates, Place, first_greatest};
use super::directions::Direction;
use super::smooth::smooth;
use super::{TOUCH_PART, WEIGHT_PART};
use crate::Vec3;
use crate::contact::{ContactPoint, Manifold};
use crate::sdf::eight::{lane, splat};

/// Most sides of a contact that are told apart.
const SIDES_MAX: usize = 6;
/// Most points of a side: two manifolds.
const POINTS_MAX: usize = 8;
/// Cosine of the widest angle between the normals of a side: 60 degrees.
const SIDE_COSINE: f32 = 0.5;
/// How much nearer to the chosen points a candidate counts for each metre that it is shallower than the deepest.
///
/// Without this the farthest points win, however shallow, and piles sink in and never rest.
const DEPTH_PENALTY: f32 = 8.0;
/// The same for the second four points of a side, of bodies that are slow: there is nothing to be foreseen, and what touches now must not be left out for what
/// does not. With 8 a ring that lies on another is given now one and now the other of two corners that hold it up 6 cm apart, and rocks for ever.
const SLOW_PENALTY: f32 = 40.0;

/// The memory of a reduction.
#[derive(Clone, Debug, Default)]
pub(super) struct Reduction {
    side: Vec<Member8>,
    /// The points that are kept, side by side.
    chosen: Vec<Candidate>,
    /// Where each side begins in `chosen`.
    starts: Vec<usize>,
    /// Those of the chosen whose normals are smoothed, by their places in the list.
    rough: Vec<u32>,
}

/// How the points of a side are spread.
#[derive(Clone, Copy, Debug)]
struct Spread {
    /// The penalty for depth of the second four: the far side of a fast ring that comes in tilted is shallow now and deep at the end of the step.
    far_penalty: f32,
    /// Points are at least so far apart. Metres.
    apart: f32,
}

/// Of a block of candidates those that belong to a side.
#[derive(Clone, Copy, Debug)]
struct Member8 {
    block: usize,
    /// How much larger their separation is than the smallest. Metres.
    shallower: Portable,
    /// To the nearest of those chosen; 0 for others than members. Square metres.
    distance_squared: Portable,
}

/// Appends the manifolds of the candidates.
pub(super) fn reduce(
    candidates: &mut Candidates,
    directions: &[Option<Direction>; 2],
    memory: &mut Reduction,
    out: &mut Vec<Manifold>,
) {
    if candidates.blocks.is_empty() {
        return;
    }
    memory.chosen.clear();
    memory.starts.clear();
    let Some(direction) = directions.iter().flatten().next() else { return };
    let spread = Spread {
        // Where nothing may be farther than the rest, nothing is.
        far_penalty: if direction.margin > 0.0 {
            let slow = direction.near / direction.margin;
            SLOW_PENALTY * slow * slow
        } else {
            SLOW_PENALTY
        },
        apart: TOUCH_PART * direction.near,
    };
    choose_points(candidates, &spread, memory);
    smooth(&mut memory.chosen, directions, &mut memory.rough);
    for (i, &start) in memory.starts.iter().enumerate() {
        let end = memory.starts.get(i + 1).copied().unwrap_or(memory.chosen.len());
        emit(&memory.chosen[start..end], WEIGHT_PART * direction.near, out);
    }
}

dispatched! {
    /// Finds the sides and the points of each.
    fn choose_points(candidates: &mut Candidates, spread: &Spread, memory: &mut Reduction) => choose_points_lanes
}

#[inline(always)]
fn choose_points_lanes<F: Lanes>(candidates: &mut Candidates, spread: &Spread, memory: &mut Reduction) {
    let Reduction { side, chosen, starts, .. } = memory;
    for _ in 0..SIDES_MAX {
        let Some(seed) = candidates.deepest::<F>() else { return };
        take_side::<F>(candidates, seed, side);
        let start = chosen.len();
        starts.push(start);
        chosen.push(candidates.at(seed));
        while chosen.len() < start + POINTS_MAX {
            let penalty =
                if chosen.len() < start + POINTS_MAX / 2 { DEPTH_PENALTY } else { spread.far_penalty };
            let newest = chosen[chosen.len() - 1].position;
            let Some(place) = farthest::<F>(candidates, side, newest, (penalty, spread.apart)) else { break };
            chosen.push(candidates.at(place));
        }
    }
}

/// Fills `side` with the candidates left whose normals are like that of the seed, and takes them out of those left.
#[inline(always)]
fn take_side<F: Lanes>(candidates: &mut Candidates, seed: Place, side: &mut Vec<Member8>) {
    let (zero, infinite) = (F::zero(), F::splat(f32::INFINITY));
    let of_seed = &candidates.blocks[seed.block];
    let normal = splat::<F>(lane(&of_seed.normal, seed.lane));
    let smallest = F::splat(of_seed.left.to_array()[seed.lane]);
    side.clear();
    for (k, block) in candidates.blocks.iter_mut().enumerate() {
        let left = F::from_array(block.left.to_array());
        let like = normal.dot(block.normal.form()).gt(F::splat(SIDE_COSINE)) & left.lt(infinite);
        // The seed itself, whatever rounding says of the length of its normal.
        let seed_bit = if k == seed.block { 1 << seed.lane } else { 0 };
        let members = F::Mask::from_bits(like.bits() | seed_bit);
        if !members.any() {
            continue;
        }
        let shallower = members.select((left - smallest).max(zero), zero);
        side.push(Member8 {
            block: k,
            shallower: Portable::from_array(shallower.to_array()),
            distance_squared: Portable::from_array(members.select(infinite, zero).to_array()),
        });
        block.left = Portable::from_array(members.select(infinite, left).to_array());
    }
}

/// The first of the members of a side that are farthest from those chosen, less a penalty for being shallow; none if
/// all are at one of those: no farther than `apart` (metres). `newest` is the last one chosen.
#[inline(always)]
fn farthest<F: Lanes>(
    candidates: &Candidates,
    side: &mut [Member8],
    newest: Vec3,
    (penalty, apart): (f32, f32),
) -> Option<Place> {
    let (newest, penalty) = (splat::<F>(newest), F::splat(penalty));
    let (mut best, mut at) = (F::splat(apart), F::zero());
    for member in side {
        let to_newest = candidates.blocks[member.block].position.form() - newest;
        let distance_squared =
            F::from_array(member.distance_squared.to_array()).min(to_newest.dot(to_newest));
        member.distance_squared = Portable::from_array(distance_squared.to_array());
        let score = distance_squared.sqrt() - penalty * F::from_array(member.shallower.to_array());
        let better = score.gt(best);
        best = better.select(score, best);
        at = better.select(F::splat(member.block as f32), at);
    }
    first_greatest(best, at, apart)
}

/// One manifold of up to four points, or two that share the points in turn. Points this `band` (metres) shallower than the deepest have no weight in
/// the mean normal.
fn emit(chosen: &[Candidate], band: f32, out: &mut Vec<Manifold>) {
    let smallest = chosen[0].separation;
    let weight = |c: &Candidate| (smallest + band - c.separation).max(0.0);
    let sum: Vec3 = chosen.iter().map(|c| c.normal * weight(c)).sum();
    let normal = sum.try_normalize().unwrap_or(chosen[0].normal);
    let manifolds = chosen.len().div_ceil(4);
    for turn in 0..manifolds {
        let mut manifold = Manifold { normal, points: [ContactPoint::FAR_APART; 4], count: 0 };
        for c in chosen.iter().skip(4 * turn).take(4) {
            let point = ContactPoint { position: c.position, normal: c.normal, separation: c.separation };
            manifold.points[manifold.count as usize] = point;
            manifold.count += 1;
        }
        out.push(manifold);
    }
}
