//! Directions: whose points are looked up in whose field.

use glam::Mat3;

use super::{MOTION_AHEAD, NEAR};
use crate::contact::Placed;
use crate::sdf::Samples;
use crate::sdf::nearest::Skin;
use crate::sdf::primitive::{Surface, hull_planes};
use crate::shape::{Enclosure, Mesh};
use crate::{Pose, Shape, Vec3};

use super::points::{self, Region, RoundPoint};

const NEAR_PART: f32 = 0.4;
/// See [`Direction::inset`]; as part of half the thickness of the shape.
const INSET_PART: f32 = 0.25;

/// Points of one shape to be looked up in the field of another.
pub(super) struct Direction<'a> {
    /// The points, in their own frame.
    pub(super) points: Points<'a>,
    /// What they are looked up in.
    pub(super) surface: Surface<'a>,
    /// The triangles of the surface if it is a mesh.
    pub(super) skin: Option<Skin<'a>>,
    /// By how much the surface may take edges and corners to be farther away than they are. Metres.
    pub(super) blur: f32,
    /// From the frame of the points to that of the field: rotation.
    pub(super) axes: Mat3,
    /// From the frame of the points to that of the field: translation. Metres.
    pub(super) origin: Vec3,
    /// Where the field is in the world.
    pub(super) field_pose: Pose,
    /// Rotation of the field in the world.
    pub(super) field_axes: Mat3,
    /// A point x of the field's frame is about to move by `drift + spin × x`, with some to spare. Metres.
    pub(super) drift: Vec3,
    /// See `drift`. Radians.
    pub(super) spin: Vec3,
    /// 1 if the field is the first shape's: its gradient then points to the second; -1 otherwise.
    pub(super) sign: f32,
    /// How far inside their own surface points are looked up that do not face the other one. Metres.
    pub(super) inset: f32,
    /// Points closer than this count, or that will be closer at the end of the step. Metres.
    pub(super) near: f32,
    /// Points farther than this do not count. Metres.
    pub(super) margin: f32,
}

/// Points of a surface.
pub(super) enum Points<'a> {
    /// Of a mesh, in a hierarchy.
    Mesh(&'a Samples),
    /// Of a primitive: corners and points along edges.
    Sharp(Samples),
    /// Of a rounded primitive: points along its axis, each with a radius.
    Round(Vec<RoundPoint>),
}

/// The directions of two shapes: the points of the first in the field of the second, then the other way round, as far
/// as there are points and fields. `margin`: metres.
pub(super) fn between<'a>(first: &Placed<'a>, second: &Placed<'a>, margin: f32) -> Vec<Direction<'a>> {
    let there = direction(first, second, margin, -1.0);
    let back = direction(second, first, margin, 1.0);
    there.into_iter().chain(back).collect()
}

/// Points of `sampled` in the field of `field`; none if `sampled` has no points.
fn direction<'a>(sampled: &Placed<'a>, field: &Placed<'a>, margin: f32, sign: f32) -> Option<Direction<'a>> {
    let to_field = field.pose.inverse() * sampled.pose;
    let surface = surface_of(field.shape, 2.0 * sampled.shape.half_thickness())?;
    // The triangles of a mended mesh do not tell its sides.
    let (skin, blur) = match field.shape {
        Shape::Mesh(mesh) if mesh.enclosure != Enclosure::Mended => {
            (Some(Skin::of(mesh)), mesh.collider().blur)
        }
        _ => (None, 0.0),
    };
    let points = match (sampled.shape, field.shape) {
        (Shape::Mesh(mesh), _) => Points::Mesh(&mesh.collider().samples),
        (shape, Shape::Mesh(mesh)) => {
            let region = region_of(mesh, &to_field.inverse(), margin);
            let gradient = |p: Vec3| {
                let (_, g) = surface.exact(to_field.transform_point(p), None, &mut None);
                to_field.inverse_transform_vector(g)
            };
            points::of(shape, &region, gradient)?
        }
        _ => return None,
    };
    // Relative motion of points of the sampled shape, seen from the field, about the origin of the field's frame.
    let (s, f) = (&sampled.motion, &field.motion);
    let spin = s.angular - f.angular;
    let at = field.pose.position;
    let drift = s.linear + s.angular.cross(at - s.about) - f.linear - f.angular.cross(at - f.about);
    let into_field = |v: Vec3| field.pose.inverse_transform_vector(v) * MOTION_AHEAD;
    Some(Direction {
        points,
        surface,
        skin,
        blur,
        axes: to_field.axes(),
        origin: to_field.position,
        field_pose: field.pose,
        field_axes: field.pose.axes(),
        drift: into_field(drift),
        spin: into_field(spin),
        sign,
        inset: INSET_PART * sampled.shape.half_thickness(),
        near: NEAR.min(margin).min(NEAR_PART * sampled.shape.half_thickness().min(field.shape.half_thickness())),
        margin,
    })
}

/// The field of a shape; none for compounds, whose parts have one each. `depth_limit`: see [`Surface::Sheet`].
fn surface_of(shape: &Shape, depth_limit: f32) -> Option<Surface<'_>> {
    Some(match shape {
        Shape::Sphere(s) => Surface::Sphere(s.radius),
        Shape::Cuboid(c) => Surface::Cuboid(*c),
        Shape::Capsule(c) => Surface::Capsule(*c),
        Shape::Cylinder(c) => Surface::Cylinder(*c),
        Shape::Hull(hull) => Surface::Hull(hull_planes(hull)),
        Shape::HalfSpace => Surface::HalfSpace,
        Shape::Compound(_) => return None,
        Shape::Mesh(mesh) => match &mesh.collider().field {
            Some(field) => Surface::Field(field),
            None => Surface::Sheet(Skin::of(mesh), depth_limit),
        },
    })
}

/// The ball around a mesh, grown by `margin`, in the frame of the primitive.
fn region_of(mesh: &Mesh, to_primitive: &Pose, margin: f32) -> Region {
    let radius = mesh.collider().radius;
    let spacing = if mesh.has_inside() { 2.0 * mesh.half_thickness() } else { radius };
    Region { centre: to_primitive.position, radius: radius + margin, spacing }
}
