//! Ridges: where long edges touch the other surface between the points that they have.
//!
//! Along an edge the distance to a surface falls towards where they touch and rises behind it. From both ends of a
//! stretch the slopes are followed to where they meet, a few times: for straight edges and flat sides the first time
//! is exact. An edge that lies on a flat side touches all along it: the places where it comes to lie on the side and
//! where it leaves it are found too, as they hold up bodies that lie across each other.
//!
//! Limit: of several places where one stretch touches the other shape one is found. Stretches are no longer than their
//! shape is thick, and the other shape has points and stretches of its own there.

use super::Candidate;
use super::directions::Direction;
use super::look_up::{Answers, Eight};
use super::sharp::Answer;
use crate::Vec3;
use crate::sdf::lanes::{Lanes, Lanes3, WIDTH};
use crate::sdf::primitive::Surface;
use crate::sdf::ridges::EightRidges;

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

/// Appends the points of long edges that are near the surface, or will be at the end of the step.
pub(super) fn find(direction: &Direction, index: usize, candidates: &mut Vec<Candidate>) {
    // These meet edges at their ends, or see them from their middle.
    if matches!(direction.surface, Surface::HalfSpace | Surface::Sphere(_)) {
        return;
    }
    direction.ridges.visit(
        |spheres| {
            direction.near(spheres.centre.transformed(&direction.axes, direction.origin), spheres.radius)
        },
        |ridges| direction.find_between(ridges, index, candidates),
    );
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
}

impl Stretch {
    fn new(from: Vec3, to: Vec3) -> Stretch {
        let length = from.distance(to);
        let end = Place { at: length, ..Place::default() };
        let ends = [Place::default(), end];
        Stretch { from, along: (to - from) / length, length, ends, lowest: Place::default() }
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
    fn find_between(&self, ridges: &EightRidges, index: usize, candidates: &mut Vec<Candidate>) {
        let from = ridges.from.transformed(&self.axes, self.origin);
        let to = ridges.to.transformed(&self.axes, self.origin);
        let mut stretches: [Stretch; WIDTH] = std::array::from_fn(|i| Stretch::new(from.lane(i), to.lane(i)));
        let middle = from.plus(to).scaled(Lanes::splat(0.5));
        let reach =
            self.reach(middle, Lanes(stretches.map(|s| 0.5 * s.length))) + Lanes::splat(self.blur_depth);
        self.measure(&mut stretches, |s| s.ends[0].at, ridges.meant, |s, place| s.ends[0] = place);
        let mut bits = keep(ridges.meant, |i| stretches[i].may_touch(reach.0[i]));
        self.measure(&mut stretches, |s| s.ends[1].at, bits, |s, place| s.ends[1] = place);
        bits = keep(bits, |i| stretches[i].touches(reach.0[i]));
        if bits == 0 {
            return;
        }
        self.descend(&mut stretches, bits);
        let eight = |points| Eight {
            points,
            outwards: ridges.normals.transformed(&self.axes, Vec3::ZERO),
            facing_max: ridges.facing_max,
        };
        for end in [0, 1] {
            let at = stretches.map(|s| s.lies(end));
            let meant = keep(bits, |i| stretches[i].is_between(at[i]));
            // The rim is next to them.
            self.find_eight(&eight(points(&stretches, at)), [meant, meant], index, candidates);
        }
        let meant = keep(bits, |i| stretches[i].is_between(stretches[i].lowest.at));
        let eight = eight(points(&stretches, stretches.map(|s| s.lowest.at)));
        let mut answers = self.meet(&eight, 0.0, meant);
        answers.found &= self.cross(&mut stretches, &mut answers);
        self.push(&eight, &answers, index, candidates);
        self.find_eight(&eight, [meant & !answers.found, 0], index, candidates);
    }

    /// Puts the normals and distances of edges that cross in the place of what the surface says; the bits of those.
    fn cross(&self, stretches: &mut [Stretch; WIDTH], answers: &mut Answers) -> u32 {
        for (end, way) in [(0, -1.0), (1, 1.0)] {
            let beside = |s: &Stretch| s.lowest.at + way * s.inside();
            self.measure(stretches, beside, answers.found, |s, place| s.ends[end] = place);
        }
        let mut crossing = 0;
        for (i, s) in stretches.iter().enumerate().filter(|(i, _)| answers.found >> i & 1 == 1) {
            if let Some((normal, distance)) = s.crossing() {
                answers.normal.set_lane(i, normal);
                answers.distance.0[i] = distance;
                crossing |= 1 << i;
            }
        }
        crossing
    }

    /// Finds the lowest places of some of eight stretches, and the rims of what they lie on.
    fn descend(&self, stretches: &mut [Stretch; WIDTH], bits: u32) {
        for s in stretches.iter_mut() {
            s.lowest = if s.ends[0].falls(1.0) { s.ends[1] } else { s.ends[0] };
        }
        for _ in 0..STEPS {
            let tangents = |s: &Stretch| s.ends[0].meets(&s.ends[1]);
            self.measure(stretches, tangents, bits, |s, place| {
                // Not for nothing: a level stretch is to be seen from its far end.
                if s.lowest.falls(1.0) || s.lowest.falls(-1.0) || place.distance < s.lowest.distance - LOWER {
                    s.lowest = place;
                }
                if place.falls(1.0) {
                    s.ends[0] = place;
                } else if place.falls(-1.0) {
                    s.ends[1] = place;
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
        stretches: &mut [Stretch; WIDTH],
        place: impl Fn(&Stretch) -> f32,
        bits: u32,
        mut tell: impl FnMut(&mut Stretch, Place),
    ) {
        if bits == 0 {
            return;
        }
        let at = std::array::from_fn(|i| place(&stretches[i]));
        let Answer { distance, gradient, .. } = self.answer(points(stretches, at), bits);
        for (i, s) in stretches.iter_mut().enumerate().filter(|(i, _)| bits >> i & 1 == 1) {
            // On an edge or corner of the surface itself there are many slopes.
            let on_surface = distance.0[i].abs() < ON_SURFACE;
            let slope = if on_surface { 0.0 } else { gradient.lane(i).dot(s.along) };
            tell(s, Place { at: at[i], distance: distance.0[i], slope, gradient: gradient.lane(i) });
        }
    }
}

fn points(stretches: &[Stretch; WIDTH], at: [f32; WIDTH]) -> Lanes3 {
    let mut points = Lanes3::ZERO;
    for (i, s) in stretches.iter().enumerate() {
        points.set_lane(i, s.from + s.along * at[i]);
    }
    points
}

/// Those of some bits that are to be kept.
fn keep(bits: u32, keeps: impl Fn(usize) -> bool) -> u32 {
    (0..WIDTH).filter(|i| bits >> i & 1 == 1 && keeps(*i)).fold(0, |kept, i| kept | 1 << i)
}
