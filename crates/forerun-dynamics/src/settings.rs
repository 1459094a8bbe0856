//! Settings of the step, each with its unit and the value that was measured to be best.

use std::fmt;

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

/// What shock propagation does, level by level from the ground up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShockPropagation {
    /// Pushes out what overlap remains; the lower body yields less than its mass says.
    #[default]
    Positions,
    /// Besides, the classic form (Guendelman et al. 2003, section 8; dissertation 2.4.7): a pass over the velocities, once a substep, in which lower
    /// bodies have infinite mass. For comparison only: crooked towers and
    /// exact pyramids stand with it, but a dropped stack of 20 wanders by two metres, and a pyramid of 30 rows with 8 mm of jitter explodes (27 m/s, energy
    /// up by a tenth; measured).
    Classic,
}

/// How a frame is computed. The defaults are for bodies of about 0.1 to 10 m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSettings {
    /// Length of one frame. Seconds, 0.00001 to 1. Default 1/60.
    pub frame_seconds: f32,
    /// Equal parts in which the solver integrates a frame (or slice). 1 to 64, default 4.
    pub substeps: u32,
    /// Sweeps over all contacts in the first substep; later ones do one. 1 to 64, default 3.
    pub first_sweeps: u32,
    /// Sweeps, each down and up, that find what the contacts of an island carry, as if it stood still, where the contact graph cannot place its weight:
    /// heaps, fallen dominoes, wedged bodies. Small high ones (arches, card houses) get 32, fast ones 6. 1 to 64, default 8.
    pub first_sweeps_hard: u32,
    /// Contacts are found this far ahead of touching, and further for fast bodies. Metres, default 0.02.
    pub contact_margin_m: f32,
    /// Overlap that is left alone. Metres, default 0.0005.
    pub overlap_allowed_m: f32,
    /// Part of the remaining overlap that one frame, or slice of one, removes. 0 to 1, default 0.3.
    pub overlap_recovery: f32,
    /// Fastest removal of overlap. m/s, default 0.5.
    pub recovery_speed_max: f32,
    /// What shock propagation does. Default positions.
    pub shock_propagation: ShockPropagation,
    /// How much a body moves when overlap with the one above it is removed: 1 as its mass says, 0 not at all. Default 0.5.
    pub shock_yield: f32,
    /// A body quieter than this counts towards rest: speed, spin times radius, and change of pose. One that goes steadily on its way, faster than a
    /// tenth of it (balls and capsules: than 0.4 of it), does not count. m/s, default 0.05.
    pub rest_speed: f32,
    /// How long a body must be quiet to come to rest, or a quarter of it where it overlaps by less than twice what is allowed; 0 switches
    /// rest off. Seconds, default 2.
    pub rest_seconds: f32,
    /// A body that overlaps deeper than this does not come to rest. Metres, default 0.01.
    pub rest_overlap_m: f32,
    /// A frame of an island that makes an overlap deeper by more than this part of the thinner body's half thickness is thrown away and done again in
    /// twice as many slices. Above 0, default 0.1.
    pub deep_overlap_part: f32,
    /// Most slices that a frame of an island is cut into (a power of two up to 64). 1 switches the return in time off. Default 8.
    pub slices_max: u32,
}

impl Default for StepSettings {
    fn default() -> Self {
        StepSettings {
            frame_seconds: 1.0 / 60.0,
            substeps: 4,
            first_sweeps: 3,
            first_sweeps_hard: 8,
            contact_margin_m: 0.02,
            overlap_allowed_m: 0.0005,
            overlap_recovery: 0.3,
            recovery_speed_max: 0.5,
            shock_propagation: ShockPropagation::Positions,
            shock_yield: 0.5,
            rest_speed: 0.05,
            rest_seconds: 2.0,
            rest_overlap_m: 0.01,
            deep_overlap_part: 0.1,
            slices_max: 8,
        }
    }
}

/// Why an environment is not possible.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EnvironmentError {
    /// The field at fault, as in [`Environment`] and [`StepSettings`].
    pub field: &'static str,
    /// What is wrong and what is allowed.
    pub message: String,
}

impl fmt::Display for EnvironmentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.field, self.message)
    }
}

impl std::error::Error for EnvironmentError {}

impl Environment {
    /// Whether a step can be done in it.
    ///
    /// # Errors
    /// When gravity is not finite or a setting is out of its range; the first field at fault.
    pub fn check(&self) -> Result<(), EnvironmentError> {
        require(self.gravity.is_finite(), "gravity", self.gravity, "finite numbers")?;
        self.settings.check()
    }
}

impl StepSettings {
    /// Whether a step can be done with them.
    ///
    /// # Errors
    /// When a setting is out of its range; the first at fault.
    pub fn check(&self) -> Result<(), EnvironmentError> {
        let seconds = self.frame_seconds;
        require((0.000_01..=1.0).contains(&seconds), "frame_seconds", seconds, "from 0.00001 to 1")?;
        for (field, value) in [
            ("substeps", self.substeps),
            ("first_sweeps", self.first_sweeps),
            ("first_sweeps_hard", self.first_sweeps_hard),
        ] {
            require((1..=64).contains(&value), field, value, "from 1 to 64")?;
        }
        for (field, value) in [
            ("contact_margin_m", self.contact_margin_m),
            ("overlap_allowed_m", self.overlap_allowed_m),
            ("recovery_speed_max", self.recovery_speed_max),
            ("rest_speed", self.rest_speed),
            ("rest_seconds", self.rest_seconds),
            ("rest_overlap_m", self.rest_overlap_m),
            ("deep_overlap_part", self.deep_overlap_part),
        ] {
            require(value >= 0.0 && value.is_finite(), field, value, "0 or more")?;
        }
        for (field, value) in [("overlap_recovery", self.overlap_recovery), ("shock_yield", self.shock_yield)]
        {
            require((0.0..=1.0).contains(&value), field, value, "from 0 to 1")?;
        }
        let part = self.deep_overlap_part;
        require(part > 0.0 && part.is_finite(), "deep_overlap_part", part, "above 0")?;
        let slices = self.slices_max;
        require(slices.is_power_of_two() && slices <= 64, "slices_max", slices, "1, 2, 4, 8, 16, 32 or 64")
    }

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

fn require(
    allowed: bool,
    field: &'static str,
    value: impl fmt::Display,
    expected: &str,
) -> Result<(), EnvironmentError> {
    if allowed {
        Ok(())
    } else {
        Err(EnvironmentError { field, message: format!("must be {expected}, is {value}") })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_out_of_range_is_named() {
        assert_eq!(Environment::default().check(), Ok(()));
        let refused = |change: fn(&mut Environment), expected: &str| {
            let mut environment = Environment::default();
            change(&mut environment);
            assert_eq!(environment.check().unwrap_err().to_string(), expected);
        };
        refused(|e| e.gravity.y = f32::NAN, "gravity: must be finite numbers, is [0, NaN, 0]");
        refused(|e| e.settings.frame_seconds = 0.0, "frame_seconds: must be from 0.00001 to 1, is 0");
        refused(|e| e.settings.frame_seconds = f32::NAN, "frame_seconds: must be from 0.00001 to 1, is NaN");
        refused(|e| e.settings.substeps = 0, "substeps: must be from 1 to 64, is 0");
        refused(|e| e.settings.first_sweeps_hard = 65, "first_sweeps_hard: must be from 1 to 64, is 65");
        refused(|e| e.settings.rest_seconds = f32::INFINITY, "rest_seconds: must be 0 or more, is inf");
        refused(|e| e.settings.shock_yield = -0.5, "shock_yield: must be from 0 to 1, is -0.5");
        refused(|e| e.settings.slices_max = 3, "slices_max: must be 1, 2, 4, 8, 16, 32 or 64, is 3");
    }
}
