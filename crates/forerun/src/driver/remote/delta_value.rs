//! Delta value: a snapshot delta and statistics as they are in a message, and back.

use std::sync::Arc;

use forerun_dynamics::BodyState;
use forerun_geometry::{Shape, Vec3};
use forerun_timeline::snapshot_delta::{BodyTraits, DeltaBase, HistoryDelta, RunDelta};
use forerun_timeline::{Change, Command, CommandKey, Counters, Edit, Frame, SnapshotDelta, Stats};
use serde::{Deserialize, Serialize};

use crate::recording::large_shapes::{LargeShape, StoredShapes, Three};
use crate::recording::orders::{
    CommandValue, DefValue, KindValue, SpringValue, ToFile, command_of, def_of, kind_of, kind_value,
    material_of, material_value, spring_of, spring_value,
};
use crate::recording::start::{StepValue, step_of, step_value};
use crate::recording::states::{LastStates, Words, state_of};
use crate::{BodyId, Environment};

/// As [`SnapshotDelta`].
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct DeltaValue {
    oldest: u64,
    horizon: u64,
    valid_to: u64,
    runs: Vec<RunValue>,
    doubts: Vec<(u32, u64, bool)>,
    effects: Vec<EffectsValue>,
    names: u32,
    histories: Vec<HistoryValue>,
    environments: Option<Vec<(u64, Three, StepValue)>>,
    /// Frames, each with all that is in force there.
    commands: Vec<(u64, Vec<CommandValue>)>,
    edits: Option<Vec<EditValue>>,
    undoable: (bool, bool),
    area_m: f32,
}

/// A frame, on whom its commands act, and where the step left those bodies.
type EffectsValue = (u64, Vec<(u32, Option<Words>)>);

/// First and last frame, what the states are compared with, and the states as in a recording.
#[derive(Debug, Serialize, Deserialize)]
struct RunValue(u64, u64, BaseValue, Vec<u8>);

#[derive(Debug, Serialize, Deserialize)]
enum BaseValue {
    Nothing,
    SameFrame,
    FrameBefore,
}

#[derive(Debug, Serialize, Deserialize)]
struct HistoryValue {
    body: u32,
    made: Option<Option<DefValue>>,
    entries: Vec<(u64, Option<TraitsValue>)>,
}

/// Kind, material, factor on gravity, force, torque, spring, inverse mass.
#[derive(Debug, Serialize, Deserialize)]
struct TraitsValue(KindValue, Three, f32, Three, Three, Option<SpringValue>, f32);

/// The value of a delta. What has to be sent before goes to `new`.
pub(super) fn delta_value(
    delta: &SnapshotDelta,
    stored: &mut StoredShapes,
    new: &mut Vec<LargeShape>,
) -> DeltaValue {
    let mut to = ToFile { stored, new };
    let history = |history: &HistoryDelta| HistoryValue {
        body: history.body.0,
        made: history.made.as_ref().map(|made| made.as_ref().map(|def| to.def(def))),
        entries: history.entries.iter().map(|(f, traits)| (f.0, traits.as_ref().map(traits_value))).collect(),
    };
    let histories = delta.histories.iter().map(history).collect();
    let commands = delta.commands.iter().map(|(frame, commands)| {
        let command = |(key, change): &(CommandKey, Arc<Change>)| to.command_of(key, change);
        (frame.0, commands.iter().map(command).collect())
    });
    let commands = commands.collect();
    let environment = |(from, environment): &(Frame, Environment)| {
        (from.0, environment.gravity.to_array(), step_value(&environment.settings))
    };
    let bits = |(body, state): &(BodyId, Option<BodyState>)| (body.0, state.map(|state| state.bits()));
    DeltaValue {
        oldest: delta.oldest.0,
        horizon: delta.horizon.0,
        valid_to: delta.valid_to.0,
        runs: delta.runs.iter().map(run_value).collect(),
        doubts: delta.doubts.iter().map(|(body, frame, arrives)| (body.0, frame.0, *arrives)).collect(),
        effects: delta.effects.iter().map(|(f, on)| (f.0, on.iter().map(bits).collect())).collect(),
        names: delta.names,
        histories,
        environments: delta.environments.as_ref().map(|all| all.iter().map(environment).collect()),
        commands,
        edits: delta.edits.as_ref().map(|edits| edits.iter().map(edit_value).collect()),
        undoable: delta.undoable,
        area_m: delta.area_m,
    }
}

/// The delta of a value; `shapes` are those sent so far.
pub(super) fn delta_of(value: DeltaValue, shapes: &[Shape]) -> Result<SnapshotDelta, String> {
    let names = value.names as usize;
    let run = |RunValue(from, to, base, states): RunValue| {
        let base = match base {
            BaseValue::Nothing => DeltaBase::Nothing,
            BaseValue::SameFrame => DeltaBase::SameFrame,
            BaseValue::FrameBefore => DeltaBase::FrameBefore,
        };
        let entries = LastStates::default().decode(&states, names);
        let entries = entries.ok_or_else(|| format!("a frame {from} that cannot be read"))?;
        Ok(RunDelta { from: Frame(from), to: Frame(to), base, entries })
    };
    let history = |value: HistoryValue| {
        let made = value.made.map(|made| made.map(|def| def_of(def, shapes).map(Arc::new)).transpose());
        let entries = value.entries.into_iter().map(|(f, traits)| (Frame(f), traits.map(traits_of)));
        Ok(HistoryDelta { body: BodyId(value.body), made: made.transpose()?, entries: entries.collect() })
    };
    let command = |value: CommandValue| {
        let Command { key, change } = command_of(value, shapes)?;
        Ok((key, Arc::new(change)))
    };
    let commands = |(frame, commands): (u64, Vec<CommandValue>)| {
        let commands: Result<Vec<_>, String> = commands.into_iter().map(command).collect();
        Ok((Frame(frame), commands?))
    };
    let environment = |(from, gravity, step): (u64, Three, StepValue)| {
        let environment = Environment { gravity: Vec3::from_array(gravity), settings: step_of(&step) };
        (Frame(from), environment)
    };
    let state = |(body, words): (u32, Option<Words>)| (BodyId(body), words.map(state_of));
    let effect = |(f, on): EffectsValue| (Frame(f), on.into_iter().map(state).collect());
    let doubt = |(body, frame, arrives)| (BodyId(body), Frame(frame), arrives);
    Ok(SnapshotDelta {
        oldest: Frame(value.oldest),
        horizon: Frame(value.horizon),
        valid_to: Frame(value.valid_to),
        runs: value.runs.into_iter().map(run).collect::<Result<_, String>>()?,
        doubts: value.doubts.into_iter().map(doubt).collect(),
        effects: value.effects.into_iter().map(effect).collect(),
        names: value.names,
        histories: value.histories.into_iter().map(history).collect::<Result<_, String>>()?,
        environments: value.environments.map(|all| all.into_iter().map(environment).collect()),
        commands: value.commands.into_iter().map(commands).collect::<Result<_, String>>()?,
        edits: value.edits.map(|edits| edits.into_iter().map(edit_of).collect()),
        undoable: value.undoable,
        area_m: value.area_m,
    })
}

fn run_value(run: &RunDelta) -> RunValue {
    let base = match run.base {
        DeltaBase::Nothing => BaseValue::Nothing,
        DeltaBase::SameFrame => BaseValue::SameFrame,
        DeltaBase::FrameBefore => BaseValue::FrameBefore,
    };
    RunValue(run.from.0, run.to.0, base, LastStates::default().encode(&run.entries))
}

fn traits_value(traits: &BodyTraits) -> TraitsValue {
    TraitsValue(
        kind_value(traits.kind),
        material_value(&traits.material),
        traits.gravity_scale,
        traits.force.to_array(),
        traits.torque.to_array(),
        traits.spring.as_ref().map(spring_value),
        traits.inverse_mass,
    )
}

fn traits_of(value: TraitsValue) -> BodyTraits {
    let TraitsValue(kind, material, gravity_scale, force, torque, spring, inverse_mass) = value;
    BodyTraits {
        kind: kind_of(kind),
        inverse_mass,
        material: material_of(material),
        gravity_scale,
        force: Vec3::from_array(force),
        torque: Vec3::from_array(torque),
        spring: spring.map(spring_of),
    }
}

/// As [`Stats`].
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct StatsValue {
    ahead: CountersValue,
    edits: CountersValue,
    last_edit: EditValue,
    ignored: u64,
    slices_max: u32,
    past_frames: u64,
    lookahead_frames: u64,
    state_bytes: u64,
    memory_bound: bool,
}

/// Affected, recomputed, frames, quarantined.
type CountersValue = (u64, u64, u64, u64);

/// Frame, commands, affected, recomputed, full, frames.
type EditValue = (u64, u32, u64, u64, u64, u64);

fn edit_value(edit: &Edit) -> EditValue {
    let Edit { frame, commands, affected, recomputed, full, frames } = *edit;
    (frame.0, commands, affected, recomputed, full, frames)
}

fn edit_of((frame, commands, affected, recomputed, full, frames): EditValue) -> Edit {
    Edit { frame: Frame(frame), commands, affected, recomputed, full, frames }
}

pub(super) fn stats_value(stats: &Stats) -> StatsValue {
    let counters = |c: &Counters| (c.affected, c.recomputed, c.frames, c.quarantined);
    StatsValue {
        ahead: counters(&stats.ahead),
        edits: counters(&stats.edits),
        last_edit: edit_value(&stats.last_edit),
        ignored: stats.ignored,
        slices_max: stats.slices_max,
        past_frames: stats.past_frames,
        lookahead_frames: stats.lookahead_frames,
        state_bytes: stats.state_bytes as u64,
        memory_bound: stats.memory_bound,
    }
}

pub(super) fn stats_of(value: &StatsValue) -> Stats {
    let counters = |(affected, recomputed, frames, quarantined): CountersValue| Counters {
        affected,
        recomputed,
        frames,
        quarantined,
    };
    Stats {
        ahead: counters(value.ahead),
        edits: counters(value.edits),
        last_edit: edit_of(value.last_edit),
        ignored: value.ignored,
        slices_max: value.slices_max,
        past_frames: value.past_frames,
        lookahead_frames: value.lookahead_frames,
        // More than this machine could hold is only said, not taken.
        state_bytes: usize::try_from(value.state_bytes).unwrap_or(usize::MAX),
        memory_bound: value.memory_bound,
    }
}
