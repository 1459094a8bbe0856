//! Areas: equal cubes, at least as large as the bounds in them, each bound in the cube of its lowest corner.
//!
//! Two bounds can only overlap when their areas are neighbours or the same. This rests on comparisons alone: the number of an area rises
//! with the coordinate, however it is rounded, and a bound is only taken in if its own two corners are in areas that are neighbours or
//! the same. Areas are not stored: bounds are sorted by area, and of each row of areas one walks along with the sweep.

use forerun_geometry::Vec3;
use rayon::prelude::*;

use super::Bound;
use crate::lanes::{LANES, LaneMask, Lanes, dispatched};

/// Bounds whose sizes span so many powers of two share areas.
const OCTAVES: usize = 3;
/// Areas are made for this part of the bounds or more.
const PART: usize = 16;
/// Farther out than so many areas along an axis all is one area.
const FARTHEST: f32 = 1_048_575.0;
/// Bounds that one task sweeps.
const BOUNDS_PER_TASK: usize = 4096;
/// To find a row of areas costs as much as to compare with so many bounds.
const BOUNDS_PER_ROW: usize = 64;

/// The sizes of the bounds that are compared first.
pub(super) struct Sizes {
    /// Largest extent. Metres.
    edge: f32,
    /// Lowest corner of all.
    low: Vec3,
}

fn extent(bound: &Bound) -> f32 {
    (bound.aabb.max - bound.aabb.min).max_element()
}

/// The power of two below a number that is not negative.
fn octave(x: f32) -> usize {
    (x.max(f32::MIN_POSITIVE).to_bits() >> 23 & 0xff) as usize
}

impl Sizes {
    /// The smallest sizes that a good part of the bounds have. None if there are none of a finite size.
    pub(super) fn smallest(bounds: &[Bound], left: &[u32]) -> Option<Sizes> {
        let mut octaves = [0u32; 256];
        for &i in left {
            let extent = extent(&bounds[i as usize]);
            octaves[octave(extent)] += u32::from(extent.is_finite());
        }
        let first = octaves.iter().position(|&count| count > 0)?;
        let mut end = (first + OCTAVES).min(octaves.len());
        let mut count: u32 = octaves[first..end].iter().sum();
        while (count as usize) < left.len() / PART && end < octaves.len() {
            count += octaves[end];
            end += 1;
        }
        let mut sizes = Sizes { edge: 0.0, low: Vec3::INFINITY };
        for &i in left {
            let bound = &bounds[i as usize];
            let extent = extent(bound);
            if extent.is_finite() && octave(extent) < end {
                sizes.edge = sizes.edge.max(extent);
                sizes.low = sizes.low.min(bound.aabb.min);
            }
        }
        // A little more, or rounding would send some of the largest away.
        sizes.edge = (sizes.edge * 1.001).max(1e-30);
        (sizes.low.is_finite() && (1.0 / sizes.edge).is_finite()).then_some(sizes)
    }
}

/// Bounds sorted by area, ready for the lanes.
#[derive(Clone, Debug, Default)]
pub(super) struct Areas {
    low: Vec3,
    per_metre: f32,
    /// Areas along x, and in a layer of x and y; empty ones on both sides included.
    row: u64,
    layer: u64,
    /// Area and bound.
    entries: Vec<(u64, u32)>,
    spare: Vec<(u64, u32)>,
    digits: Vec<u32>,
    /// Number of the area of each bound, rising.
    areas: Vec<u64>,
    bounds: Bounds8,
}

/// Bounds by coordinate, with eight at the end that nothing overlaps.
#[derive(Clone, Debug, Default)]
struct Bounds8 {
    min: [Vec<f32>; 3],
    max: [Vec<f32>; 3],
    /// Index of the bound; the highest bit is set where it is dynamic.
    who: Vec<u32>,
}

const DYNAMIC: u32 = 1 << 31;

impl Bounds8 {
    /// Replaces what is held by some of `bounds`.
    fn fill(&mut self, bounds: &[Bound], indices: impl Iterator<Item = u32>) {
        self.who.clear();
        self.who.extend(indices.map(|i| i | if bounds[i as usize].dynamic { DYNAMIC } else { 0 }));
        let count = self.who.len();
        for k in 0..3 {
            let (min, max) = (&mut self.min[k], &mut self.max[k]);
            min.resize(count + LANES, 0.0);
            max.resize(count + LANES, 0.0);
            for ((min, max), who) in min.iter_mut().zip(max.iter_mut()).zip(&self.who) {
                let aabb = &bounds[(who & !DYNAMIC) as usize].aabb;
                (*min, *max) = (aabb.min[k], aabb.max[k]);
            }
            min[count..].fill(f32::INFINITY);
            max[count..].fill(f32::NEG_INFINITY);
        }
    }

    fn len(&self) -> usize {
        self.who.len()
    }

    #[inline(always)]
    fn load<F: Lanes>(of: &[f32], at: usize) -> F {
        let mut lanes = [0.0; LANES];
        lanes.copy_from_slice(&of[at..at + LANES]);
        F::from_array(lanes)
    }

    /// Which of eight bounds overlap one along an axis.
    #[inline(always)]
    fn reach<F: Lanes>(&self, one: &One<F>, at: usize, axis: usize) -> F::Mask {
        let min = Self::load::<F>(&self.min[axis], at);
        let max = Self::load::<F>(&self.max[axis], at);
        min.le(one.max[axis]) & one.min[axis].le(max)
    }

    /// Appends the pairs of one bound with those in a range.
    #[inline(always)]
    fn meet<F: Lanes>(&self, one: &One<F>, range: (usize, usize), pairs: &mut Vec<(u32, u32)>) {
        let (mut at, end) = range;
        while at < end {
            let mut bits = (self.reach(one, at, 0) & self.reach(one, at, 1) & self.reach(one, at, 2)).bits();
            if end - at < LANES {
                bits &= (1 << (end - at)) - 1;
            }
            while bits != 0 {
                let other = self.who[at + bits.trailing_zeros() as usize];
                bits &= bits - 1;
                if (one.who | other) & DYNAMIC != 0 {
                    let (a, b) = (one.who & !DYNAMIC, other & !DYNAMIC);
                    pairs.push((a.min(b), a.max(b)));
                }
            }
            at += LANES;
        }
    }
}

/// One bound in all lanes.
struct One<F> {
    min: [F; 3],
    max: [F; 3],
    who: u32,
}

impl<F: Lanes> One<F> {
    #[inline(always)]
    fn new(min: [f32; 3], max: [f32; 3], who: u32) -> Self {
        One {
            min: [F::splat(min[0]), F::splat(min[1]), F::splat(min[2])],
            max: [F::splat(max[0]), F::splat(max[1]), F::splat(max[2])],
            who,
        }
    }

    #[inline(always)]
    fn of(bounds: &Bounds8, at: usize) -> Self {
        let Bounds8 { min, max, who } = bounds;
        One::new([min[0][at], min[1][at], min[2][at]], [max[0][at], max[1][at], max[2][at]], who[at])
    }
}

impl Areas {
    /// The area of a point along the axes, 1 and up. Rises with every coordinate.
    fn area(&self, point: Vec3) -> [u64; 3] {
        // Saturating, and 0 for NaN: anything may be asked for.
        let at = |k: usize| ((point[k] - self.low[k]) * self.per_metre).min(FARTHEST) as u32;
        [u64::from(at(0)) + 1, u64::from(at(1)) + 1, u64::from(at(2)) + 1]
    }

    fn number(&self, area: [u64; 3]) -> u64 {
        area[2] * self.layer + area[1] * self.row + area[0]
    }

    /// Sorts into areas those of `left` that are small enough; the others go to `large`, which is replaced.
    ///
    pub(super) fn fill(&mut self, bounds: &[Bound], left: &[u32], sizes: &Sizes, large: &mut Vec<u32>) {
        (self.low, self.per_metre) = (sizes.low, 1.0 / sizes.edge);
        large.clear();
        self.entries.clear();
        let mut most = [0; 3];
        for &i in left {
            let aabb = &bounds[i as usize].aabb;
            let (low, high) = (self.area(aabb.min), self.area(aabb.max));
            // A bound at infinity fits only if both of its ends are there, and then it is in the farthest area.
            let fits = (0..3).all(|k| high[k] - low[k].min(high[k]) <= 1) && aabb.min.cmpge(sizes.low).all();
            if fits && aabb.max.is_finite() {
                most = [0, 1, 2].map(|k| most[k].max(low[k]));
                self.entries.push((low[2] << 42 | low[1] << 21 | low[0], i));
            } else {
                large.push(i);
            }
        }
        (self.row, self.layer) = (most[0] + 2, (most[0] + 2) * (most[1] + 2));
        let (row, layer, mask) = (self.row, self.layer, (1 << 21) - 1);
        for (area, _) in &mut self.entries {
            *area = (*area >> 42) * layer + (*area >> 21 & mask) * row + (*area & mask);
        }
        let highest = self.number(most);
        sort_by_area(&mut self.entries, &mut self.spare, &mut self.digits, highest);
        self.areas.clear();
        self.areas.extend(self.entries.iter().map(|(area, _)| *area));
        self.bounds.fill(bounds, self.entries.iter().map(|(_, i)| *i));
    }

    /// Appends the pairs among those in the areas.
    pub(super) fn sweep(&self, pairs: &mut Vec<(u32, u32)>) {
        let count = self.bounds.len();
        if count <= BOUNDS_PER_TASK || rayon::current_num_threads() == 1 {
            return sweep(self, (0, count), pairs);
        }
        let starts: Vec<usize> = (0..count).step_by(BOUNDS_PER_TASK).collect();
        let parts: Vec<Vec<(u32, u32)>> = (starts.par_iter())
            .map(|&from| {
                let mut pairs = Vec::new();
                sweep(self, (from, count.min(from + BOUNDS_PER_TASK)), &mut pairs);
                pairs
            })
            .collect();
        parts.iter().for_each(|part| pairs.extend(part));
    }

    /// Appends the pairs of each large bound with those in the areas.
    pub(super) fn look_up(&self, bounds: &[Bound], large: &[u32], pairs: &mut Vec<(u32, u32)>) {
        look_up(self, bounds, large, pairs);
    }

    /// Appends the pairs among `few`, each compared with each.
    pub(super) fn compare_all(&mut self, bounds: &[Bound], few: &[u32], pairs: &mut Vec<(u32, u32)>) {
        self.bounds.fill(bounds, few.iter().copied());
        compare_all(&self.bounds, pairs);
    }

    /// The entries whose areas are in a range of numbers.
    fn range(&self, first: u64, last: u64) -> (usize, usize) {
        let from = self.areas.partition_point(|&area| area < first);
        (from, from + self.areas[from..].partition_point(|&area| area <= last))
    }
}

dispatched! {
    fn sweep(areas: &Areas, range: (usize, usize), pairs: &mut Vec<(u32, u32)>) => sweep_lanes
}

/// Each bound of a range with those after it in its own and the next area of the row, and those in the three areas each of the four rows
/// that come after: half of its neighbours, as the other half looks at it.
#[inline(always)]
fn sweep_lanes<F: Lanes>(areas: &Areas, range: (usize, usize), pairs: &mut Vec<(u32, u32)>) {
    let Areas { row, layer, areas: ref numbers, ref bounds, .. } = *areas;
    let (from, to) = range;
    let Some(&first) = numbers.get(from) else { return };
    let steps = [row, layer - row, layer, layer + row];
    let mut rows = [(0, 0); 4];
    for k in 0..4 {
        rows[k] = areas.range(first + steps[k] - 1, first + steps[k] + 1);
    }
    let mut end = areas.range(first, first + 1).1;
    let mut current = first;
    for at in from..to {
        if numbers[at] != current {
            current = numbers[at];
            end = skip(numbers, end, current + 2);
            for k in 0..4 {
                let start = skip(numbers, rows[k].0, current + steps[k] - 1);
                rows[k] = (start, skip(numbers, rows[k].1.max(start), current + steps[k] + 2));
            }
        }
        let one = One::<F>::of(bounds, at);
        bounds.meet(&one, (at + 1, end), pairs);
        for row in rows {
            bounds.meet(&one, row, pairs);
        }
    }
}

/// The first entry from `at` on whose area is not below a number.
#[inline(always)]
fn skip(numbers: &[u64], mut at: usize, below: u64) -> usize {
    while at < numbers.len() && numbers[at] < below {
        at += 1;
    }
    at
}

dispatched! {
    fn look_up(areas: &Areas, bounds: &[Bound], large: &[u32], pairs: &mut Vec<(u32, u32)>) => look_up_lanes
}

#[inline(always)]
fn look_up_lanes<F: Lanes>(areas: &Areas, bounds: &[Bound], large: &[u32], pairs: &mut Vec<(u32, u32)>) {
    let count = areas.bounds.len();
    // The rows that hold anybody end here.
    let most = [areas.row - 2, areas.layer / areas.row - 2];
    let last_layer = areas.areas.last().map_or(0, |number| number / areas.layer);
    for &i in large {
        let Bound { aabb, dynamic } = bounds[i as usize];
        let who = i | if dynamic { DYNAMIC } else { 0 };
        let one = One::<F>::new(aabb.min.to_array(), aabb.max.to_array(), who);
        let (low, high) = (areas.area(aabb.min), areas.area(aabb.max));
        // Whoever overlaps begins one area before at most.
        let low = [low[0] - 1, low[1] - 1, low[2] - 1];
        let high = [high[0].min(most[0]), high[1].min(most[1]), high[2].min(last_layer)];
        if high[1] < low[1] || high[2] < low[2] {
            continue;
        }
        let rows = (high[1] - low[1] + 1) * (high[2] - low[2] + 1);
        if aabb.min.is_nan() || rows as usize > count / BOUNDS_PER_ROW {
            areas.bounds.meet(&one, (0, count), pairs);
            continue;
        }
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                let range = areas.range(areas.number([low[0], y, z]), areas.number([high[0], y, z]));
                areas.bounds.meet(&one, range, pairs);
            }
        }
    }
}

dispatched! {
    fn compare_all(bounds: &Bounds8, pairs: &mut Vec<(u32, u32)>) => compare_all_lanes
}

#[inline(always)]
fn compare_all_lanes<F: Lanes>(bounds: &Bounds8, pairs: &mut Vec<(u32, u32)>) {
    for at in 0..bounds.len() {
        bounds.meet(&One::<F>::of(bounds, at), (at + 1, bounds.len()), pairs);
    }
}

/// Sorts by area, the lower index first: by digits, the last first, as many bits each as it takes for the fewest rounds.
fn sort_by_area(
    entries: &mut Vec<(u64, u32)>,
    spare: &mut Vec<(u64, u32)>,
    digits: &mut Vec<u32>,
    highest: u64,
) {
    /// Most bits of a digit: the counters are to stay in the nearest cache.
    const BITS: u32 = 11;
    let bits = (u64::BITS - highest.leading_zeros()).max(1);
    let rounds = bits.div_ceil(BITS);
    let width = bits.div_ceil(rounds);
    let mask = (1u64 << width) - 1;
    spare.resize(entries.len(), (0, 0));
    for round in 0..rounds {
        let digit = |area: u64| (area >> (round * width) & mask) as usize;
        digits.clear();
        digits.resize(1 << width, 0);
        for &(area, _) in entries.iter() {
            digits[digit(area)] += 1;
        }
        let mut start = 0;
        for count in digits.iter_mut() {
            start += std::mem::replace(count, start);
        }
        for &entry in entries.iter() {
            let at = &mut digits[digit(entry.0)];
            spare[*at as usize] = entry;
            *at += 1;
        }
        std::mem::swap(entries, spare);
    }
}
