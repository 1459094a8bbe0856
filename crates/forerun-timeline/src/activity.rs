//! Activity: which areas are active, and their clocks, for statistics (dissertation, section 4.1: `Ativa(c)` and `t(c)`).

use std::collections::BTreeMap;

use forerun_dynamics::{BodyId, bounds};
use forerun_geometry::{Aabb, Vec3};

use crate::areas::Area;
use crate::snapshot::Doubt;
use crate::tables::Tables;
use crate::{Frame, Timeline};

impl Timeline {
    /// The areas with something to compute before the horizon, each with its clock: the first frame at which that is so. Sorted.
    /// Bodies over a great many areas are left out.
    #[must_use]
    pub fn area_clocks(&self) -> Vec<(Area, Frame)> {
        let grid = self.areas.grid();
        let mut clocks: BTreeMap<Area, Frame> = BTreeMap::new();
        for Doubt { body, known_to: frame, .. } in self.doubtful() {
            for area in self.bound(body, frame).into_iter().flat_map(|bound| grid.covered(&bound)) {
                let clock = clocks.entry(area).or_insert(frame);
                *clock = frame.min(*clock);
            }
        }
        clocks.into_iter().collect()
    }

    /// How many areas are active at a stored frame: a body that moved to where it is since the frame before is in them. 0 when the
    /// frame is not stored. Bodies over a great many areas are left out. Costs in proportion to the bodies that moved.
    #[must_use]
    pub fn areas_active(&self, frame: Frame) -> u32 {
        if frame < self.oldest() || frame > self.horizon() {
            return 0;
        }
        let grid = self.areas.grid();
        let bounds = moving(&self.tables, frame).into_iter().filter_map(|body| self.bound(body, frame));
        let mut areas: Vec<Area> = bounds.flat_map(|bound| grid.covered(&bound)).collect();
        areas.sort_unstable();
        areas.dedup();
        areas.len() as u32
    }

    fn bound(&self, id: BodyId, frame: Frame) -> Option<Aabb> {
        let (body, state) = self.body_at(id, frame).zip(self.state(id, frame))?;
        Some(bounds::swept_bound(body, state, &self.environment_at(frame)))
    }
}

/// The bodies whose state at a stored frame is not that of the frame before; at the oldest frame, that have a velocity. Sorted.
pub(crate) fn moving(tables: &Tables, frame: Frame) -> Vec<BodyId> {
    let table = tables.at(frame);
    if frame > tables.oldest() {
        return table.differences(tables.at(frame.minus(1)));
    }
    let moves = |v: Vec3| v != Vec3::ZERO;
    let moving = table.iter().filter(|(_, s)| moves(s.velocity) || moves(s.angular_velocity));
    moving.map(|(body, _)| body).collect()
}
