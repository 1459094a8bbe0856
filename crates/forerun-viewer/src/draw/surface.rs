//! Surfaces: which shapes are drawn with the same triangles, and what those are.

use std::sync::Arc;

use forerun::{Shape, Vec3};
use three_d::{CpuMesh, Indices, Mat4, Positions};

use super::convert::vector;
use crate::tessellate::facets;

/// Equal for shapes that are drawn with the same triangles, scaled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Look {
    Cuboid,
    Sphere,
    /// By radius and half height, as bits.
    Capsule(u32, u32),
    Cylinder,
    /// By the memory that equal shapes share.
    Shared(usize),
}

/// What a shape looks like; none for half-spaces, which have no end.
pub(super) fn look_of(shape: &Shape) -> Option<Look> {
    Some(match shape {
        Shape::HalfSpace => return None,
        Shape::Cuboid(_) => Look::Cuboid,
        Shape::Sphere(_) => Look::Sphere,
        Shape::Cylinder(_) => Look::Cylinder,
        Shape::Capsule(capsule) => Look::Capsule(capsule.radius.to_bits(), capsule.half_height.to_bits()),
        Shape::Hull(hull) => Look::Shared(Arc::as_ptr(hull) as usize),
        Shape::Compound(compound) => Look::Shared(Arc::as_ptr(compound) as usize),
        Shape::Mesh(mesh) => Look::Shared(Arc::as_ptr(mesh) as usize),
    })
}

/// By how much the triangles of the look are stretched for a shape.
pub(super) fn scale_of(shape: &Shape) -> Mat4 {
    let scale = match shape {
        Shape::Cuboid(cuboid) => cuboid.half_extents,
        Shape::Sphere(sphere) => Vec3::splat(sphere.radius),
        Shape::Cylinder(cylinder) => Vec3::new(cylinder.radius, cylinder.half_height, cylinder.radius),
        _ => Vec3::ONE,
    };
    Mat4::from_nonuniform_scale(scale.x, scale.y, scale.z)
}

/// The triangles of a shape's look.
pub(super) fn mesh_of(shape: &Shape) -> CpuMesh {
    let unit = match shape {
        Shape::Cuboid(_) => Shape::cuboid(Vec3::ONE),
        Shape::Sphere(_) => Shape::sphere(1.0),
        Shape::Cylinder(_) => Shape::cylinder(1.0, 1.0),
        other => Ok(other.clone()),
    };
    // Shapes of size 1 are possible.
    let facets = facets(&unit.unwrap_or(Shape::HalfSpace));
    let positions = facets.iter().flat_map(|facet| facet.corners.map(vector)).collect();
    let normals = facets.iter().flat_map(|facet| facet.normals.map(vector)).collect();
    CpuMesh {
        positions: Positions::F32(positions),
        indices: Indices::None,
        normals: Some(normals),
        ..CpuMesh::default()
    }
}
