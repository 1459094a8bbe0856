//! Directions: whose points are looked up in whose field.

use glam::Mat3;

use super::{MOTION_AHEAD, near};
use crate::contact::Placed;
use crate::sdf::Samples;
use crate::sdf::nearest::Skin;
use crate::sdf::primitive::{Surface, hull_planes};
use crate::shape::{Enclosure, Mesh};
use crate::{Pose, Shape, Vec3};

use super::points::{PointList, Region, RoundPoint};

/// See [`Direction::inset`]; as part of half the thickness of the shape.
const INSET_PART: f32 = 0.25;

/// Which of the two directions of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// Points of the first shape in the field of the second.
    There = 0,
    /// Points of the second shape in the field of the first.
    Back = 1,
}

/// What is worked out anew for each pair of a mesh and another shape: the points and planes of the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Primitives {
    points: PointList,
    /// Of a hull, see [`Surface::Hull`].
    planes: Vec<(Vec3, f32)>,
}

/// Points of one shape to be looked up in the field of another.
pub(super) struct Direction<'a> {
    pub(super) way: Way,
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
    /// How far inside their own surface points are looked up that do not face the other one. Metres.
    pub(super) inset: f32,
    /// Points closer than this count, or that will be closer at the end of the step. Metres.
    pub(super) near: f32,
    /// Points farther than this do not count. Metres.
    pub(super) margin: f32,
}

impl Direction<'_> {
    /// What turns the field's gradient into the normal from the first shape to the second: it leads away from the shape whose field it is.
    #[inline(always)]
    pub(super) fn sign(&self) -> f32 {
        match self.way {
            Way::There => -1.0,
            Way::Back => 1.0,
        }
    }
}

/// Points of a surface.
#[derive(Clone, Copy)]
pub(super) enum Points<'a> {
    /// Corners and points along edges.
    Sharp(&'a Samples),
    /// Of a rounded primitive: points along its axis, each with a radius.
    Round(&'a [RoundPoint]),
}

/// The directions of two shapes: the points of the first in the field of the second, then the other way round, as far
/// as there are points and fields. `margin`: metres.
pub(super) fn between<'a>(
    first: &Placed<'a>,
    second: &Placed<'a>,
    margin: f32,
    memory: &'a mut Primitives,
) -> [Option<Direction<'a>>; 2] {
    memory.planes.clear();
    for shape in [first.shape, second.shape] {
        if let Shape::Hull(hull) = shape {
            hull_planes(hull, &mut memory.planes);
        }
    }
    memory.points.clear();
    for (sampled, field) in [(first, second), (second, first)] {
        if let (shape, Shape::Mesh(mesh)) = (sampled.shape, field.shape) {
            let surface = mesh_surface(mesh, 2.0 * shape.half_thickness());
            let to_field = field.pose.inverse() * sampled.pose;
            let region = region_of(mesh, &to_field.inverse(), margin);
            let gradient = |p: Vec3| {
                let (_, g) = surface.exact(to_field.transform_point(p), None, &mut None);
                to_field.inverse_transform_vector(g)
            };
            memory.points.fill(shape, &region, gradient);
        }
    }
    [
        direction([first, second], Way::There, margin, memory),
        direction([second, first], Way::Back, margin, memory),
    ]
}

/// Points of `sampled` in the field of `field`; none if `sampled` has no points.
fn direction<'a>(
    [sampled, field]: [&Placed<'a>; 2],
    way: Way,
    margin: f32,
    memory: &'a Primitives,
) -> Option<Direction<'a>> {
    let points = match (sampled.shape, field.shape) {
        (Shape::Mesh(mesh), _) => Points::Sharp(&mesh.collider().samples),
        _ => memory.points.points()?,
    };
    let surface = match field.shape {
        Shape::Mesh(mesh) => mesh_surface(mesh, 2.0 * sampled.shape.half_thickness()),
        shape => primitive_surface(shape, &memory.planes)?,
    };
    // The triangles of a mended mesh do not tell its sides.
    let (skin, blur) = match field.shape {
        Shape::Mesh(mesh) if mesh.enclosure != Enclosure::Mended => {
            (Some(Skin::of(mesh)), mesh.collider().blur)
        }
        _ => (None, 0.0),
    };
    let to_field = field.pose.inverse() * sampled.pose;
    // Relative motion of points of the sampled shape, seen from the field, about the origin of the field's frame.
    let (s, f) = (&sampled.motion, &field.motion);
    let spin = s.angular - f.angular;
    let at = field.pose.position;
    let drift = s.linear + s.angular.cross(at - s.about) - f.linear - f.angular.cross(at - f.about);
    let into_field = |v: Vec3| field.pose.inverse_transform_vector(v) * MOTION_AHEAD;
    Some(Direction {
        way,
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
        inset: INSET_PART * sampled.shape.half_thickness(),
        near: near(sampled.shape, field.shape, margin),
        margin,
    })
}

/// The field of a mesh. `depth_limit`: see [`Surface::Sheet`].
fn mesh_surface(mesh: &Mesh, depth_limit: f32) -> Surface<'_> {
    match &mesh.collider().field {
        Some(field) => Surface::Field(field),
        None => Surface::Sheet(Skin::of(mesh), depth_limit),
    }
}

/// The field of a primitive, `planes` being those of a hull; none for compounds, whose parts have one each.
fn primitive_surface<'a>(shape: &Shape, planes: &'a [(Vec3, f32)]) -> Option<Surface<'a>> {
    Some(match shape {
        Shape::Sphere(s) => Surface::Sphere(s.radius),
        Shape::Cuboid(c) => Surface::Cuboid(*c),
        Shape::Capsule(c) => Surface::Capsule(*c),
        Shape::Cylinder(c) => Surface::Cylinder(*c),
        Shape::Hull(_) => Surface::Hull(planes),
        Shape::HalfSpace => Surface::HalfSpace,
        Shape::Compound(_) | Shape::Mesh(_) => return None,
    })
}

/// The ball around a mesh, grown by `margin`, in the frame of the primitive.
fn region_of(mesh: &Mesh, to_primitive: &Pose, margin: f32) -> Region {
    let radius = mesh.collider().radius;
    let spacing = if mesh.has_inside() { 2.0 * mesh.half_thickness() } else { radius };
    Region { centre: to_primitive.position, radius: radius + margin, spacing }
}
