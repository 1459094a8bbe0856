//! Broad phase: which pairs of bounds overlap. Areas (a spatial grid) with sort and sweep inside, as in chapter 4 of the
//! dissertation.
//!
//! Promise: the pairs are exactly the overlapping ones, sorted; grid and sweep only make it fast.

use forerun_geometry::{Aabb, Vec3};
use rayon::prelude::*;

/// Edge of an area over the mean extent of the bounds: measured best between many small areas and long sweeps.
const AREA_OVER_EXTENT: f32 = 3.0;
/// A grid has at most this many areas for each bound; beyond, the areas grow.
const AREAS_PER_BOUND: usize = 8;
/// Areas that one task sweeps.
const AREAS_PER_TASK: usize = 256;

/// What the broad phase knows of a body.
#[derive(Clone, Copy, Debug)]
pub struct Bound {
    /// Swept bound.
    pub aabb: Aabb,
    /// Whether the body is dynamic: pairs of two others are left out.
    pub dynamic: bool,
}

/// All pairs (lower index first) of overlapping bounds of which at least one is dynamic, sorted.
#[must_use]
pub fn overlapping_pairs(bounds: &[Bound]) -> Vec<(u32, u32)> {
    let Some(grid) = Grid::around(bounds) else {
        return overlapping_pairs_by_force(bounds);
    };
    let (mut large, mut small) = (Vec::new(), Vec::new());
    for (i, b) in bounds.iter().enumerate() {
        if grid.is_large(&b.aabb) { large.push(i as u32) } else { small.push(i as u32) }
    }
    let mut pairs = grid.sweep_areas(bounds, &small);
    for (k, &i) in large.iter().enumerate() {
        let a = &bounds[i as usize];
        for &j in small.iter().chain(&large[k + 1..]) {
            let b = &bounds[j as usize];
            if (a.dynamic || b.dynamic) && a.aabb.overlaps(&b.aabb) {
                pairs.push((i.min(j), i.max(j)));
            }
        }
    }
    sort_pairs(pairs, bounds.len())
}

/// The reference that tests compare with: every bound against every other.
#[must_use]
pub fn overlapping_pairs_by_force(bounds: &[Bound]) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    for (i, a) in bounds.iter().enumerate() {
        for (j, b) in bounds.iter().enumerate().skip(i + 1) {
            if (a.dynamic || b.dynamic) && a.aabb.overlaps(&b.aabb) {
                pairs.push((i as u32, j as u32));
            }
        }
    }
    pairs
}

/// Below this many bounds a grid does not pay.
const FEW: usize = 12;

/// Equal cubes over the place where most bounds are; bounds outside count to the outermost ones.
struct Grid {
    origin: Vec3,
    per_metre: f32,
    edge: f32,
    size: [usize; 3],
}

/// A bound in an area.
#[derive(Clone, Copy)]
struct Entry {
    aabb: Aabb,
    index: u32,
    dynamic: bool,
}

impl Grid {
    fn around(bounds: &[Bound]) -> Option<Grid> {
        if bounds.len() < FEW {
            return None;
        }
        let (mut sum, mut count) = (0.0f64, 0u32);
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for b in bounds.iter().filter(|b| b.dynamic) {
            let extent = (b.aabb.max - b.aabb.min).max_element();
            if extent.is_finite() {
                sum += f64::from(extent);
                count += 1;
                low = low.min(b.aabb.min);
                high = high.max(b.aabb.max);
            }
        }
        if count == 0 || !(low.is_finite() && high.is_finite()) {
            return None;
        }
        let mut edge = AREA_OVER_EXTENT * (sum / f64::from(count)).max(1e-6) as f32;
        let most = AREAS_PER_BOUND * bounds.len();
        loop {
            // Saturating: a body a light year away must not overflow.
            let size = ((high - low) / edge).to_array().map(|cells| (cells as usize).saturating_add(1));
            if size.iter().try_fold(1usize, |n, &s| n.checked_mul(s)).is_some_and(|n| n <= most) {
                return Some(Grid { origin: low, per_metre: 1.0 / edge, edge, size });
            }
            edge *= 1.5;
        }
    }

    fn is_large(&self, aabb: &Aabb) -> bool {
        let extent = (aabb.max - aabb.min).max_element();
        extent > self.edge || extent.is_nan()
    }

    /// The area that holds a point. Monotone in every coordinate, also outside the grid.
    fn area(&self, point: Vec3) -> [usize; 3] {
        let at = (point - self.origin) * self.per_metre;
        [0, 1, 2].map(|k| (at[k].max(0.0) as usize).min(self.size[k] - 1))
    }

    fn number(&self, area: [usize; 3]) -> usize {
        (area[2] * self.size[1] + area[1]) * self.size[0] + area[0]
    }

    /// Sorts the bounds into all areas that they touch, and sweeps each area along x.
    fn sweep_areas(&self, bounds: &[Bound], small: &[u32]) -> Vec<(u32, u32)> {
        let count = self.size[0] * self.size[1] * self.size[2];
        let mut starts = vec![0u32; count + 1];
        let each = |visit: &mut dyn FnMut(usize, u32)| {
            for &i in small {
                let aabb = &bounds[i as usize].aabb;
                let (low, high) = (self.area(aabb.min), self.area(aabb.max));
                for z in low[2]..=high[2] {
                    for y in low[1]..=high[1] {
                        for x in low[0]..=high[0] {
                            visit(self.number([x, y, z]), i);
                        }
                    }
                }
            }
        };
        each(&mut |area, _| starts[area + 1] += 1);
        for a in 0..count {
            starts[a + 1] += starts[a];
        }
        let mut next = starts.clone();
        let mut entries = vec![0u32; starts[count] as usize];
        each(&mut |area, i| {
            entries[next[area] as usize] = i;
            next[area] += 1;
        });
        let areas: Vec<usize> = (0..count).filter(|&a| starts[a + 1] - starts[a] > 1).collect();
        let sweep = |areas: &[usize]| {
            let (mut pairs, mut list) = (Vec::new(), Vec::new());
            for &area in areas {
                let (from, to) = (starts[area] as usize, starts[area + 1] as usize);
                list.clear();
                list.extend(entries[from..to].iter().map(|&index| {
                    let b = &bounds[index as usize];
                    Entry { aabb: b.aabb, index, dynamic: b.dynamic }
                }));
                self.sweep(area, &mut list, &mut pairs);
            }
            pairs
        };
        if areas.len() <= AREAS_PER_TASK {
            return sweep(&areas);
        }
        let parts: Vec<Vec<(u32, u32)>> = areas.par_chunks(AREAS_PER_TASK).map(sweep).collect();
        parts.concat()
    }

    /// Sort and sweep inside one area. A pair that shares several areas belongs to the one that holds the lowest corner of its overlap.
    fn sweep(&self, area: usize, list: &mut [Entry], pairs: &mut Vec<(u32, u32)>) {
        list.sort_unstable_by(|a, b| a.aabb.min.x.total_cmp(&b.aabb.min.x).then(a.index.cmp(&b.index)));
        for (k, a) in list.iter().enumerate() {
            for b in &list[k + 1..] {
                if b.aabb.min.x > a.aabb.max.x {
                    break;
                }
                if (a.dynamic || b.dynamic)
                    && a.aabb.overlaps(&b.aabb)
                    && self.number(self.area(a.aabb.min.max(b.aabb.min))) == area
                {
                    pairs.push((a.index.min(b.index), a.index.max(b.index)));
                }
            }
        }
    }
}

/// Sorts by first, then second: a counting sort over the first, and a short sort for each.
fn sort_pairs(pairs: Vec<(u32, u32)>, count: usize) -> Vec<(u32, u32)> {
    let mut starts = vec![0u32; count + 1];
    for &(i, _) in &pairs {
        starts[i as usize + 1] += 1;
    }
    for i in 0..count {
        starts[i + 1] += starts[i];
    }
    let mut next = starts.clone();
    let mut sorted = vec![(0, 0); pairs.len()];
    for pair in pairs {
        let at = &mut next[pair.0 as usize];
        sorted[*at as usize] = pair;
        *at += 1;
    }
    for i in 0..count {
        sorted[starts[i] as usize..starts[i + 1] as usize].sort_unstable();
    }
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(seed: u64) -> impl FnMut(f32) -> f32 {
        let mut state = seed;
        move |scale| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            scale * ((state >> 40) as f32 / (1u64 << 24) as f32)
        }
    }

    #[test]
    fn grid_and_sweep_find_what_brute_force_finds() {
        for seed in 0..40 {
            let mut r = random(seed);
            let spread = [3.0, 30.0, 300.0, 3e6][seed as usize % 4];
            let bounds: Vec<Bound> = (0..300)
                .map(|i| {
                    let centre = Vec3::new(r(spread), r(0.2 * spread), r(spread));
                    let half = Vec3::new(r(1.0), r(1.0), r(1.0)) * if i % 50 == 0 { 40.0 } else { 1.0 };
                    Bound { aabb: Aabb::from_centre(centre, half), dynamic: i % 7 != 0 }
                })
                .chain([Bound {
                    aabb: Aabb { min: Vec3::NEG_INFINITY, max: Vec3::new(f32::INFINITY, 0.5, f32::INFINITY) },
                    dynamic: false,
                }])
                .collect();
            assert_eq!(overlapping_pairs(&bounds), overlapping_pairs_by_force(&bounds), "seed {seed}");
        }
    }

    #[test]
    fn a_bound_at_infinity_does_not_hang() {
        let mut bounds = vec![Bound { aabb: Aabb::from_centre(Vec3::ZERO, Vec3::ONE), dynamic: true }; 20];
        bounds[3].aabb = Aabb::from_centre(Vec3::splat(1e30), Vec3::ONE);
        assert_eq!(overlapping_pairs(&bounds), overlapping_pairs_by_force(&bounds));
    }
}
