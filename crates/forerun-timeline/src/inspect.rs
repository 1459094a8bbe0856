//! Inspect: what is inside a stored frame: its step, done once more and looked into, and its areas with their clocks.
//!
//! The step is memoryless, so that every stored frame can be looked into whenever somebody wants to, by whoever has a snapshot; the
//! timeline knows nothing of it.

use std::collections::BTreeMap;

use forerun_dynamics::{BodyId, Inspection, Member, bounds, inspect};
use forerun_geometry::Aabb;

use crate::activity::moving;
use crate::areas::Area;
use crate::{Frame, Snapshot};

/// What is inside the step that leaves a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameInspection {
    /// The frame.
    pub frame: Frame,
    /// Bodies, islands and contacts of the step from here to the next frame, before the commands of that.
    pub step: Inspection,
    /// The areas that are visited at the frame, or have something to compute. Sorted.
    pub areas: Vec<InspectedArea>,
}

/// An area: a cell of the grid that says who is near (dissertation, section 4.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InspectedArea {
    /// Its name: its lowest corner divided by its edge.
    pub area: Area,
    /// Where it is.
    pub bounds: Aabb,
    /// How many bodies may be in it at the frame. Those over a great many areas are not counted.
    pub visitors: u32,
    /// Whether one of them moved to where it is since the frame before (`Ativa(c)`).
    pub active: bool,
    /// Its clock `t(c)`: the first frame at which something in it waits to be computed; the horizon when nothing does before that.
    pub clock: Frame,
}

impl Snapshot {
    /// What is inside the step that leaves a frame; `None` where the frame is not stored. Costs a step of all bodies, and more: a display asks for it
    /// and goes on.
    #[must_use]
    pub fn inspect(&self, frame: Frame) -> Option<FrameInspection> {
        let table = self.tables.get(frame)?;
        let members = table.iter().filter_map(|(id, state)| {
            let body = self.definitions.body(id, frame)?;
            Some(Member { id, body, state: *state })
        });
        let members: Vec<Member> = members.collect();
        let step = inspect::inspect(&members, &self.definitions.environment(frame));
        Some(FrameInspection { frame, step, areas: self.areas(frame) })
    }

    /// The areas that are visited at a frame, or have something to compute, sorted; none where the frame is not stored. Costs a look at every body.
    #[must_use]
    pub fn areas(&self, frame: Frame) -> Vec<InspectedArea> {
        let Some(table) = self.tables.get(frame) else { return Vec::new() };
        let mut areas: BTreeMap<Area, InspectedArea> = BTreeMap::new();
        let new = |area: Area| InspectedArea {
            area,
            bounds: self.grid.bounds(area),
            visitors: 0,
            active: false,
            clock: self.horizon(),
        };
        let moving = moving(&self.tables, frame);
        for (body, _) in table.iter() {
            let moves = moving.binary_search(&body).is_ok();
            for area in self.covered(body, frame) {
                let inspected = areas.entry(area).or_insert_with(|| new(area));
                inspected.visitors += 1;
                inspected.active |= moves;
            }
        }
        for doubt in &self.doubtful {
            for area in self.covered(doubt.body, doubt.known_to) {
                let inspected = areas.entry(area).or_insert_with(|| new(area));
                inspected.clock = inspected.clock.min(doubt.known_to);
            }
        }
        areas.into_values().collect()
    }

    /// The areas that a body may visit at a frame.
    fn covered(&self, id: BodyId, frame: Frame) -> impl Iterator<Item = Area> + use<> {
        let there = self.definitions.body(id, frame).zip(self.state(id, frame));
        let environment = self.definitions.environment(frame);
        let bound = there.map(|(body, state)| bounds::swept_bound(body, state, &environment));
        let grid = self.grid;
        bound.into_iter().flat_map(move |bound| grid.covered(&bound))
    }
}
