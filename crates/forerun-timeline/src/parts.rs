//! Parts: a timeline as plain values, for files and for other programs, and the same timeline made of them again.
//!
//! Promise: what is made of a timeline's parts goes on bit for bit as that would have. Parts come from outside: whatever they say, making
//! a timeline of them neither panics nor puts a number into a state that does not belong there.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

use forerun_dynamics::{Body, BodyDef, BodyId, BodyKind, BodyState, Environment, Material, Spring, bounds};
use forerun_geometry::Vec3;

use crate::areas::{Areas, Until};
use crate::command_log::CommandLog;
use crate::definitions::Definitions;
use crate::frame_table::{Entry, FrameTable};
use crate::order::UndoLog;
use crate::snapshot_delta::BodyTraits;
use crate::tables::Tables;
use crate::timeline::area_edge;
use crate::{Change, Command, CommandKey, Frame, Order, Progress, Stats, Timeline, TimelineSettings};

/// Frames beyond this have no exact time, and no session gets there.
pub const FRAME_MAX: u64 = 1 << 53;

/// How far the squared length of a stored rotation may be off 1: far more than rounding does.
const UNIT_TOLERANCE: f32 = 1e-3;

/// What is kept of the states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// Those at the oldest frame: the others are computed again.
    Commands,
    /// Those of all frames that are known to be true.
    States,
}

/// All that a timeline is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct TimelineParts {
    /// How far it looks ahead and back.
    pub settings: TimelineSettings,
    /// Where the display is.
    pub display: Frame,
    /// The oldest frame kept.
    pub oldest: Frame,
    /// Gravity and settings of the step at the oldest frame.
    pub environment: Environment,
    /// The names 0, 1, 2, ..., and what they stand for.
    pub names: Vec<NameParts>,
    /// The commands that act after the oldest frame, in the order in which they act.
    pub commands: Vec<Command>,
    /// The sequence number of the local user's next command.
    pub next_sequence: u64,
    /// The local user's orders that can be taken back: what takes them back. The last is the next.
    pub undo: Vec<Order>,
    /// What does again the orders that were taken back. The last is the next.
    pub redo: Vec<Order>,
    /// For each frame after the oldest one, as far as states are kept: what differs from the frame before, in the order of the bodies'
    /// names; `None` for a body that is not there any more.
    pub frames: Vec<Vec<(BodyId, Option<BodyState>)>>,
}

/// What a name stands for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NameParts {
    /// How the body was made; `None` while it only has a name, or where one of the commands makes it.
    pub def: Option<Arc<BodyDef>>,
    /// The body at the oldest frame; `None` where it is not there.
    pub body: Option<BodyParts>,
}

/// What of a body commands change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyParts {
    /// How it moves.
    pub kind: BodyKind,
    /// 1/kg; 0 unless dynamic.
    pub inverse_mass: f32,
    /// Surface.
    pub material: Material,
    /// Factor on gravity.
    pub gravity_scale: f32,
    /// Constant external force. N.
    pub force: Vec3,
    /// Constant external torque. N m.
    pub torque: Vec3,
    /// The spring that holds it.
    pub spring: Option<Spring>,
    /// Its state.
    pub state: BodyState,
}

/// Why no timeline can be made of parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartsError {
    /// The part at fault, as in [`TimelineParts`].
    pub place: String,
    /// What is wrong with it.
    pub message: String,
}

impl fmt::Display for PartsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}

impl std::error::Error for PartsError {}

fn wrong(place: impl fmt::Display, message: impl fmt::Display) -> PartsError {
    PartsError { place: place.to_string(), message: message.to_string() }
}

impl Timeline {
    /// The timeline as plain values. Statistics are no part of it.
    #[must_use]
    pub fn parts(&self, keep: Keep) -> TimelineParts {
        let oldest = self.oldest();
        let last = if keep == Keep::States { self.valid_to() } else { oldest };
        let frames = (oldest.next().0..=last.0).map(Frame).map(|frame| {
            let (before, table) = (self.table(frame.minus(1)), self.table(frame));
            table.differences(before).into_iter().map(|body| (body, table.get(body).copied())).collect()
        });
        TimelineParts {
            settings: self.settings,
            display: self.display,
            oldest,
            environment: self.definitions.environment(oldest),
            names: (0..self.names()).map(|name| self.name_parts(BodyId(name as u32))).collect(),
            commands: self
                .log
                .iter()
                .map(|(key, change)| Command { key: *key, change: change.clone() })
                .collect(),
            next_sequence: self.next_sequence,
            undo: self.undo.undo.clone(),
            redo: self.undo.redo.clone(),
            frames: frames.collect(),
        }
    }

    fn name_parts(&self, id: BodyId) -> NameParts {
        let oldest = self.oldest();
        let there = self.definitions.body(id, oldest).zip(self.table(oldest).get(id));
        let body = there.map(|(body, state)| BodyParts {
            kind: body.kind,
            inverse_mass: body.inverse_mass,
            material: body.material,
            gravity_scale: body.gravity_scale,
            force: body.force,
            torque: body.torque,
            spring: body.spring,
            state: *state,
        });
        let first = CommandKey { frame: Frame(0), source: 0, sequence: 0 };
        let adds = |(_, change): (CommandKey, &Change)| matches!(change, Change::Add { .. });
        let is_added = self.log.of_body_from(id, first.frame).any(adds);
        let def = self.definitions.def(id).filter(|_| !is_added);
        NameParts { def: def.cloned(), body }
    }

    /// A timeline of parts. With states it is as far computed as they go; the states at frames with commands are computed once more, to
    /// know again what the commands did; where contacts are recorded, those at all frames, to know them again.
    ///
    /// # Errors
    /// The first part that is not possible, or states that the commands do not lead to.
    pub fn from_parts(parts: TimelineParts) -> Result<Timeline, PartsError> {
        for (place, frame) in [("display", parts.display), ("oldest", parts.oldest)] {
            if frame.0 > FRAME_MAX {
                return Err(wrong(place, format!("must be at most {FRAME_MAX}, is {}", frame.0)));
            }
        }
        let bare = Timeline::new(&[], parts.environment, parts.settings);
        let mut timeline = bare.map_err(|error| wrong("environment", error))?;
        timeline.put_bodies(&parts)?;
        timeline.put_commands(&parts)?;
        timeline.undo = Arc::new(UndoLog { undo: parts.undo, redo: parts.redo });
        timeline.put_states(&parts.frames)?;
        timeline.display = parts.display;
        timeline.fit_memory();
        Ok(timeline)
    }

    /// Forgets how to undo orders on commands up to a frame, as when that frame were the oldest: for who repeats the orders of a session that
    /// had forgotten more than this timeline.
    pub fn forget_undo_to(&mut self, oldest: Frame) {
        if self.undo.begins_by(oldest) {
            Arc::make_mut(&mut self.undo).forget_to(oldest);
        }
    }

    /// The bodies at the oldest frame.
    fn put_bodies(&mut self, parts: &TimelineParts) -> Result<(), PartsError> {
        let mut made = Vec::with_capacity(parts.names.len());
        let mut entries: Vec<Entry> = Vec::new();
        for (name, part) in parts.names.iter().enumerate() {
            let id = u32::try_from(name).map_err(|_| wrong("names", "are more than there are ids"))?;
            let body = make(part, &parts.environment)
                .map_err(|error| PartsError { place: format!("names[{name}].{}", error.place), ..error })?;
            if let (Some(_), Some(BodyParts { state, .. })) = (&body, part.body) {
                entries.push((BodyId(id), Some(state)));
            }
            made.push((part.def.clone(), body));
        }
        let edge_m = self.settings.area_m.filter(|edge| *edge > 0.0 && edge.is_finite());
        let bodies = made.iter().filter_map(|(_, body)| body.as_deref());
        let mut areas = Areas::new(edge_m.unwrap_or_else(|| area_edge(bodies)));
        for (id, state) in &entries {
            let bound = made[id.0 as usize].1.as_ref().zip(state.as_ref());
            let bound = bound.map(|(body, state)| bounds::swept_bound(body, state, &parts.environment));
            areas.visit(*id, parts.oldest, bound.as_ref(), Until::FurtherNotice);
        }
        let empty = Arc::new(FrameTable::default());
        self.tables = Tables::new(parts.oldest, empty.with_entries(&entries, &empty).0);
        self.definitions = Arc::new(Definitions::at(parts.oldest, made, parts.environment));
        (self.areas, self.display) = (areas, parts.oldest);
        Ok(())
    }

    /// The commands, in any order. Those that were accepted once are not asked again whether they suit the body: they came in another
    /// order then.
    fn put_commands(&mut self, parts: &TimelineParts) -> Result<(), PartsError> {
        let after = parts.oldest.next();
        let mut log = CommandLog::default();
        let definitions = Arc::make_mut(&mut self.definitions);
        let mut commanded = BTreeSet::new();
        self.next_sequence = parts.next_sequence;
        for (index, Command { key, change }) in parts.commands.iter().enumerate() {
            let refuse = |message: String| Err(wrong(format!("commands[{index}]"), message));
            if key.frame < after {
                return refuse(format!("must act after {}, acts at {}", parts.oldest, key.frame));
            }
            if log.contains(key) {
                return refuse("has the key of another".to_owned());
            }
            if let Err(error) = change.check_numbers() {
                return refuse(error.to_string());
            }
            if let Some(body) = change.body().filter(|body| body.0 as usize >= parts.names.len()) {
                return refuse(format!("body {} has no name", body.0));
            }
            if let Change::Add { body, def } = change {
                if definitions.def(*body).is_some() {
                    return refuse(format!("body {} was added before", body.0));
                }
                if let Err(error) = Body::new(def) {
                    return refuse(error.to_string());
                }
                definitions.set_def(*body, Some(Arc::new(BodyDef::clone(def))));
            }
            if key.source == crate::order::LOCAL {
                self.next_sequence = self.next_sequence.max(key.sequence.saturating_add(1));
            }
            commanded.extend(change.body());
            log.insert(*key, change.clone());
        }
        for body in commanded {
            definitions.rebuild_body(body, after, log.of_body_from(body, after));
        }
        definitions.rebuild_environment(after, log.gravities_from(after));
        self.log = Arc::new(log);
        Ok(())
    }

    /// The states after the oldest frame.
    fn put_states(&mut self, frames: &[Vec<Entry>]) -> Result<(), PartsError> {
        let settings = self.settings;
        // No bound on what is read: it was kept, or memory would have been short then.
        self.settings = TimelineSettings { lookahead: u32::MAX, bytes_max: None, ..settings };
        for (index, changes) in frames.iter().enumerate() {
            let frame = self.horizon().next();
            let refused = |message| wrong(format!("frames[{index}]"), message);
            self.check_changes(changes).map_err(refused)?;
            let table = Arc::clone(self.table(self.horizon()));
            let next = table.with_entries(changes, &table).0;
            // Touches are no part: where they are recorded, all frames are computed once more.
            if self.settings.record_contacts || self.log.at(frame).next().is_some() {
                if self.advance() == Progress::Idle || !next.differences(self.table(frame)).is_empty() {
                    let message =
                        "are not the states that the commands lead to: they were computed by another version";
                    return Err(wrong(format!("frames[{index}]"), message));
                }
                continue;
            }
            let environment = self.definitions.environment(frame);
            for (id, state) in changes {
                let Some((body, state)) = self.definitions.body(*id, frame).zip(state.as_ref()) else {
                    return Err(wrong(format!("frames[{index}]"), format!("body {} is not there", id.0)));
                };
                let bound = bounds::swept_bound(body, state, &environment);
                self.areas.visit(*id, frame, Some(&bound), Until::FurtherNotice);
            }
            self.tables.push(next);
        }
        self.settings = settings;
        self.stats = Stats { ignored: self.stats.ignored, ..Stats::default() };
        Ok(())
    }
}

impl Timeline {
    fn check_changes(&self, changes: &[Entry]) -> Result<(), String> {
        let environment = self.definitions.environment(self.oldest());
        if !changes.is_sorted_by(|(a, _), (b, _)| a < b) {
            return Err("is not in the order of the bodies' names".to_owned());
        }
        for (id, state) in changes {
            if id.0 as usize >= self.names() {
                return Err(format!("body {} has no name", id.0));
            }
            if let Some(state) = state {
                check_state(state, &environment).map_err(|message| format!("body {}: {message}", id.0))?;
            }
        }
        Ok(())
    }
}

/// The body that a name stands for, as it is now.
fn make(part: &NameParts, environment: &Environment) -> Result<Option<Arc<Body>>, PartsError> {
    let Some(def) = &part.def else {
        return match part.body {
            Some(_) => Err(wrong("def", "is missing")),
            None => Ok(None),
        };
    };
    Body::new(def).map_err(|error| wrong("def", error))?;
    let Some(now) = &part.body else { return Ok(None) };
    let traits = BodyTraits {
        kind: now.kind,
        inverse_mass: now.inverse_mass,
        material: now.material,
        gravity_scale: now.gravity_scale,
        force: now.force,
        torque: now.torque,
        spring: now.spring,
    };
    let body = traits.body(def).map_err(|message| wrong("body", message))?;
    check_state(&now.state, environment).map_err(|message| wrong("body.state", message))?;
    Ok(Some(Arc::new(body)))
}

/// What every stored state is: finite, without -0, turned by a unit quaternion, and not longer at rest than there is.
pub(crate) fn check_state(state: &BodyState, environment: &Environment) -> Result<(), String> {
    if !(state.is_finite() && state.same_bits(&state.canonical())) {
        return Err("has a number that is not finite, or -0".to_owned());
    }
    let [x, y, z, w] = state.rotation.to_array();
    let squared = x * x + y * y + z * z + w * w;
    if (squared - 1.0).abs() > UNIT_TOLERANCE {
        return Err(format!("has a rotation of squared length {squared}, not 1"));
    }
    let most = environment.settings.rest_frames().saturating_add(1);
    if state.rest > most {
        return Err(format!("rests for {} frames, of at most {most}", state.rest));
    }
    Ok(())
}
