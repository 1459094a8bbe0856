//! Settings of the step that a scene changes.

use forerun_dynamics::{ShockPropagation, StepSettings};
use serde::{Deserialize, Serialize};

use crate::error::{Fault, Step};

/// What a scene file changes in the settings of the step; what is left out keeps its default. See
/// [`StepSettings`] for what each does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SettingsEntry {
    /// 1 to 64.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub substeps: Option<u32>,
    /// 1 to 64.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_sweeps: Option<u32>,
    /// 1 to 64.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_sweeps_hard: Option<u32>,
    /// Metres, 0 or more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact_margin_m: Option<f32>,
    /// Metres, 0 or more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overlap_allowed_m: Option<f32>,
    /// 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overlap_recovery: Option<f32>,
    /// m/s, 0 or more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recovery_speed_max: Option<f32>,
    /// What shock propagation does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shock_propagation: Option<ShockEntry>,
    /// 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shock_yield: Option<f32>,
    /// m/s, 0 or more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_speed: Option<f32>,
    /// Seconds; 0 switches rest off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_seconds: Option<f32>,
    /// Metres, 0 or more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_overlap_m: Option<f32>,
    /// Above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deep_overlap_part: Option<f32>,
    /// A power of two from 1 to 64.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slices_max: Option<u32>,
}

impl SettingsEntry {
    pub(crate) fn check(&self) -> Result<(), Fault> {
        self.over(StepSettings::default()).check().map_err(|error| {
            Fault::new(error.message, "leave the field out for its default")
                .under(Step::Field(error.field.into()))
        })
    }

    /// `settings` with what this changes.
    pub(crate) fn over(&self, settings: StepSettings) -> StepSettings {
        StepSettings {
            substeps: self.substeps.unwrap_or(settings.substeps),
            first_sweeps: self.first_sweeps.unwrap_or(settings.first_sweeps),
            first_sweeps_hard: self.first_sweeps_hard.unwrap_or(settings.first_sweeps_hard),
            contact_margin_m: self.contact_margin_m.unwrap_or(settings.contact_margin_m),
            overlap_allowed_m: self.overlap_allowed_m.unwrap_or(settings.overlap_allowed_m),
            overlap_recovery: self.overlap_recovery.unwrap_or(settings.overlap_recovery),
            recovery_speed_max: self.recovery_speed_max.unwrap_or(settings.recovery_speed_max),
            shock_propagation: self.shock_propagation.map_or(settings.shock_propagation, ShockEntry::meant),
            shock_yield: self.shock_yield.unwrap_or(settings.shock_yield),
            rest_speed: self.rest_speed.unwrap_or(settings.rest_speed),
            rest_seconds: self.rest_seconds.unwrap_or(settings.rest_seconds),
            slices_max: self.slices_max.unwrap_or(settings.slices_max),
            deep_overlap_part: self.deep_overlap_part.unwrap_or(settings.deep_overlap_part),
            rest_overlap_m: self.rest_overlap_m.unwrap_or(settings.rest_overlap_m),
            ..settings
        }
    }
}

/// What shock propagation does, as a scene says it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ShockEntry {
    /// On positions: overlap is pushed out.
    Positions,
    /// On velocities too: lower bodies of infinite mass, for comparison.
    Classic,
}

impl ShockEntry {
    fn meant(self) -> ShockPropagation {
        match self {
            ShockEntry::Positions => ShockPropagation::Positions,
            ShockEntry::Classic => ShockPropagation::Classic,
        }
    }
}
