//! Settings of the step, each with its unit and the value that was measured to be best.

use forerun_geometry::Vec3;

/// What a whole step is subject to, besides the bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    /// Acceleration of free fall. m/s². Default (0, -9.81, 0).
    pub gravity: Vec3,
    /// How the step is done.
    pub settings: StepSettings,
}

impl Default for Environment {
    fn default() -> Self {
        Environment { gravity: Vec3::new(0.0, -9.81, 0.0), settings: StepSettings::default() }
    }
}

/// How a frame is computed. The defaults are for bodies of about 0.1 to 10 m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSettings {
    /// Length of one frame. Seconds, above 0. Default 1/60.
    pub frame_seconds: f32,
    /// Equal parts in which the solver integrates a frame (or slice). 1 to 64, default 4.
    pub substeps: u32,
    /// Sweeps over all contacts in the first substep; later ones do one. Default 3.
    pub first_sweeps: u32,
    /// The same for islands whose weight the contact graph cannot place: heaps, arches, wedged bodies. Default 12.
    pub first_sweeps_hard: u32,
    /// Contacts are found this far ahead of touching, and further for fast bodies. Metres, default 0.02.
    pub contact_margin_m: f32,
    /// Overlap that is left alone. Metres, default 0.0005.
    pub overlap_allowed_m: f32,
    /// Part of the remaining overlap that one frame removes. 0 to 1, default 0.3.
    pub overlap_recovery: f32,
    /// Fastest removal of overlap. m/s, default 0.5.
    pub recovery_speed_max: f32,
    /// How much a body moves when overlap with the one above it is removed: 1 as its mass says, 0 not at all. Default 0.5.
    pub shock_yield: f32,
    /// A body quieter than this counts towards rest: speed, spin times radius, and change of pose. m/s, default 0.05.
    pub rest_speed: f32,
    /// How long a body must be quiet to come to rest, or a quarter of it where it overlaps by less than twice what is allowed; 0 switches
    /// rest off. Seconds, default 2.
    pub rest_seconds: f32,
    /// A body that overlaps deeper than this does not come to rest. Metres, default 0.01.
    pub rest_overlap_m: f32,
    /// Most slices that a frame of an island is cut into (a power of two). 1 switches the return in time off. Default 8.
    pub slices_max: u32,
}

impl Default for StepSettings {
    fn default() -> Self {
        StepSettings {
            frame_seconds: 1.0 / 60.0,
            substeps: 4,
            first_sweeps: 3,
            first_sweeps_hard: 12,
            contact_margin_m: 0.02,
            overlap_allowed_m: 0.0005,
            overlap_recovery: 0.3,
            recovery_speed_max: 0.5,
            shock_yield: 0.5,
            rest_speed: 0.05,
            rest_seconds: 2.0,
            rest_overlap_m: 0.01,
            slices_max: 8,
        }
    }
}

impl StepSettings {
    /// How many frames a body must be quiet to come to rest: a state with so many in [`BodyState::rest`](crate::BodyState::rest) is at rest, and one
    /// more says that its whole island is. 0 when rest is off.
    #[must_use]
    pub fn rest_frames(&self) -> u32 {
        if self.rest_seconds > 0.0 {
            (self.rest_seconds / self.frame_seconds + 0.5).max(1.0) as u32
        } else {
            0
        }
    }
}
