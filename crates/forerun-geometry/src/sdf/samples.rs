//! Samples: points of a surface that are looked up in the field of another, in a hierarchy of spheres.
//!
//! Promise: every vertex is a sample, and points along long edges are no further apart than asked.

use super::lanes::{Lanes, Lanes3, WIDTH};
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
    /// The points of leaf k; the last leaf repeats its last point.
    points: Vec<Lanes3>,
    /// Their normals.
    normals: Vec<Lanes3>,
    /// See [`Sample::facing_max`].
    facing_max: Vec<Lanes>,
    /// Spheres around the leaves: lane l of block k is leaf 8 k + l.
    leaves: Vec<Spheres>,
    /// Spheres around the blocks of leaves: lane l of block k is leaf block 8 k + l.
    nodes: Vec<Spheres>,
    /// Number of points that are meant.
    count: usize,
}

/// Eight spheres. Those that only fill the block up have a radius of minus infinity: near nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spheres {
    pub(crate) centre: Lanes3,
    pub(crate) radius: Lanes,
}

impl Samples {
    /// Sorts the samples into the hierarchy.
    pub(crate) fn new(mut samples: Vec<Sample>) -> Samples {
        sort_by_place(&mut samples, |s| s.point);
        let leaves: Vec<&[Sample]> = samples.chunks(WIDTH).collect();
        let points: Vec<Vec3> = samples.iter().map(|s| s.point).collect();
        let of_leaves: Vec<&[Vec3]> = points.chunks(WIDTH).collect();
        let of_nodes: Vec<&[Vec3]> = points.chunks(WIDTH * WIDTH).collect();
        Samples {
            points: leaves.iter().map(|leaf| block_of(leaf, |s| s.point)).collect(),
            normals: leaves.iter().map(|leaf| block_of(leaf, |s| s.normal)).collect(),
            facing_max: leaves
                .iter()
                .map(|leaf| Lanes(std::array::from_fn(|i| leaf[i.min(leaf.len() - 1)].facing_max)))
                .collect(),
            leaves: of_leaves.chunks(WIDTH).map(Spheres::around).collect(),
            nodes: of_nodes.chunks(WIDTH).map(Spheres::around).collect(),
            count: samples.len(),
        }
    }

    /// How many points there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The samples, in the order of the hierarchy.
    pub fn iter(&self) -> impl Iterator<Item = Sample> + '_ {
        (0..self.count).map(|i| Sample {
            point: self.points[i / WIDTH].lane(i % WIDTH),
            normal: self.normals[i / WIDTH].lane(i % WIDTH),
            facing_max: self.facing_max[i / WIDTH].0[i % WIDTH],
        })
    }

    /// Memory that the points and spheres take.
    #[must_use]
    pub fn bytes(&self) -> usize {
        2 * size_of_val(&*self.points)
            + size_of_val(&*self.facing_max)
            + size_of_val(&*self.leaves)
            + size_of_val(&*self.nodes)
    }

    /// Calls `visit` with eight points, their normals, how these must face what they touch and the bits of those that are meant, for every leaf
    /// that `near` lets through: it is asked about eight spheres at a time and answers with the bits of those that are near enough.
    #[inline]
    pub(crate) fn visit(
        &self,
        near: impl Fn(&Spheres) -> u32,
        mut visit: impl FnMut([&Lanes3; 2], &Lanes, u32),
    ) {
        for (block, nodes) in self.nodes.iter().enumerate() {
            let mut node_bits = near(nodes);
            while node_bits != 0 {
                let node = block * WIDTH + node_bits.trailing_zeros() as usize;
                node_bits &= node_bits - 1;
                let mut leaf_bits = near(&self.leaves[node]);
                while leaf_bits != 0 {
                    let leaf = node * WIDTH + leaf_bits.trailing_zeros() as usize;
                    leaf_bits &= leaf_bits - 1;
                    let meant = (self.count - leaf * WIDTH).min(WIDTH);
                    let (points, normals) = (&self.points[leaf], &self.normals[leaf]);
                    visit([points, normals], &self.facing_max[leaf], (1_u32 << meant) - 1);
                }
            }
        }
    }
}

impl Spheres {
    /// The spheres around up to eight groups of points.
    pub(super) fn around<P: AsRef<[Vec3]>>(groups: &[P]) -> Spheres {
        let mut spheres = Spheres { centre: Lanes3::ZERO, radius: Lanes::splat(f32::NEG_INFINITY) };
        for (i, group) in groups.iter().map(AsRef::as_ref).enumerate() {
            let min = group.iter().fold(Vec3::INFINITY, |m, p| m.min(*p));
            let max = group.iter().fold(Vec3::NEG_INFINITY, |m, p| m.max(*p));
            let centre = (min + max) * 0.5;
            let radius = group.iter().fold(0.0_f32, |r, p| r.max(p.distance(centre)));
            spheres.centre.set_lane(i, centre);
            // A little more, for what the sums below may lose.
            spheres.radius.0[i] = radius * 1.0001 + 1e-6;
        }
        spheres
    }
}

fn block_of(leaf: &[Sample], part: impl Fn(&Sample) -> Vec3) -> Lanes3 {
    let mut block = Lanes3::ZERO;
    for i in 0..WIDTH {
        block.set_lane(i, part(&leaf[i.min(leaf.len() - 1)]));
    }
    block
}

/// Sorts things at places so that every run of 8, and of 64, is close together: halves along the longest side, again and again.
pub(super) fn sort_by_place<T>(things: &mut [T], place: fn(&T) -> Vec3) {
    if things.len() <= WIDTH {
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
    let leaf_or_node = if things.len() > WIDTH * WIDTH { WIDTH * WIDTH } else { WIDTH };
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
            let mut visited: Vec<[u32; 3]> = Vec::new();
            let all = |spheres: &Spheres| Lanes::splat(f32::NEG_INFINITY).below(spheres.radius).bits();
            samples.visit(all, |[points, _], _, meant| {
                visited.extend(
                    (0..WIDTH)
                        .filter(|i| meant >> i & 1 == 1)
                        .map(|i| points.lane(i).to_array().map(f32::to_bits)),
                );
            });
            let mut expected: Vec<[u32; 3]> =
                given.iter().map(|s| s.point.to_array().map(f32::to_bits)).collect();
            visited.sort_unstable();
            expected.sort_unstable();
            assert_eq!(visited, expected);
            for (i, sample) in samples.iter().enumerate() {
                for (spheres, k) in [(&samples.leaves, i / WIDTH), (&samples.nodes, i / (WIDTH * WIDTH))] {
                    let (sphere, lane) = (spheres[k / WIDTH], k % WIDTH);
                    assert!(sample.point.distance(sphere.centre.lane(lane)) <= sphere.radius.0[lane]);
                }
            }
        }
    }

    #[test]
    fn neighbours_share_leaves() {
        let samples = Samples::new(scattered(1000));
        let mean = samples.leaves.iter().flat_map(|l| l.radius.0).filter(|r| *r > 0.0).sum::<f32>() / 125.0;
        assert!(mean < 0.2, "leaves of 8 in 1000 points of a unit cube have a mean radius of {mean} m");
    }
}
