//! Field storage: how fields are made from distances, and written and read.

use super::accuracy::FieldError;
use super::bake::Grid;
use super::blocks::{BLOCK, BLOCKS_MAX, Blocks, NODES, flat, unflat};
use super::field::Field;
use super::kept::Reader;
use crate::Vec3;
use crate::shape::Mesh;

/// More nodes than a grid may have: whole numbers below this are exact in the arithmetic of look-ups.
const NODES_END: usize = 1 << 23;

impl Field {
    /// A field from distances (metres) at the nodes of a grid, x fastest.
    ///
    /// The distances are stored in steps of the largest one over 32767. Before that a twelfth of the sum of second
    /// differences is taken off: between nodes trilinear interpolation lies above a convex function by that much on
    /// average, which would make round shapes too small. Not so at sharp edges, where it would make them too large.
    pub(super) fn from_distances(grid: &Grid, distances: &[f32]) -> Field {
        Field::store(grid, None, &without_interpolation_bias(grid, distances))
    }

    /// A field of blocks, from distances (metres) without the bias of interpolation, in the order of the blocks.
    pub(super) fn from_blocks(grid: &Grid, blocks: Blocks, distances: &[f32]) -> Field {
        Field::store(grid, Some(blocks), distances)
    }

    fn store(grid: &Grid, blocks: Option<Blocks>, distances: &[f32]) -> Field {
        let largest = distances.iter().fold(0.0_f32, |m, d| m.max(d.abs()));
        let scale = if largest > 0.0 { largest / f32::from(i16::MAX) } else { 1.0 };
        let nodes = distances.iter().map(|d| (d / scale).round() as i16).collect();
        Field {
            origin: grid.origin,
            cell: grid.cell,
            size: grid.size,
            cells: Vec3::from_array(grid.size.map(|n| (n - 1) as f32)),
            scale,
            error: FieldError::default(),
            blocks,
            nodes,
        }
    }

    /// The same field, its error measured on the surface that it was made from.
    pub(super) fn measured_on(self, surface: &Mesh) -> Field {
        Field { error: FieldError::measure(&self, surface), ..self }
    }

    /// Appends what [`Field::read`] reads.
    pub(super) fn write(&self, out: &mut Vec<u8>) {
        let numbers = self.origin.to_array().into_iter().chain(self.cell.to_array()).chain([self.scale]);
        numbers.for_each(|x| out.extend(x.to_le_bytes()));
        self.size.iter().for_each(|n| out.extend((*n as u32).to_le_bytes()));
        self.error.write(out);
        out.push(u8::from(self.blocks.is_some()));
        if let Some(blocks) = &self.blocks {
            blocks.numbers.iter().for_each(|n| out.extend(n.to_le_bytes()));
        }
        self.nodes.iter().for_each(|d| out.extend(d.to_le_bytes()));
    }

    /// A field that was written; none where it cannot be one.
    pub(super) fn read(reader: &mut Reader<'_>) -> Option<Field> {
        let (origin, cell, scale) = (reader.vec3()?, reader.vec3()?, reader.f32()?);
        let size = [reader.u32()?, reader.u32()?, reader.u32()?].map(|n| n as usize);
        let lengths = [cell.x, cell.y, cell.z, scale];
        let possible = origin.is_finite()
            && lengths.iter().all(|x| *x > 0.0 && x.is_finite())
            && size.iter().all(|n| *n >= 3);
        if !possible {
            return None;
        }
        let error = FieldError::read(reader)?;
        let (blocks, count) = match reader.array()? {
            [0] => (None, product(size).filter(|count| *count < NODES_END)?),
            [1] => {
                let blocks = read_blocks(reader, size)?;
                let count = blocks.coarse_nodes() + blocks.fine()? * NODES;
                (Some(blocks), count)
            }
            _ => return None,
        };
        let nodes = reader.i16s(count)?;
        let cells = Vec3::from_array(size.map(|n| (n - 1) as f32));
        Some(Field { origin, cell, size, cells, scale, error, blocks, nodes })
    }

    /// Distances between neighbouring nodes along x, y and z. Metres.
    pub(super) fn cell_size(&self) -> Vec3 {
        self.cell
    }

    /// Calls `visit` with the lowest corner of each cell, its size, and the distances at its corners: x changes fastest, then y, then z.
    pub(super) fn each_cell(&self, mut visit: impl FnMut(Vec3, Vec3, [f32; 8])) {
        let [_, row, layer, _] = self.rows().map(|offset| offset as usize);
        let mut cell = |low: [usize; 3], size: usize, base: usize| {
            let corners = [0, 1, row, row + 1, layer, layer + 1, layer + row, layer + row + 1];
            let distances = corners.map(|k| f32::from(self.nodes[base + k]) * self.scale);
            let low = Vec3::from_array(low.map(|n| n as f32));
            visit(self.origin + low * self.cell, self.cell * size as f32, distances);
        };
        if let Some(blocks) = &self.blocks {
            blocks.each_cell(cell);
            return;
        }
        let cells = self.size.map(|n| n - 1);
        for low in (0..cells.iter().product()).map(|k| unflat(k, cells)) {
            cell(low, 1, flat(low, self.size));
        }
    }
}

/// The product of three numbers, if there is one.
fn product(size: [usize; 3]) -> Option<usize> {
    size.iter().try_fold(1_usize, |all, n| all.checked_mul(*n))
}

/// The blocks of a grid of so many nodes.
fn read_blocks(reader: &mut Reader<'_>, size: [usize; 3]) -> Option<Blocks> {
    let count = size.map(|n| (n - 1) / BLOCK);
    let whole = (0..3).all(|axis| count[axis] * BLOCK + 1 == size[axis]);
    if !whole || product(count)? > BLOCKS_MAX {
        return None;
    }
    let mut blocks = Blocks::new(count);
    for number in &mut blocks.numbers {
        *number = u16::from_le_bytes(reader.array()?);
    }
    Some(blocks)
}

/// Second differences that would take off more than this part of a cell come from sharp edges: the smallest radius
/// that the cells are made for takes off a twenty-fourth.
pub(super) const ROUND_PART: f32 = 1.0 / 16.0;

/// The distances less (sum of the 6 neighbours - 6 times the node) / 12; nodes on the faces of the grid and at sharp
/// edges stay.
#[allow(clippy::needless_range_loop, reason = "the index is that of the neighbours too")]
fn without_interpolation_bias(grid: &Grid, distances: &[f32]) -> Vec<f32> {
    let ([nx, ny, nz], cell) = (grid.size, grid.cell.min_element());
    let (row, layer) = (nx, nx * ny);
    let mut corrected = distances.to_vec();
    for z in 1..nz - 1 {
        for y in 1..ny - 1 {
            for i in z * layer + y * row + 1..z * layer + y * row + nx - 1 {
                let d = |k: usize| distances[k];
                let neighbours =
                    (d(i - 1) + d(i + 1)) + (d(i - row) + d(i + row)) + (d(i - layer) + d(i + layer));
                let bias = (neighbours - 6.0 * d(i)) * (1.0 / 12.0);
                if bias.abs() < ROUND_PART * cell {
                    corrected[i] = d(i) - bias;
                }
            }
        }
    }
    corrected
}
