//! Ridges: long straight edges that another surface can touch between any two points of theirs.
//!
//! Promise: every stretch is in a sphere of its block, and as long as the shape is thick at most.

use super::lanes::{Lanes, Lanes3, WIDTH};
use super::samples::Spheres;
use crate::Vec3;

/// A stretch of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ridge {
    pub(crate) ends: [Vec3; 2],
    /// See [`Sample`](super::Sample).
    pub(crate) normal: Vec3,
    /// See [`Sample::facing_max`](super::Sample::facing_max).
    pub(crate) facing_max: f32,
}

/// Eight stretches. Those that only fill the block up repeat the last.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EightRidges {
    pub(crate) from: Lanes3,
    pub(crate) to: Lanes3,
    pub(crate) normals: Lanes3,
    pub(crate) facing_max: Lanes,
    /// The bits of those that are meant.
    pub(crate) meant: u32,
}

/// Stretches in blocks of 8.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Ridges {
    blocks: Vec<EightRidges>,
    /// Spheres around the blocks: lane l of the k-th eight is block 8 k + l.
    spheres: Vec<Spheres>,
}

impl Ridge {
    /// Cuts an edge into stretches no longer than `spacing`.
    pub(crate) fn cut(self, spacing: f32, into: &mut Vec<Ridge>) {
        let [a, b] = self.ends;
        let parts = (a.distance(b) / spacing).ceil().max(1.0);
        let at = |k: u32| a + (b - a) * (k as f32 / parts);
        into.extend((0..parts as u32).map(|k| Ridge { ends: [at(k), at(k + 1)], ..self }));
    }
}

impl Ridges {
    /// Puts neighbours together.
    pub(crate) fn new(mut ridges: Vec<Ridge>) -> Ridges {
        super::samples::sort_by_place(&mut ridges, |r| (r.ends[0] + r.ends[1]) * 0.5);
        let blocks: Vec<EightRidges> = ridges.chunks(WIDTH).map(EightRidges::new).collect();
        let ends: Vec<Vec<Vec3>> =
            ridges.chunks(WIDTH).map(|block| block.iter().flat_map(|r| r.ends).collect()).collect();
        let spheres = ends.chunks(WIDTH).map(Spheres::around).collect();
        Ridges { blocks, spheres }
    }

    /// Memory that they take.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.blocks) + size_of_val(&*self.spheres)
    }

    /// Calls `visit` with every block that `near` lets through: it is asked about eight spheres at a time.
    #[inline]
    pub(crate) fn visit(&self, near: impl Fn(&Spheres) -> u32, mut visit: impl FnMut(&EightRidges)) {
        for (eight, spheres) in self.spheres.iter().enumerate() {
            let mut bits = near(spheres);
            while bits != 0 {
                visit(&self.blocks[eight * WIDTH + bits.trailing_zeros() as usize]);
                bits &= bits - 1;
            }
        }
    }
}

impl EightRidges {
    fn new(ridges: &[Ridge]) -> EightRidges {
        let lane = |i: usize| &ridges[i.min(ridges.len() - 1)];
        let block = |part: &dyn Fn(&Ridge) -> Vec3| {
            let mut block = Lanes3::ZERO;
            for i in 0..WIDTH {
                block.set_lane(i, part(lane(i)));
            }
            block
        };
        EightRidges {
            from: block(&|r| r.ends[0]),
            to: block(&|r| r.ends[1]),
            normals: block(&|r| r.normal),
            facing_max: Lanes(std::array::from_fn(|i| lane(i).facing_max)),
            meant: (1 << ridges.len()) - 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stretch_is_in_the_sphere_of_its_block_and_none_is_lost() {
        let mut given = Vec::new();
        for i in 0..37_u32 {
            let a = Vec3::new((i * 7 % 13) as f32, (i * 5 % 11) as f32, (i * 3 % 7) as f32);
            let ridge =
                Ridge { ends: [a, a + Vec3::X * (1.0 + i as f32 * 0.1)], normal: Vec3::Y, facing_max: 0.2 };
            ridge.cut(0.75, &mut given);
        }
        assert!(given.iter().all(|r| r.ends[0].distance(r.ends[1]) <= 0.7501));
        let ridges = Ridges::new(given.clone());
        let mut found = Vec::new();
        for (k, block) in ridges.blocks.iter().enumerate() {
            let (spheres, l) = (&ridges.spheres[k / WIDTH], k % WIDTH);
            for i in (0..WIDTH).filter(|i| block.meant >> i & 1 == 1) {
                let ends = [block.from.lane(i), block.to.lane(i)];
                assert!(ends.iter().all(|e| e.distance(spheres.centre.lane(l)) <= spheres.radius.0[l]));
                found.push(ends.map(|e| e.to_array().map(f32::to_bits)));
            }
        }
        let mut expected: Vec<_> =
            given.iter().map(|r| r.ends.map(|e| e.to_array().map(f32::to_bits))).collect();
        found.sort_unstable();
        expected.sort_unstable();
        assert_eq!(found, expected);
    }
}
