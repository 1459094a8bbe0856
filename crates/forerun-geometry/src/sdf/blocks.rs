//! Blocks: fields that are fine near the surface only, for what is large and mostly empty.
//!
//! The grid is cut into blocks of 4 cells a side. Those near the surface have all their nodes; the others are one large cell of a coarse grid
//! each. Both kinds of nodes lie in the same list with the same distance from row to row, so that one look-up serves both.
//!
//! Promise: where blocks meet, both have the same distances up to rounding to 16 bits.

use forerun_lanes::LANES;

/// Cells along the side of a block.
pub(super) const BLOCK: usize = 4;
/// Most blocks of a field, coarse ones included: they take 6 bytes each.
pub(super) const BLOCKS_MAX: usize = 1 << 17;
/// Nodes along the side of a block, and of a chunk of the coarse grid.
pub(super) const SIDE: usize = BLOCK + 1;
/// Nodes of a block, and of a chunk.
pub(super) const NODES: usize = SIDE * SIDE * SIDE;
/// From the lowest node of a cell to the rows of nodes along its four edges in the direction of x.
pub(super) const ROWS: [u32; 4] = [0, SIDE as u32, (SIDE * SIDE) as u32, (SIDE * SIDE + SIDE) as u32];

/// Which blocks of a grid are fine.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Blocks {
    /// Number of blocks along x, y and z.
    pub(super) count: [usize; 3],
    /// For each block, x fastest: 0 if it is coarse, else its number among the fine ones from 1.
    pub(super) numbers: Vec<u16>,
    /// Number of chunks of the coarse grid along x, y and z: each serves 4 blocks a side.
    chunks: [usize; 3],
}

/// Where eight points are.
pub(super) struct BlockPlace {
    /// The lowest nodes of their cells.
    pub(super) base: [u32; LANES],
    /// Position in the cell along x, y and z, 0 to 1.
    pub(super) fraction: [[f32; LANES]; 3],
    /// Fine cells per cell, inverted: 1 where it is fine, a quarter where it is coarse.
    pub(super) step: [f32; LANES],
}

impl Blocks {
    /// Blocks of which none is fine yet.
    pub(super) fn new(count: [usize; 3]) -> Blocks {
        Blocks { count, numbers: vec![0; count.iter().product()], chunks: count.map(|n| n.div_ceil(BLOCK)) }
    }

    /// Memory that the numbers take.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.numbers)
    }

    /// Number of fine blocks, if each has a number of its own.
    pub(super) fn fine(&self) -> Option<usize> {
        let mut numbers: Vec<u16> = self.numbers.iter().copied().filter(|n| *n > 0).collect();
        numbers.sort_unstable();
        numbers
            .iter()
            .zip(1_u32..)
            .all(|(number, wanted)| u32::from(*number) == wanted)
            .then_some(numbers.len())
    }

    /// Nodes of the coarse grid, which come first in the list.
    pub(super) fn coarse_nodes(&self) -> usize {
        self.chunks.iter().product::<usize>() * NODES
    }

    /// Where a node of the coarse grid is kept in chunks: as many as eight places. `corner`: counted in blocks.
    pub(super) fn coarse_places(&self, corner: [usize; 3]) -> impl Iterator<Item = usize> + '_ {
        (0..8).filter_map(move |k| {
            // On the high face of the chunk before as well.
            let before = [0, 1, 2].map(|axis| k >> axis & 1);
            let mut chunk = [0; 3];
            let mut local = [0; 3];
            for axis in 0..3 {
                chunk[axis] = (corner[axis] / BLOCK).checked_sub(before[axis])?;
                local[axis] = corner[axis] - chunk[axis] * BLOCK;
            }
            let known = (0..3).all(|axis| chunk[axis] < self.chunks[axis] && local[axis] <= BLOCK);
            known.then(|| flat(chunk, self.chunks) * NODES + flat(local, [SIDE; 3]))
        })
    }

    /// The cells of eight points. `at`: position along x, y and z in fine cells, within the grid.
    #[allow(clippy::needless_range_loop, reason = "several short arrays are walked side by side")]
    #[inline(always)]
    pub(super) fn place(&self, at: [[f32; LANES]; 3]) -> BlockPlace {
        let first = self.coarse_nodes() as u32;
        let mut place = BlockPlace { base: [0; LANES], fraction: [[0.0; LANES]; 3], step: [1.0; LANES] };
        for lane in 0..LANES {
            let (mut block, mut cell) = ([0; 3], [0; 3]);
            for axis in 0..3 {
                let last = self.count[axis] as u32 * BLOCK as u32 - 1;
                cell[axis] = (at[axis][lane] as u32).min(last);
                block[axis] = (cell[axis] / BLOCK as u32) as usize;
            }
            let number = u32::from(self.numbers[flat(block, self.count)]);
            let (local, low, step) = if number > 0 {
                (cell.map(|c| c as usize % BLOCK), cell, 1.0)
            } else {
                let low = block.map(|b| (b * BLOCK) as u32);
                (block.map(|b| b % BLOCK), low, 1.0 / BLOCK as f32)
            };
            let start = if number > 0 {
                first + (number - 1) * NODES as u32
            } else {
                (flat(block.map(|b| b / BLOCK), self.chunks) * NODES) as u32
            };
            place.base[lane] = start + flat(local, [SIDE; 3]) as u32;
            place.step[lane] = step;
            for axis in 0..3 {
                place.fraction[axis][lane] = (at[axis][lane] - low[axis] as f32) * step;
            }
        }
        place
    }

    /// Calls `visit` for every cell, fine or coarse: its lowest node counted in fine cells, its size in those, and the place of its lowest node in
    /// the list.
    pub(super) fn each_cell(&self, mut visit: impl FnMut([usize; 3], usize, usize)) {
        let first = self.coarse_nodes();
        for (k, number) in self.numbers.iter().map(|n| *n as usize).enumerate() {
            let block = unflat(k, self.count);
            if number == 0 {
                let chunk = flat(block.map(|b| b / BLOCK), self.chunks) * NODES;
                visit(block.map(|b| b * BLOCK), BLOCK, chunk + flat(block.map(|b| b % BLOCK), [SIDE; 3]));
                continue;
            }
            for cell in (0..BLOCK * BLOCK * BLOCK).map(|c| unflat(c, [BLOCK; 3])) {
                let low = [0, 1, 2].map(|axis| block[axis] * BLOCK + cell[axis]);
                visit(low, 1, first + (number - 1) * NODES + flat(cell, [SIDE; 3]));
            }
        }
    }
}

/// The index of a place in a list, x fastest.
#[inline(always)]
pub(super) fn flat([x, y, z]: [usize; 3], size: [usize; 3]) -> usize {
    (z * size[1] + y) * size[0] + x
}

/// The place of an index in a list, x fastest.
pub(super) fn unflat(index: usize, size: [usize; 3]) -> [usize; 3] {
    [index % size[0], index / size[0] % size[1], index / (size[0] * size[1])]
}
