//! Samples: points of a surface that are looked up in the field of another, in a hierarchy of spheres.
//!
//! Promise: every vertex is a sample, and points along long edges are no further apart than asked.

use forerun_lanes::{LANES, Lanes, Portable, V8};

use super::eight::{lane, of_vectors};
use crate::Vec3;

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Where it is. Metres.
    pub point: Vec3,
    /// Outward unit normal: at an edge or corner the mean of those around.
    pub normal: Vec3,
    /// Largest cosine between this normal and the outward normal of whatever touches here: -1 if only what faces it exactly may.
    pub facing_max: f32,
}

impl Sample {
    /// [`Sample::facing_max`] at edges and corners: two surfaces that touch face each other, with some to spare. It keeps a point
    /// that has come through the side of an edge, or past the middle of a thin part, from being pushed out on the wrong side.
    pub(crate) const SHARP: f32 = 0.2;

    /// [`Sample::facing_max`] inside a plane: 30 degrees for what interpolation turns a normal by.
    pub(crate) const FLAT: f32 = -0.87;

    /// [`Sample::facing_max`] where the normals of the faces around are up to an angle away from that of the sample, whose cosine is given.
    ///
    /// A point inside a flat or smooth part of a surface can only be touched by what lies on that part: without this it would catch the
    /// front of whatever slides over it (an *internal edge*).
    pub(crate) fn facing_within(cosine: f32) -> f32 {
        // From flat to an edge of 90 degrees, whose cosine is that of 45.
        let sharpness = (1.0 - cosine) / (1.0 - std::f32::consts::FRAC_1_SQRT_2);
        Sample::FLAT + (Sample::SHARP - Sample::FLAT) * sharpness.clamp(0.0, 1.0)
    }
}

/// Samples in leaves of 8, the leaves in nodes of 8.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// The last one repeats its last point.
    leaves: Vec<Leaf>,
    /// Spheres around the leaves: lane l of block k is leaf 8 k + l.
    leaf_spheres: Vec<Spheres>,
    /// Spheres around the blocks of leaves: lane l of block k is leaf block 8 k + l. None where the samples are in no order.
    node_spheres: Vec<Spheres>,
    /// Number of points that are meant.
    count: usize,
}

/// Eight samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leaf {
    pub(crate) points: V8<Portable>,
    pub(crate) normals: V8<Portable>,
    /// See [`Sample::facing_max`].
    pub(crate) facing_max: Portable,
}

/// Eight spheres. Those that only fill the block up have a radius of minus infinity: near nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spheres {
    pub(crate) centre: V8<Portable>,
    pub(crate) radius: Portable,
}

impl Samples {
    /// Sorts the samples into the hierarchy.
    pub(crate) fn new(mut samples: Vec<Sample>) -> Samples {
        sort_by_place(&mut samples, |s| s.point);
        let mut sorted = Samples::default();
        sorted.fill(&samples);
        for groups in samples.chunks(LANES * LANES * LANES) {
            sorted.node_spheres.push(Spheres::around(groups, LANES * LANES, |s| [s.point; 2]));
        }
        sorted
    }

    /// Replaces all by the given samples, in the order given and without nodes: quick, and enough for a few in some order of place.
    pub(crate) fn fill(&mut self, samples: &[Sample]) {
        let Samples { leaves, leaf_spheres, node_spheres, count } = self;
        leaves.clear();
        leaves.extend(samples.chunks(LANES).map(Leaf::of));
        leaf_spheres.clear();
        leaf_spheres.extend(
            samples.chunks(LANES * LANES).map(|groups| Spheres::around(groups, LANES, |s| [s.point; 2])),
        );
        node_spheres.clear();
        *count = samples.len();
    }

    /// How many points there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The samples, in the order of the hierarchy.
    pub fn iter(&self) -> impl Iterator<Item = Sample> + '_ {
        (0..self.count).map(|i| {
            let (leaf, i) = (&self.leaves[i / LANES], i % LANES);
            Sample {
                point: lane(&leaf.points, i),
                normal: lane(&leaf.normals, i),
                facing_max: leaf.facing_max.to_array()[i],
            }
        })
    }

    /// Memory that the points and spheres take.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.leaves) + size_of_val(&*self.leaf_spheres) + size_of_val(&*self.node_spheres)
    }

    /// A leaf, and the bits of those of its samples that are meant.
    #[inline(always)]
    pub(crate) fn leaf(&self, leaf: usize) -> (&Leaf, u32) {
        let meant = (self.count - leaf * LANES).min(LANES);
        (&self.leaves[leaf], (1_u32 << meant) - 1)
    }

    /// Spheres around eight leaves each.
    #[inline(always)]
    pub(crate) fn leaf_spheres(&self) -> &[Spheres] {
        &self.leaf_spheres
    }

    /// Spheres around eight of [`Samples::leaf_spheres`] each; none where the samples are in no order.
    #[inline(always)]
    pub(crate) fn node_spheres(&self) -> &[Spheres] {
        &self.node_spheres
    }
}

impl Leaf {
    /// Up to eight samples.
    fn of(samples: &[Sample]) -> Leaf {
        let samples: [Sample; LANES] = std::array::from_fn(|i| samples[i.min(samples.len() - 1)]);
        Leaf {
            points: of_vectors(&samples.map(|s| s.point)),
            normals: of_vectors(&samples.map(|s| s.normal)),
            facing_max: Portable::from_array(samples.map(|s| s.facing_max)),
        }
    }
}

impl Spheres {
    /// The spheres around up to eight groups of so many things, each between two points.
    pub(super) fn around<T>(things: &[T], group: usize, ends: fn(&T) -> [Vec3; 2]) -> Spheres {
        let (mut centre, mut radius) = ([Vec3::ZERO; LANES], [f32::NEG_INFINITY; LANES]);
        for (i, group) in things.chunks(group).enumerate() {
            let points = || group.iter().flat_map(ends);
            let min = points().fold(Vec3::INFINITY, Vec3::min);
            let max = points().fold(Vec3::NEG_INFINITY, Vec3::max);
            centre[i] = (min + max) * 0.5;
            let farthest = points().fold(0.0_f32, |r, p| r.max(p.distance_squared(centre[i]))).sqrt();
            // A little more, for what the sums below may lose.
            radius[i] = farthest * 1.0001 + 1e-6;
        }
        Spheres { centre: of_vectors(&centre), radius: Portable::from_array(radius) }
    }
}

/// Sorts things at places so that every run of 8, and of 64, is close together: halves along the longest side, again and again.
pub(super) fn sort_by_place<T>(things: &mut [T], place: fn(&T) -> Vec3) {
    if things.len() <= LANES {
        return;
    }
    let min = things.iter().fold(Vec3::INFINITY, |m, t| m.min(place(t)));
    let max = things.iter().fold(Vec3::NEG_INFINITY, |m, t| m.max(place(t)));
    let axis = (max - min).max_position();
    let key = |t: &T| [0, 1, 2].map(|k| place(t)[(axis + k) % 3]);
    things.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
    });
    let leaf_or_node = if things.len() > LANES * LANES { LANES * LANES } else { LANES };
    let half = (things.len() / 2).div_ceil(leaf_or_node) * leaf_or_node;
    let (low, high) = things.split_at_mut(half);
    sort_by_place(low, place);
    sort_by_place(high, place);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scattered(count: u32) -> Vec<Sample> {
        let part = |i: u32, k: u32| ((i * 7919 + k * 104_729) % 1009) as f32 / 1009.0;
        let point = |i| Vec3::new(part(i, 1), part(i * i % 997, 2), part(i * 31 % 499, 3));
        (0..count).map(|i| Sample { point: point(i), normal: Vec3::Y, facing_max: Sample::SHARP }).collect()
    }

    #[test]
    fn every_sample_is_visited_once_and_lies_in_its_spheres() {
        for count in [1, 7, 8, 9, 64, 65, 500, 1000] {
            let given = scattered(count);
            let samples = Samples::new(given.clone());
            let bits = |point: Vec3| point.to_array().map(f32::to_bits);
            let mut visited: Vec<[u32; 3]> = Vec::new();
            for leaf in 0..count.div_ceil(LANES as u32) as usize {
                let (leaf, meant) = samples.leaf(leaf);
                let meant = (0..LANES).filter(|i| meant >> i & 1 == 1);
                visited.extend(meant.map(|i| bits(lane(&leaf.points, i))));
            }
            let mut expected: Vec<[u32; 3]> = given.iter().map(|s| bits(s.point)).collect();
            visited.sort_unstable();
            expected.sort_unstable();
            assert_eq!(visited, expected);
            let of_runs = [(&samples.leaf_spheres, LANES), (&samples.node_spheres, LANES * LANES)];
            for (i, sample) in samples.iter().enumerate() {
                for (spheres, run) in of_runs {
                    let (spheres, at) = (spheres[i / run / LANES], i / run % LANES);
                    let reach = spheres.radius.to_array()[at];
                    assert!(sample.point.distance(lane(&spheres.centre, at)) <= reach);
                }
            }
        }
    }

    #[test]
    fn neighbours_share_leaves() {
        let samples = Samples::new(scattered(1000));
        let radii = samples.leaf_spheres.iter().flat_map(|l| l.radius.to_array());
        let mean = radii.filter(|r| *r > 0.0).sum::<f32>() / 125.0;
        assert!(mean < 0.2, "leaves of 8 in 1000 points of a unit cube have a mean radius of {mean} m");
    }
}
