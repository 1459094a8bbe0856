//! Check: does a timeline that was edited equal a full simulation, bit for bit? For tests and the command line.
//!
//! The reference shares with the timeline the step and what commands do, and nothing of what decides which bodies are computed: it computes
//! all bodies together in every frame, and where a command wakes who is near, it asks everybody.

use std::fmt;
use std::sync::Arc;

use forerun_dynamics::{BodyDef, BodyId, BodyState, Environment};

use crate::affected::Mutation;
use crate::frame_table::same_entry;
use crate::hearing::NAMES_AHEAD;
pub use crate::random_change::{Random, random_change};
use crate::{Change, Command, CommandError, Frame, Progress, Timeline, TimelineError, TimelineSettings};

/// What is to be checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckSettings {
    /// How many random edits are made, one after the other.
    pub edits: u32,
    /// From which all that is random follows.
    pub seed: u64,
    /// How many frames are simulated.
    pub frames: u32,
    /// A rule left out, to show that the check notices.
    #[doc(hidden)]
    pub mutation: Mutation,
}

impl Default for CheckSettings {
    fn default() -> Self {
        CheckSettings { edits: 20, seed: 1, frames: 200, mutation: Mutation::None }
    }
}

/// A moment in a check: who has a clock may look at it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckMoment {
    /// An edit is about to be submitted.
    EditBegins,
    /// All frames are true again.
    EditEnds,
    /// The same edit is about to be submitted to the reference, which computes everything after it again.
    FullBegins,
    /// The reference is done.
    FullEnds,
}

/// A body and frame whose bits differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mismatch {
    /// The frame.
    pub frame: Frame,
    /// The body.
    pub body: BodyId,
    /// Its state in the timeline.
    pub found: Option<BodyState>,
    /// Its state in the full simulation.
    pub expected: Option<BodyState>,
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Mismatch { frame, body, found, expected } = self;
        write!(f, "{frame}, body {}: found {found:?}, a full run gives {expected:?}", body.0)
    }
}

/// What a check found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CheckReport {
    /// Body-frames whose bits differ from the full run, after each edit and at the end.
    pub mismatches: u64,
    /// The first of them.
    pub first_mismatch: Option<Mismatch>,
    /// Body-frames that the edits truly changed.
    pub affected: u64,
    /// Body-frames that were computed again for it.
    pub recomputed: u64,
    /// Body-frames that the full runs computed.
    pub full: u64,
}

/// Makes random edits on a timeline of the bodies and compares it with full simulations. Calls `at` at the moments of each edit.
///
/// # Errors
/// When the environment or a body is not possible, or a full run refuses a command that the timeline accepted: then nothing is shown.
pub fn check(
    bodies: &[BodyDef],
    environment: Environment,
    settings: &CheckSettings,
    at: &mut dyn FnMut(CheckMoment),
) -> Result<CheckReport, FullRunError> {
    let all =
        TimelineSettings { lookahead: settings.frames, past: settings.frames, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(bodies, environment, all).map_err(FullRunError::Start)?;
    timeline.mutate(settings.mutation);
    let mut reference = Timeline::new(bodies, environment, all).map_err(FullRunError::Start)?;
    reference.recompute_all();
    run(&mut timeline);
    run(&mut reference);

    let mut random = Random::new(settings.seed);
    let mut commands = Vec::new();
    let mut report = CheckReport::default();
    report.add(&timeline, &reference);
    for _ in 0..settings.edits {
        let frame = Frame(1 + random.below(u64::from(settings.frames.max(1))));
        let change = random_change(&mut timeline, frame, &mut random);
        let known = timeline.names();
        at(CheckMoment::EditBegins);
        let edited = timeline.change(frame, change.clone());
        run(&mut timeline);
        at(CheckMoment::EditEnds);
        // What is refused changed nothing, and the reference need not hear of it.
        let Ok(key) = edited else { continue };
        while reference.names() < known {
            reference.reserve_body();
        }
        at(CheckMoment::FullBegins);
        reference.submit(Command { key, change: change.clone() }).map_err(FullRunError::Command)?;
        run(&mut reference);
        at(CheckMoment::FullEnds);
        commands.push(Command { key, change });
        report.add(&timeline, &reference);
    }
    // The reference was edited too: compare with one that knew everything from the start.
    report.add_fresh(&timeline, full_run(bodies, commands, environment, settings.frames))?;
    let edits = timeline.stats().edits;
    (report.affected, report.recomputed) = (edits.affected, edits.recomputed);
    report.full = reference.stats().edits.recomputed;
    Ok(report)
}

impl CheckReport {
    fn add(&mut self, timeline: &Timeline, reference: &Timeline) {
        let (count, first) = mismatches(timeline, reference);
        self.mismatches += count;
        self.first_mismatch = self.first_mismatch.or(first);
    }

    /// A comparison that cannot be made is no agreement.
    fn add_fresh(
        &mut self,
        timeline: &Timeline,
        fresh: Result<Timeline, FullRunError>,
    ) -> Result<(), FullRunError> {
        self.add(timeline, &fresh?);
        Ok(())
    }
}

/// Why there is no full run.
#[derive(Clone, Debug, PartialEq)]
pub enum FullRunError {
    /// The environment or a body is not possible.
    Start(TimelineError),
    /// A command is refused.
    Command(CommandError),
}

impl fmt::Display for FullRunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FullRunError::Start(error) => write!(f, "{error}"),
            FullRunError::Command(error) => write!(f, "a full run refuses a command: {error}"),
        }
    }
}

impl std::error::Error for FullRunError {}

/// A full simulation to frame `frames` that knows all commands from the start and computes all bodies in every frame.
///
/// # Errors
/// When a body is not possible or a command is refused.
pub fn full_run(
    bodies: &[BodyDef],
    commands: impl IntoIterator<Item = Command>,
    environment: Environment,
    frames: u32,
) -> Result<Timeline, FullRunError> {
    let settings = TimelineSettings { lookahead: frames, past: frames, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(bodies, environment, settings).map_err(FullRunError::Start)?;
    timeline.recompute_all();
    // Commands may name bodies that later ones add.
    let mut commands: Vec<Command> = commands.into_iter().collect();
    commands.sort_by_key(|command| (!matches!(command.change, Change::Add { .. }), command.key));
    // And bodies whose names were reserved, or whose `Add` was taken back.
    let named = commands.iter().filter_map(|command| command.change.body());
    let known = timeline.names() + NAMES_AHEAD;
    if let Some(last) = named.map(|body| body.0 as usize).filter(|name| *name < known).max() {
        Arc::make_mut(&mut timeline.definitions).reserve(last + 1);
    }
    timeline.submit_all(commands).map_err(FullRunError::Command)?;
    run(&mut timeline);
    Ok(timeline)
}

/// How many body-frames differ in the frames that both have, and the first of them.
#[must_use]
pub fn mismatches(timeline: &Timeline, reference: &Timeline) -> (u64, Option<Mismatch>) {
    let mut count = 0;
    let mut first = None;
    let from = timeline.oldest().max(reference.oldest());
    let to = timeline.horizon().min(reference.horizon());
    for frame in (from.0..=to.0).map(Frame) {
        for body in timeline.table(frame).differences(reference.table(frame)) {
            let (found, expected) = (timeline.state(body, frame), reference.state(body, frame));
            debug_assert!(!same_entry(found, expected));
            count += 1;
            first =
                first.or(Some(Mismatch { frame, body, found: found.copied(), expected: expected.copied() }));
        }
    }
    (count, first)
}

impl Timeline {
    /// Does the step that leaves a frame once more, for all bodies together, and compares it with what is stored: the first body that
    /// differs. `None` when none does, or when the next frame is not known to be true.
    #[must_use]
    pub fn audit(&self, frame: Frame) -> Option<Mismatch> {
        if frame < self.oldest() || frame >= self.valid_to() {
            return None;
        }
        let mut again = self.clone();
        again.stale.entry(frame).or_default().everyone = true;
        let _ = again.advance();
        let next = frame.next();
        let body = *self.table(next).differences(again.table(next)).first()?;
        let (found, expected) = (self.state(body, next), again.state(body, next));
        Some(Mismatch { frame: next, body, found: found.copied(), expected: expected.copied() })
    }
}

fn run(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CommandKey;
    use forerun_geometry::Vec3;
    use forerun_geometry::shape::{Shape, Sphere};

    #[test]
    fn a_full_run_that_refuses_a_command_is_an_error_and_no_agreement() {
        let bodies = [BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 }))];
        let timeline = full_run(&bodies, [], Environment::default(), 5).unwrap();
        let key = CommandKey { frame: Frame(2), source: 0, sequence: 0 };
        let unknown = Command { key, change: Change::Release { body: BodyId(u32::MAX) } };
        let mut report = CheckReport::default();
        let refused = full_run(&bodies, [unknown], Environment::default(), 5);
        assert_eq!(
            report.add_fresh(&timeline, refused),
            Err(FullRunError::Command(CommandError::UnknownBody(BodyId(u32::MAX))))
        );
        // The same with a run that fell differently is seen.
        let push = Change::Push { body: BodyId(0), impulse: Vec3::X, at_point: None };
        let pushed = full_run(&bodies, [Command { key, change: push }], Environment::default(), 5);
        report.add_fresh(&timeline, pushed).unwrap();
        assert_eq!(report.mismatches, 4);
    }
}
