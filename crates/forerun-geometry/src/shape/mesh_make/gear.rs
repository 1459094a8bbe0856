//! Gear: involute teeth round a disc with a bore.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::outline::Outline;
use super::surface::{at_angle, on_circle};
use super::{ShapeError, below, count};
use crate::shape::{TriangleList, positive};

/// Angle between the line of pressure of two gears and the tangent of their pitch circles: that of ISO 53.
const PRESSURE_DEGREES: f64 = 20.0;
/// Height of a tooth above the pitch circle, in modules (ISO 53).
const ADDENDUM: f64 = 1.0;
/// Depth of a gap below the pitch circle, in modules (ISO 53).
const DEDENDUM: f64 = 1.25;
/// By how much a tooth is thinner than a gap on the pitch circle, in modules: two gears of one module mesh with this play.
const BACKLASH: f64 = 0.08;
/// Steps along the flank of a tooth.
const FLANK_PARTS: u32 = 6;

/// A spur gear about the y axis with straight teeth of the common involute form (20 degrees); one tooth points to +x.
///
/// Gears of one module mesh when their axes are half the sum of their teeth times the module apart. Flanks below the base circle
/// are radial: gears with fewer than about 12 teeth lock with large ones, as there is no undercut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gear {
    /// How many. 6 to 200.
    pub teeth: u32,
    /// Diameter of the pitch circle for each tooth: a tooth is 2.25 of it high. Metres, above 0.
    pub module: f32,
    /// Half the width along the axis. Metres, above 0.
    pub half_width: f32,
    /// Radius of the hole about the axis. Metres, above 0 and below nine tenths of the circle at the feet of the teeth.
    pub bore: f32,
}

impl Gear {
    /// Whether it can be made.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        count("teeth", self.teeth, 6..=200)?;
        positive("module", self.module)?;
        positive("half_width", self.half_width)?;
        below("bore", self.bore, 0.9 * self.radius_at(-DEDENDUM) as f32, "nine tenths of the root circle")
    }

    /// Radius of the pitch circle: two gears mesh when their axes are the sum of theirs apart. Metres.
    #[must_use]
    pub fn pitch_radius(&self) -> f32 {
        self.radius_at(0.0) as f32
    }

    /// Its surface.
    ///
    /// # Errors
    /// As [`Gear::check`].
    pub fn triangles(&self) -> Result<TriangleList, ShapeError> {
        self.check()?;
        let mut web = self.web();
        let outline = Outline { border: self.border(), holes: vec![web.remove(0)], web };
        // The outline's plane is turned to lie: its x stays, its y becomes -z.
        Ok(outline.extrude(self.half_width.into(), |[x, y, depth]| [x, depth, -y]))
    }

    /// Circles from the feet of the teeth to the bore, with fewer and fewer points.
    fn web(&self) -> Vec<Vec<DVec2>> {
        let bore = f64::from(self.bore);
        let mut radius = self.radius_at(-DEDENDUM);
        let mut step = PI * radius / f64::from(self.teeth);
        let mut circles = Vec::new();
        while radius > bore {
            radius = if radius - 1.5 * step > bore { radius - step } else { bore };
            let points = ((TAU * radius / step).round() as u32).max(16);
            circles.push((0..points).map(|i| radius * on_circle(i, points)).collect());
            step *= 1.4;
        }
        circles
    }

    /// Radius so many modules above the pitch circle.
    fn radius_at(&self, height: f64) -> f64 {
        f64::from(self.module) * (0.5 * f64::from(self.teeth) + height)
    }

    /// Half the angle that a tooth fills at a radius.
    fn half_angle(&self, radius: f64) -> f64 {
        let teeth = f64::from(self.teeth);
        let pressure = PRESSURE_DEGREES.to_radians();
        let base = self.radius_at(0.0) * libm::cos(pressure);
        let here = libm::acos((base / radius).min(1.0));
        let at_pitch = (0.5 * PI - BACKLASH) / teeth;
        at_pitch + involute(pressure) - involute(here)
    }

    /// Counter-clockwise, tooth by tooth.
    pub(super) fn border(&self) -> Vec<DVec2> {
        let (root, tip) = (self.radius_at(-DEDENDUM), self.radius_at(ADDENDUM));
        // Teeth of small gears would end in a point and go on: they are cut off where they are still a little wide.
        let wide = |radius: f64| self.half_angle(radius) * radius > 0.1 * f64::from(self.module);
        let steps = (0..=20).map(|i| tip - (tip - self.radius_at(0.0)) * f64::from(i) / 20.0);
        let tip = steps.into_iter().find(|radius| wide(*radius)).unwrap_or(tip);
        let heights: Vec<f64> =
            (0..=FLANK_PARTS).map(|i| root + (tip - root) * f64::from(i) / f64::from(FLANK_PARTS)).collect();
        let pitch = TAU / f64::from(self.teeth);
        let mut border = Vec::new();
        for tooth in 0..self.teeth {
            let middle = pitch * f64::from(tooth);
            let mut point = |radius: f64, angle: f64| border.push(radius * at_angle(middle + angle));
            heights.iter().for_each(|radius| point(*radius, -self.half_angle(*radius)));
            point(tip, 0.0);
            heights.iter().rev().for_each(|radius| point(*radius, self.half_angle(*radius)));
            point(root, 0.5 * pitch);
        }
        border
    }
}

/// The involute function: tan a - a.
fn involute(angle: f64) -> f64 {
    libm::tan(angle) - angle
}
