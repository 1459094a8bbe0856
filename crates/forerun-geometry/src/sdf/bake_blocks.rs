//! Baking of blocks: the fields of what is large and mostly empty.
//!
//! Promise: as for [`super::bake`]: the same bytes for any number of threads.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::BakeProgress;
use super::bake::{Bounding, Grid};
use super::blocks::{BLOCK, BLOCKS_MAX, Blocks, NODES, SIDE, flat, unflat};
use super::field::Field;
use super::field_storage::ROUND_PART;

/// Nodes nearer to the surface than this many cells are in fine blocks.
const FINE_CELLS: f64 = 3.0;

/// The distances at all nodes of a fine block.
type Fine = [f32; NODES];

/// A field of blocks in the making.
struct Baker<'a> {
    grid: Grid,
    bounding: &'a Bounding<'a>,
    blocks: Blocks,
    /// Index of each fine block.
    fine: Vec<usize>,
}

/// The field of a surface on a grid of whole blocks, if it takes no more than so many bytes.
pub(super) fn bake_blocks(
    grid: Grid,
    bounding: &Bounding<'_>,
    bytes_max: usize,
    progress: BakeProgress<'_>,
) -> Option<Field> {
    let count = grid.size.map(|n| (n - 1) / BLOCK);
    if count.iter().product::<usize>() > BLOCKS_MAX {
        return None;
    }
    let mut baker = Baker { grid, bounding, blocks: Blocks::new(count), fine: Vec::new() };
    baker.find_fine();
    let bytes = 2 * (baker.blocks.coarse_nodes() + baker.fine.len() * NODES + baker.blocks.numbers.len());
    if bytes > bytes_max || baker.fine.len() > usize::from(u16::MAX) {
        return None;
    }
    let coarse = baker.coarse();
    let fine = baker.fine(progress);
    let corrected: Vec<Fine> =
        (0..fine.len()).into_par_iter().map(|k| baker.corrected(k, &fine, &coarse)).collect();
    let mut distances = vec![0.0; baker.blocks.coarse_nodes()];
    for (k, distance) in coarse.iter().enumerate() {
        for place in baker.blocks.coarse_places(unflat(k, baker.corners())) {
            distances[place] = *distance;
        }
    }
    distances.extend(corrected.iter().flatten());
    Some(Field::from_blocks(&baker.grid, baker.blocks, &distances))
}

impl Baker<'_> {
    /// Number of corners of blocks along x, y and z.
    fn corners(&self) -> [usize; 3] {
        self.blocks.count.map(|n| n + 1)
    }

    /// Finds the blocks with nodes near the surface: by their middles, from which no node is farther than half a diagonal.
    fn find_fine(&mut self) {
        let cell = self.grid.cell.as_dvec3();
        let enough = FINE_CELLS * f64::from(self.grid.cell()) + 0.5 * BLOCK as f64 * cell.length();
        let [nx, ny, nz] = self.blocks.count;
        let middle = DVec3::splat(0.5 * BLOCK as f64) * cell;
        let near = |row: usize| {
            let mut last = None;
            let mut found = Vec::new();
            for x in 0..nx {
                let block = [x, row % ny, row / ny];
                let at = self.grid.position(block.map(|b| b * BLOCK)) + middle;
                let distance = f64::from(self.bounding.measure(at, &mut last));
                if distance.abs() <= enough {
                    found.push(flat(block, [nx, ny, nz]));
                }
            }
            found
        };
        let rows: Vec<Vec<usize>> = (0..ny * nz).into_par_iter().map(near).collect();
        self.fine = rows.into_iter().flatten().collect();
        // Too many are refused before the numbers are used.
        for (block, number) in self.fine.iter().zip(1_u32..) {
            self.blocks.numbers[*block] = u16::try_from(number).unwrap_or(u16::MAX);
        }
    }

    /// Distances at the corners of all blocks. Metres.
    fn coarse(&self) -> Vec<f32> {
        let corners = self.corners();
        let mut distances = vec![0.0; corners.iter().product()];
        distances.par_chunks_mut(corners[0]).enumerate().for_each(|(row, distances)| {
            let mut last = None;
            for (x, distance) in distances.iter_mut().enumerate() {
                let node = [x, row % corners[1], row / corners[1]].map(|corner| corner * BLOCK);
                *distance = self.bounding.measure(self.grid.position(node), &mut last);
            }
        });
        distances
    }

    /// Distances at the nodes of the fine blocks. Metres.
    fn fine(&self, progress: BakeProgress<'_>) -> Vec<Fine> {
        let done = AtomicUsize::new(0);
        let of = |block: &usize| {
            let low = unflat(*block, self.blocks.count).map(|b| b * BLOCK);
            let mut last = None;
            let mut distances = [0.0; NODES];
            for (k, distance) in distances.iter_mut().enumerate() {
                let node = unflat(k, [SIDE; 3]);
                let at = self.grid.position([0, 1, 2].map(|axis| low[axis] + node[axis]));
                *distance = self.bounding.measure(at, &mut last);
            }
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, self.fine.len());
            distances
        };
        self.fine.par_iter().map(of).collect()
    }

    /// The nodes of a fine block as they are to be kept: on faces and edges shared with coarse blocks interpolated as it is done there, else
    /// without the bias of interpolation.
    fn corrected(&self, k: usize, fine: &[Fine], coarse: &[f32]) -> Fine {
        let block = unflat(self.fine[k], self.blocks.count);
        std::array::from_fn(|n| {
            let node = unflat(n, [SIDE; 3]);
            match self.coarse_around(block, node) {
                Some(neighbour) => {
                    self.interpolated(neighbour, [0, 1, 2].map(|a| block[a] * BLOCK + node[a]), coarse)
                }
                None => fine[k][n] - self.bias(block, node, fine).unwrap_or(0.0),
            }
        })
    }

    /// A coarse block that has a node of another block on its surface.
    fn coarse_around(&self, block: [usize; 3], node: [usize; 3]) -> Option<[usize; 3]> {
        let beside = |axis: usize| match node[axis] {
            0 => -1,
            BLOCK => 1,
            _ => 0,
        };
        let way = [0, 1, 2].map(beside);
        (1..8).find_map(|k| {
            let step = [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { way[axis] } else { 0 });
            let neighbour = self.moved(block, step)?;
            (self.blocks.numbers[flat(neighbour, self.blocks.count)] == 0).then_some(neighbour)
        })
    }

    /// A block so many further; none beyond the grid.
    fn moved(&self, block: [usize; 3], step: [isize; 3]) -> Option<[usize; 3]> {
        let mut moved = block;
        for axis in 0..3 {
            moved[axis] = block[axis].checked_add_signed(step[axis])?;
            if moved[axis] >= self.blocks.count[axis] {
                return None;
            }
        }
        Some(moved)
    }

    /// What a coarse block has at a node on its surface.
    fn interpolated(&self, block: [usize; 3], node: [usize; 3], coarse: &[f32]) -> f32 {
        let part = [0, 1, 2].map(|axis| (node[axis] - block[axis] * BLOCK) as f32 / BLOCK as f32);
        let mut sum = 0.0;
        for k in 0..8 {
            let side = [0, 1, 2].map(|axis| k >> axis & 1);
            let weights = [0, 1, 2].map(|axis| if side[axis] == 1 { part[axis] } else { 1.0 - part[axis] });
            let corner = [0, 1, 2].map(|axis| block[axis] + side[axis]);
            sum += weights[0] * weights[1] * weights[2] * coarse[flat(corner, self.corners())];
        }
        sum
    }

    /// How much interpolation around a node lies above the distance on average; see [`Field::from_distances`]. None where a neighbour is missing, or
    /// at a sharp edge.
    fn bias(&self, block: [usize; 3], node: [usize; 3], fine: &[Fine]) -> Option<f32> {
        let at = |axis: usize, step: isize| {
            let (mut way, mut moved) = ([0; 3], node);
            moved[axis] = match (node[axis], step) {
                (0, -1) => {
                    way[axis] = -1;
                    BLOCK - 1
                }
                (BLOCK, 1) => {
                    way[axis] = 1;
                    1
                }
                (n, step) => n.checked_add_signed(step)?,
            };
            let number = self.blocks.numbers[flat(self.moved(block, way)?, self.blocks.count)];
            Some(fine.get(usize::from(number).checked_sub(1)?)?[flat(moved, [SIDE; 3])])
        };
        let middle = at(0, 0)?;
        let sum = (at(0, -1)? + at(0, 1)?) + (at(1, -1)? + at(1, 1)?) + (at(2, -1)? + at(2, 1)?);
        let bias = (sum - 6.0 * middle) * (1.0 / 12.0);
        (bias.abs() < ROUND_PART * self.grid.cell.min_element()).then_some(bias)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sdf::moments::Moments;
    use crate::sdf::nearest::Skin;
    use crate::shape::{Mesh, mesh_make};
    use crate::{Quat, Vec3};

    fn of_blocks(mesh: &Mesh, cell: f32) -> Field {
        let bounding = Bounding::Exactly(Skin::of(mesh));
        bake_blocks(Grid::of_blocks(mesh, cell), &bounding, 1 << 24, &|_, _| {}).expect("small enough")
    }

    fn dense(mesh: &Mesh, cell: f32) -> Field {
        let bounding = Bounding::Exactly(Skin::of(mesh));
        super::super::bake::bake_dense(Grid::around(mesh, cell), &bounding, &|_, _| {})
    }

    fn points(count: u32, reach: Vec3) -> impl Iterator<Item = Vec3> {
        let mut state = 1_u32;
        let mut number = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        (0..count).map(move |_| Vec3::new(number(), number(), number()) * reach)
    }

    fn tilted_torus() -> Mesh {
        let flat = mesh_make::torus(1.0, 0.08, 64, 16).expect("a closed mesh");
        let tilt = Quat::from_rotation_arc(Vec3::Y, Vec3::new(0.6, 0.64, 0.48));
        let vertices: Vec<Vec3> = flat.vertices.iter().map(|v| tilt * *v).collect();
        Mesh::new(vertices, flat.triangles).expect("a closed mesh")
    }

    #[test]
    fn blocks_say_near_the_surface_what_a_dense_grid_says() {
        let mesh = tilted_torus();
        let (blocks, dense) = (of_blocks(&mesh, 0.02), dense(&mesh, 0.02));
        assert!(3 * blocks.bytes() < dense.bytes(), "{} and {}", blocks.bytes(), dense.bytes());
        let (mut near, mut far) = (0, 0);
        let around = points(20_000, Vec3::splat(0.1)).zip(mesh.vertices.iter().cycle());
        let around = around.map(|(offset, vertex)| *vertex + offset);
        for point in points(20_000, mesh.bounds().half_extents()).chain(around) {
            let ((a, g), (b, h)) = (blocks.distance_and_gradient(point), dense.distance_and_gradient(point));
            if b.abs() < 0.03 {
                // Rounding to 16 bits differs: the farthest node is not the same.
                assert!((a - b).abs() < 2e-4 && g.distance(h) < 0.05, "{a} {g} and {b} {h} at {point}");
                near += 1;
            } else if dense.contains(point) {
                // Four cells are one: a distance bends by a fraction of that.
                assert!((a - b).abs() < 0.02 && (a < 0.0) == (b < 0.0), "{a} and {b} at {point}");
                far += 1;
            }
        }
        assert!(near > 2000 && far > 10_000, "{near} near, {far} far");
        let (a, b) = (Moments::of(&blocks).volume, Moments::of(&dense).volume);
        assert!((a / b - 1.0).abs() < 1e-3, "{a} and {b}");
    }

    #[test]
    fn nothing_jumps_where_blocks_meet() {
        let frame = mesh_make::frame(Vec3::new(0.5, 0.06, 0.5), 0.08).expect("a closed mesh");
        for mesh in [frame, mesh_make::torus(0.5, 0.1, 48, 12).expect("a closed mesh")] {
            let field = of_blocks(&mesh, 0.015);
            let bounds = field.bounds();
            let step = 1e-4;
            for point in points(40_000, bounds.half_extents()) {
                let point = bounds.centre() + point;
                // Across the faces of blocks, at all places of them.
                for axis in 0..3 {
                    let block = 4.0 * field.cell_size()[axis];
                    let mut face = point;
                    face[axis] =
                        bounds.min[axis] + ((point[axis] - bounds.min[axis]) / block).round() * block;
                    let mut beside = Vec3::ZERO;
                    beside[axis] = step;
                    let [a, b] = [face - beside, face + beside].map(|p| field.distance_and_gradient(p).0);
                    assert!((a - b).abs() < 6.0 * step, "from {a} to {b} at {face}");
                }
            }
        }
    }

    #[test]
    fn a_hair_on_the_size_of_cells_does_not_change_blocks_for_a_dense_grid() {
        let mesh = tilted_torus();
        let across = mesh.bounds().max.x - mesh.bounds().min.x;
        // 80 cells either way: a little smaller than wished, and a little larger.
        let [small, large] = [79.995, 80.005].map(|parts| {
            super::super::bake::bake(&mesh, across / parts, &Bounding::Exactly(Skin::of(&mesh)), &|_, _| {})
        });
        assert!(small.blocks.is_some() && large.blocks.is_some());
        assert!(small.cell_size().distance(large.cell_size()) < 1e-6);
    }

    #[test]
    fn what_takes_too_much_memory_is_refused() {
        let mesh = mesh_make::torus(0.5, 0.2, 24, 12).expect("a closed mesh");
        let bounding = Bounding::Exactly(Skin::of(&mesh));
        let bake = |cell, bytes| bake_blocks(Grid::of_blocks(&mesh, cell), &bounding, bytes, &|_, _| {});
        assert!(bake(0.02, 1 << 24).is_some_and(|field| field.bytes() <= 1 << 24));
        assert!(bake(0.02, 1 << 12).is_none() && bake(0.0001, 1 << 24).is_none());
    }
}
