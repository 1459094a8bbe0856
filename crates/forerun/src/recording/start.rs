//! Start: settings, names and bodies as they are in a file, and back.

use std::sync::Arc;

use forerun_dynamics::{Body, BodyDef, BodyState, Environment, ShockPropagation, StepSettings};
use forerun_geometry::{Shape, Vec3};
use forerun_timeline::parts::{BodyParts, NameParts, TimelineParts};
use forerun_timeline::{Frame, TimelineSettings};
use serde::{Deserialize, Serialize};

use super::large_shapes::Three;
use super::orders::{
    DefValue, KindValue, SpringValue, ToFile, def_of, kind_of, kind_value, material_of, material_value,
    spring_of, spring_value,
};
use super::states::{Words, state_of};

/// Settings and frames.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct StartValue {
    /// The version of the program that wrote the file: another one may compute other states.
    program: String,
    lookahead: u32,
    past: u32,
    bytes_max: Option<u64>,
    area_m: Option<f32>,
    record_contacts: bool,
    display: u64,
    oldest: u64,
    next_sequence: u64,
    /// How many names follow.
    pub(crate) names: u32,
    gravity: Three,
    step: StepValue,
}

/// As [`StepSettings`].
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct StepValue {
    frame_seconds: f32,
    substeps: u32,
    first_sweeps: u32,
    first_sweeps_hard: u32,
    contact_margin_m: f32,
    overlap_allowed_m: f32,
    overlap_recovery: f32,
    recovery_speed_max: f32,
    shock_propagation_classic: bool,
    shock_yield: f32,
    rest_speed: f32,
    rest_seconds: f32,
    rest_overlap_m: f32,
    deep_overlap_part: f32,
    slices_max: u32,
}

/// What a name stands for.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct NameValue {
    def: Option<DefValue>,
    body: PresenceValue,
}

/// A body at the oldest frame.
#[derive(Debug, Serialize, Deserialize)]
enum PresenceValue {
    /// It is not there.
    Absent,
    /// As it was made.
    AsMade,
    /// In a state that it came to later.
    Moved(Words),
    /// Changed by commands.
    Changed(Box<BodyValue>),
    /// Of another mass than it was made with (1/kg), and perhaps changed in other ways.
    Weighed(f32, Box<BodyValue>),
}

#[derive(Debug, Serialize, Deserialize)]
struct BodyValue {
    kind: KindValue,
    material: Three,
    gravity_scale: f32,
    force: Three,
    torque: Three,
    spring: Option<SpringValue>,
    state: Words,
}

/// The settings and frames of a timeline.
pub(crate) fn start_value(parts: &TimelineParts) -> StartValue {
    let TimelineSettings { lookahead, past, bytes_max, area_m, record_contacts } = parts.settings;
    StartValue {
        program: env!("CARGO_PKG_VERSION").to_owned(),
        lookahead,
        past,
        bytes_max: bytes_max.map(|bytes| bytes as u64),
        area_m,
        record_contacts,
        display: parts.display.0,
        oldest: parts.oldest.0,
        next_sequence: parts.next_sequence,
        names: parts.names.len() as u32,
        gravity: parts.environment.gravity.to_array(),
        step: step_value(&parts.environment.settings),
    }
}

/// A timeline of these settings, without names, commands and states.
pub(crate) fn start_of(value: StartValue) -> TimelineParts {
    TimelineParts {
        settings: TimelineSettings {
            lookahead: value.lookahead,
            past: value.past,
            // More than this machine could hold is no bound.
            bytes_max: value.bytes_max.map(|bytes| usize::try_from(bytes).unwrap_or(usize::MAX)),
            area_m: value.area_m,
            record_contacts: value.record_contacts,
        },
        display: Frame(value.display),
        oldest: Frame(value.oldest),
        environment: Environment { gravity: Vec3::from_array(value.gravity), settings: step_of(&value.step) },
        names: Vec::new(),
        commands: Vec::new(),
        next_sequence: value.next_sequence,
        undo: Vec::new(),
        redo: Vec::new(),
        frames: Vec::new(),
    }
}

pub(crate) fn step_value(settings: &StepSettings) -> StepValue {
    StepValue {
        frame_seconds: settings.frame_seconds,
        substeps: settings.substeps,
        first_sweeps: settings.first_sweeps,
        first_sweeps_hard: settings.first_sweeps_hard,
        contact_margin_m: settings.contact_margin_m,
        overlap_allowed_m: settings.overlap_allowed_m,
        overlap_recovery: settings.overlap_recovery,
        recovery_speed_max: settings.recovery_speed_max,
        shock_propagation_classic: settings.shock_propagation == ShockPropagation::Classic,
        shock_yield: settings.shock_yield,
        rest_speed: settings.rest_speed,
        rest_seconds: settings.rest_seconds,
        rest_overlap_m: settings.rest_overlap_m,
        deep_overlap_part: settings.deep_overlap_part,
        slices_max: settings.slices_max,
    }
}

pub(crate) fn step_of(value: &StepValue) -> StepSettings {
    StepSettings {
        frame_seconds: value.frame_seconds,
        substeps: value.substeps,
        first_sweeps: value.first_sweeps,
        first_sweeps_hard: value.first_sweeps_hard,
        contact_margin_m: value.contact_margin_m,
        overlap_allowed_m: value.overlap_allowed_m,
        overlap_recovery: value.overlap_recovery,
        recovery_speed_max: value.recovery_speed_max,
        shock_propagation: match value.shock_propagation_classic {
            true => ShockPropagation::Classic,
            false => ShockPropagation::Positions,
        },
        shock_yield: value.shock_yield,
        rest_speed: value.rest_speed,
        rest_seconds: value.rest_seconds,
        rest_overlap_m: value.rest_overlap_m,
        deep_overlap_part: value.deep_overlap_part,
        slices_max: value.slices_max,
    }
}

impl ToFile<'_> {
    pub(crate) fn name(&mut self, name: &NameParts) -> NameValue {
        let NameParts { def, body } = name;
        let made = def.as_ref().and_then(|def| Body::new(def).ok());
        let presence = match (body, made) {
            (None, _) => PresenceValue::Absent,
            (Some(now), Some((made, state))) if same_bits(now, &as_made(&made, state)) => {
                match now.state.same_bits(&state) {
                    true => PresenceValue::AsMade,
                    false => PresenceValue::Moved(now.state.bits()),
                }
            }
            (Some(now), _) => {
                let of_kind = def
                    .as_ref()
                    .and_then(|def| Body::new(&BodyDef { kind: now.kind, ..BodyDef::clone(def) }).ok());
                let as_made =
                    of_kind.is_none_or(|(made, _)| made.inverse_mass.to_bits() == now.inverse_mass.to_bits());
                match as_made {
                    true => PresenceValue::Changed(Box::new(body_value(now))),
                    false => PresenceValue::Weighed(now.inverse_mass, Box::new(body_value(now))),
                }
            }
        };
        NameValue { def: def.as_ref().map(|def| self.def(def)), body: presence }
    }
}

/// What a name stands for; `stored` are the shapes so far.
pub(crate) fn name_of(value: NameValue, stored: &[Shape]) -> Result<NameParts, String> {
    let def = value.def.map(|def| def_of(def, stored)).transpose()?.map(Arc::new);
    let made = |state: Option<Words>| -> Result<Option<BodyParts>, String> {
        let def = def.as_ref().ok_or("a body that was never made")?;
        let (body, first) = Body::new(def).map_err(|error| error.to_string())?;
        Ok(Some(as_made(&body, state.map_or(first, state_of))))
    };
    let body = match value.body {
        PresenceValue::Absent => None,
        PresenceValue::AsMade => made(None)?,
        PresenceValue::Moved(words) => made(Some(words))?,
        PresenceValue::Changed(now) => {
            let def = def.as_ref().ok_or("a body that was never made")?;
            let of_kind = BodyDef { kind: kind_of(now.kind), ..BodyDef::clone(def) };
            let (made, _) = Body::new(&of_kind).map_err(|error| error.to_string())?;
            Some(body_of(*now, made.inverse_mass))
        }
        PresenceValue::Weighed(inverse_mass, now) => Some(body_of(*now, inverse_mass)),
    };
    Ok(NameParts { def, body })
}

fn body_value(now: &BodyParts) -> BodyValue {
    BodyValue {
        kind: kind_value(now.kind),
        material: material_value(&now.material),
        gravity_scale: now.gravity_scale,
        force: now.force.to_array(),
        torque: now.torque.to_array(),
        spring: now.spring.as_ref().map(spring_value),
        state: now.state.bits(),
    }
}

fn body_of(value: BodyValue, inverse_mass: f32) -> BodyParts {
    BodyParts {
        kind: kind_of(value.kind),
        inverse_mass,
        material: material_of(value.material),
        gravity_scale: value.gravity_scale,
        force: Vec3::from_array(value.force),
        torque: Vec3::from_array(value.torque),
        spring: value.spring.map(spring_of),
        state: state_of(value.state),
    }
}

/// A body that no command changed.
fn as_made(body: &Body, state: BodyState) -> BodyParts {
    BodyParts {
        kind: body.kind,
        inverse_mass: body.inverse_mass,
        material: body.material,
        gravity_scale: body.gravity_scale,
        force: body.force,
        torque: body.torque,
        spring: body.spring,
        state,
    }
}

/// Whether two bodies are the same, bit for bit, but for their states.
fn same_bits(a: &BodyParts, b: &BodyParts) -> bool {
    let numbers = |body: &BodyParts| {
        let ([x, y, z], [u, v, w]) = (body.force.to_array(), body.torque.to_array());
        let [friction, static_friction, restitution] = material_value(&body.material);
        [x, y, z, u, v, w, friction, static_friction, restitution, body.gravity_scale, body.inverse_mass]
            .map(f32::to_bits)
    };
    a.kind == b.kind && a.spring == b.spring && numbers(a) == numbers(b)
}
