//! Contact with meshes, convex or not: points of one surface looked up in the distance field of the other.
//!
//! Four steps: *directions* (whose points are looked up in whose field), *culling* (spheres of points that are far
//! away), *look-ups* (points near the other surface, or about to be, become candidates) and *reduction* (a few
//! manifolds that stand for all candidates). Guendelman, Bridson, Fedkiw, *Nonconvex Rigid Bodies with Stacking* (2003),
//! section 3, looks up vertices and edge points of triangle meshes in signed distance functions in the same way.
//!
//! Promise: a pure function of its arguments; nothing is remembered from frame to frame.

use super::{Manifold, Placed};
use crate::Shape;

mod candidates;
mod course;
mod directions;
mod look_up;
mod points;
mod reduce;
mod ridges;
mod sharp;
mod smooth;

use candidates::Candidates;
use directions::Primitives;
use reduce::Reduction;

/// Points this near to the other surface count however they move; points farther away only if they will be as near as
/// this at the end of the step. Metres, for shapes with half a thickness of 5 cm or more.
///
/// All lengths that contact is found with are parts of the one that [`near`] gives for a pair: links, threads and teeth of
/// millimetres get the same contacts as those of decimetres, only smaller.
const NEAR: f32 = 0.02;
/// The same for thinner shapes, as part of half the thickness of the thinner of the two: of what is farther away there is another side.
const NEAR_PART: f32 = 0.4;
/// Points nearer to each other than this are one, and points this near to the other surface touch it. As part of [`near`].
const TOUCH_PART: f32 = 0.25;
/// Points weigh in the mean normal by how far they are above this much more than the smallest separation. As part of [`near`].
const WEIGHT_PART: f32 = 0.5;
/// Motion ahead that contact is looked for in, as a multiple of the motion of the step: contacts push bodies too.
pub const MOTION_AHEAD: f32 = 1.2;

/// The memory that contact with meshes is found in. What it holds between two searches means nothing.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory {
    primitives: Primitives,
    candidates: Candidates,
    reduction: Reduction,
}

/// Appends the manifolds between two shapes of which at least one is a mesh and none a compound.
///
/// Points are listed whose separation is below `margin` (metres) and that are near the other surface or will be within
/// the step. Each has a normal of its own; two manifolds with up to eight points may share a side of the contact.
pub(super) fn mesh_manifolds(
    first: &Placed,
    second: &Placed,
    margin: f32,
    memory: &mut Memory,
    out: &mut Vec<Manifold>,
) {
    let Memory { primitives, candidates, reduction } = memory;
    let directions = directions::between(first, second, margin, primitives);
    candidates.clear();
    for direction in directions.iter().flatten() {
        look_up::find(direction, candidates);
        // Both ways: where edges cross only the sharper one sees both sides of the other.
        if ridges::has_any(direction) {
            ridges::find(direction, candidates);
        }
    }
    reduce::reduce(candidates, &directions, reduction, out);
}

/// How near points of the one shape must come to the other to count. Metres.
fn near(first: &Shape, second: &Shape, margin: f32) -> f32 {
    NEAR.min(NEAR_PART * first.half_thickness().min(second.half_thickness())).min(margin)
}
