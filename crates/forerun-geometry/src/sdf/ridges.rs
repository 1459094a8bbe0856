//! Ridges: long straight edges that another surface can touch between any two points of theirs.
//!
//! Promise: every stretch is in a sphere of its block, and as long as the shape is thick at most.

use forerun_lanes::{LANES, Lanes, Row, V8};

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

/// Eight stretches.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EightRidges<F> {
    pub(crate) from: V8<F>,
    pub(crate) to: V8<F>,
    pub(crate) normals: V8<F>,
    pub(crate) facing_max: F,
}

/// Stretches in blocks of 8.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Ridges {
    /// Of each stretch both ends, and [`Ridge::facing_max`]; then the normal.
    rows: Vec<Row>,
    /// Spheres around the blocks: lane l of the k-th eight is block 8 k + l.
    spheres: Vec<Spheres>,
}

/// Rows that a stretch takes.
const ROWS: usize = 2;

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
        self.rows.clear();
        self.rows.extend(ridges.iter().flat_map(|r| {
            let ([a, b], n) = (r.ends, r.normal);
            [
                Row([a.x, a.y, a.z, b.x, b.y, b.z, r.facing_max, 0.0]),
                Row([n.x, n.y, n.z, 0.0, 0.0, 0.0, 0.0, 0.0]),
            ]
        }));
        self.spheres.clear();
        let eights = ridges.chunks(LANES * LANES);
        self.spheres.extend(eights.map(|eight| Spheres::around(eight, LANES, |r| r.ends)));
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Spheres around eight blocks each: lane l of the k-th is around block 8 k + l.
    #[inline(always)]
    pub(crate) fn spheres(&self) -> &[Spheres] {
        &self.spheres
    }

    /// The numbers of eight stretches from the given one on, and the bits of those that there are: the last one fills them up.
    #[inline(always)]
    pub(crate) fn run(&self, first: usize) -> ([u32; LANES], u32) {
        let count = self.rows.len() / ROWS;
        let mut which = [0; LANES];
        for (i, which) in which.iter_mut().enumerate() {
            *which = (first + i).min(count - 1) as u32;
        }
        (which, (1_u32 << (count - first).min(LANES)) - 1)
    }

    /// Eight stretches by their numbers.
    #[inline(always)]
    pub(crate) fn eight<F: Lanes>(&self, which: &[u32; LANES]) -> EightRidges<F> {
        let mut rows = *which;
        for row in &mut rows {
            *row *= ROWS as u32;
        }
        let [ax, ay, az, bx, by, bz, facing_max, _] = F::gather(&self.rows, &rows);
        let [nx, ny, nz, ..] = F::gather(&self.rows[1..], &rows);
        EightRidges {
            from: V8 { x: ax, y: ay, z: az },
            to: V8 { x: bx, y: by, z: bz },
            normals: V8 { x: nx, y: ny, z: nz },
            facing_max,
        }
    }

    /// Memory that they take.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.rows) + size_of_val(&*self.spheres)
    }
}

#[cfg(test)]
mod tests {
    use forerun_lanes::Portable;

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
        for first in (0..given.len()).step_by(LANES) {
            let (which, meant) = ridges.run(first);
            let (eight, block) = (ridges.eight::<Portable>(&which), first / LANES);
            let (spheres, l) = (&ridges.spheres()[block / LANES], block % LANES);
            for i in (0..LANES).filter(|i| meant >> i & 1 == 1) {
                let ends = [eight.from, eight.to].map(|end| lane(&end, i));
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
