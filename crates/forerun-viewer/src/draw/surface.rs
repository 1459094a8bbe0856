//! Surfaces: which shapes are drawn with the same triangles, and what those are.

use std::collections::BTreeMap;
use std::sync::Arc;

use forerun::{Shape, Vec3};
use three_d::{Context, ElementBuffer, VertexBuffer};

use crate::tessellate::{Facet, coarse_facets, facets};

/// More bodies of one look are drawn with fewer triangles.
const FINE_MAX: usize = 1500;

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

/// Triangles on the graphics card, corners that are shared once.
pub(super) struct Triangles {
    pub(super) positions: VertexBuffer<[f32; 3]>,
    pub(super) normals: VertexBuffer<[f32; 3]>,
    pub(super) corners: ElementBuffer<u32>,
}

/// The triangles of a look.
pub(super) struct Surface {
    fine: Triangles,
    /// For many bodies; none where it is no less.
    coarse: Option<Triangles>,
    /// As long as it is kept, no other shape can get its memory and so its look.
    _shape: Shape,
}

impl Surface {
    /// For so many bodies.
    pub(super) fn triangles(&self, bodies: usize) -> &Triangles {
        self.coarse.as_ref().filter(|_| bodies > FINE_MAX).unwrap_or(&self.fine)
    }
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
    let unit = unit.unwrap_or(Shape::HalfSpace);
    let is_round = matches!(unit, Shape::Sphere(_) | Shape::Cylinder(_) | Shape::Capsule(_));
    Surface {
        fine: triangles_of(context, &facets(&unit)),
        coarse: is_round.then(|| triangles_of(context, &coarse_facets(&unit))),
        _shape: shape.clone(),
    }
}

fn triangles_of(context: &Context, facets: &[Facet]) -> Triangles {
    let (corners, numbers) = shared(facets);
    let [positions, normals] = [0, 1].map(|k| corners.iter().map(|corner| corner[k]).collect::<Vec<_>>());
    Triangles {
        positions: VertexBuffer::new_with_data(context, &positions),
        normals: VertexBuffer::new_with_data(context, &normals),
        corners: ElementBuffer::new_with_data(context, &numbers),
    }
}

/// Position and normal.
type Corner = [[f32; 3]; 2];

/// Each corner once, and the numbers of those that make the triangles, three by three.
fn shared(facets: &[Facet]) -> (Vec<Corner>, Vec<u32>) {
    let corners = facets
        .iter()
        .flat_map(|facet| [0, 1, 2].map(|k| [facet.corners[k].to_array(), facet.normals[k].to_array()]));
    let mut sorted: Vec<(Corner, u32)> = corners.zip(0..).collect();
    let bits = |corner: &Corner| corner.map(|column| column.map(f32::to_bits));
    sorted.sort_unstable_by_key(|(corner, number)| (bits(corner), *number));
    let mut numbers = vec![0; sorted.len()];
    let mut once: Vec<Corner> = Vec::new();
    for (corner, number) in sorted {
        if once.last().is_none_or(|last| bits(last) != bits(&corner)) {
            once.push(corner);
        }
        numbers[number as usize] = once.len() as u32 - 1;
    }
    (once, numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shared_corners_make_the_same_triangles() {
        let ball = facets(&Shape::sphere(1.0).unwrap());
        let (corners, numbers) = shared(&ball);
        assert_eq!(numbers.len(), 3 * ball.len());
        for (facet, numbers) in ball.iter().zip(numbers.as_chunks::<3>().0) {
            for k in 0..3 {
                let [position, normal] = corners[numbers[k] as usize];
                assert_eq!((position, normal), (facet.corners[k].to_array(), facet.normals[k].to_array()));
            }
        }
        // A smooth surface has about half as many corners as triangles.
        assert!(corners.len() < ball.len(), "{} for {}", corners.len(), ball.len());
    }

    #[test]
    fn many_round_bodies_have_a_fifth_of_the_triangles() {
        let ball = Shape::sphere(1.0).unwrap();
        assert!(5 * coarse_facets(&ball).len() < facets(&ball).len() + 100);
        let block = Shape::cuboid(Vec3::ONE).unwrap();
        assert_eq!(coarse_facets(&block).len(), facets(&block).len());
    }
}
