//! Recording: a timeline or a session in a file, and the same again from it.
//!
//! A file is a list of records, each with a checksum that goes on from the one before. Records are only ever added, so a session that
//! breaks off loses at most the last one. `docs/recording-format.md` describes the bytes.

mod decode;
mod encode;
mod error;
mod file;
pub(crate) mod large_shapes;
pub(crate) mod orders;
mod recorder;
mod replay;
pub(crate) mod start;
pub(crate) mod states;

use std::path::Path;

use forerun_timeline::parts::{Keep, TimelineParts};
use forerun_timeline::{Change, CommandError, Frame, Order, Timeline, TimelineSettings};

pub use decode::Recovered;
pub use error::{RecordingError, RecordingFault};
pub use recorder::Recorder;
pub use replay::{MarkDifference, Replay};

/// So many names may have been reserved between two that are used: who reads a file is not to run out of memory for one number in it.
const RESERVED_MAX: usize = 65_536;

/// What a recording file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// The timeline at the start.
    pub start: TimelineParts,
    /// What came after it, in the order in which it came.
    pub events: Vec<Event>,
}

/// What is recorded of a session after its start.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// An order that was obeyed, or an undo or redo that was tried in vain.
    Order(Order),
    /// What was so when all orders so far had been worked off to a frame.
    Mark(Mark),
    /// From here on it is another timeline: a fork was adopted, which may have had another past.
    Restart(Box<TimelineParts>),
}

/// A hash to compare a replay with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark {
    /// Where the display was: at most 2^53.
    pub display: Frame,
    /// The oldest frame that was kept.
    pub oldest: Frame,
    /// The frame that was hashed: at most past and lookahead after the displayed and the oldest one.
    pub frame: Frame,
    /// [`Timeline::state_hash`] of that frame.
    pub hash: u64,
}

impl Mark {
    /// What is so now: of the displayed frame, or the last one before it that is known to be true.
    #[must_use]
    pub fn of(timeline: &Timeline) -> Mark {
        let frame = timeline.display().max(timeline.oldest()).min(timeline.valid_to());
        Mark::at(timeline, frame)
    }

    fn at(timeline: &Timeline, frame: Frame) -> Mark {
        // A frame from the oldest to the last true one always has a hash.
        let hash = timeline.state_hash(frame).unwrap_or_default();
        Mark { display: timeline.display(), oldest: timeline.oldest(), frame, hash }
    }
}

/// How far after the oldest and the displayed frame a mark may be: a replay computes up to there.
fn mark_reach(settings: &TimelineSettings) -> u64 {
    u64::from(settings.past) + u64::from(settings.lookahead)
}

impl Recording {
    /// A timeline as it is now.
    #[must_use]
    pub fn of(timeline: &Timeline, keep: Keep) -> Recording {
        // The lookahead may have been longer once.
        let most = timeline.display().max(timeline.oldest()).plus(mark_reach(&timeline.settings()));
        let mark = Mark::at(timeline, timeline.valid_to().min(most));
        Recording { start: timeline.parts(keep), events: vec![Event::Mark(mark)] }
    }

    /// The timeline at the end of the recording: all orders are heard, and not yet worked off.
    ///
    /// # Errors
    /// When the recording holds what no timeline can be, or an order that cannot be obeyed.
    pub fn timeline(&self) -> Result<Timeline, RecordingError> {
        let mut timeline = Timeline::from_parts(self.start.clone()).map_err(RecordingError::impossible)?;
        for event in &self.events {
            match event {
                Event::Order(order) => {
                    let obeyed = obey(&mut timeline, order);
                    // What could not be undone in the session cannot be here, and is forgotten as it was there.
                    if !matches!(order, Order::Undo | Order::Redo) {
                        obeyed.map_err(|error| RecordingError::impossible(format!("an order: {error}")))?;
                    }
                }
                Event::Mark(mark) => {
                    timeline.set_display(mark.display);
                    // Their frames are still kept here, as nothing was computed; the session could not undo them any more.
                    timeline.forget_undo_to(mark.oldest);
                }
                Event::Restart(parts) => {
                    let made = Timeline::from_parts(TimelineParts::clone(parts));
                    timeline = made.map_err(RecordingError::impossible)?;
                }
            }
        }
        Ok(timeline)
    }
}

/// Obeys a recorded order. Names that were reserved for it are not recorded: they are reserved now.
fn obey(timeline: &mut Timeline, order: &Order) -> Result<(), CommandError> {
    if let Order::Submit(command) | Order::Replace(command) = order
        && let Some(body) = command.change.body()
    {
        let reserved = (body.0 as usize).min(timeline.names() + RESERVED_MAX);
        // A body that is added has a name by that.
        let count = reserved + usize::from(!matches!(command.change, Change::Add { .. }));
        while timeline.names() < count {
            timeline.reserve_body();
        }
    }
    timeline.obey(order.clone())
}

/// Saves a timeline: bodies, commands and, if wanted, all states that are known to be true. What was at `path` is replaced once
/// all is written.
///
/// ```
/// use forerun::{Keep, Scene, Timeline, TimelineSettings, load_timeline, save_timeline, timeline_of};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = std::env::temp_dir().join(format!("forerun-doc-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// # let path = folder.join("dominoes.forerun");
/// let mut timeline = timeline_of(&Scene::open("dominoes:20")?, TimelineSettings::default())?;
/// for _ in 0..30 {
///     timeline.advance();
/// }
/// save_timeline(&timeline, &path, Keep::States)?;
///
/// let mut again = load_timeline(&path)?;
/// timeline.advance();
/// again.advance();
/// assert!(timeline.diff(&again).is_none()); // it goes on bit for bit
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok(())
/// # }
/// ```
///
/// Recorded contacts are no part of it: they are found again when it is loaded, but for those of the oldest frame, so that what touches there
/// begins to touch at the next.
///
/// # Errors
/// When the file cannot be written.
pub fn save_timeline(timeline: &Timeline, path: impl AsRef<Path>, keep: Keep) -> Result<(), RecordingError> {
    Recording::of(timeline, keep).write(path)
}

/// Loads a timeline that [`save_timeline`] saved, or that a session ended with. It goes on bit for bit.
///
/// # Errors
/// When the file cannot be read, is no recording, is cut or corrupted, or holds what no timeline can be: byte, fault and remedy.
pub fn load_timeline(path: impl AsRef<Path>) -> Result<Timeline, RecordingError> {
    let path = path.as_ref();
    Recording::read(path)?.timeline().map_err(|error| error.in_file(path))
}
