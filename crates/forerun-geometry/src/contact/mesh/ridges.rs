//! Ridges: where long edges touch the other surface between the points that they have.
//!
//! Along an edge the distance to a surface falls towards where they touch and rises behind it. From both ends of a
//! stretch the slopes are followed to where they meet, a few times: for straight edges and flat sides the first time
//! is exact. An edge that lies on a flat side touches all along it: the places where it comes to lie on the side and
//! where it leaves it are found too, as they hold up bodies that lie across each other.
//!
//! Limit: of several places where one stretch touches the other shape one is found. Stretches are no longer than their
//! shape is thick, and the other shape has points and stretches of its own there.

use forerun_lanes::{LANES, Lanes, Portable, V8, dispatched};

use super::candidates::{Block, Candidates};
use super::directions::Direction;
use super::look_up::{Eight, Query};
use super::sharp::Answer;
use crate::Vec3;
use crate::sdf::eight::{lane, of_vectors, transformed};
use crate::sdf::primitive::{LookUp, Surface};
use crate::sdf::ridges::EightRidges;
use crate::sdf::samples::Spheres;

/// How often slopes are followed.
const STEPS: u32 = 3;
/// Slopes below this are level: the edge lies on the surface there.
const LEVEL: f32 = 1e-3;
/// Places are lower than others by this much at least. Metres.
const LOWER: f32 = 1e-4;
/// Sides are too far apart for an edge to be between them where the mean of their normals is shorter than this.
const CROSSING_MIN: f32 = 0.5;
/// Places this near to the surface are on it. Metres.
const ON_SURFACE: f32 = 1e-5;
/// Part of a stretch next to its ends, which are points already.
const END_PART: f32 = 1e-3;
/// How far behind the rim of a side the points are where an edge has come to lie on it, at least. Metres.
const INSIDE: f32 = 1e-3;
/// How much farther, for each metre that they are deep or high, so that the side is nearer to them than the one next to it.
const INSIDE_PER_DEPTH: f32 = 1.5;

/// Whether there are edges to follow. Half-spaces meet edges at their ends, and spheres see them from their middle.
pub(super) fn has_any(direction: &Direction) -> bool {
    !direction.ridges.blocks.is_empty()
        && !matches!(direction.surface, Surface::HalfSpace | Surface::Sphere(_))
}

/// Appends the points of long edges that are near the surface, or will be at the end of the step.
pub(super) fn find(direction: &Direction, candidates: &mut Candidates) {
    // What is farther and fast is seen by the points, which are no farther apart than the shape is thick, and is then cut into slices.
    let direction = &direction.close();
    for (eight, spheres) in direction.ridges.spheres.iter().enumerate() {
        let mut bits = 0;
        near(direction, spheres, &mut bits);
        while bits != 0 {
            let ridges = &direction.ridges.blocks[eight * LANES + bits.trailing_zeros() as usize];
            direction.follow(ridges, &mut candidates.blocks);
            bits &= bits - 1;
        }
    }
}

dispatched! {
    fn near(direction: &Direction, spheres: &Spheres, bits: &mut u32) => near_lanes
}

#[inline(always)]
fn near_lanes<F: Lanes>(direction: &Direction, spheres: &Spheres, bits: &mut u32) {
    *bits = direction.near::<F, _>(&direction.surface, spheres);
}

dispatched! {
    /// No point of the surface, but for its blur, is nearer than this to points of the field's frame. Metres.
    fn bound(direction: &Direction, points: &V8<Portable>, out: &mut [f32; LANES]) => bound_lanes
}

#[inline(always)]
fn bound_lanes<F: Lanes>(direction: &Direction, points: &V8<Portable>, out: &mut [f32; LANES]) {
    *out = direction.surface.lower_bound::<F>(points.form()).to_array();
}

dispatched! {
    /// What the surface says to points of the field's frame.
    fn ask(direction: &Direction, points: &V8<Portable>, asked: u32, told: &mut Told) => ask_lanes
}

#[inline(always)]
fn ask_lanes<F: Lanes>(direction: &Direction, points: &V8<Portable>, asked: u32, told: &mut Told) {
    let Answer { distance, gradient, .. } = direction.answer::<F>(points.form(), asked);
    *told = Told { distance: distance.to_array(), gradient: gradient.form() };
}

dispatched! {
    /// Appends points that are near; those of `crossing` stretches as their crossings say.
    fn append(direction: &Direction, points: &Points, blocks: &mut Vec<Block>) => append_lanes
}

#[inline(always)]
fn append_lanes<F: Lanes>(direction: &Direction, points: &Points, blocks: &mut Vec<Block>) {
    let eight = Eight::<F> {
        points: points.points.form(),
        outwards: transformed(points.ridges.normals.form(), &direction.axes, Vec3::ZERO),
        facing_max: F::from_array(points.ridges.facing_max.to_array()),
    };
    let query = Query {
        told: direction.surface.look_up_some(eight.points, points.meant),
        meant: points.meant,
        doubted: points.beside,
        crossings: points.crossings.as_ref(),
    };
    direction.find_eight(&direction.surface, &eight, &query, blocks);
}

/// What the surface says to eight points.
struct Told {
    /// Metres.
    distance: [f32; LANES],
    gradient: V8<Portable>,
}

/// Points to be looked up.
struct Points<'a> {
    ridges: &'a EightRidges,
    points: V8<Portable>,
    /// The bits of those that are asked for.
    meant: u32,
    /// The bits of those that have a rim next to them.
    beside: u32,
    crossings: Option<Crossings>,
}

/// Distances and normals of edges that cross.
pub(super) struct Crossings {
    /// The bits of the points that are crossings.
    pub(super) known: u32,
    pub(super) distance: [f32; LANES],
    pub(super) normal: [Vec3; LANES],
}

/// A place on a stretch.
#[derive(Clone, Copy, Default)]
struct Place {
    /// From the beginning of the stretch. Metres.
    at: f32,
    /// To the surface. Metres.
    distance: f32,
    /// Of the distance, along the stretch.
    slope: f32,
    /// Of the distance; its direction is that of the way out.
    gradient: Vec3,
}

impl Place {
    /// Whether the distance falls from here into the stretch; `way` is 1 from its beginning and -1 from its end.
    fn falls(&self, way: f32) -> bool {
        self.slope * way < -LEVEL
    }

    /// Where the tangents of two places meet; halfway where they do not.
    fn meets(&self, other: &Place) -> f32 {
        let turn = other.slope - self.slope;
        let rise = other.distance - self.distance - other.slope * (other.at - self.at);
        let at = if turn > LEVEL { self.at - rise / turn } else { 0.5 * (self.at + other.at) };
        at.max(self.at).min(other.at)
    }
}

/// A stretch of an edge in the field's frame.
#[derive(Clone, Copy, Default)]
struct Stretch {
    from: Vec3,
    /// Unit.
    along: Vec3,
    /// Metres.
    length: f32,
    /// What is left of it on both sides of the lowest place.
    ends: [Place; 2],
    /// Where it is lowest, as far as is known.
    lowest: Place,
    /// Whether following slopes leads no further.
    settled: bool,
}

impl Stretch {
    fn new(from: Vec3, to: Vec3) -> Stretch {
        let length = from.distance(to);
        let end = Place { at: length, ..Place::default() };
        let ends = [Place::default(), end];
        Stretch { from, along: (to - from) / length, length, ends, ..Stretch::default() }
    }

    /// Whether it may touch between its ends, and nearer than `reach`, as far as its first end tells.
    fn may_touch(&self, reach: f32) -> bool {
        !self.ends[0].falls(-1.0) && self.ends[0].distance - self.length < reach
    }

    /// The same once both ends are known.
    fn touches(&self, reach: f32) -> bool {
        let [a, b] = &self.ends;
        let between = !b.falls(1.0) && (a.falls(1.0) || b.falls(-1.0));
        between && 0.5 * (a.distance + b.distance - self.length) < reach
    }

    /// Whether a place is not one of the ends.
    fn is_between(&self, at: f32) -> bool {
        at > END_PART * self.length && at < (1.0 - END_PART) * self.length
    }

    /// Where the edge comes to lie on what it touches, as far as one end tells.
    fn comes_to_lie(&self, end: usize) -> f32 {
        let (end, level) = (&self.ends[end], Place { slope: 0.0, ..self.lowest });
        if end.at < level.at { end.meets(&level) } else { level.meets(end) }
    }

    /// A place a little behind that.
    fn lies(&self, end: usize) -> f32 {
        let at = self.comes_to_lie(end);
        let run = self.lowest.at - at;
        let slope = self.ends[end].slope.abs().max(LEVEL);
        at + run.signum() * (self.inside() / slope).min(0.5 * run.abs())
    }

    /// How far one must go from the rim of a side to be sure to see it.
    fn inside(&self) -> f32 {
        INSIDE + INSIDE_PER_DEPTH * self.lowest.distance.abs()
    }

    /// Normal and distance where the edge crosses another, given what is on both sides of it: the mean of the normals
    /// there that is at a right angle to the edge, and the distance along it.
    fn crossing(&self) -> Option<(Vec3, f32)> {
        let [a, b] = &self.ends;
        if !a.falls(1.0) || !b.falls(-1.0) {
            return None;
        }
        let sum = a.gradient * b.slope - b.gradient * a.slope;
        let (length, slopes) = (sum.length(), b.slope - a.slope);
        (length > CROSSING_MIN * slopes).then(|| (sum / length, self.lowest.distance * slopes / length))
    }
}

impl Direction<'_> {
    /// Appends where some of eight stretches touch.
    fn follow(&self, ridges: &EightRidges, blocks: &mut Vec<Block>) {
        let [from, to] = ridges.ends.map(|end| transformed::<Portable>(end, &self.axes, self.origin));
        let mut stretches: [Stretch; LANES] =
            std::array::from_fn(|i| Stretch::new(lane(&from, i), lane(&to, i)));
        let radii = Portable::from_array(stretches.map(|s| 0.5 * s.length));
        let reach = self.reach((from + to) * Portable::splat(0.5), radii).to_array();
        let reach = reach.map(|r| r + self.blur_depth);
        let (mut first, mut second) = ([0.0; LANES], [0.0; LANES]);
        bound(self, &from, &mut first);
        bound(self, &to, &mut second);
        let mut bits = keep(ridges.meant, |i| 0.5 * (first[i] + second[i] - stretches[i].length) < reach[i]);
        self.measure(&mut stretches, |s| s.ends[0].at, bits, |s, place| s.ends[0] = place);
        bits = keep(bits, |i| stretches[i].may_touch(reach[i]));
        self.measure(&mut stretches, |s| s.ends[1].at, bits, |s, place| s.ends[1] = place);
        bits = keep(bits, |i| stretches[i].touches(reach[i]));
        if bits == 0 {
            return;
        }
        self.descend(&mut stretches, bits);
        for end in [0, 1] {
            let at = stretches.map(|s| s.lies(end));
            let meant = keep(bits, |i| stretches[i].is_between(at[i]));
            let points = points(&stretches, at);
            append(self, &Points { ridges, points, meant, beside: meant, crossings: None }, blocks);
        }
        let meant = keep(bits, |i| stretches[i].is_between(stretches[i].lowest.at));
        let points = points(&stretches, stretches.map(|s| s.lowest.at));
        let crossings = Some(self.crossings(&mut stretches, meant));
        append(self, &Points { ridges, points, meant, beside: 0, crossings }, blocks);
    }

    /// Looks at both sides of the lowest places of some of eight stretches.
    fn crossings(&self, stretches: &mut [Stretch; LANES], bits: u32) -> Crossings {
        for (end, way) in [(0, -1.0), (1, 1.0)] {
            let beside = |s: &Stretch| s.lowest.at + way * s.inside();
            self.measure(stretches, beside, bits, |s, place| s.ends[end] = place);
        }
        let mut crossings = Crossings { known: 0, distance: [0.0; LANES], normal: [Vec3::ZERO; LANES] };
        for (i, s) in stretches.iter().enumerate().filter(|(i, _)| bits >> i & 1 == 1) {
            if let Some((normal, distance)) = s.crossing() {
                (crossings.normal[i], crossings.distance[i]) = (normal, distance);
                crossings.known |= 1 << i;
            }
        }
        crossings
    }

    /// Finds the lowest places of some of eight stretches, and the rims of what they lie on.
    fn descend(&self, stretches: &mut [Stretch; LANES], bits: u32) {
        for s in stretches.iter_mut() {
            s.lowest = if s.ends[0].falls(1.0) { s.ends[1] } else { s.ends[0] };
        }
        for _ in 0..STEPS {
            let tangents = |s: &Stretch| s.ends[0].meets(&s.ends[1]);
            let unsettled = keep(bits, |i| !stretches[i].settled);
            self.measure(stretches, tangents, unsettled, |s, place| {
                // Not for nothing: a level stretch is to be seen from its far end.
                let on_the_way = s.lowest.falls(1.0) || s.lowest.falls(-1.0);
                if on_the_way || place.distance < s.lowest.distance - LOWER {
                    s.lowest = place;
                }
                if place.falls(1.0) {
                    s.ends[0] = place;
                } else if place.falls(-1.0) {
                    s.ends[1] = place;
                } else {
                    s.settled = true;
                }
            });
        }
        for (end, way) in [(0, 1.0), (1, -1.0)] {
            self.measure(
                stretches,
                |s| s.comes_to_lie(end),
                bits,
                |s, place| {
                    if place.falls(way) {
                        s.ends[end] = place;
                    }
                },
            );
        }
    }

    /// Asks for the distance at a place of each of some of eight stretches.
    fn measure(
        &self,
        stretches: &mut [Stretch; LANES],
        place: impl Fn(&Stretch) -> f32,
        bits: u32,
        mut tell: impl FnMut(&mut Stretch, Place),
    ) {
        if bits == 0 {
            return;
        }
        let at = std::array::from_fn(|i| place(&stretches[i]));
        let mut told = Told { distance: [0.0; LANES], gradient: V8::zero() };
        ask(self, &points(stretches, at), bits, &mut told);
        for (i, s) in stretches.iter_mut().enumerate().filter(|(i, _)| bits >> i & 1 == 1) {
            let (distance, gradient) = (told.distance[i], lane(&told.gradient, i));
            // On an edge or corner of the surface itself there are many slopes.
            let slope = if distance.abs() < ON_SURFACE { 0.0 } else { gradient.dot(s.along) };
            tell(s, Place { at: at[i], distance, slope, gradient });
        }
    }
}

fn points(stretches: &[Stretch; LANES], at: [f32; LANES]) -> V8<Portable> {
    of_vectors(&std::array::from_fn(|i| stretches[i].from + stretches[i].along * at[i]))
}

/// Those of some bits that are to be kept.
fn keep(bits: u32, keeps: impl Fn(usize) -> bool) -> u32 {
    (0..LANES).filter(|i| bits >> i & 1 == 1 && keeps(*i)).fold(0, |kept, i| kept | 1 << i)
}
