//! Activity: which areas are active, and their clocks, for statistics (dissertation, section 4.1: `Ativa(c)` and `t(c)`).

use std::collections::BTreeMap;

use forerun_dynamics::{BodyId, bounds};

use crate::areas::Area;
use crate::{Frame, Timeline};

impl Timeline {
    /// The areas with something to compute before the horizon, each with its clock: the first frame at which that is so. Sorted.
    /// Bodies over a great many areas are left out.
    #[must_use]
    pub fn area_clocks(&self) -> Vec<(Area, Frame)> {
        let mut clocks: BTreeMap<Area, Frame> = BTreeMap::new();
        for (body, frame) in self.doubtful() {
            for area in self.areas_of(body, frame) {
                let clock = clocks.entry(area).or_insert(frame);
                *clock = frame.min(*clock);
            }
        }
        clocks.into_iter().collect()
    }

    /// How many areas are active at a stored frame: a body that moves is in them. 0 when the frame is not stored.
    #[must_use]
    pub fn areas_active(&self, frame: Frame) -> u32 {
        if frame < self.oldest() || frame > self.horizon() {
            return 0;
        }
        let table = self.table(frame);
        let moving: Vec<BodyId> = if frame == self.oldest() {
            let moves = |v: forerun_geometry::Vec3| v != forerun_geometry::Vec3::ZERO;
            let bodies = table.iter().filter(|(_, s)| moves(s.velocity) || moves(s.angular_velocity));
            bodies.map(|(body, _)| body).collect()
        } else {
            table.differences(self.table(frame.minus(1)))
        };
        let mut areas: Vec<Area> = moving.iter().flat_map(|body| self.areas_of(*body, frame)).collect();
        areas.sort_unstable();
        areas.dedup();
        areas.len() as u32
    }

    fn areas_of(&self, id: BodyId, frame: Frame) -> impl Iterator<Item = Area> {
        let environment = self.environment_at(frame);
        let bound = self.body_at(id, frame).zip(self.state(id, frame));
        let bound = bound.map(|(body, state)| bounds::swept_bound(body, state, &environment));
        bound.into_iter().flat_map(|bound| self.areas.covered(&bound))
    }
}
