//! Baking: from triangles to a field, once for each mesh.
//!
//! Promise: the same triangles give the same field, byte for byte, on every target.

use glam::DVec3;

use super::Field;
use super::nearest::{Nearest, Skin};
use crate::Vec3;

/// Cells in half the thinnest thickness: 4 make the normals good to a degree (2 would still do).
const CELLS_PER_HALF_THICKNESS: f32 = 4.0;
/// Cells between the surface and the faces of the grid.
const PADDING: usize = 2;
/// Largest grid: 2 MB at two bytes a node. Meshes that are large and thin get larger cells instead.
const NODES_MAX: usize = 1 << 20;
/// Cells along the side of a block that is either computed node by node or, far from the surface, interpolated.
const BLOCK: usize = 4;
/// Nodes nearer to the surface than this many cells are exact. Farther ones only serve to cull.
const EXACT_CELLS: f32 = 4.0;

/// The field of a closed surface: exact distances to the triangles at the nodes near it, signs by pseudo-normals.
pub(crate) fn bake(skin: Skin<'_>) -> Field {
    let bounds = skin.mesh.bounds();
    let extent = bounds.max - bounds.min;
    let wished = cell_size(extent, skin.mesh.half_thickness() / CELLS_PER_HALF_THICKNESS);
    // Nodes on all six sides of the box around the mesh: the edges of boxes and plates are met exactly.
    let cells = cells_along(extent, wished);
    let cell = extent / Vec3::from_array(cells.map(|n| n as f32));
    let origin = bounds.min - cell * PADDING as f32;
    let size = cells.map(|n| n as usize + 2 * PADDING + 1);
    let distances = vec![f32::NAN; size.iter().product()];
    let mut baker = Baker { skin, origin, cell, size, distances, guess: None };
    let blocks = baker.blocks();
    for block in &blocks {
        for node in block.corners() {
            baker.measure(node);
        }
    }
    let (far, near): (Vec<Block>, Vec<Block>) = blocks.iter().partition(|block| baker.is_far(block));
    for block in near {
        block.nodes().for_each(|node| baker.measure(node));
    }
    for block in far {
        block.nodes().for_each(|node| baker.interpolate(&block, node));
    }
    Field::from_distances(origin, cell, size, &baker.distances)
}

/// A field in the making.
struct Baker<'a> {
    skin: Skin<'a>,
    origin: Vec3,
    cell: Vec3,
    size: [usize; 3],
    /// Distances so far; not a number where not known yet.
    distances: Vec<f32>,
    /// The last answer: the next node is close by.
    guess: Option<Nearest>,
}

/// The nodes from `low` to `high`, both included.
#[derive(Clone, Copy)]
struct Block {
    low: [usize; 3],
    high: [usize; 3],
}

impl Block {
    fn corners(self) -> impl Iterator<Item = [usize; 3]> {
        (0..8).map(move |k| {
            [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { self.low[axis] } else { self.high[axis] })
        })
    }

    fn nodes(self) -> impl Iterator<Item = [usize; 3]> {
        let [x, y, z] = [0, 1, 2].map(|axis| self.low[axis]..=self.high[axis]);
        z.flat_map(move |z| {
            let x = x.clone();
            y.clone().flat_map(move |y| x.clone().map(move |x| [x, y, z]))
        })
    }
}

impl Baker<'_> {
    /// All blocks; neighbours share the nodes between them.
    fn blocks(&self) -> Vec<Block> {
        let [nx, ny, nz] = self.size.map(|n| (0..n - 1).step_by(BLOCK));
        let mut blocks = Vec::new();
        for z in nz {
            for y in ny.clone() {
                for x in nx.clone() {
                    let low = [x, y, z];
                    let high = [0, 1, 2].map(|axis| (low[axis] + BLOCK).min(self.size[axis] - 1));
                    blocks.push(Block { low, high });
                }
            }
        }
        blocks
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.size[1] + y) * self.size[0] + x
    }

    /// Whether no node of a block, its corners known, can be so near that it must be exact.
    fn is_far(&self, block: &Block) -> bool {
        let half_diagonal = 0.5 * BLOCK as f32 * self.cell.length();
        let enough = EXACT_CELLS * self.cell.max_element() + half_diagonal;
        block.corners().all(|node| self.distances[self.index(node)].abs() > enough)
    }

    fn measure(&mut self, node: [usize; 3]) {
        let index = self.index(node);
        if !self.distances[index].is_nan() {
            return;
        }
        let at = DVec3::from_array(node.map(|i| i as f64)) * self.cell.as_dvec3() + self.origin.as_dvec3();
        let nearest = self.skin.nearest(at, self.guess.as_ref());
        self.distances[index] = self.skin.signed(at, &nearest).distance as f32;
        self.guess = Some(nearest);
    }

    /// Trilinear interpolation from the corners of the block.
    fn interpolate(&mut self, block: &Block, node: [usize; 3]) {
        let index = self.index(node);
        if !self.distances[index].is_nan() {
            return;
        }
        let part = [0, 1, 2]
            .map(|axis| (node[axis] - block.low[axis]) as f32 / (block.high[axis] - block.low[axis]) as f32);
        let mut sum = 0.0;
        for (k, corner) in block.corners().enumerate() {
            let weights =
                [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { 1.0 - part[axis] } else { part[axis] });
            sum += weights[0] * weights[1] * weights[2] * self.distances[self.index(corner)];
        }
        self.distances[index] = sum;
    }
}

/// The wished cell size, or the smallest larger one (in steps of a twentieth) whose grid is not too large.
fn cell_size(extent: Vec3, wished: f32) -> f32 {
    // No grid of so many nodes could be finer along its longest side.
    let mut cell = wished.max(extent.max_element() / NODES_MAX as f32);
    let nodes = |cell| cells_along(extent, cell).map(|n| n + 2 * PADDING as u64 + 1).iter().product::<u64>();
    while nodes(cell) > NODES_MAX as u64 {
        cell *= 1.05;
    }
    cell
}

/// How many cells no larger than `cell` there are along each side of the box around the mesh.
fn cells_along(extent: Vec3, cell: f32) -> [u64; 3] {
    // A little less: a side of four cells is not to become five by rounding.
    extent.to_array().map(|e| ((e / cell - 0.01).ceil() as u64).max(1))
}
