//! Jack: the toy with six knobs, all of one smooth piece.

use glam::DVec3;

use super::surface_net::{Grid, surface_net};
use super::{ShapeError, below, count};
use crate::shape::{TriangleList, positive};

/// Six arms along the axes, each with a knob at its end; where parts meet the surface is smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jack {
    /// From the middle to the end of an arm. Metres, above 4 `knob_radius`.
    pub reach: f32,
    /// Radius of an arm. Metres, above 0 and at most `knob_radius`.
    pub arm_radius: f32,
    /// Radius of a knob. Metres, above 0.
    pub knob_radius: f32,
    /// Cells of the grid along the whole jack: the finer, the more triangles. 16 to 256, and enough for an arm to be 3 cells thick.
    pub cells: u32,
}

impl Jack {
    /// Whether it can be made.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        positive("reach", self.reach)?;
        below("knob_radius", self.knob_radius, 0.25 * self.reach, "a quarter of reach")?;
        let arm = self.arm_radius;
        if !(arm > 0.0 && arm <= self.knob_radius) {
            let message = format!("must be above 0 and at most knob_radius ({}), is {arm}", self.knob_radius);
            return Err(ShapeError::new("arm_radius", message));
        }
        count("cells", self.cells, 16..=256)?;
        if 2.0 * arm * self.cells as f32 >= 3.0 * 2.0 * self.reach {
            return Ok(());
        }
        let least = (3.0 * self.reach / arm).ceil();
        Err(ShapeError::new(
            "cells",
            format!("must be {least} or more for this arm_radius, is {}", self.cells),
        ))
    }

    /// Its surface.
    ///
    /// # Errors
    /// As [`Jack::check`].
    pub fn triangles(&self) -> Result<TriangleList, ShapeError> {
        self.check()?;
        // Two cells more than it needs, so that the surface does not touch the sides of the grid; and no node at the tip of a knob, where
        // the four cells around it would all have their vertex.
        let cell = 2.0 * f64::from(self.reach) / (f64::from(self.cells) - 0.6);
        let half = 0.5 * cell * f64::from(self.cells + 2);
        let grid = Grid { origin: DVec3::splat(-half), cell, cells: self.cells + 2 };
        Ok(surface_net(&grid, |p| self.distance(p)))
    }

    /// Below 0 inside; near the surface about the distance to it. Metres.
    pub(super) fn distance(&self, p: DVec3) -> f64 {
        let [reach, arm, knob] = [self.reach, self.arm_radius, self.knob_radius].map(f64::from);
        let p = p.abs();
        let axes = [[p.x, p.y, p.z], [p.y, p.z, p.x], [p.z, p.x, p.y]];
        let mut arms = axes.map(|[along, u, v]| {
            let (past_knob, across) = (along - (reach - knob), u * u + v * v);
            let to_knob = (past_knob * past_knob + across).sqrt() - knob;
            let to_arm = (past_knob.max(0.0) * past_knob.max(0.0) + across).sqrt() - arm;
            smooth_min(to_arm, to_knob, 0.5 * arm)
        });
        // By size, so that no axis is preferred.
        arms.sort_by(f64::total_cmp);
        smooth_min(smooth_min(arms[0], arms[1], arm), arms[2], arm)
    }
}

/// The smaller of two, rounded off where they differ by less than `blend` (quadratic polynomial).
fn smooth_min(a: f64, b: f64, blend: f64) -> f64 {
    let near = (blend - (a - b).abs()).max(0.0);
    a.min(b) - near * near / (4.0 * blend)
}
