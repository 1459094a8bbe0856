//! Bowl: a turned shell that opens upwards and stands on a flat foot.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use super::revolution::{close_ends, lathe};
use super::surface::{Surface, arc, line_to};
use super::{FINEST, ShapeError, below, count};
use crate::shape::{TriangleList, positive};

/// A bowl about the y axis: its foot stands on y = 0 and it opens upwards. The wall is a quarter of an ellipse from the edge of the foot to the
/// rim; the rim is round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bowl {
    /// From the axis to the outside of the rim. Metres, above 0.
    pub radius: f32,
    /// Radius of the flat foot. Metres, above 0 and below `radius` by more than `thickness`.
    pub foot_radius: f32,
    /// From the foot to where the rounding of the rim begins. Metres, above `thickness`; the bowl is half a thickness higher.
    pub height: f32,
    /// Of wall and bottom. Metres, above 0.
    pub thickness: f32,
    /// Points round the rim. 8 to 1024; even better a multiple of 16, as smaller rings have half, a quarter... of them.
    pub segments: u32,
}

impl Bowl {
    /// Whether it can be made.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        positive("radius", self.radius)?;
        positive("height", self.height)?;
        below("thickness", self.thickness, self.height.min(self.radius), "height and radius")?;
        below("foot_radius", self.foot_radius, self.radius - self.thickness, "radius less thickness")?;
        count("segments", self.segments, 8..=FINEST)
    }

    /// Its surface.
    ///
    /// # Errors
    /// As [`Bowl::check`].
    pub fn triangles(&self) -> Result<TriangleList, ShapeError> {
        self.check()?;
        let profile = self.profile();
        let mut surface = Surface::default();
        let rings = lathe(&mut surface, &profile, self.segments);
        for pair in rings.windows(2) {
            surface.band(&pair[0], &pair[1]);
        }
        close_ends(&mut surface, &profile, &rings);
        Ok(surface.finish())
    }

    /// From the middle of the foot outside up to the rim and inside down to the middle.
    fn profile(&self) -> Vec<DVec2> {
        let [radius, foot, height, thickness] =
            [self.radius, self.foot_radius, self.height, self.thickness].map(f64::from);
        let step = TAU * radius / f64::from(self.segments);
        let outer = DVec2::new(radius - foot, height);
        let inner = outer - DVec2::splat(thickness);
        // About as long as an ellipse's quarter: a circle's with the mean of the half axes.
        let parts = |axes: DVec2| ((0.5 * FRAC_PI_2 * (axes.x + axes.y) / step).round() as u32).max(3);
        let top = DVec2::new(foot, height);
        let mut profile = vec![DVec2::ZERO];
        line_to(&mut profile, DVec2::new(foot, 0.0), step);
        arc(&mut profile, top, outer, (-FRAC_PI_2, 0.0, parts(outer)));
        let rim = DVec2::new(radius - 0.5 * thickness, height);
        let rim_parts = ((FRAC_PI_2 * thickness / step).round() as u32).max(4);
        arc(&mut profile, rim, DVec2::splat(0.5 * thickness), (0.0, PI, rim_parts));
        arc(&mut profile, top, inner, (0.0, -FRAC_PI_2, parts(inner)));
        line_to(&mut profile, DVec2::new(0.0, thickness), step);
        profile
    }
}
