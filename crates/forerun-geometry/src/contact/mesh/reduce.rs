//! Reduction: a few manifolds that stand for many candidates.
//!
//! Sides of the contact are found by normal: the deepest candidate left and all whose normals are within 60 degrees of
//! its own. Of each side up to eight points are kept that are far apart, deep ones first.

use super::Candidate;
use super::directions::Direction;
use super::points::RoundPoint;
use crate::Vec3;
use crate::contact::{ContactPoint, Manifold};
use crate::sdf::primitive::Surface;

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
/// Cosine of the largest angle by which smoothing may turn a normal: 20 degrees.
const SMOOTH_COSINE: f32 = 0.94;
/// Points nearer to each other than this are one. Metres.
const SAME_POINT: f32 = 0.005;
/// Points weigh in the mean normal by how far they are above this much more than the smallest separation. Metres.
const WEIGHT_BAND: f32 = 0.01;

/// Appends the manifolds of the candidates.
pub(super) fn reduce(candidates: &mut Vec<Candidate>, directions: &[Direction], out: &mut Vec<Manifold>) {
    for _ in 0..SIDES_MAX {
        let Some(seed) = deepest(candidates) else { return };
        let normal = candidates[seed].normal;
        // The seed first; the others stay in the order in which they were found.
        let mut side = vec![candidates.remove(seed)];
        candidates.retain(|c| {
            let belongs = c.normal.dot(normal) > SIDE_COSINE;
            if belongs {
                side.push(*c);
            }
            !belongs
        });
        let direction = &directions[side[0].direction];
        let mut chosen = choose(&side, DEPTH_PENALTY * direction.near / direction.margin, 0.25 * direction.near);
        for c in &mut chosen {
            smooth(c, &directions[c.direction]);
        }
        emit(&chosen, 0.5 * direction.near, out);
    }
}

/// The first of the candidates with the smallest separation.
fn deepest(candidates: &[Candidate]) -> Option<usize> {
    let mut best: Option<(usize, f32)> = None;
    for (i, c) in candidates.iter().enumerate() {
        if best.is_none_or(|(_, separation)| c.separation < separation) {
            best = Some((i, c.separation));
        }
    }
    best.map(|(i, _)| i)
}

/// Up to eight candidates of a side, the first among them: again and again the one farthest from those chosen, less a
/// penalty for being shallow. `far_penalty` is that of the second four: the far side of a fast ring that comes in
/// tilted is shallow now and deep at the end of the step.
fn choose(side: &[Candidate], far_penalty: f32, same: f32) -> Vec<Candidate> {
    let mut chosen = vec![side[0]];
    let mut left: Vec<Left> = side
        .iter()
        .map(|c| Left {
            position: c.position,
            shallower: (c.separation - side[0].separation).max(0.0),
            distance_squared: f32::INFINITY,
        })
        .collect();
    while chosen.len() < POINTS_MAX {
        let newest = chosen[chosen.len() - 1].position;
        let penalty = if chosen.len() < POINTS_MAX / 2 { DEPTH_PENALTY } else { far_penalty };
        let mut best = (same, None);
        for (i, c) in left.iter_mut().enumerate() {
            c.distance_squared = c.distance_squared.min(c.position.distance_squared(newest));
            // Squared it saves the root of most: the distance must be above the best score and the penalty.
            let needed = best.0 + penalty * c.shallower;
            if c.distance_squared > needed * needed {
                best = (c.distance_squared.sqrt() - penalty * c.shallower, Some(i));
            }
        }
        let (_, Some(i)) = best else { break };
        chosen.push(side[i]);
    }
    chosen
}

/// A candidate that may still be chosen.
struct Left {
    position: Vec3,
    /// How much larger its separation is than the smallest. Metres.
    shallower: f32,
    /// To the nearest of those chosen. Square metres.
    distance_squared: f32,
}

/// Replaces the normal of a candidate found in the field of a mesh by the smooth one.
fn smooth(c: &mut Candidate, direction: &Direction) {
    let Surface::Field(field) = &direction.surface else { return };
    // Beyond the grid there is nothing to take differences of.
    if !c.rough || !field.contains(c.point) {
        return;
    }
    let Some(smooth) = field.smooth_gradient(c.point).try_normalize() else { return };
    let point = RoundPoint { centre: c.point, radius: 0.0 };
    let smoothed = direction.candidate(point, smooth, c.separation, c.direction);
    // On round surfaces the two are within a few degrees. At edges and in the middle of thin parts the differences mix
    // sides that have nothing to do with each other.
    if smoothed.normal.dot(c.normal) > SMOOTH_COSINE {
        *c = smoothed;
    }
}

/// One manifold of up to four points, or two that share the points in turn.
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
