//! Directions: whose points are looked up in whose field.

use forerun_lanes::{Lanes, V8};
use glam::Mat3;

use super::{MOTION_AHEAD, near};
use crate::contact::{Motion, Placed};
use crate::sdf::Samples;
use crate::sdf::blur::Blur;
use crate::sdf::eight::splat;
use crate::sdf::nearest::Skin;
use crate::sdf::primitive::{Surface, hull_planes};
use crate::sdf::ridges::Ridges;
use crate::shape::{Enclosure, Mesh};
use crate::{Pose, Shape, Vec3};

use super::points::{PointList, Region, RoundPoint};

/// See [`Direction::inset`]; as part of half the thickness of the thinner shape.
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
#[derive(Clone, Copy)]
pub(super) struct Direction<'a> {
    pub(super) way: Way,
    /// The points, in their own frame.
    pub(super) points: Points<'a>,
    /// Long edges of the same shape.
    pub(super) ridges: &'a Ridges,
    /// What they are looked up in.
    pub(super) surface: Surface<'a>,
    /// The triangles of the surface if it is a mesh.
    pub(super) skin: Option<Skin<'a>>,
    /// Where the field blurs the edges of the surface.
    pub(super) blur: Option<&'a Blur>,
    /// By how much the field may take them to be farther away than they are. Metres.
    pub(super) blur_depth: f32,
    /// From the frame of the points to that of the field: rotation.
    pub(super) axes: Mat3,
    /// From the frame of the points to that of the field: translation. Metres.
    pub(super) origin: Vec3,
    /// Origin of the field's frame in the world. Metres.
    pub(super) field_position: Vec3,
    /// Rotation of the field in the world.
    pub(super) field_axes: Mat3,
    /// How the points are about to move.
    pub(super) goes: Going,
    /// How the field is.
    pub(super) comes: Going,
    /// What moves by x against the other comes nearer to it than tangents say by up to this times x²: surfaces are bent. 1/m
    pub(super) bend: f32,
    /// How far inside their own surface points are looked up that do not face the other one. Metres.
    pub(super) inset: f32,
    /// Points closer than this count, or that will be closer at the end of the step. Metres.
    pub(super) near: f32,
    /// Points farther than this do not count. Metres.
    pub(super) margin: f32,
}

impl Primitives {
    /// Works out the points and planes of the one of two shapes that is no mesh. `margin`: metres.
    fn fill(&mut self, first: &Placed, second: &Placed, margin: f32) {
        self.planes.clear();
        self.points.clear();
        for (sampled, field) in [(first, second), (second, first)] {
            if let Shape::Hull(hull) = sampled.shape {
                hull_planes(hull, &mut self.planes);
            }
            if let (shape, Shape::Mesh(mesh)) = (sampled.shape, field.shape) {
                let surface = mesh_surface(mesh, 2.0 * shape.half_thickness());
                let to_field = field.pose.inverse() * sampled.pose;
                let region = region_of(mesh, &to_field.inverse(), margin);
                let gradient = |p: Vec3| {
                    let (_, g) = surface.exact(to_field.transform_point(p), None, &mut None);
                    to_field.inverse_transform_vector(g)
                };
                self.points.fill(shape, &region, gradient);
            }
        }
    }
}

impl Direction<'_> {
    /// The same for what is nearer than half the thickness of the thinner shape, whatever the motion.
    pub(super) fn close(&self) -> Self {
        let half_thickness = self.inset / INSET_PART;
        Direction { margin: self.margin.min(self.near + half_thickness), ..*self }
    }

    /// Whether all points count that are near enough, however they move.
    #[inline(always)]
    pub(super) fn is_slow(&self) -> bool {
        self.margin <= self.near
    }

    /// What turns the field's gradient into the normal from the first shape to the second: it leads away from the shape whose field it is.
    #[inline(always)]
    pub(super) fn sign(&self) -> f32 {
        match self.way {
            Way::There => -1.0,
            Way::Back => 1.0,
        }
    }
}

/// A motion in the field's frame, with some to spare: a point x is about to move by `drift + spin × x`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Going {
    /// Metres.
    drift: Vec3,
    /// Radians.
    spin: Vec3,
    /// Length of `spin`. Radians.
    turn: f32,
}

impl Going {
    /// `at`: the origin of the field's frame. Metres.
    fn new(motion: &Motion, at: Vec3, into_field: &Mat3) -> Going {
        let drift = motion.linear + motion.angular.cross(at - motion.about);
        // No point goes farther than across its circle, whatever the spin: so far the bounds of bodies reach, too.
        let spin = (*into_field * motion.angular * MOTION_AHEAD).clamp_length_max(2.0);
        Going { drift: *into_field * drift * MOTION_AHEAD, spin, turn: spin.length() }
    }

    /// The motion of points of the field's frame. Metres.
    #[inline(always)]
    pub(super) fn at<F: Lanes>(&self, points: V8<F>) -> V8<F> {
        splat::<F>(self.spin).cross(points) + splat(self.drift)
    }

    /// Radians.
    pub(super) fn turn(&self) -> f32 {
        self.turn
    }

    /// How far points of balls move at most: no further than the centre, and what turning about it adds. Metres.
    #[inline(always)]
    pub(super) fn at_most<F: Lanes>(&self, centres: V8<F>, radii: F) -> F {
        self.at(centres).length() + radii * F::splat(self.turn)
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
    let axes = [first.pose.axes(), second.pose.axes()];
    if let (Shape::Mesh(a), Shape::Mesh(b)) = (first.shape, second.shape) {
        let into = axes[1].transpose();
        let place = into * (first.pose.position - second.pose.position);
        if are_apart(&(into * axes[0]), place, [a, b], margin) {
            return [None, None];
        }
    } else {
        memory.fill(first, second, margin);
    }
    [
        direction([first, second], axes, (Way::There, margin), memory),
        direction([second, first], [axes[1], axes[0]], (Way::Back, margin), memory),
    ]
}

/// Whether the boxes of two meshes, the first turned by `axes` and moved by `origin` in the frame of the second, are farther apart than `margin` along
/// an axis of either. Metres.
fn are_apart(axes: &Mat3, origin: Vec3, [first, second]: [&Mesh; 2], margin: f32) -> bool {
    let [(c1, h1), (c2, h2)] = [first, second].map(|mesh| {
        let b = mesh.bounds();
        ((b.min + b.max) * 0.5, (b.max - b.min) * 0.5)
    });
    // A little more, for what rounding may lose.
    let margin = Vec3::splat(margin * 1.0001 + 1e-6);
    let between = *axes * c1 + origin - c2;
    let sizes = Mat3::from_cols(axes.x_axis.abs(), axes.y_axis.abs(), axes.z_axis.abs());
    (between.abs() - (sizes * h1 + h2)).cmpgt(margin).any()
        || ((axes.transpose() * between).abs() - (sizes.transpose() * h2 + h1)).cmpgt(margin).any()
}

/// Points of `sampled` in the field of `field`, whose axes in the world are given; none if `sampled` has no points.
fn direction<'a>(
    [sampled, field]: [&Placed<'a>; 2],
    [sampled_axes, field_axes]: [Mat3; 2],
    (way, margin): (Way, f32),
    memory: &'a Primitives,
) -> Option<Direction<'a>> {
    let (points, ridges) = match sampled.shape {
        Shape::Mesh(mesh) => (Points::Sharp(&mesh.collider().samples), &mesh.collider().ridges),
        _ => memory.points.points()?,
    };
    let surface = match field.shape {
        Shape::Mesh(mesh) => mesh_surface(mesh, 2.0 * sampled.shape.half_thickness()),
        shape => primitive_surface(shape, &memory.planes)?,
    };
    let near = near(sampled.shape, field.shape, margin);
    // The triangles of a mended mesh do not tell its sides.
    let (skin, blur) = match field.shape {
        Shape::Mesh(mesh) if mesh.enclosure != Enclosure::Mended => {
            (Some(Skin::of(mesh)), Some(&mesh.collider().blur).filter(|b| b.is_any()))
        }
        _ => (None, None),
    };
    let into_field = field_axes.transpose();
    let at = field.pose.position;
    Some(Direction {
        way,
        points,
        ridges,
        surface,
        skin,
        blur,
        blur_depth: blur.map_or(0.0, |b| b.depth),
        axes: into_field * sampled_axes,
        origin: into_field * (sampled.pose.position - at),
        field_position: at,
        field_axes,
        goes: Going::new(&sampled.motion, at, &into_field),
        comes: Going::new(&field.motion, at, &into_field),
        bend: bend(sampled.shape, field.shape),
        inset: INSET_PART * sampled.shape.half_thickness().min(field.shape.half_thickness()),
        near,
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

/// See [`Direction::bend`]: half of one over the radius of the bends that matter, for each of two meshes taken to be its own. Beside what is flat or convex
/// tangents tell the truth, but for turns.
fn bend(sampled: &Shape, field: &Shape) -> f32 {
    let of = |mesh: &Mesh| 0.5 / mesh.ball().radius;
    match (sampled, field) {
        (Shape::Mesh(sampled), Shape::Mesh(field)) => of(sampled) + of(field),
        _ => 0.0,
    }
}

/// The ball around a mesh, grown by `margin`, in the frame of the primitive.
fn region_of(mesh: &Mesh, to_primitive: &Pose, margin: f32) -> Region {
    let ball = mesh.ball();
    let spacing = if mesh.has_inside() { 2.0 * mesh.half_thickness() } else { ball.radius };
    Region { centre: to_primitive.transform_point(ball.centre), radius: ball.radius + margin, spacing }
}
