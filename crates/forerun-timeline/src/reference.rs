//! Reference: full simulations, and whether a timeline has their bits.
//!
//! A full simulation shares with the timeline the step and what commands do, and nothing of what decides which bodies are computed: it
//! computes all bodies together in every frame, and where a command wakes who is near, it asks everybody.

use std::fmt;
use std::sync::Arc;

use forerun_dynamics::{BodyDef, BodyId, BodyState, Environment};

use crate::frame_table::same_entry;
use crate::hearing::NAMES_AHEAD;
use crate::{Change, Command, CommandError, Frame, Progress, Timeline, TimelineError, TimelineSettings};

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

/// Computes until everything is true.
pub(crate) fn run(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}
