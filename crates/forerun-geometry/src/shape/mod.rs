//! Shapes: what a body looks like to the physics.

use std::fmt;
use std::sync::Arc;

use crate::{Pose, Vec3};

mod bounding;
mod compound;
mod hull;
mod hull_faces;
mod hull_surface;
mod measure;
mod mesh;
mod mesh_draft;
pub mod mesh_make;
mod mesh_parts;
mod mesh_ray;
mod mesh_report;
mod mesh_topology;
mod reach;
mod roots;
mod triangle_list;
mod triangle_tree;

pub use compound::Compound;
pub use hull::{Hull, HullEdge, HullFace, hull_inner_radius};
pub use mesh::Mesh;
pub use mesh_draft::{Inside, MeshDraft, MeshOptions};
pub(crate) use mesh_ray::FirstHits;
pub use mesh_report::{Enclosure, MeshError, MeshRepairs};
pub use triangle_list::TriangleList;

/// A shape in a frame of its own. Cloning is cheap: large shapes are shared.
///
/// The constructors check their arguments; who fills the variants by hand promises the ranges given with each field.
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
    /// A triangle mesh, convex or not.
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

/// Why a shape cannot be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShapeError {
    /// The argument at fault.
    pub field: &'static str,
    /// What is wrong and what is allowed.
    pub message: String,
}

impl ShapeError {
    pub(crate) fn new(field: &'static str, message: impl Into<String>) -> Self {
        ShapeError { field, message: message.into() }
    }
}

impl fmt::Display for ShapeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.field, self.message)
    }
}

impl std::error::Error for ShapeError {}

impl Shape {
    /// A ball of the given radius (metres).
    ///
    /// # Errors
    /// When the radius is not a finite number above 0.
    pub fn sphere(radius: f32) -> Result<Shape, ShapeError> {
        Ok(Shape::Sphere(Sphere { radius: positive("radius", radius)? }))
    }

    /// A box of the given half extents (metres).
    ///
    /// # Errors
    /// When a half extent is not a finite number above 0.
    pub fn cuboid(half_extents: Vec3) -> Result<Shape, ShapeError> {
        for half_extent in half_extents.to_array() {
            positive("half_extents", half_extent)?;
        }
        Ok(Shape::Cuboid(Cuboid { half_extents }))
    }

    /// A capsule along y: half the length of the inner segment and the radius (metres).
    ///
    /// # Errors
    /// When the half height is not a finite number of 0 or more, or the radius not one above 0.
    pub fn capsule(half_height: f32, radius: f32) -> Result<Shape, ShapeError> {
        if !(half_height >= 0.0 && half_height.is_finite()) {
            return Err(ShapeError::new(
                "half_height",
                format!("must be a finite number of 0 or more, is {half_height}"),
            ));
        }
        Ok(Shape::Capsule(Capsule { half_height, radius: positive("radius", radius)? }))
    }

    /// A cylinder along y (metres).
    ///
    /// # Errors
    /// When one of the two is not a finite number above 0.
    pub fn cylinder(half_height: f32, radius: f32) -> Result<Shape, ShapeError> {
        Ok(Shape::Cylinder(Cylinder {
            half_height: positive("half_height", half_height)?,
            radius: positive("radius", radius)?,
        }))
    }

    /// The convex hull of points (metres). Points inside, on edges or on faces are left out.
    ///
    /// # Errors
    /// When there are fewer than 4 points, one is not finite, or all lie in a plane; see [`Hull::new`].
    pub fn hull(points: &[Vec3]) -> Result<Shape, ShapeError> {
        Ok(Shape::Hull(Arc::new(Hull::new(points)?)))
    }

    /// The ground: all points with y at or below 0.
    #[must_use]
    pub fn half_space() -> Shape {
        Shape::HalfSpace
    }

    /// Several convex shapes held rigidly together, each at a pose in the compound's frame.
    ///
    /// # Errors
    /// When there is no part, a part is a half-space, mesh or compound, or a pose is not possible; see [`Compound::new`].
    pub fn compound(parts: Vec<(Pose, Shape)>) -> Result<Shape, ShapeError> {
        Ok(Shape::Compound(Arc::new(Compound::new(parts)?)))
    }

    /// A triangle mesh with an inside, wound counter-clockwise seen from outside (metres).
    ///
    /// # Errors
    /// When the triangles are not the surface of a solid; see [`Mesh::new`].
    pub fn mesh(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Shape, ShapeError> {
        Ok(Mesh::new(vertices, triangles)?.into())
    }

    /// Whether there is a finite volume inside: what a dynamic body must have.
    #[must_use]
    pub fn has_volume(&self) -> bool {
        match self {
            Shape::HalfSpace => false,
            Shape::Mesh(mesh) => mesh.has_inside(),
            _ => true,
        }
    }
}

impl From<Mesh> for Shape {
    fn from(mesh: Mesh) -> Shape {
        Shape::Mesh(Arc::new(mesh))
    }
}

impl From<MeshError> for ShapeError {
    fn from(error: MeshError) -> ShapeError {
        ShapeError::new("mesh", error.to_string())
    }
}

fn positive(field: &'static str, value: f32) -> Result<f32, ShapeError> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(ShapeError::new(field, format!("must be a finite number above 0, is {value}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constructors_refuse_what_is_out_of_range() {
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(Shape::sphere(bad).unwrap_err().field, "radius");
            assert_eq!(Shape::cuboid(Vec3::new(1.0, bad, 1.0)).unwrap_err().field, "half_extents");
            assert_eq!(Shape::capsule(1.0, bad).unwrap_err().field, "radius");
            assert_eq!(Shape::cylinder(bad, 1.0).unwrap_err().field, "half_height");
        }
        assert_eq!(Shape::capsule(-0.1, 1.0).unwrap_err().field, "half_height");
        assert!(Shape::capsule(0.0, 1.0).is_ok());
        let message = Shape::sphere(-1.0).unwrap_err().to_string();
        assert_eq!(message, "radius: must be a finite number above 0, is -1");
    }
}
