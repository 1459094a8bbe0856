//! Surfaces: which shapes are drawn with the same triangles, and what those are.

use std::collections::BTreeMap;
use std::sync::Arc;

use forerun::{Shape, Vec3};
use three_d::{Context, VertexBuffer};

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
pub(super) fn scale_of(shape: &Shape) -> Vec3 {
    match shape {
        Shape::Cuboid(cuboid) => cuboid.half_extents,
        Shape::Sphere(sphere) => Vec3::splat(sphere.radius),
        Shape::Cylinder(cylinder) => Vec3::new(cylinder.radius, cylinder.half_height, cylinder.radius),
        _ => Vec3::ONE,
    }
}

/// The triangles of a look, on the graphics card.
pub(super) struct Surface {
    pub(super) positions: VertexBuffer<[f32; 3]>,
    pub(super) normals: VertexBuffer<[f32; 3]>,
    pub(super) vertices: u32,
    /// As long as it is kept, no other shape can get its memory and so its look.
    _shape: Shape,
}

/// The surfaces that were drawn so far.
#[derive(Default)]
pub(super) struct Surfaces {
    by_look: BTreeMap<Look, Surface>,
}

impl Surfaces {
    /// Makes the surface of a shape, unless it is there.
    pub(super) fn prepare(&mut self, context: &Context, look: Look, shape: &Shape) {
        self.by_look.entry(look).or_insert_with(|| surface_of(context, shape));
    }

    pub(super) fn get(&self, look: Look) -> Option<&Surface> {
        self.by_look.get(&look)
    }
}

fn surface_of(context: &Context, shape: &Shape) -> Surface {
    let unit = match shape {
        Shape::Cuboid(_) => Shape::cuboid(Vec3::ONE),
        Shape::Sphere(_) => Shape::sphere(1.0),
        Shape::Cylinder(_) => Shape::cylinder(1.0, 1.0),
        other => Ok(other.clone()),
    };
    // Shapes of size 1 are possible.
    let facets = facets(&unit.unwrap_or(Shape::HalfSpace));
    let positions: Vec<[f32; 3]> =
        facets.iter().flat_map(|facet| facet.corners.map(|corner| corner.to_array())).collect();
    let normals: Vec<[f32; 3]> =
        facets.iter().flat_map(|facet| facet.normals.map(|normal| normal.to_array())).collect();
    Surface {
        vertices: positions.len() as u32,
        positions: VertexBuffer::new_with_data(context, &positions),
        normals: VertexBuffer::new_with_data(context, &normals),
        _shape: shape.clone(),
    }
}
