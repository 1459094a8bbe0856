//! Contact with meshes, convex or not: points of one surface looked up in the distance field of the other.
//!
//! Four steps: *directions* (whose points are looked up in whose field), *culling* (spheres of points that are far
//! away), *look-ups* (points near the other surface, or about to be, become candidates) and *reduction* (a few
//! manifolds that stand for all candidates). Guendelman, Bridson, Fedkiw, *Nonconvex Rigid Bodies with Stacking* (2003),
//! section 3, looks up vertices and edge points of triangle meshes in signed distance functions in the same way.
//!
//! Promise: a pure function of its arguments; nothing is remembered from frame to frame.

use super::{Manifold, Placed};
use crate::{Pose, Shape, Vec3};

mod directions;
mod look_up;
mod points;
mod reduce;

use directions::Direction;

/// Motion ahead that contact is looked for in, as a multiple of the motion of the step: contacts push bodies too.
const MOTION_AHEAD: f32 = 1.2;

/// A point of one surface near the other.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// The point in the frame of the field. Metres.
    point: Vec3,
    /// Radius of the ball about the point that belongs to the shape: 0 for points of the surface itself. Metres.
    radius: f32,
    /// Midpoint between the two surfaces, in the world. Metres.
    position: Vec3,
    /// Unit normal in the world, from the first shape to the second.
    normal: Vec3,
    /// Distance between the surfaces. Metres.
    separation: f32,
    /// The direction that found it.
    direction: u32,
}

/// Appends the manifolds between two shapes of which at least one is a mesh: where they touch, are within `margin`
/// (metres) of touching, or will be within the step.
///
/// Each point has a normal of its own; up to two manifolds with up to eight points share a side of the contact.
pub fn mesh_manifolds(first: &Placed, second: &Placed, margin: f32, out: &mut Vec<Manifold>) {
    let reach = reach(first, second, margin);
    let mut directions: Vec<Direction> = Vec::new();
    let mut candidates: Vec<Candidate> = Vec::new();
    for a in &parts(first) {
        for b in &parts(second) {
            for direction in directions::between((first, a), (second, b), [margin, reach]) {
                look_up::find(&direction, directions.len() as u32, &mut candidates);
                directions.push(direction);
            }
        }
    }
    reduce::reduce(&mut candidates, &directions, out);
}

/// A part of a placed shape: all of it, or a part of a compound.
struct Part<'a> {
    shape: &'a Shape,
    pose: Pose,
}

fn parts<'a>(placed: &Placed<'a>) -> Vec<Part<'a>> {
    match placed.shape {
        Shape::Compound(compound) => {
            compound.parts.iter().map(|(pose, shape)| Part { shape, pose: placed.pose * *pose }).collect()
        }
        shape => vec![Part { shape, pose: placed.pose }],
    }
}

/// How far apart surfaces may be and still touch within the step: the margin, or more for fast shapes. Metres.
fn reach(first: &Placed, second: &Placed, margin: f32) -> f32 {
    let turning = |p: &Placed| {
        let centre = p.pose.inverse_transform_point(p.motion.about);
        let angle = p.motion.angular.length();
        // Half-spaces are infinite; they do not turn.
        if angle > 0.0 { angle * p.shape.radius_about(centre).min(1e6) } else { 0.0 }
    };
    let motion = (first.motion.linear - second.motion.linear).length() + turning(first) + turning(second);
    margin.max(MOTION_AHEAD * motion)
}
