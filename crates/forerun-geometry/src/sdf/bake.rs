//! Baking: from triangles to a field, once for each mesh.
//!
//! Promise: the same triangles give the same field, byte for byte, on every target and for any number of threads.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::Field;
use super::bake_blocks::bake_blocks;
use super::blocks::{BLOCK, NODES};
use super::mend::Mended;
use super::nearest::{Nearest, Skin, nearest};
use super::winding::winding;
use crate::Vec3;
use crate::shape::Mesh;

/// Cells in half the thinnest thickness, or half the narrowest gap: 4 make the normals good to a degree (2 would still do).
const CELLS_PER_HALF_THICKNESS: f32 = 4.0;
/// Cells between the surface and the faces of the grid.
const PADDING: usize = 2;
/// Largest grid: 2 MB at two bytes a node. Meshes that are large and thin get larger cells instead.
const NODES_MAX: usize = 1 << 20;
/// Larger grids are better made of blocks, if these are fewer.
const DENSE_MAX: usize = 1 << 17;
/// The finest cells of blocks that are tried, as a part of those of the dense grid that memory allows.
const FINEST: f32 = 0.2;
/// Blocks are to be finer than that dense grid by at least this factor: they take longer to look up.
const FINER: f32 = 0.8;
/// Nodes nearer to the surface than this many cells are exact. Farther ones only serve to cull.
const EXACT_CELLS: f32 = 4.0;

/// Told how much of the baking is done and how much there is in all, by the threads that do it: `done` is a different number
/// each time, from 1 to all there is, but a smaller one may come after a larger one.
pub type BakeProgress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// What bounds the inside.
pub(crate) enum Bounding<'a> {
    /// A surface whose normals tell its sides.
    Exactly(Skin<'a>),
    /// Pieces of a surface, and the triangles that wind round what is inside.
    Mended {
        surface: &'a Mesh,
        covered: &'a Mesh,
        /// No hole in the surface is wider. Metres.
        gap: f64,
    },
}

impl<'a> Bounding<'a> {
    /// What bounds the inside of a mended mesh.
    pub(crate) fn mended(mended: &'a Mended) -> Bounding<'a> {
        Bounding::Mended { surface: &mended.surface, covered: &mended.covered, gap: mended.gap }
    }

    /// The signed distance of a point. `last`, of a point close by, makes it quick and is replaced.
    pub(super) fn measure(&self, at: DVec3, last: &mut Option<Measured>) -> f32 {
        let guess = last.as_ref().map(|m| &m.nearest);
        let (distance, nearest) = match self {
            Bounding::Exactly(skin) => {
                let nearest = skin.nearest(at, guess);
                (skin.signed(at, &nearest).distance, nearest)
            }
            Bounding::Mended { surface, covered, gap } => {
                let nearest = nearest(surface, at, guess);
                let distance = nearest.distance();
                // Between points that are farther from the surface than from each other it does not pass.
                let same_side = |m: &&Measured| m.distance.abs() + distance > at.distance(m.at) + 3.0 * gap;
                let inside = match last.as_ref().filter(same_side) {
                    Some(m) => m.distance < 0.0,
                    None => winding(covered, at) > 0,
                };
                (if inside { -distance } else { distance }, nearest)
            }
        };
        *last = Some(Measured { at, distance, nearest });
        distance as f32
    }
}

/// A point with its distance.
pub(super) struct Measured {
    at: DVec3,
    /// Negative inside. Metres.
    distance: f64,
    nearest: Nearest,
}

/// Where the nodes of a field are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// The first node. Metres.
    pub(super) origin: Vec3,
    /// Distances between neighbouring nodes along x, y and z. Metres.
    pub(super) cell: Vec3,
    /// Number of nodes along x, y and z.
    pub(super) size: [usize; 3],
}

impl Grid {
    /// A grid around a mesh, no larger than memory allows. `wished`: size of cells. Metres.
    pub(crate) fn around(mesh: &Mesh, wished: f32) -> Grid {
        let bounds = mesh.bounds();
        let extent = bounds.max - bounds.min;
        // Nodes on all six sides of the box around the mesh: the edges of boxes and plates are met exactly.
        let cells = cells_along(extent, cell_size(extent, wished));
        let cell = extent / Vec3::from_array(cells.map(|n| n as f32));
        let origin = bounds.min - cell * PADDING as f32;
        Grid { origin, cell, size: cells.map(|n| n as usize + 2 * PADDING + 1) }
    }

    /// The same of whole blocks, however large; there is more room behind the mesh.
    pub(super) fn of_blocks(mesh: &Mesh, cell: f32) -> Grid {
        let bounds = mesh.bounds();
        let extent = bounds.max - bounds.min;
        let cells = cells_along(extent, cell);
        let cell = extent / Vec3::from_array(cells.map(|n| n as f32));
        let size = cells.map(|n| (n as usize + 2 * PADDING).next_multiple_of(BLOCK) + 1);
        Grid { origin: bounds.min - cell * PADDING as f32, cell, size }
    }

    /// Largest distance between neighbouring nodes. Metres.
    pub(crate) fn cell(&self) -> f32 {
        self.cell.max_element()
    }

    pub(super) fn position(&self, node: [usize; 3]) -> DVec3 {
        DVec3::from_array(node.map(|i| i as f64)) * self.cell.as_dvec3() + self.origin.as_dvec3()
    }
}

/// The field of a surface around a mesh: exact distances at the nodes near it. `wished`: size of cells. Metres.
pub(crate) fn bake(mesh: &Mesh, wished: f32, bounding: &Bounding<'_>, progress: BakeProgress<'_>) -> Field {
    let dense = Grid::around(mesh, wished);
    let field = in_blocks(mesh, wished, &dense, |grid, bytes| bake_blocks(grid, bounding, bytes, progress));
    let field = field.unwrap_or_else(|| bake_dense(dense, bounding, progress));
    field.measured_on(match bounding {
        Bounding::Exactly(skin) => skin.mesh,
        Bounding::Mended { surface, .. } => surface,
    })
}

/// The field of a surface on a dense grid.
pub(super) fn bake_dense(grid: Grid, bounding: &Bounding<'_>, progress: BakeProgress<'_>) -> Field {
    let distances = Baker { grid, bounding }.distances(progress);
    Field::from_distances(&grid, &distances)
}

/// The field that `bake` makes in blocks, if that is much smaller than a dense grid of the wished cells, or where that would be too large,
/// if it is finer than the dense grid that is not.
fn in_blocks(
    mesh: &Mesh,
    wished: f32,
    dense: &Grid,
    bake: impl Fn(Grid, usize) -> Option<Field>,
) -> Option<Field> {
    let nodes: usize = dense.size.iter().product();
    if nodes <= DENSE_MAX {
        return None;
    }
    // Not by the size of its cells: a whole number of them may be a little larger than wished.
    let extent = mesh.bounds().max - mesh.bounds().min;
    if cell_size(extent, wished) <= wished {
        return bake(Grid::of_blocks(mesh, wished), nodes);
    }
    // Finer blocks along the surface would be too many, by two layers of them.
    let area: f64 = (0..mesh.triangles.len()).map(|t| 0.5 * mesh.face_vector(t as u32).length()).sum();
    let layers = 2.0 * area * (2 * NODES) as f64 / (2 * NODES_MAX) as f64;
    let finest = layers.sqrt() as f32 / BLOCK as f32;
    let mut finer = wished.max(finest).max(FINEST * dense.cell());
    while finer < FINER * dense.cell() {
        if let Some(field) = bake(Grid::of_blocks(mesh, finer), 2 * NODES_MAX) {
            return Some(field);
        }
        finer *= 1.2;
    }
    None
}

/// A field in the making.
struct Baker<'a> {
    grid: Grid,
    bounding: &'a Bounding<'a>,
}

/// Distances at the corners of all blocks.
struct Corners {
    /// Number of corners along x, y and z: one more than blocks.
    size: [usize; 3],
    distances: Vec<f32>,
}

impl Baker<'_> {
    /// Distances at all nodes, x fastest. Metres.
    fn distances(&self, progress: BakeProgress<'_>) -> Vec<f32> {
        let corners = self.corners();
        let [nx, ny, nz] = self.grid.size;
        let mut distances = vec![0.0; nx * ny * nz];
        let rows = ny.div_ceil(BLOCK);
        let (done, total) = (AtomicUsize::new(0), nz.div_ceil(BLOCK) * rows);
        distances.par_chunks_mut(nx * ny * BLOCK).enumerate().for_each(|(slab, nodes)| {
            let mut last = None;
            for row in 0..rows {
                for block in 0..nx.div_ceil(BLOCK) {
                    self.fill([block, row, slab], &corners, nodes, &mut last);
                }
                progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
            }
        });
        distances
    }

    /// Measures the corners of all blocks. The last ones are where the grid ends.
    fn corners(&self) -> Corners {
        let size = self.grid.size.map(|n| (n - 1).div_ceil(BLOCK) + 1);
        let mut distances = vec![0.0; size.iter().product()];
        distances.par_chunks_mut(size[0]).enumerate().for_each(|(row, distances)| {
            let mut last = None;
            for (x, distance) in distances.iter_mut().enumerate() {
                let corner = [x, row % size[1], row / size[1]];
                let node = [0, 1, 2].map(|axis| (corner[axis] * BLOCK).min(self.grid.size[axis] - 1));
                *distance = self.measure(node, &mut last);
            }
        });
        Corners { size, distances }
    }

    /// Fills in the nodes of a block, but for those on its high faces that are the next block's, into those of its slab.
    fn fill(&self, block: [usize; 3], corners: &Corners, slab: &mut [f32], last: &mut Option<Measured>) {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let low = block[axis] * BLOCK;
            low..(low + BLOCK).min(self.grid.size[axis])
        });
        // The last nodes may be by themselves: then they are the high face of the block before.
        let cells = [0, 1, 2].map(|axis| block[axis].min(corners.size[axis] - 2));
        let values = corners.of(cells);
        let far = self.is_far(&values);
        for z in z {
            for y in y.clone() {
                for x in x.clone() {
                    let node = [x, y, z];
                    let index = (z - block[2] * BLOCK) * self.grid.size[0] * self.grid.size[1]
                        + y * self.grid.size[0]
                        + x;
                    slab[index] =
                        if far { self.interpolate(cells, &values, node) } else { self.measure(node, last) };
                }
            }
        }
    }

    /// Whether no node of a block with these distances at its corners can be so near that it must be exact.
    fn is_far(&self, corners: &[f32; 8]) -> bool {
        let half_diagonal = 0.5 * BLOCK as f32 * self.grid.cell.length();
        let enough = EXACT_CELLS * self.grid.cell() + half_diagonal;
        corners.iter().all(|distance| distance.abs() > enough)
    }

    fn measure(&self, node: [usize; 3], last: &mut Option<Measured>) -> f32 {
        self.bounding.measure(self.grid.position(node), last)
    }

    /// Trilinear interpolation from the corners of a block.
    fn interpolate(&self, block: [usize; 3], corners: &[f32; 8], node: [usize; 3]) -> f32 {
        let part = [0, 1, 2].map(|axis| {
            let low = block[axis] * BLOCK;
            let high = (low + BLOCK).min(self.grid.size[axis] - 1);
            (node[axis] - low) as f32 / (high - low) as f32
        });
        let mut sum = 0.0;
        for (k, distance) in corners.iter().enumerate() {
            let weights =
                [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { 1.0 - part[axis] } else { part[axis] });
            sum += weights[0] * weights[1] * weights[2] * distance;
        }
        sum
    }
}

impl Corners {
    /// Distances at the corners of a block: x changes fastest, then y, then z.
    fn of(&self, [x, y, z]: [usize; 3]) -> [f32; 8] {
        std::array::from_fn(|k| {
            let [x, y, z] = [x + (k & 1), y + (k >> 1 & 1), z + (k >> 2)];
            self.distances[(z * self.size[1] + y) * self.size[0] + x]
        })
    }
}

/// The size of cells that suits the thickness of a mesh and its gaps. Metres.
pub(crate) fn suitable_cell(mesh: &Mesh) -> f32 {
    mesh.half_thickness().min(mesh.measure_half_gap()) / CELLS_PER_HALF_THICKNESS
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
