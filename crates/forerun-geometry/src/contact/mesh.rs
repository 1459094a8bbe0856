//! Contact with meshes, convex or not: points of one surface looked up in the distance field of the other.
//!
//! Four steps: *directions* (whose points are looked up in whose field), *culling* (spheres of points that are far
//! away), *look-ups* (points near the other surface, or about to be, become candidates) and *reduction* (a few
//! manifolds that stand for all candidates). Guendelman, Bridson, Fedkiw, *Nonconvex Rigid Bodies with Stacking* (2003),
//! section 3, looks up vertices and edge points of triangle meshes in signed distance functions in the same way.
//!
//! Promise: a pure function of its arguments; nothing is remembered from frame to frame.

use super::{Manifold, Placed};
use crate::Vec3;

mod directions;
mod look_up;
mod points;
mod reduce;
mod ridges;
mod sharp;

/// Points this near to the other surface count however they move; points farther away only if they will be as near as
/// this at the end of the step. Metres.
const NEAR: f32 = 0.02;
/// Motion ahead that contact is looked for in, as a multiple of the motion of the step: contacts push bodies too.
const MOTION_AHEAD: f32 = 1.2;

/// A point of one surface near the other.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// The point in the frame of the field. Metres.
    point: Vec3,
    /// Whether the normal is that of trilinear interpolation at the point and may be smoothed.
    rough: bool,
    /// Midpoint between the two surfaces, in the world. Metres.
    position: Vec3,
    /// Unit normal in the world, from the first shape to the second.
    normal: Vec3,
    /// Distance between the surfaces. Metres.
    separation: f32,
    /// The direction that found it.
    direction: usize,
}

/// Appends the manifolds between two shapes of which at least one is a mesh and none a compound.
///
/// Points are listed whose separation is below `margin` (metres) and that are near the other surface or will be within
/// the step. Each has a normal of its own; two manifolds with up to eight points may share a side of the contact.
pub(super) fn mesh_manifolds(first: &Placed, second: &Placed, margin: f32, out: &mut Vec<Manifold>) {
    let directions = directions::between(first, second, margin);
    let mut candidates: Vec<Candidate> = Vec::new();
    for (index, direction) in directions.iter().enumerate() {
        look_up::find(direction, index, &mut candidates);
        ridges::find(direction, index, &mut candidates);
    }
    reduce::reduce(&mut candidates, &directions, out);
}
