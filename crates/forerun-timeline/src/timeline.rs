//! The timeline: all states, the commands, and what is known to be true up to where.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use forerun_dynamics::{
    Body, BodyDef, BodyError, BodyId, BodyState, Environment, EnvironmentError, StepScratch, bounds,
};

use crate::affected::{Mutation, Scratch};
use crate::areas::{Areas, Until};
use crate::command_log::CommandLog;
use crate::commanding::FrameEffects;
use crate::definitions::Definitions;
use crate::frame_table::FrameTable;
use crate::order::UndoLog;
use crate::stale::Stale;
use crate::stats::{Advance, Edit, Stats};
use crate::tables::Tables;
use crate::{Change, CommandKey, Frame};

/// Edge of an area where no body says how large things are. Metres.
const AREA_EDGE_M: f32 = 2.0;

/// Of so many edits it is remembered what they cost.
pub(crate) const EDITS_KEPT: usize = 64;

/// How far a timeline looks ahead and back, and what it may cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimelineSettings {
    /// How many frames are computed beyond the display's. 1 or more, default 100.
    pub lookahead: u32,
    /// How many frames before the display's are kept, for commands that come late and for scrubbing. Default 100.
    pub past: u32,
    /// Most memory for states; `None` for as much as the frames need. Bytes. When it runs out, the oldest past goes first, then the
    /// lookahead gets shorter (see [`Stats::memory_bound`]); the display's frame and the next are always kept. Default `None`.
    pub bytes_max: Option<usize>,
    /// Edge of an area (a cell of the grid that says who is near). Metres, above 0; `None` chooses one from the bodies.
    pub area_m: Option<f32>,
    /// Whether it is stored who touched whom, where and how hard; see [`Snapshot::contacts`](crate::Snapshot::contacts). Costs 44 bytes a
    /// touching pair and frame in which something about it changes. Default `false`.
    pub record_contacts: bool,
}

impl Default for TimelineSettings {
    fn default() -> Self {
        TimelineSettings { lookahead: 100, past: 100, bytes_max: None, area_m: None, record_contacts: false }
    }
}

/// What a call of [`advance`](Timeline::advance) did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// One frame was computed or recomputed.
    Advanced(Advance),
    /// Everything is true up to the display frame plus the lookahead: nothing to do until a command comes or the display moves on.
    Idle,
}

/// All states of all bodies over frames, kept equal, bit for bit, to a full simulation with the same commands.
///
/// A clone is a [fork](Timeline::fork): it shares all states until they differ.
#[derive(Clone, Debug)]
pub struct Timeline {
    pub(crate) settings: TimelineSettings,
    pub(crate) display: Frame,
    pub(crate) tables: Tables,
    pub(crate) definitions: Arc<Definitions>,
    pub(crate) log: Arc<CommandLog>,
    pub(crate) undo: Arc<UndoLog>,
    /// By frame below the horizon: what of the step that leaves it is out of date.
    pub(crate) stale: BTreeMap<Frame, Stale>,
    /// By frame: what its commands did.
    pub(crate) effects: Arc<BTreeMap<Frame, Arc<FrameEffects>>>,
    pub(crate) areas: Areas,
    pub(crate) scratch: Scratch,
    pub(crate) step_scratch: StepScratch,
    /// Of the local user's next command.
    pub(crate) next_sequence: u64,
    pub(crate) stats: Stats,
    /// The last edits; the last is the one that is being worked off, if any is.
    pub(crate) edits: Arc<VecDeque<Edit>>,
    /// Whether the lookahead was cut for lack of memory since the display last moved.
    pub(crate) shrunk: bool,
    /// Whether past was forgotten for lack of memory that the number of frames would keep.
    pub(crate) memory_cut: bool,
    pub(crate) mutation: Mutation,
    pub(crate) recompute_all: bool,
}

impl Timeline {
    /// A timeline of the bodies, named 0, 1, 2, ... in their order, at frame 0.
    ///
    /// # Errors
    /// When the environment or a body is not possible; the field, and the index of the body.
    pub fn new(
        bodies: &[BodyDef],
        environment: Environment,
        settings: TimelineSettings,
    ) -> Result<Timeline, TimelineError> {
        environment.check().map_err(TimelineError::Environment)?;
        let mut made = Vec::with_capacity(bodies.len());
        let mut states = Vec::with_capacity(bodies.len());
        for (index, def) in bodies.iter().enumerate() {
            let (body, state) = Body::new(def).map_err(|error| TimelineError::Body { index, error })?;
            made.push((Arc::new(def.clone()), Arc::new(body)));
            states.push(state);
        }
        let edge_m = settings.area_m.filter(|edge| *edge > 0.0 && edge.is_finite());
        let mut areas = Areas::new(edge_m.unwrap_or_else(|| area_edge(made.iter().map(|(_, body)| &**body))));
        for (index, ((_, body), state)) in made.iter().zip(&states).enumerate() {
            let bound = bounds::swept_bound(body, state, &environment);
            areas.visit(BodyId(index as u32), Frame(0), Some(&bound), Until::FurtherNotice);
        }
        Ok(Timeline {
            settings: TimelineSettings { lookahead: settings.lookahead.max(1), ..settings },
            display: Frame(0),
            tables: Tables::new(Frame(0), Arc::new(FrameTable::new(&states))),
            definitions: Arc::new(Definitions::new(made, environment)),
            log: Arc::default(),
            undo: Arc::default(),
            stale: BTreeMap::new(),
            effects: Arc::default(),
            areas,
            scratch: Scratch::default(),
            step_scratch: StepScratch::default(),
            next_sequence: 0,
            stats: Stats::default(),
            edits: Arc::default(),
            shrunk: false,
            memory_cut: false,
            mutation: Mutation::None,
            recompute_all: false,
        })
    }

    /// A name for a body to be added, different from all others.
    pub fn reserve_body(&mut self) -> BodyId {
        let names = self.definitions.names();
        Arc::make_mut(&mut self.definitions).reserve(names + 1);
        BodyId(names as u32)
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

    /// How far the timeline looks ahead and back.
    #[must_use]
    pub fn settings(&self) -> TimelineSettings {
        self.settings
    }

    /// The oldest frame kept. Commands act after it.
    #[must_use]
    pub fn oldest(&self) -> Frame {
        self.tables.oldest()
    }

    /// The last frame computed.
    #[must_use]
    pub fn horizon(&self) -> Frame {
        self.tables.horizon()
    }

    /// The last frame that is known to be true for all bodies.
    #[must_use]
    pub fn valid_to(&self) -> Frame {
        self.stale.first_key_value().map_or(self.horizon(), |(frame, _)| *frame)
    }

    /// The stored state of a body, after the commands of the frame; `None` when there is none.
    #[must_use]
    pub fn state(&self, body: BodyId, frame: Frame) -> Option<&BodyState> {
        self.tables.get(frame)?.get(body)
    }

    /// The body as it is from this frame to the next; `None` when it does not exist then.
    #[must_use]
    pub fn body_at(&self, body: BodyId, frame: Frame) -> Option<&Arc<Body>> {
        self.definitions.body(body, frame)
    }

    /// Gravity and settings as they are from this frame to the next.
    #[must_use]
    pub fn environment_at(&self, frame: Frame) -> Environment {
        self.definitions.environment(frame)
    }

    /// The bodies that are stored at a frame, in the order of their ids; none when the frame is not stored.
    #[must_use]
    pub fn bodies_at(&self, frame: Frame) -> Vec<BodyId> {
        let table = self.tables.get(frame);
        table.into_iter().flat_map(|table| table.iter().map(|(body, _)| body)).collect()
    }

    /// How many names of bodies are in use; ids are below it.
    #[must_use]
    pub fn names(&self) -> usize {
        self.definitions.names()
    }

    /// The sequence number of the local user's (source 0) next command: above that of all of them accepted so far.
    #[must_use]
    pub fn next_sequence(&self) -> u64 {
        self.next_sequence
    }

    /// The accepted commands that act after the oldest frame, in the order in which they act.
    pub fn commands(&self) -> impl Iterator<Item = (&CommandKey, &Change)> {
        self.log.iter()
    }

    /// What has been done so far, and what is kept.
    #[must_use]
    pub fn stats(&self) -> Stats {
        Stats {
            last_edit: self.edits.back().copied().unwrap_or_default(),
            past_frames: self.display.since(self.oldest()),
            lookahead_frames: self.horizon().since(self.display),
            state_bytes: self.state_bytes(),
            memory_bound: self.is_memory_bound(),
            ..self.stats
        }
    }

    /// What the last 64 batches of commands cost, the latest last: that one may not be worked off yet.
    pub fn edits(&self) -> impl DoubleEndedIterator<Item = &Edit> {
        self.edits.iter()
    }

    /// Memory of all stored states. Bytes.
    #[must_use]
    pub fn state_bytes(&self) -> usize {
        self.tables.bytes()
    }

    /// An accepted command that acts after the oldest frame.
    #[must_use]
    pub fn command(&self, key: &CommandKey) -> Option<&Change> {
        self.log.get(key)
    }

    pub(crate) fn table(&self, frame: Frame) -> &Arc<FrameTable> {
        self.tables.at(frame)
    }

    pub(crate) fn count(&mut self, done: &Advance, quarantined: u32) {
        if done.extended {
            self.stats.ahead.add(done, quarantined);
        } else {
            self.stats.edits.add(done, quarantined);
            if let Some(edit) = Arc::make_mut(&mut self.edits).back_mut() {
                edit.add(done);
            }
        }
        self.stats.slices_max = self.stats.slices_max.max(done.slices_max);
    }

    /// Leaves out a rule, to show that tests notice.
    #[doc(hidden)]
    pub fn mutate(&mut self, mutation: Mutation) {
        self.mutation = mutation;
    }

    /// From now on computes all bodies in every frame and trusts nothing stored: the reference that the rest is compared with.
    #[doc(hidden)]
    pub fn recompute_all(&mut self) {
        self.recompute_all = true;
    }
}

/// An edge of areas that suits the bodies: four times the radius of the middle one of those that move. Metres.
pub(crate) fn area_edge<'a>(bodies: impl Iterator<Item = &'a Body>) -> f32 {
    let mut radii: Vec<f32> =
        bodies.filter(|b| b.is_dynamic() && b.radius.is_finite()).map(|b| b.radius).collect();
    radii.sort_unstable_by(f32::total_cmp);
    radii.get(radii.len() / 2).map_or(AREA_EDGE_M, |radius| (4.0 * radius).clamp(1e-3, 1e6))
}

/// What of a new timeline is not possible, and why.
#[derive(Clone, Debug, PartialEq)]
pub enum TimelineError {
    /// Gravity or a setting.
    Environment(EnvironmentError),
    /// A body.
    Body {
        /// Index of the body in the given list.
        index: usize,
        /// What is wrong with it.
        error: BodyError,
    },
}

impl std::fmt::Display for TimelineError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            TimelineError::Environment(error) => write!(f, "environment: {error}"),
            TimelineError::Body { index, error } => write!(f, "body {index}: {error}"),
        }
    }
}

impl std::error::Error for TimelineError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Progress;
    use forerun_geometry::Vec3;
    use forerun_geometry::shape::{Shape, Sphere};

    #[test]
    fn definitions_are_copied_only_where_there_is_something_to_forget() {
        let bodies = [BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 }))];
        let settings = TimelineSettings { lookahead: 20, past: 2, ..TimelineSettings::default() };
        let mut timeline = Timeline::new(&bodies, Environment::default(), settings).unwrap();
        timeline.change(Frame(8), Change::SetGravity { gravity: Vec3::X }).unwrap();
        timeline.change(Frame(10), Change::SetGravityScale { body: BodyId(0), scale: 0.5 }).unwrap();
        while timeline.advance() != Progress::Idle {}
        let mut copied = Vec::new();
        for display in 1..16 {
            let snapshot = timeline.snapshot();
            let before = Arc::clone(&timeline.definitions);
            timeline.set_display(Frame(display));
            if !Arc::ptr_eq(&before, &timeline.definitions) {
                copied.push(timeline.oldest().0);
            }
            drop(snapshot);
        }
        assert_eq!(copied, [8, 10]);
        assert_eq!(timeline.environment_at(Frame(13)).gravity, Vec3::X);
    }
}
