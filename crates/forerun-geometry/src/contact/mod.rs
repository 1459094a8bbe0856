//! Contact between two shapes: stateless manifolds.
//!
//! Promise: the result depends on the arguments alone, and `contact_manifolds(a, b)` lists the same points as
//! `contact_manifolds(b, a)` only up to rounding: callers fix the order (lower body first).

use crate::{Pose, Shape, Vec3};

/// One point of a manifold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Midpoint between the two surfaces, in the world. Metres.
    pub position: Vec3,
    /// Unit normal at this point, from the first shape to the second.
    pub normal: Vec3,
    /// Distance between the surfaces along the normal; negative where they overlap. Metres.
    pub separation: f32,
}

/// Up to four points in which two shapes touch or may soon touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manifold {
    /// Mean unit normal, from the first shape to the second.
    pub normal: Vec3,
    /// The points; the first `count` are meant.
    pub points: [ContactPoint; 4],
    /// How many points there are, 1 to 4.
    pub count: u32,
}

/// How far a shape is about to move: velocity times the length of the step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Displacement of the reference point. Metres.
    pub linear: Vec3,
    /// Rotation vector in the world. Radians.
    pub angular: Vec3,
    /// The point that `linear` is about (a body's centre of mass), in the world. Metres.
    pub about: Vec3,
}

/// A shape somewhere in the world, about to move.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// The shape.
    pub shape: &'a Shape,
    /// Where its frame is.
    pub pose: Pose,
    /// How far it is about to move.
    pub motion: Motion,
}

/// Appends the manifolds of two shapes that come nearer than `margin` (metres).
pub fn contact_manifolds(_first: &Placed, _second: &Placed, _margin: f32, _out: &mut Vec<Manifold>) {}
