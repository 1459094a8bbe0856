//! Snapshot delta: what whoever has one snapshot needs to have a later one, as plain values.
//!
//! What differs is found by looking at what the two snapshots do not share, and what comes out shares with the snapshot before as the
//! original does: a frame of rest, a block of bodies that nothing reached and a body that no command changed cost nothing to send or keep.
//!
//! Promise: applied to a snapshot with the bits of the one that it was made from, it gives one with the bits of the other: states, certainty
//! and samples. Deltas come from outside: whatever they say, applying one neither panics nor stores a number that is none. Recorded contacts are
//! no part of it.

mod histories;
mod marks;
mod runs;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use forerun_dynamics::{Body, BodyDef, BodyId, BodyKind, BodyState, Environment, Material, Spring};
use forerun_geometry::Vec3;

use crate::areas::Grid;
use crate::commanding::{Effect, FrameEffects};
use crate::effect::{Ignored, weighed};
use crate::snapshot::Doubt;
use crate::{Change, CommandKey, Edit, Frame, Snapshot};

/// A frame, on whom its commands act, and the states in which the step left those bodies.
pub type EffectsAt = (Frame, Vec<(BodyId, Option<BodyState>)>);

/// A frame, and the commands in force at it.
pub type CommandsAt = (Frame, Vec<(CommandKey, Arc<Change>)>);

/// What differs between two snapshots.
#[derive(Clone, Debug, PartialEq)]
pub struct SnapshotDelta {
    /// The oldest frame that is kept now.
    pub oldest: Frame,
    /// The last frame computed now.
    pub horizon: Frame,
    /// The last frame that is now known to be true for all bodies.
    pub valid_to: Frame,
    /// The frames with other states, in their order.
    pub runs: Vec<RunDelta>,
    /// The bodies that wait to be recomputed: the last frame at which each is known to be true, and whether it is known where the step from
    /// there leads. Sorted by body.
    pub doubts: Vec<(BodyId, Frame, bool)>,
    /// The frames at which commands did something else than before: on whom they act now, and the state in which the step left that body, if
    /// it was there. Sorted; nobody where no command acts any more.
    pub effects: Vec<EffectsAt>,
    /// How many names are in use.
    pub names: u32,
    /// The bodies that are something else than before. Sorted by body.
    pub histories: Vec<HistoryDelta>,
    /// The frames of which other commands are in force than before: all that are now. Sorted; none where there are no more.
    pub commands: Vec<CommandsAt>,
    /// What the last batches of commands cost, if that is not as before.
    pub edits: Option<Vec<Edit>>,
    /// Whether there is something to undo, and to do again.
    pub undoable: (bool, bool),
    /// Edge of an area. Metres.
    pub area_m: f32,
    /// Gravity and settings from which frame on, if that is not as before. Sorted by frame; of two of one frame the later one holds.
    pub environments: Option<Vec<(Frame, Environment)>>,
}

/// Frames that are alike, and that are not what they were.
#[derive(Clone, Debug, PartialEq)]
pub struct RunDelta {
    /// The first of them.
    pub from: Frame,
    /// The last of them.
    pub to: Frame,
    /// What the entries are to be put into.
    pub base: DeltaBase,
    /// The states that differ from the base; `None` for a body that is not there. Sorted by body.
    pub entries: Vec<(BodyId, Option<BodyState>)>,
}

/// What the states of a frame are compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeltaBase {
    /// No bodies at all.
    Nothing,
    /// The same frame of the snapshot before.
    SameFrame,
    /// The frame before, as it is now.
    FrameBefore,
}

/// What one body is now.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryDelta {
    /// Which body.
    pub body: BodyId,
    /// How it was made, if that is not as before.
    pub made: Option<Option<Arc<BodyDef>>>,
    /// What it is from which frame on; `None` where it does not exist. Sorted by frame.
    pub entries: Vec<(Frame, Option<BodyTraits>)>,
}

/// What of a body commands change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyTraits {
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
}

impl BodyTraits {
    /// Those of a body.
    #[must_use]
    pub fn of(body: &Body) -> BodyTraits {
        let Body { kind, inverse_mass, material, gravity_scale, force, torque, spring, .. } = *body;
        BodyTraits { kind, inverse_mass, material, gravity_scale, force, torque, spring }
    }

    /// The body with these traits that was made so.
    ///
    /// # Errors
    /// When the definition is not possible for the kind, or a number is not finite or out of its range.
    pub fn body(&self, def: &BodyDef) -> Result<Body, String> {
        let BodyTraits { kind, inverse_mass, material, gravity_scale, force, torque, spring } = *self;
        let (made, _) =
            Body::new(&BodyDef { kind, ..BodyDef::clone(def) }).map_err(|error| format!("kind: {error}"))?;
        let body = BodyId(0);
        let mut changes = vec![
            Change::SetMaterial { body, material },
            Change::SetForce { body, force, torque },
            Change::SetGravityScale { body, scale: gravity_scale },
        ];
        changes.extend(spring.map(|spring| Change::Hold { body, spring }));
        for change in changes {
            change.check_numbers().map_err(|error| error.to_string())?;
        }
        let made = if inverse_mass.to_bits() == made.inverse_mass.to_bits() {
            made
        } else {
            let possible = inverse_mass > 0.0 && inverse_mass.is_finite();
            let weighed = if possible { weighed(&made, &made, inverse_mass) } else { Err(Ignored) };
            weighed.map_err(|Ignored| format!("inverse_mass: {inverse_mass} is not possible for it"))?
        };
        Ok(Body { material, force, torque, gravity_scale, spring, ..made })
    }
}

/// Why a delta cannot be applied. Nothing changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeltaError {
    /// The part at fault, as in [`SnapshotDelta`].
    pub place: &'static str,
    /// What is wrong with it.
    pub message: String,
}

impl fmt::Display for DeltaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}

impl std::error::Error for DeltaError {}

fn wrong(place: &'static str, message: impl fmt::Display) -> DeltaError {
    DeltaError { place, message: message.to_string() }
}

impl SnapshotDelta {
    /// What is needed to have `after`, by who has `before`, or nothing yet.
    #[must_use]
    pub fn between(before: Option<&Snapshot>, after: &Snapshot) -> SnapshotDelta {
        let definitions = before.map(|before| &*before.definitions);
        let (names, histories) = histories::delta(definitions, &after.definitions);
        let environments = &after.definitions.environments;
        SnapshotDelta {
            oldest: after.oldest(),
            horizon: after.horizon(),
            valid_to: after.valid_to,
            runs: runs::delta(before.map(|before| &before.tables), &after.tables),
            doubts: after.doubtful.iter().map(|doubt| (doubt.body, doubt.known_to, doubt.arrives)).collect(),
            effects: effects_delta(before.map(|before| &*before.effects), &after.effects),
            names,
            histories,
            commands: marks::commands_delta(
                before.map(|before| &*before.marks.commands),
                &after.marks.commands,
            ),
            edits: marks::edits_delta(before.map(|before| &before.marks.edits), &after.marks.edits),
            undoable: (after.marks.can_undo, after.marks.can_redo),
            area_m: after.grid.edge_m(),
            environments: (definitions.map(|before| &before.environments) != Some(environments))
                .then(|| environments.clone()),
        }
    }

    /// The snapshot that it leads to from `before`.
    ///
    /// # Errors
    /// The part that does not fit `before`, or is not possible.
    pub fn apply(&self, before: Option<&Snapshot>) -> Result<Arc<Snapshot>, DeltaError> {
        if self.oldest > self.valid_to
            || self.valid_to > self.horizon
            || self.horizon.0 > crate::parts::FRAME_MAX
        {
            let message = format!("true to {}, of {} to {}", self.valid_to, self.oldest, self.horizon);
            return Err(wrong("horizon", message));
        }
        let definitions = histories::apply(before.map(|before| &before.definitions), self)?;
        let tables = runs::apply(before.map(|before| &before.tables), self, &definitions)?;
        Ok(Arc::new(Snapshot {
            valid_to: self.valid_to,
            tables,
            definitions,
            doubtful: self.doubtful()?,
            effects: self.effects(before)?,
            marks: marks::apply(before.map(|before| &before.marks), self)?,
            grid: Grid::new(self.area_m).ok_or_else(|| wrong("area_m", "must be above 0"))?,
        }))
    }

    fn doubtful(&self) -> Result<Vec<Doubt>, DeltaError> {
        if !self.doubts.is_sorted_by(|(a, ..), (b, ..)| a < b) {
            return Err(wrong("doubts", "are not in the order of the bodies' names"));
        }
        let kept = self.oldest..=self.horizon;
        if let Some((body, known_to, _)) = self.doubts.iter().find(|(_, frame, _)| !kept.contains(frame)) {
            return Err(wrong(
                "doubts",
                format!("body {} is known to {known_to}, which is not kept", body.0),
            ));
        }
        let doubt = |&(body, known_to, arrives): &(BodyId, Frame, bool)| Doubt { body, known_to, arrives };
        Ok(self.doubts.iter().map(doubt).collect())
    }

    fn effects(
        &self,
        before: Option<&Snapshot>,
    ) -> Result<Arc<BTreeMap<Frame, Arc<FrameEffects>>>, DeltaError> {
        let mut all = before.map_or_else(Arc::default, |before| Arc::clone(&before.effects));
        if self.effects.is_empty() {
            return Ok(all);
        }
        let effects = Arc::make_mut(&mut all);
        for (frame, bodies) in &self.effects {
            if let Some((body, _)) = bodies.iter().find(|(_, state)| state.is_some_and(|s| !s.is_finite())) {
                return Err(wrong("effects", format!("body {} has a number that is not finite", body.0)));
            }
            if bodies.is_empty() {
                effects.remove(frame);
            } else {
                let shown = bodies.iter().map(|(body, arrived)| (*body, Effect::shown(*arrived)));
                effects.insert(*frame, Arc::new(shown.collect()));
            }
        }
        Ok(all)
    }
}

type Effects = BTreeMap<Frame, Arc<FrameEffects>>;

fn effects_delta(before: Option<&Effects>, after: &Effects) -> Vec<EffectsAt> {
    if before.is_some_and(|before| std::ptr::eq(before, after)) {
        return Vec::new();
    }
    let nothing = Effects::new();
    let before = before.unwrap_or(&nothing);
    let gone = before.keys().filter(|frame| !after.contains_key(frame)).map(|frame| (*frame, Vec::new()));
    let other =
        after.iter().filter(|(frame, now)| !before.get(frame).is_some_and(|old| Arc::ptr_eq(old, now)));
    let other = other.map(|(frame, now)| {
        (*frame, now.iter().map(|(body, effect)| (*body, effect.arrived)).collect::<Vec<_>>())
    });
    let mut effects: Vec<_> = gone.chain(other).collect();
    effects.sort_unstable_by_key(|(frame, _)| *frame);
    effects
}
