//! Ridges: where long edges touch the other surface between the points that they have.
//!
//! Along an edge the distance to a surface falls towards where they touch and rises behind it. From both ends of a
//! stretch the slopes are followed to where they meet, a few times: for straight edges and flat sides the first time
//! is exact. An edge that lies on a flat side touches all along it: the places where it comes to lie on the side and
//! where it leaves it are found too, as they hold up bodies that lie across each other.
//!
//! Limit: of several places where one stretch touches the other shape one is found. Stretches are no longer than their
//! shape is thick, and the other shape has points and stretches of its own there.

use forerun_lanes::{LANES, LaneMask, Lanes, Portable, Row, V8, dispatched};

use super::candidates::{Block, Candidates};
use super::course::{Course, Place, Stretches};
use super::directions::Direction;
use super::look_up::{Eight, Query};
use super::sharp::Answer;
use crate::Vec3;
use crate::sdf::eight::transformed;
use crate::sdf::primitive::{LookUp, Surface};

/// How often slopes are followed.
const STEPS: u32 = 3;
/// Places are lower than others by this much at least. Metres.
const LOWER: f32 = 1e-4;
/// Sides are too far apart for an edge to be between them where the mean of their normals is shorter than this.
const CROSSING_MIN: f32 = 0.5;
/// Places this near to the surface are on it. Metres.
const ON_SURFACE: f32 = 1e-5;

/// The memory of a search.
#[derive(Clone, Debug, Default)]
pub(super) struct Search {
    /// Stretches that are near, by number.
    near: Vec<u32>,
    /// Those of them that touch the surface between their ends.
    touching: Vec<u32>,
    /// Both ends of each of those, see [`Place::of`].
    ends: Vec<Row>,
}

/// Whether there are edges to follow. Half-spaces meet edges at their ends, and spheres see them from their middle.
pub(super) fn has_any(direction: &Direction) -> bool {
    !direction.ridges.is_empty() && !matches!(direction.surface, Surface::HalfSpace | Surface::Sphere(_))
}

/// Appends the points of long edges that are near the surface, or will be at the end of the step.
pub(super) fn find(direction: &Direction, candidates: &mut Candidates) {
    // What is farther and fast is seen by the points, which are no farther apart than the shape is thick, and is then cut into slices.
    let direction = &direction.close();
    let Candidates { blocks, search, .. } = candidates;
    list_near(direction, &mut search.near);
    list_touching(direction, search);
    let eights = search.touching.chunks(LANES).zip(search.ends.chunks(2 * LANES));
    for (which, ends) in eights {
        follow(direction, which, ends, blocks);
    }
}

dispatched! {
    /// Fills a list with the stretches that may hold points that count.
    fn list_near(direction: &Direction, near: &mut Vec<u32>) => list_near_lanes
}

#[inline(always)]
fn list_near_lanes<F: Lanes>(direction: &Direction, near: &mut Vec<u32>) {
    let (ridges, half) = (direction.ridges, F::splat(0.5));
    near.clear();
    for (eight, spheres) in ridges.spheres().iter().enumerate() {
        let mut blocks = direction.near::<F, _>(&direction.surface, spheres);
        while blocks != 0 {
            let first = (eight * LANES + blocks.trailing_zeros() as usize) * LANES;
            blocks &= blocks - 1;
            let (which, meant) = ridges.run(first);
            let stretches = Stretches::new(direction, &ridges.eight::<F>(&which));
            let (middle, radius) = (stretches.at(half * stretches.length), half * stretches.length);
            let reach = direction.reach(middle, radius) + F::splat(direction.blur_depth);
            let mut bits = (direction.surface.lower_bound(middle) - radius).lt(reach).bits() & meant;
            while bits != 0 {
                near.push(which[bits.trailing_zeros() as usize]);
                bits &= bits - 1;
            }
        }
    }
}

dispatched! {
    /// Of the stretches that are near lists those that touch between their ends.
    fn list_touching(direction: &Direction, search: &mut Search) => list_touching_lanes
}

#[inline(always)]
fn list_touching_lanes<F: Lanes>(direction: &Direction, search: &mut Search) {
    let Search { near, touching, ends } = search;
    touching.clear();
    ends.clear();
    for eight in near.chunks(LANES) {
        let (which, meant) = filled(eight);
        let stretches = Stretches::new(direction, &direction.ridges.eight::<F>(&which));
        let length = stretches.length;
        let radius = F::splat(0.5) * length;
        let reach = direction.reach(stretches.at(radius), radius) + F::splat(direction.blur_depth);
        let a = direction.measure(&stretches, F::zero(), meant);
        // The distance falls by a metre for each metre of the stretch at most.
        let mut bits = meant & !a.falls(-1.0) & (a.distance - length).lt(reach).bits();
        if bits == 0 {
            continue;
        }
        let b = direction.measure(&stretches, length, bits);
        bits &= !b.falls(1.0) & (a.falls(1.0) | b.falls(-1.0));
        bits &= (F::splat(0.5) * (a.distance + b.distance - length)).lt(reach).bits();
        let (mut rows_a, mut rows_b) = ([Row::default(); LANES], [Row::default(); LANES]);
        a.write(&mut rows_a);
        b.write(&mut rows_b);
        while bits != 0 {
            let i = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            touching.push(which[i]);
            ends.extend([rows_a[i], rows_b[i]]);
        }
    }
}

dispatched! {
    /// Appends where some stretches, eight at most, touch, given their ends.
    fn follow(direction: &Direction, which: &[u32], ends: &[Row], blocks: &mut Vec<Block>) => follow_lanes
}

#[inline(always)]
fn follow_lanes<F: Lanes>(direction: &Direction, which: &[u32], ends: &[Row], blocks: &mut Vec<Block>) {
    let (which, bits) = filled(which);
    let ridges = direction.ridges.eight::<F>(&which);
    let stretches = Stretches::new(direction, &ridges);
    let mut course = Course::new(ends, bits);
    direction.descend(&stretches, &mut course, bits);
    let outwards = transformed(ridges.normals, &direction.axes, Vec3::ZERO).form();
    let facing_max = Portable::from_array(ridges.facing_max.to_array());
    for end in 0..2 {
        let at = course.lies(end);
        let meant = bits & stretches.are_between(at);
        if meant != 0 {
            let points = stretches.at(at).form();
            let found = Points { points, outwards, facing_max, meant, beside: meant, crossings: None };
            append(direction, &found, blocks);
        }
    }
    let at = course.lowest.at;
    let meant = bits & stretches.are_between(at);
    if meant != 0 {
        let points = stretches.at(at).form();
        let crossings = Some(direction.crossings(&stretches, &course, meant));
        append(direction, &Points { points, outwards, facing_max, meant, beside: 0, crossings }, blocks);
    }
}

dispatched! {
    /// What the surface says to points of the field's frame.
    fn ask(direction: &Direction, points: &V8<Portable>, asked: u32, told: &mut Told) => ask_lanes
}

#[inline(always)]
fn ask_lanes<F: Lanes>(direction: &Direction, points: &V8<Portable>, asked: u32, told: &mut Told) {
    let Answer { distance, gradient, .. } = direction.answer::<F>(points.form(), asked);
    *told = Told { distance: Portable::from_array(distance.to_array()), gradient: gradient.form() };
}

dispatched! {
    /// Appends points that are near; those of crossings as these say.
    fn append(direction: &Direction, points: &Points, blocks: &mut Vec<Block>) => append_lanes
}

#[inline(always)]
fn append_lanes<F: Lanes>(direction: &Direction, points: &Points, blocks: &mut Vec<Block>) {
    let eight = Eight::<F> {
        points: points.points.form(),
        outwards: points.outwards.form(),
        facing_max: F::from_array(points.facing_max.to_array()),
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
    distance: Portable,
    gradient: V8<Portable>,
}

/// Points to be looked up.
struct Points {
    points: V8<Portable>,
    outwards: V8<Portable>,
    facing_max: Portable,
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
    pub(super) distance: Portable,
    pub(super) normal: V8<Portable>,
}

impl Direction<'_> {
    /// Finds the lowest places of some of eight stretches, and the rims of what they lie on.
    #[inline(always)]
    fn descend<F: Lanes>(&self, stretches: &Stretches<F>, course: &mut Course<F>, bits: u32) {
        for _ in 0..STEPS {
            let unsettled = bits & !course.settled;
            if unsettled == 0 {
                break;
            }
            let place = self.measure(stretches, course.ends[0].meets(&course.ends[1]), unsettled);
            // Not for nothing: a level stretch is to be seen from its far end.
            let on_the_way = course.lowest.falls(1.0) | course.lowest.falls(-1.0);
            let lower = place.distance.lt(course.lowest.distance - F::splat(LOWER)).bits();
            course.lowest.take(&place, unsettled & (on_the_way | lower));
            let (down, up) = (place.falls(1.0), place.falls(-1.0));
            course.ends[0].take(&place, unsettled & down);
            course.ends[1].take(&place, unsettled & up);
            course.settled |= !(down | up);
        }
        let place = self.measure(stretches, course.comes_to_lie(0), bits);
        course.ends[0].take(&place, bits & place.falls(1.0));
        let place = self.measure(stretches, course.comes_to_lie(1), bits);
        course.ends[1].take(&place, bits & place.falls(-1.0));
    }

    /// Looks at both sides of the lowest places of some of eight stretches. Where these cross an edge, given what is on
    /// both sides of it, the normal is the mean of the normals there that is at a right angle to the edge.
    #[inline(always)]
    fn crossings<F: Lanes>(&self, stretches: &Stretches<F>, course: &Course<F>, bits: u32) -> Crossings {
        let (lowest, inside) = (&course.lowest, course.inside());
        let a = self.measure(stretches, lowest.at - inside, bits);
        let b = self.measure(stretches, lowest.at + inside, bits);
        let sum = a.gradient * b.slope - b.gradient * a.slope;
        let (length, slopes) = (sum.length(), b.slope - a.slope);
        let known = bits & a.falls(1.0) & b.falls(-1.0) & (F::splat(CROSSING_MIN) * slopes).lt(length).bits();
        let distance = lowest.distance * slopes / length;
        Crossings {
            known,
            distance: Portable::from_array(distance.to_array()),
            normal: (sum * (F::one() / length)).form(),
        }
    }

    /// Asks for the distance at a place of each of some of eight stretches.
    #[inline(always)]
    fn measure<F: Lanes>(&self, stretches: &Stretches<F>, at: F, bits: u32) -> Place<F> {
        let mut told = Told { distance: Portable::zero(), gradient: V8::zero() };
        ask(self, &stretches.at(at).form(), bits, &mut told);
        let (distance, gradient) = (F::from_array(told.distance.to_array()), told.gradient.form::<F>());
        // On an edge or corner of the surface itself there are many slopes.
        let on_surface = distance.abs().lt(F::splat(ON_SURFACE));
        let slope = on_surface.select(F::zero(), gradient.dot(stretches.along));
        Place { at, distance, slope, gradient }
    }
}

/// Eight of up to eight numbers, the last of which fills them up, and the bits of those that are meant.
#[inline(always)]
fn filled(numbers: &[u32]) -> ([u32; LANES], u32) {
    let mut eight = [0; LANES];
    for i in 0..LANES {
        eight[i] = numbers[i.min(numbers.len() - 1)];
    }
    (eight, (1 << numbers.len()) - 1)
}
