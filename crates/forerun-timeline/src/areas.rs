//! Areas: the cells of a spatial grid, each with the bodies that visit it and when, so that who is near at a frame is a look-up
//! (dissertation, section 3.2 and the grid of chapter 4).
//!
//! Promise: [`Areas::near`] names every body whose bound at that frame, as last told by [`Areas::visit`], shares an area with the
//! asked bounds. It may name more: whoever asks compares bounds.

use std::collections::BTreeMap;
use std::sync::Arc;

use forerun_dynamics::BodyId;
use forerun_geometry::{Aabb, Vec3};

use crate::Frame;
use crate::shared_list::SharedList;

/// A cell of the grid: its lowest corner divided by the edge of an area.
pub type Area = [i32; 3];

/// A bound over more areas than this is kept in one list for all of space.
const AREAS_MAX: i64 = 64;

/// Areas beyond this are one: farther than 2^24 edges an f32 has no finer position anyway.
const AREA_LIMIT: f32 = 16_777_216.0;

/// Areas are kept in so many parts, which copies share until they are written to.
const PARTS: usize = 256;

/// Areas whose coordinates differ only in so many low bits are in one part: neighbours are, mostly.
const PART_BITS: u32 = 2;

/// Past visits are forgotten in so many parts at a time: a pass over all of them is not worth it for each frame.
const PARTS_FORGOTTEN: usize = 8;

/// The end of a visit that goes on until told otherwise.
const OPEN: Frame = Frame(u64::MAX);

/// A body may be in the area at frames from `enters` to before `leaves`.
#[derive(Clone, Copy, Debug)]
struct Visit {
    body: BodyId,
    enters: Frame,
    leaves: Frame,
}

/// The areas that a bound covers, corners included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cover {
    Areas {
        min: Area,
        max: Area,
    },
    /// Too many to list.
    Large,
}

/// Where a visit is told of: bodies stay where they are beyond the last frame, not beyond one before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Until {
    /// At this frame, and on from there until told otherwise: it is the last one.
    FurtherNotice,
    /// At this frame only.
    NextFrame,
}

/// Areas with their visitors, sorted by body.
type Visits = BTreeMap<Area, Vec<Visit>>;

/// The areas themselves, whoever visits them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid {
    /// Edge of an area. Metres, above 0.
    edge_m: f32,
}

impl Grid {
    /// Areas of an edge (metres); none where it is not above 0.
    pub(crate) fn new(edge_m: f32) -> Option<Grid> {
        (edge_m > 0.0 && edge_m.is_finite()).then_some(Grid { edge_m })
    }

    /// Edge of an area. Metres.
    pub(crate) fn edge_m(&self) -> f32 {
        self.edge_m
    }
}

/// All areas with a visitor. A copy shares what neither side has written since.
#[derive(Clone, Debug)]
pub(crate) struct Areas {
    grid: Grid,
    /// By [`part_of`] an area.
    parts: Vec<Arc<Visits>>,
    /// Bodies over more than [`AREAS_MAX`] areas, sorted by body.
    large: Vec<Visit>,
    /// By body: what it covers at the last frame.
    last: SharedList<Option<Cover>>,
    /// The part whose past is forgotten next.
    next_forgotten: usize,
}

impl Areas {
    /// No visitors. The edge of an area is in metres, above 0.
    pub(crate) fn new(edge_m: f32) -> Areas {
        let parts = (0..PARTS).map(|_| Arc::default()).collect();
        let grid = Grid { edge_m };
        Areas { grid, parts, large: Vec::new(), last: SharedList::default(), next_forgotten: 0 }
    }

    /// A body has this bound at a frame; `None` when it is not there.
    pub(crate) fn visit(&mut self, body: BodyId, frame: Frame, bound: Option<&Aabb>, until: Until) {
        let cover = bound.map(|bound| self.grid.cover(bound));
        if until == Until::NextFrame {
            if let Some(cover) = cover {
                self.for_each_list(cover, |list| extend(list, body, frame, frame.next()));
            }
            return;
        }
        let index = body.0 as usize;
        self.last.grow(index + 1, &None);
        if self.last.get(index) == Some(&cover) {
            return;
        }
        let last = self.last.get_mut(index);
        if let Some(old) = last.and_then(|last| std::mem::replace(last, cover)) {
            self.for_each_list(old, |list| close(list, body, frame));
        }
        if let Some(new) = cover {
            self.for_each_list(new, |list| extend(list, body, frame, OPEN));
        }
    }

    /// Adds to `found` the bodies that may have a bound near one of these at a frame, in no order and perhaps twice. `false` when a
    /// bound covers so much that everybody has to be asked.
    pub(crate) fn near(&self, frame: Frame, bounds: &[Aabb], found: &mut Vec<BodyId>) -> bool {
        let mut areas: Vec<Area> = Vec::with_capacity(4 * bounds.len());
        for bound in bounds {
            let Cover::Areas { min, max } = self.grid.cover(bound) else { return false };
            areas.extend(areas_between(min, max));
        }
        // Neighbours share areas, and an area has many visitors: each is asked once.
        areas.sort_unstable();
        areas.dedup();
        let here = |v: &&Visit| v.enters <= frame && frame < v.leaves;
        for list in areas.iter().filter_map(|area| self.parts[part_of(area)].get(area)) {
            found.extend(list.iter().filter(here).map(|v| v.body));
        }
        found.extend(self.large.iter().filter(here).map(|v| v.body));
        true
    }

    /// The areas themselves.
    pub(crate) fn grid(&self) -> Grid {
        self.grid
    }

    /// Forgets, bit by bit, the visits that ended by `oldest`.
    pub(crate) fn forget_before(&mut self, oldest: Frame) {
        for _ in 0..PARTS_FORGOTTEN {
            let part = &mut self.parts[self.next_forgotten];
            self.next_forgotten = (self.next_forgotten + 1) % PARTS;
            // A part that is written to is no longer shared: only where there is something to forget.
            if part.values().flatten().any(|visit| visit.leaves <= oldest) {
                Arc::make_mut(part).retain(|_, list| {
                    list.retain(|v| v.leaves > oldest);
                    !list.is_empty()
                });
            }
        }
        self.large.retain(|v| v.leaves > oldest);
    }

    fn for_each_list(&mut self, cover: Cover, mut act: impl FnMut(&mut Vec<Visit>)) {
        match cover {
            Cover::Large => act(&mut self.large),
            Cover::Areas { min, max } => {
                for area in areas_between(min, max) {
                    act(Arc::make_mut(&mut self.parts[part_of(&area)]).entry(area).or_default());
                }
            }
        }
    }
}

impl Grid {
    /// The areas that a bound covers; none when they are too many to list.
    pub(crate) fn covered(self, bound: &Aabb) -> impl Iterator<Item = Area> + use<> {
        let corners = match self.cover(bound) {
            Cover::Areas { min, max } => Some((min, max)),
            Cover::Large => None,
        };
        corners.into_iter().flat_map(|(min, max)| areas_between(min, max))
    }

    /// Where an area is.
    pub(crate) fn bounds(self, area: Area) -> Aabb {
        let corner = area.map(|coordinate| coordinate as f32 * self.edge_m);
        let min = Vec3::from_array(corner);
        Aabb { min, max: min + Vec3::splat(self.edge_m) }
    }

    fn cover(self, bound: &Aabb) -> Cover {
        // Rounding down and limiting keep the order, so bounds that overlap share an area.
        let cell = |v: Vec3| {
            let scaled = (v / self.edge_m).floor().clamp(Vec3::splat(-AREA_LIMIT), Vec3::splat(AREA_LIMIT));
            [scaled.x as i32, scaled.y as i32, scaled.z as i32]
        };
        let (min, max) = (cell(bound.min), cell(bound.max));
        let sizes = [0, 1, 2].map(|axis| i64::from(max[axis]) - i64::from(min[axis]) + 1);
        // Each size is at most 2^25 + 1: their product can pass the range of i64 but not when the first two are in bounds.
        if sizes[0] * sizes[1] > AREAS_MAX || sizes[0] * sizes[1] * sizes[2] > AREAS_MAX {
            Cover::Large
        } else {
            Cover::Areas { min, max }
        }
    }
}

/// Which part an area is in: neighbours together, distant ones spread evenly (multiplicative hashing, Knuth, TAOCP 3, 6.4).
fn part_of(area: &Area) -> usize {
    let spread = |coordinate: i32, factor: u32| ((coordinate >> PART_BITS) as u32).wrapping_mul(factor);
    let mixed = spread(area[0], 0x9e37_79b1) ^ spread(area[1], 0x85eb_ca77) ^ spread(area[2], 0xc2b2_ae3d);
    (mixed >> 24) as usize % PARTS
}

fn areas_between(min: Area, max: Area) -> impl Iterator<Item = Area> {
    (min[0]..=max[0])
        .flat_map(move |x| (min[1]..=max[1]).flat_map(move |y| (min[2]..=max[2]).map(move |z| [x, y, z])))
}

/// One visit per body and area: it covers all frames of the ones that were told. More than true, never less.
fn extend(list: &mut Vec<Visit>, body: BodyId, enters: Frame, leaves: Frame) {
    match list.binary_search_by_key(&body, |v| v.body) {
        Ok(index) => {
            let visit = &mut list[index];
            visit.enters = visit.enters.min(enters);
            visit.leaves = visit.leaves.max(leaves);
        }
        Err(index) => list.insert(index, Visit { body, enters, leaves }),
    }
}

fn close(list: &mut [Visit], body: BodyId, frame: Frame) {
    if let Ok(index) = list.binary_search_by_key(&body, |v| v.body) {
        list[index].leaves = frame;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(x: f32) -> Aabb {
        Aabb::from_centre(Vec3::new(x, 0.5, 0.5), Vec3::splat(0.25))
    }

    fn near(areas: &Areas, frame: u64, x: f32) -> Vec<u32> {
        let mut found = Vec::new();
        assert!(areas.near(Frame(frame), &[ball(x)], &mut found));
        let mut ids: Vec<u32> = found.into_iter().map(|b| b.0).collect();
        ids.sort_unstable();
        ids.dedup();
        ids
    }

    #[test]
    fn a_visitor_is_found_where_and_when_it_is_there() {
        let mut areas = Areas::new(1.0);
        areas.visit(BodyId(7), Frame(0), Some(&ball(0.5)), Until::FurtherNotice);
        areas.visit(BodyId(7), Frame(10), Some(&ball(3.5)), Until::FurtherNotice);
        assert_eq!(near(&areas, 0, 0.4), [7]);
        assert_eq!(near(&areas, 9, 0.4), [7]);
        assert_eq!(near(&areas, 10, 0.4), [0; 0]);
        assert_eq!(near(&areas, 1000, 3.4), [7]);
        // Told again of a frame before the last one: it is there, and still everywhere that it was.
        areas.visit(BodyId(7), Frame(4), Some(&ball(-5.5)), Until::NextFrame);
        assert_eq!(near(&areas, 4, -5.5), [7]);
        assert_eq!(near(&areas, 5, -5.5), [0; 0]);
        assert_eq!(near(&areas, 1000, 3.4), [7]);
    }

    #[test]
    fn large_bounds_are_found_from_everywhere_and_ask_everybody() {
        let mut areas = Areas::new(1.0);
        let ground =
            Aabb { min: Vec3::splat(f32::NEG_INFINITY), max: Vec3::new(f32::INFINITY, 0.0, f32::INFINITY) };
        areas.visit(BodyId(0), Frame(0), Some(&ground), Until::FurtherNotice);
        assert_eq!(near(&areas, 3, 1e30), [0]);
        assert!(!areas.near(Frame(3), &[ball(0.0), ground], &mut Vec::new()));
        areas.visit(BodyId(0), Frame(5), None, Until::FurtherNotice);
        assert_eq!(near(&areas, 5, 1e30), [0; 0]);
    }

    #[test]
    fn the_past_is_forgotten() {
        let mut areas = Areas::new(1.0);
        areas.visit(BodyId(1), Frame(0), Some(&ball(0.5)), Until::FurtherNotice);
        areas.visit(BodyId(1), Frame(1), Some(&ball(9.5)), Until::FurtherNotice);
        for _ in 0..PARTS / PARTS_FORGOTTEN {
            areas.forget_before(Frame(1000));
        }
        assert_eq!(areas.parts.iter().map(|part| part.len()).sum::<usize>(), 1);
        assert_eq!(near(&areas, 1000, 9.5), [1]);
    }
}
