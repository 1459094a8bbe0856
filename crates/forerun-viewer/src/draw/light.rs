//! Light: sun and sky, by day and at dusk.

use forerun::Vec3;
use three_d::Program;

use super::convert::vector;
use super::eye::Eye;
use super::shadow::Shadows;
use crate::view::Theme;

/// Direction from the bodies to the sun: such that the three sides of a box that one sees are not equally light.
pub(super) const TO_SUN: Vec3 = Vec3::new(0.28, 0.77, 0.57);

/// Colours of light and of what is always there, as parts of full light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Light {
    pub(super) sun: Vec3,
    pub(super) from_sky: Vec3,
    pub(super) from_ground: Vec3,
    pub(super) haze: Vec3,
    pub(super) zenith: Vec3,
    pub(super) nadir: Vec3,
    pub(super) earth: Vec3,
    pub(super) lines: Vec3,
    /// Around what is selected, as screens show it.
    pub(super) outline: Vec3,
}

const DAY: Light = Light {
    sun: Vec3::new(0.80, 0.76, 0.69),
    from_sky: Vec3::new(0.33, 0.37, 0.43),
    from_ground: Vec3::new(0.17, 0.16, 0.15),
    haze: Vec3::new(0.70, 0.77, 0.84),
    zenith: Vec3::new(0.22, 0.40, 0.66),
    nadir: Vec3::new(0.45, 0.48, 0.52),
    earth: Vec3::new(0.55, 0.55, 0.54),
    lines: Vec3::new(0.27, 0.29, 0.32),
    outline: Vec3::new(0.98, 0.45, 0.05),
};

const DUSK: Light = Light {
    sun: Vec3::new(0.86, 0.80, 0.72),
    from_sky: Vec3::new(0.26, 0.29, 0.35),
    from_ground: Vec3::new(0.10, 0.10, 0.11),
    haze: Vec3::new(0.055, 0.065, 0.085),
    zenith: Vec3::new(0.012, 0.016, 0.026),
    nadir: Vec3::new(0.015, 0.017, 0.021),
    earth: Vec3::new(0.060, 0.064, 0.072),
    lines: Vec3::new(0.150, 0.160, 0.180),
    outline: Vec3::new(1.0, 0.62, 0.15),
};

impl Light {
    /// That of a theme.
    pub(super) fn of(theme: Theme) -> &'static Light {
        match theme {
            Theme::Dark => &DUSK,
            Theme::Light => &DAY,
        }
    }

    /// Tells a program that draws what is lit.
    pub(super) fn tell(&self, program: &Program, eye: &Eye, shadows: &Shadows, haze_distance: f32) {
        let tell = |name: &str, value: Vec3| program.use_uniform_if_required(name, vector(value));
        tell("eye", eye.position);
        tell("toSun", TO_SUN.normalize());
        tell("sun", self.sun);
        tell("fromSky", self.from_sky);
        tell("fromGround", self.from_ground);
        tell("hazeColour", self.haze);
        program.use_uniform_if_required("hazeDistance", haze_distance);
        shadows.tell(program);
    }
}
