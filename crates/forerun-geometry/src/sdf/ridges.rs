//! Ridges: long straight edges that another surface can touch between any two points of theirs.
//!
//! Promise: every stretch is in a sphere of its block, and as long as the shape is thick at most.

use forerun_lanes::{LANES, Lanes, Portable, V8};

use super::eight::of_vectors;
use super::samples::{Spheres, sort_by_place};
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EightRidges {
    /// Both ends.
    pub(crate) ends: [V8<Portable>; 2],
    pub(crate) normals: V8<Portable>,
    pub(crate) facing_max: Portable,
    /// The bits of those that are meant.
    pub(crate) meant: u32,
}

/// Stretches in blocks of 8.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Ridges {
    pub(crate) blocks: Vec<EightRidges>,
    /// Spheres around the blocks: lane l of the k-th eight is block 8 k + l.
    pub(crate) spheres: Vec<Spheres>,
}

impl Ridge {
    /// Metres.
    pub(crate) fn length(&self) -> f32 {
        self.ends[0].distance(self.ends[1])
    }

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
        sort_by_place(&mut ridges, |r| (r.ends[0] + r.ends[1]) * 0.5);
        let mut sorted = Ridges::default();
        sorted.fill(&ridges);
        sorted
    }

    /// Replaces all by the given stretches, in the order given.
    pub(crate) fn fill(&mut self, ridges: &[Ridge]) {
        self.blocks.clear();
        self.blocks.extend(ridges.chunks(LANES).map(EightRidges::new));
        self.spheres.clear();
        let eights = ridges.chunks(LANES * LANES);
        self.spheres.extend(eights.map(|eight| Spheres::around(eight, LANES, |r| r.ends)));
    }

    /// Memory that they take.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.blocks) + size_of_val(&*self.spheres)
    }
}

impl EightRidges {
    fn new(ridges: &[Ridge]) -> EightRidges {
        let eight: [Ridge; LANES] = std::array::from_fn(|i| ridges[i.min(ridges.len() - 1)]);
        EightRidges {
            ends: [0, 1].map(|end| of_vectors(&eight.map(|r| r.ends[end]))),
            normals: of_vectors(&eight.map(|r| r.normal)),
            facing_max: Portable::from_array(eight.map(|r| r.facing_max)),
            meant: (1 << ridges.len()) - 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sdf::eight::lane;

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
            let (spheres, l) = (&ridges.spheres[k / LANES], k % LANES);
            for i in (0..LANES).filter(|i| block.meant >> i & 1 == 1) {
                let ends = block.ends.map(|end| lane(&end, i));
                assert!(
                    ends.iter().all(|e| e.distance(lane(&spheres.centre, l)) <= spheres.radius.to_array()[l])
                );
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
