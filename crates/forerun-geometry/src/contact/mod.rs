//! Contact between two shapes: stateless manifolds.
//!
//! Promise: the result depends on the arguments alone, and `contact_manifolds(a, b)` lists the same points as
//! `contact_manifolds(b, a)` only up to rounding: callers fix the order (lower body first).
//!
//! One room for each family of pairs, one function for each pair (`shape_shape`). Round shapes have closed
//! formulas; two cuboids have a kernel of their own; whatever has faces and is not two cuboids goes through
//! `convex`. Without a memory of the last frame a manifold must not flip between two equally good answers: faces
//! are preferred to edges and the first shape's faces to the second's, each by a margin named where it is used.

use crate::{Pose, Shape, Vec3};

mod capsule;
mod clip;
mod compound;
mod convex;
mod cuboid;
mod cylinder;
mod gjk;
mod half_space;
mod mesh;
mod overlap;
mod passing;
mod penetration;
mod reduce;
mod solid;
mod sphere;

pub use cuboid::cuboid_cuboid;
pub use mesh::MOTION_AHEAD;

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
    /// The points; the first `count` are meant, the others are far apart (10⁶ m) and harmless.
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

/// Appends the manifolds of two shapes: none or one for a convex pair, several where a compound or a mesh takes part.
///
/// Only points whose separation is below `margin` (metres, 0 or more) are listed. The normal points from `first` to
/// `second`. What does not move (two half-spaces) has no contact. All numbers are assumed finite.
///
/// The motions decide about what is still apart: a contact that would stop shapes that in truth pass each other is left
/// out, and two cuboids are met at a corner or edge that no face brings together only if they are about to hit there.
pub fn contact_manifolds(first: &Placed, second: &Placed, margin: f32, out: &mut Vec<Manifold>) {
    ContactScratch::default().contact_manifolds(first, second, margin, out);
}

/// The memory that contacts are found in, to be used again from pair to pair. What is in it has no meaning: any scratch gives the same bits as a
/// new one.
#[derive(Clone, Debug, Default)]
pub struct ContactScratch {
    mesh: mesh::Memory,
}

impl ContactScratch {
    /// As [`contact_manifolds`]; what a steady sequence of pairs needs is allocated once.
    pub fn contact_manifolds(
        &mut self,
        first: &Placed,
        second: &Placed,
        margin: f32,
        out: &mut Vec<Manifold>,
    ) {
        match (first.shape, second.shape) {
            (Shape::Compound(_), _) | (_, Shape::Compound(_)) => {
                compound::compound_any(first, second, margin, self, out);
            }
            (Shape::Mesh(_), _) | (_, Shape::Mesh(_)) => {
                mesh::mesh_manifolds(first, second, margin, &mut self.mesh, out);
            }
            _ => {
                let found = convex_pair((first.shape, &first.pose), (second.shape, &second.pose), margin)
                    .or_else(|| convex::corner_about_to_hit(first, second, margin));
                out.extend(found.filter(|manifold| !passing::passes_by(first, second, manifold)));
            }
        }
    }
}

/// The manifold of two convex shapes, or of a convex shape and a half-space.
fn convex_pair(first: (&Shape, &Pose), second: (&Shape, &Pose), margin: f32) -> Option<Manifold> {
    use Shape::{Capsule, Cuboid, HalfSpace, Sphere};
    let ((a, pa), (b, pb)) = (first, second);
    match (a, b) {
        (HalfSpace, _) => half_space::half_space_any(pa, b, pb, margin),
        (_, HalfSpace) => half_space::half_space_any(pb, a, pa, margin).map(Manifold::flipped),
        (Sphere(s), _) => sphere::sphere_any(s, pa.position, second, margin),
        (_, Sphere(s)) => sphere::sphere_any(s, pb.position, first, margin).map(Manifold::flipped),
        (Capsule(c), Capsule(d)) => capsule::capsule_capsule(c, pa, d, pb, margin),
        (Cuboid(c), Cuboid(d)) => cuboid_cuboid(c, pa, d, pb, margin),
        _ => convex::convex_convex(first, second, margin),
    }
}

impl ContactPoint {
    /// Fills the unused places of a manifold.
    const FAR_APART: ContactPoint =
        ContactPoint { position: Vec3::ZERO, normal: Vec3::ZERO, separation: 1.0e6 };
}

impl Motion {
    /// Displacement of a point that moves along, to first order. Metres.
    fn of(&self, point: Vec3) -> Vec3 {
        self.linear + self.angular.cross(point - self.about)
    }
}

impl Manifold {
    /// A manifold of up to four points; none if there are none.
    fn from_points(points: &[ContactPoint]) -> Option<Manifold> {
        let first = points.first()?;
        let mut all = [ContactPoint::FAR_APART; 4];
        all[..points.len()].copy_from_slice(points);
        let sum = points.iter().fold(Vec3::ZERO, |sum, point| sum + point.normal);
        let same = points.iter().all(|point| point.normal == first.normal);
        let normal = if same { first.normal } else { unit_or(sum, first.normal) };
        Some(Manifold { normal, points: all, count: points.len() as u32 })
    }

    /// The same contact, seen from the other shape.
    fn flipped(mut self) -> Self {
        self.normal = -self.normal;
        for point in &mut self.points[..self.count as usize] {
            point.normal = -point.normal;
        }
        self
    }

    /// The points that are meant.
    #[must_use]
    pub fn points(&self) -> &[ContactPoint] {
        &self.points[..self.count as usize]
    }

    /// The smallest separation of all points. Metres.
    #[must_use]
    pub fn deepest(&self) -> f32 {
        self.points().iter().fold(f32::INFINITY, |least, point| least.min(point.separation))
    }
}

/// `vector` at length 1, or `fallback` (a unit vector) where it is too short to have a direction.
fn unit_or(vector: Vec3, fallback: Vec3) -> Vec3 {
    // Scaled first: the square of a short vector would vanish.
    let largest = vector.abs().max_element();
    if largest < 1.0e-12 {
        return fallback;
    }
    let scaled = vector / largest;
    scaled / scaled.length()
}

/// A unit vector across `direction` (unit): its cross product with the coordinate axis that it follows least.
fn any_perpendicular(direction: Vec3) -> Vec3 {
    let a = direction.abs();
    let axis = if a.x <= a.y && a.x <= a.z {
        Vec3::X
    } else if a.y <= a.z {
        Vec3::Y
    } else {
        Vec3::Z
    };
    let across = direction.cross(axis);
    across / across.length()
}
