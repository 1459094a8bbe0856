//! Course: where eight stretches of edges come near the other surface, in lanes.

use forerun_lanes::{LANES, LaneMask, Lanes, Row, V8, cells};

use super::directions::Direction;
use crate::sdf::eight::transformed;
use crate::sdf::ridges::EightRidges;

/// Slopes below this are level: the edge lies on the surface there.
const LEVEL: f32 = 1e-3;
/// Part of a stretch next to its ends, which are points already.
const END_PART: f32 = 1e-3;
/// How far behind the rim of a side the points are where an edge has come to lie on it, at least. Metres.
const INSIDE: f32 = 1e-3;
/// How much farther, for each metre that they are deep or high, so that the side is nearer to them than the one next to it.
const INSIDE_PER_DEPTH: f32 = 1.5;

/// A place on each of eight stretches.
#[derive(Clone, Copy)]
pub(super) struct Place<F> {
    /// From the beginning of the stretch. Metres.
    pub(super) at: F,
    /// To the surface. Metres.
    pub(super) distance: F,
    /// Of the distance, along the stretch.
    pub(super) slope: F,
    /// Of the distance; its direction is that of the way out.
    pub(super) gradient: V8<F>,
}

impl<F: Lanes> Place<F> {
    /// What was written in rows.
    #[inline(always)]
    pub(super) fn of(rows: &[Row], which: &[u32; LANES]) -> Self {
        let [at, distance, slope, x, y, z, ..] = F::gather(rows, which);
        Place { at, distance, slope, gradient: V8 { x, y, z } }
    }

    #[inline(always)]
    pub(super) fn write(&self, rows: &mut [Row; LANES]) {
        let (zero, g) = (F::zero(), self.gradient);
        let index = std::array::from_fn(|i| i as u32);
        F::scatter(cells(rows), &index, [self.at, self.distance, self.slope, g.x, g.y, g.z, zero, zero]);
    }

    /// The bits of those from which the distance falls into the stretch; `way` is 1 from its beginning and -1 from its end.
    #[inline(always)]
    pub(super) fn falls(&self, way: f32) -> u32 {
        (self.slope * F::splat(way)).lt(F::splat(-LEVEL)).bits()
    }

    /// Takes another place where a bit is set.
    #[inline(always)]
    pub(super) fn take(&mut self, other: &Self, bits: u32) {
        let taken = F::Mask::from_bits(bits);
        self.at = taken.select(other.at, self.at);
        self.distance = taken.select(other.distance, self.distance);
        self.slope = taken.select(other.slope, self.slope);
        self.gradient = taken.select_v(other.gradient, self.gradient);
    }

    /// Where the tangents of two places meet; halfway where they do not.
    #[inline(always)]
    pub(super) fn meets(&self, other: &Self) -> F {
        let turn = other.slope - self.slope;
        let rise = other.distance - self.distance - other.slope * (other.at - self.at);
        let half = F::splat(0.5) * (self.at + other.at);
        let at = turn.gt(F::splat(LEVEL)).select(self.at - rise / turn, half);
        at.max(self.at).min(other.at)
    }
}

/// Eight stretches of edges in the field's frame.
pub(super) struct Stretches<F> {
    from: V8<F>,
    /// Unit.
    pub(super) along: V8<F>,
    /// Metres.
    pub(super) length: F,
}

impl<F: Lanes> Stretches<F> {
    #[inline(always)]
    pub(super) fn new(direction: &Direction, ridges: &EightRidges<F>) -> Self {
        let from = transformed(ridges.from, &direction.axes, direction.origin);
        let way = transformed(ridges.to, &direction.axes, direction.origin) - from;
        let length = way.length();
        Stretches { from, along: way * (F::one() / length), length }
    }

    /// The points that are so far from the beginning. Metres.
    #[inline(always)]
    pub(super) fn at(&self, at: F) -> V8<F> {
        self.from + self.along * at
    }

    /// The bits of the places that are not ends.
    #[inline(always)]
    pub(super) fn are_between(&self, at: F) -> u32 {
        let (first, last) = (F::splat(END_PART) * self.length, F::splat(1.0 - END_PART) * self.length);
        (first.lt(at) & at.lt(last)).bits()
    }
}

/// What is known of where eight stretches touch.
pub(super) struct Course<F> {
    /// What is left of them on both sides of the lowest places.
    pub(super) ends: [Place<F>; 2],
    /// Where they are lowest, as far as is known.
    pub(super) lowest: Place<F>,
    /// The bits of those that are not to be followed further.
    pub(super) settled: u32,
}

impl<F: Lanes> Course<F> {
    /// Of the stretches whose bits are set; both ends of each of them follow each other in the rows.
    #[inline(always)]
    pub(super) fn new(rows: &[Row], bits: u32) -> Self {
        let last = 31 - bits.leading_zeros();
        let (mut first, mut second) = ([0; LANES], [0; LANES]);
        for i in 0..LANES as u32 {
            (first[i as usize], second[i as usize]) = (2 * i.min(last), 2 * i.min(last) + 1);
        }
        let ends = [Place::<F>::of(rows, &first), Place::of(rows, &second)];
        let mut lowest = ends[0];
        lowest.take(&ends[1], ends[0].falls(1.0));
        Course { ends, lowest, settled: !bits }
    }

    /// Where the edges come to lie on what they touch, as far as one end tells.
    #[inline(always)]
    pub(super) fn comes_to_lie(&self, end: usize) -> F {
        let (level, end) = (Place { slope: F::zero(), ..self.lowest }, self.ends[end]);
        let is_before = end.at.lt(level.at).bits();
        let (mut first, mut second) = (level, end);
        first.take(&end, is_before);
        second.take(&level, is_before);
        first.meets(&second)
    }

    /// Places a little behind those.
    #[inline(always)]
    pub(super) fn lies(&self, end: usize) -> F {
        let at = self.comes_to_lie(end);
        let run = self.lowest.at - at;
        let slope = self.ends[end].slope.abs().max(F::splat(LEVEL));
        let step = (self.inside() / slope).min(F::splat(0.5) * run.abs());
        at + run.lt(F::zero()).select(-step, step)
    }

    /// How far one must go from the rim of a side to be sure to see it.
    #[inline(always)]
    pub(super) fn inside(&self) -> F {
        F::splat(INSIDE) + F::splat(INSIDE_PER_DEPTH) * self.lowest.distance.abs()
    }
}
