//! Baking: from triangles to a field, once for each mesh.
//!
//! Promise: the same triangles give the same field, byte for byte, on every target.

use glam::DVec3;

use super::Field;
use super::triangle_tree::{Nearest, TriangleTree};
use crate::{Aabb, Vec3};

/// Cells in half the thinnest thickness: 4 make the normals good to a degree (2 would still do).
const CELLS_PER_HALF_THICKNESS: f32 = 4.0;
/// Cells between the surface and the faces of the grid.
const PADDING: usize = 2;
/// Largest grid: 2 MB at two bytes a node. Meshes that are large and thin get larger cells instead.
const NODES_MAX: usize = 1 << 20;
/// Part of the surface that may be thinner than what counts as the thinnest: edges taper to nothing.
const THINNER_PART: f64 = 0.05;
/// Triangles at which the thickness is measured, evenly spread over the list.
const THICKNESS_PROBES: usize = 4096;

/// The field of a closed surface: exact distances to the triangles at the nodes, signs by pseudo-normals.
pub(crate) fn bake(tree: &TriangleTree, half_thickness: f32) -> Field {
    let bounds = bounds_of(&tree.topology().vertices);
    let cell = cell_size(&bounds, half_thickness / CELLS_PER_HALF_THICKNESS);
    let size = grid_size(&bounds, cell).map(|n| n as usize);
    let cells = Vec3::from_array(size.map(|n| (n - 1) as f32));
    let origin = (bounds.min + bounds.max - cells * cell) * 0.5;
    let mut distances = Vec::with_capacity(size.iter().product());
    let mut row_start: Option<Nearest> = None;
    for z in 0..size[2] {
        for y in 0..size[1] {
            let mut guess = row_start;
            for x in 0..size[0] {
                let node = origin.as_dvec3() + DVec3::new(x as f64, y as f64, z as f64) * f64::from(cell);
                // A closed surface has triangles, so there is a nearest one.
                let Some(nearest) = tree.nearest(node, guess.as_ref()) else { continue };
                distances.push(tree.signed(node, &nearest).distance as f32);
                guess = Some(nearest);
                if x == 0 {
                    row_start = guess;
                }
            }
        }
    }
    Field::from_distances(origin, cell, size, &distances)
}

/// Half the thickness of the thinnest part of a closed surface that is more than a twentieth of its area: measured
/// from the middle of triangles straight inwards to the other side. Metres.
pub(crate) fn half_thickness(tree: &TriangleTree) -> f32 {
    let topology = tree.topology();
    let stride = topology.triangles.len().div_ceil(THICKNESS_PROBES).max(1);
    let extent = {
        let bounds = bounds_of(&topology.vertices);
        f64::from((bounds.max - bounds.min).max_element())
    };
    let mut probes: Vec<(f64, f64)> = Vec::new();
    for (i, triangle) in topology.triangles.iter().enumerate().step_by(stride) {
        let [a, b, c] = topology.corners(triangle);
        let inwards = -tree.face_normal(i as u32);
        let area = (b - a).cross(c - a).length();
        let thickness = tree.first_exit((a + b + c) / 3.0, inwards, 1e-6 * extent);
        probes.push((thickness.unwrap_or(extent), area));
    }
    probes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let total: f64 = probes.iter().map(|p| p.1).sum();
    let mut thinner = 0.0;
    for (thickness, area) in probes {
        thinner += area;
        if thinner > THINNER_PART * total {
            return (0.5 * thickness) as f32;
        }
    }
    (0.5 * extent) as f32
}

/// The smallest box around points.
pub(crate) fn bounds_of(points: &[Vec3]) -> Aabb {
    let min = points.iter().fold(Vec3::INFINITY, |m, p| m.min(*p));
    let max = points.iter().fold(Vec3::NEG_INFINITY, |m, p| m.max(*p));
    Aabb { min, max }
}

/// The wished cell size, or the smallest larger one (in steps of a twentieth) whose grid is not too large.
fn cell_size(bounds: &Aabb, wished: f32) -> f32 {
    let extent = (bounds.max - bounds.min).max_element();
    // No grid of so many nodes could be finer along its longest side.
    let mut cell = wished.max(extent / NODES_MAX as f32);
    while grid_size(bounds, cell).into_iter().product::<u64>() > NODES_MAX as u64 {
        cell *= 1.05;
    }
    cell
}

/// Nodes along each axis of a grid around the bounds.
fn grid_size(bounds: &Aabb, cell: f32) -> [u64; 3] {
    let extent = bounds.max - bounds.min;
    extent.to_array().map(|e| (e / cell).ceil() as u64 + 2 * PADDING as u64 + 1)
}
