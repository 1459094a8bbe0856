//! Directions: whose points are looked up in whose field.

use glam::Mat3;

use super::{MOTION_AHEAD, NEAR};
use crate::contact::{Motion, Placed};
use crate::sdf::Samples;
use crate::sdf::lanes::Lanes3;
use crate::sdf::nearest::Skin;
use crate::sdf::primitive::{Surface, hull_planes};
use crate::shape::{Enclosure, Mesh};
use crate::{Pose, Shape, Vec3};

use super::points::{self, Region, RoundPoint};

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
    /// How the points are about to move.
    pub(super) goes: Going,
    /// How the field is.
    pub(super) comes: Going,
    /// What moves by x against the other comes nearer to it than the tangents say by up to this times x²: surfaces are bent. 1/m
    pub(super) bend: f32,
    /// 1 if the field is the first shape's: its gradient then points to the second; -1 otherwise.
    pub(super) sign: f32,
    /// How far inside their own surface points are looked up that do not face the other one. Metres.
    pub(super) inset: f32,
    /// Points closer than this count, or that will be closer at the end of the step. Metres.
    pub(super) near: f32,
    /// Points farther than this do not count. Metres.
    pub(super) margin: f32,
}

/// A motion in the field's frame, with some to spare: a point x is about to move by `drift + spin × x`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Going {
    /// Metres.
    drift: Vec3,
    /// Radians.
    pub(super) spin: Vec3,
}

impl Going {
    fn new(motion: &Motion, field: &Pose) -> Going {
        let into_field = |v: Vec3| field.inverse_transform_vector(v) * MOTION_AHEAD;
        let drift = motion.linear + motion.angular.cross(field.position - motion.about);
        Going { drift: into_field(drift), spin: into_field(motion.angular) }
    }

    /// The motion of points of the field's frame. Metres.
    #[inline(always)]
    pub(super) fn at(&self, points: Lanes3) -> Lanes3 {
        let (w, p) = (self.spin, points);
        let spun = Lanes3 { x: p.z * w.y - p.y * w.z, y: p.x * w.z - p.z * w.x, z: p.y * w.x - p.x * w.y };
        spun.plus(Lanes3::splat(self.drift))
    }
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
    Some(Direction {
        points,
        surface,
        skin,
        blur,
        axes: to_field.axes(),
        origin: to_field.position,
        field_pose: field.pose,
        field_axes: field.pose.axes(),
        goes: Going::new(&sampled.motion, &field.pose),
        comes: Going::new(&field.motion, &field.pose),
        bend: bend(sampled.shape) + bend(field.shape),
        sign,
        inset: INSET_PART * sampled.shape.half_thickness(),
        near: NEAR.min(margin),
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

/// See [`Direction::bend`]: half of one over the radius of the bends that matter, taken to be that of the mesh. What primitives there are is convex, and flat
/// enough: what moves past comes no nearer than their tangents say.
fn bend(shape: &Shape) -> f32 {
    if let Shape::Mesh(mesh) = shape { 0.5 / mesh.collider().radius } else { 0.0 }
}

/// The ball around a mesh, grown by `margin`, in the frame of the primitive.
fn region_of(mesh: &Mesh, to_primitive: &Pose, margin: f32) -> Region {
    let radius = mesh.collider().radius;
    let spacing = if mesh.has_inside() { 2.0 * mesh.half_thickness() } else { radius };
    Region { centre: to_primitive.position, radius: radius + margin, spacing }
}
