//! The timeline: all states, the commands, and what is known to be true up to where.

use std::sync::Arc;

use forerun_dynamics::{Body, BodyDef, BodyError, BodyId, BodyState, Environment};

use crate::{Change, Command, CommandError, CommandKey, Frame, Snapshot};

/// How far a timeline looks ahead and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimelineSettings {
    /// How many frames are computed beyond the display's. 1 or more, default 100.
    pub lookahead: u32,
    /// How many frames before the display's are kept, for commands that come late and for scrubbing. Default 100.
    pub past: u32,
    /// Edge of an area (a cell of the grid that says who is near). Metres, above 0; `None` chooses one from the bodies.
    pub area_m: Option<f32>,
}

impl Default for TimelineSettings {
    fn default() -> Self {
        TimelineSettings { lookahead: 100, past: 100, area_m: None }
    }
}

/// What a call of [`Timeline::advance`] did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// One frame was computed or recomputed.
    Advanced(Advance),
    /// Everything is true up to the display frame plus the lookahead: nothing to do until a command comes or the display moves on.
    Idle,
}

/// One frame of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Advance {
    /// The frame whose states were computed.
    pub frame: Frame,
    /// Bodies that were advanced to it.
    pub recomputed: u32,
    /// Bodies whose state there is another one than before; of a new frame: that moved.
    pub affected: u32,
    /// Most slices that an island's frame was cut into.
    pub slices_max: u32,
    /// Whether the frame is a new one, beyond the old horizon.
    pub extended: bool,
}

/// Sums of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Body-frames whose stored bits were replaced by others.
    pub affected: u64,
    /// Body-frames that were advanced.
    pub recomputed: u64,
    /// Frames that were worked on.
    pub frames: u64,
    /// Bodies that were stopped because their next state was not finite, each time it happened.
    pub quarantined: u64,
}

/// What a timeline has done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Work on new frames.
    pub ahead: Counters,
    /// Re-simulation, all together.
    pub edits: Counters,
    /// Re-simulation for the last batch of commands: those that came before everything was true again.
    pub last_edit: Counters,
    /// Commands in force that did nothing: their body was not there, or the result would not have been finite.
    pub ignored: u64,
    /// Most slices that an island's frame was cut into.
    pub slices_max: u32,
}

/// All states of all bodies over frames, kept equal, bit for bit, to a full simulation with the same commands.
#[derive(Clone, Debug)]
pub struct Timeline {
    settings: TimelineSettings,
    environment: Environment,
    bodies: Vec<Arc<Body>>,
    states: Vec<BodyState>,
    display: Frame,
    next_sequence: u64,
}

impl Timeline {
    /// A timeline of the bodies, named 0, 1, 2, ... in their order, at frame 0.
    ///
    /// # Errors
    /// When a body is not possible; the index and what is wrong with it.
    pub fn new(
        bodies: &[BodyDef],
        environment: Environment,
        settings: TimelineSettings,
    ) -> Result<Timeline, TimelineError> {
        let mut made = Vec::new();
        let mut states = Vec::new();
        for (index, def) in bodies.iter().enumerate() {
            let (body, state) = Body::new(def).map_err(|error| TimelineError { index, error })?;
            made.push(Arc::new(body));
            states.push(state);
        }
        Ok(Timeline { settings, environment, bodies: made, states, display: Frame(0), next_sequence: 0 })
    }

    /// A name for a body to be added.
    pub fn reserve_body(&mut self) -> BodyId {
        BodyId(self.bodies.len() as u32)
    }

    /// Accepts a command. It acts when its frame is next computed: call [`Timeline::advance`].
    ///
    /// # Errors
    /// When it cannot be obeyed; then nothing changed.
    pub fn submit(&mut self, command: Command) -> Result<(), CommandError> {
        let _ = command;
        Ok(())
    }

    /// Accepts commands in turn.
    ///
    /// # Errors
    /// At the first that cannot be obeyed; those before it are accepted.
    pub fn submit_all(&mut self, commands: impl IntoIterator<Item = Command>) -> Result<(), CommandError> {
        commands.into_iter().try_for_each(|command| self.submit(command))
    }

    /// Accepts a change by the local user (source 0, the next sequence number).
    ///
    /// # Errors
    /// As [`Timeline::submit`].
    pub fn change(&mut self, frame: Frame, change: Change) -> Result<CommandKey, CommandError> {
        let key = CommandKey { frame, source: 0, sequence: self.next_sequence };
        self.next_sequence += 1;
        self.submit(Command { key, change })?;
        Ok(key)
    }

    /// Computes one frame: the earliest that is out of date, or else a new one.
    pub fn advance(&mut self) -> Progress {
        Progress::Idle
    }

    /// Tells where the display is. Frames older than `past` before it are forgotten, unless the physics still needs them.
    pub fn set_display(&mut self, frame: Frame) {
        self.display = self.display.max(frame);
    }

    /// Where the display is.
    #[must_use]
    pub fn display(&self) -> Frame {
        self.display
    }

    /// Changes how many frames are computed beyond the display's (1 or more). What is already computed stays.
    pub fn set_lookahead(&mut self, frames: u32) {
        self.settings.lookahead = frames.max(1);
    }

    /// The oldest frame kept. Commands act after it.
    #[must_use]
    pub fn oldest(&self) -> Frame {
        Frame(0)
    }

    /// The last frame computed.
    #[must_use]
    pub fn horizon(&self) -> Frame {
        Frame(0)
    }

    /// The last frame that is known to be true for all bodies.
    #[must_use]
    pub fn valid_to(&self) -> Frame {
        Frame(0)
    }

    /// The stored state of a body, after the commands of the frame; `None` when there is none.
    #[must_use]
    pub fn state(&self, body: BodyId, frame: Frame) -> Option<&BodyState> {
        self.states.get(body.0 as usize).filter(|_| frame == Frame(0))
    }

    /// The body as it is from this frame to the next; `None` when it does not exist then.
    #[must_use]
    pub fn body_at(&self, body: BodyId, frame: Frame) -> Option<&Arc<Body>> {
        self.bodies.get(body.0 as usize).filter(|_| frame == Frame(0))
    }

    /// Gravity and settings as they are from this frame to the next.
    #[must_use]
    pub fn environment_at(&self, frame: Frame) -> Environment {
        let _ = frame;
        self.environment
    }

    /// The bodies that exist at a frame, in the order of their ids.
    #[must_use]
    pub fn bodies_at(&self, frame: Frame) -> Vec<BodyId> {
        let _ = frame;
        (0..self.bodies.len() as u32).map(BodyId).collect()
    }

    /// An immutable picture of the whole, for the display. Cheap.
    #[must_use]
    pub fn snapshot(&self) -> Arc<Snapshot> {
        Arc::new(Snapshot {
            oldest: self.oldest(),
            horizon: self.horizon(),
            valid_to: self.valid_to(),
            frame_seconds: self.environment.settings.frame_seconds,
        })
    }

    /// What has been done so far.
    #[must_use]
    pub fn stats(&self) -> Stats {
        Stats::default()
    }

    /// How many areas are active at a frame: a body that moves is in them (dissertation, section 4.1).
    #[must_use]
    pub fn areas_active(&self, frame: Frame) -> u32 {
        let _ = frame;
        0
    }
}

/// Which body of a new timeline is not possible, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct TimelineError {
    /// Index of the body in the given list.
    pub index: usize,
    /// What is wrong with it.
    pub error: BodyError,
}

impl std::fmt::Display for TimelineError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "body {}: {}", self.index, self.error)
    }
}

impl std::error::Error for TimelineError {}
