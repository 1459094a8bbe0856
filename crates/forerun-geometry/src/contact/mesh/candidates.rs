//! Candidates: points of one surface near the other, eight at a time.

use forerun_lanes::{LaneMask, Lanes, Portable, V8};

use super::directions::Way;
use super::ridges::Search;
use crate::Vec3;
use crate::sdf::eight::lane;

/// The candidates of a pair, in the order in which they were found.
#[derive(Clone, Debug, Default)]
pub(super) struct Candidates {
    pub(super) blocks: Vec<Block>,
    /// The leaves of samples that are looked up.
    pub(super) leaves: Vec<u32>,
    /// The blocks of eight leaves that are looked into.
    pub(super) nodes: Vec<u32>,
    /// Of long edges.
    pub(super) search: Search,
}

/// Eight points, not all of which are candidates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    /// In the frame of the field. Metres.
    pub(super) point: V8<Portable>,
    /// Midpoints between the two surfaces, in the world. Metres.
    pub(super) position: V8<Portable>,
    /// Unit normals in the world, from the first shape to the second.
    pub(super) normal: V8<Portable>,
    /// Distances between the surfaces. Metres.
    pub(super) separation: Portable,
    /// The separations of candidates that no side of the contact has yet; infinite for all others.
    pub(super) left: Portable,
    /// The bits of those whose normal is that of trilinear interpolation at the point and may be smoothed.
    pub(super) rough: u32,
    /// What found them.
    pub(super) way: Way,
}

/// One of eight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) block: usize,
    pub(super) lane: usize,
}

/// A candidate by itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// See [`Block::point`].
    pub(super) point: Vec3,
    /// See [`Block::rough`].
    pub(super) rough: bool,
    /// See [`Block::position`].
    pub(super) position: Vec3,
    /// See [`Block::normal`].
    pub(super) normal: Vec3,
    /// See [`Block::separation`].
    pub(super) separation: f32,
    /// See [`Block::way`].
    pub(super) way: Way,
}

impl Candidates {
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
    }

    pub(super) fn at(&self, place: Place) -> Candidate {
        let (block, i) = (&self.blocks[place.block], place.lane);
        Candidate {
            point: lane(&block.point, i),
            rough: block.rough >> i & 1 == 1,
            position: lane(&block.position, i),
            normal: lane(&block.normal, i),
            separation: block.separation.to_array()[i],
            way: block.way,
        }
    }

    /// The first of the candidates left with the smallest separation.
    #[inline(always)]
    pub(super) fn deepest<F: Lanes>(&self) -> Option<Place> {
        let (mut least, mut at) = (F::splat(f32::INFINITY), F::zero());
        for (k, block) in self.blocks.iter().enumerate() {
            let left = F::from_array(block.left.to_array());
            let deeper = left.lt(least);
            least = deeper.select(left, least);
            at = deeper.select(F::splat(k as f32), at);
        }
        first_greatest(-least, at, f32::NEG_INFINITY)
    }
}

/// Where the greatest of eight numbers came from, each in the block given for its lane; of equals the first. None if
/// none is above `floor`.
#[inline(always)]
pub(super) fn first_greatest<F: Lanes>(numbers: F, blocks: F, floor: f32) -> Option<Place> {
    let mut greatest = floor;
    for number in numbers.to_array() {
        greatest = if number > greatest { number } else { greatest };
    }
    if greatest <= floor {
        return None;
    }
    let mut equal = F::splat(greatest).le(numbers).bits();
    let (blocks, mut best) = (blocks.to_array(), equal.trailing_zeros() as usize);
    equal &= equal - 1;
    while equal != 0 {
        let lane = equal.trailing_zeros() as usize;
        equal &= equal - 1;
        best = if blocks[lane] < blocks[best] { lane } else { best };
    }
    Some(Place { block: blocks[best] as usize, lane: best })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_equals_the_first_candidate_is_the_greatest() {
        let greatest = |numbers: [f32; 8], blocks: [f32; 8]| {
            first_greatest(Portable::from_array(numbers), Portable::from_array(blocks), 0.5)
        };
        let blocks = [3.0, 2.0, 2.0, 1.0, 0.0, 4.0, 4.0, 9.0];
        let place = |block, lane| Some(Place { block, lane });
        assert_eq!(greatest([1.0, 1.0, 1.0, 0.9, 0.0, 1.0, 1.0, 0.6], blocks), place(2, 1));
        assert_eq!(greatest([1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.1], blocks), place(9, 7));
        assert_eq!(greatest([0.5, 0.4, -1.0, 0.5, f32::NAN, f32::NEG_INFINITY, 0.0, 0.1], blocks), None);
    }
}
