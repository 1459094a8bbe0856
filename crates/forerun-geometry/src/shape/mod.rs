//! Shapes: what a body looks like to the physics.

use std::sync::Arc;

use crate::{Aabb, MassProperties, Pose, Vec3};
use glam::Quat;

mod compound;
mod hull;
mod mesh;

pub use compound::Compound;
pub use hull::{Hull, HullEdge, HullFace};
pub use mesh::Mesh;

/// A shape in a frame of its own. Cloning is cheap: large shapes are shared.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A ball about the origin.
    Sphere(Sphere),
    /// A box about the origin, by half extents.
    Cuboid(Cuboid),
    /// All points within a radius of a segment along y.
    Capsule(Capsule),
    /// A solid cylinder along y.
    Cylinder(Cylinder),
    /// A convex polyhedron.
    Hull(Arc<Hull>),
    /// All points with y at or below 0: the ground. Never dynamic.
    HalfSpace,
    /// Several convex shapes held rigidly together.
    Compound(Arc<Compound>),
    /// A closed triangle mesh, convex or not.
    Mesh(Arc<Mesh>),
}

/// A ball about the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Radius. Metres, above 0.
    pub radius: f32,
}

/// A box about the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// Half the size along x, y and z. Metres, above 0.
    pub half_extents: Vec3,
}

/// All points within `radius` of the segment from (0, -half_height, 0) to (0, half_height, 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Half the length of the inner segment. Metres, 0 or more.
    pub half_height: f32,
    /// Radius. Metres, above 0.
    pub radius: f32,
}

/// A solid cylinder about the origin, along y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Half the height. Metres, above 0.
    pub half_height: f32,
    /// Radius. Metres, above 0.
    pub radius: f32,
}

impl Shape {
    /// Mass properties at a uniform density (kg/m³).
    #[must_use]
    pub fn mass_properties(&self, density: f32) -> MassProperties {
        let (mass, principal_inertia) = match self {
            Shape::Sphere(s) => {
                let mass = density * (4.0 / 3.0) * std::f32::consts::PI * s.radius * s.radius * s.radius;
                (mass, Vec3::splat(0.4 * mass * s.radius * s.radius))
            }
            Shape::Cuboid(c) => {
                let h = c.half_extents;
                let mass = density * 8.0 * h.x * h.y * h.z;
                let q = h * h;
                (mass, Vec3::new(q.y + q.z, q.x + q.z, q.x + q.y) * (mass / 3.0))
            }
            _ => (0.0, Vec3::ZERO),
        };
        MassProperties { mass, centre: Vec3::ZERO, principal_inertia, principal_rotation: Quat::IDENTITY }
    }

    /// The smallest axis-aligned box around the shape at `pose`.
    #[must_use]
    pub fn aabb(&self, pose: &Pose) -> Aabb {
        match self {
            Shape::Sphere(s) => Aabb::from_centre(pose.position, Vec3::splat(s.radius)),
            Shape::Cuboid(c) => {
                let m = pose.axes();
                let h = c.half_extents;
                let e = m.x_axis.abs() * h.x + m.y_axis.abs() * h.y + m.z_axis.abs() * h.z;
                Aabb::from_centre(pose.position, e)
            }
            _ => Aabb::from_centre(pose.position, Vec3::splat(f32::INFINITY)),
        }
    }

    /// Distance from `centre` to the farthest point of the shape. Metres; infinite for half-spaces.
    #[must_use]
    pub fn radius_about(&self, centre: Vec3) -> f32 {
        match self {
            Shape::Sphere(s) => centre.length() + s.radius,
            Shape::Cuboid(c) => (centre.abs() + c.half_extents).length(),
            _ => f32::INFINITY,
        }
    }

    /// Half of the smallest thickness: what moves further than this in one step may pass through. Metres.
    #[must_use]
    pub fn half_thickness(&self) -> f32 {
        match self {
            Shape::Sphere(s) => s.radius,
            Shape::Cuboid(c) => c.half_extents.min_element(),
            _ => f32::INFINITY,
        }
    }
}
