//! Replay: everything is computed again from a recording's orders, and compared with its hashes.

use forerun_timeline::parts::TimelineParts;
use forerun_timeline::{Frame, Progress, Timeline, TimelineSettings};

use super::error::RecordingError;
use super::{Event, Mark, Recording};

/// What a replay came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replay {
    /// Orders that were obeyed.
    pub orders: u64,
    /// Orders that were refused. The recorded session obeyed them, but may have asked before it knew that they come to nothing.
    pub refused: u64,
    /// Hashes that were compared.
    pub marks: u64,
    /// Those that are different.
    pub differences: Vec<MarkDifference>,
    /// The last frame that was computed.
    pub last: Frame,
    /// The hash of the last frame that was compared, in this replay.
    pub hash: Option<u64>,
}

/// A hash that is different in the replay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MarkDifference {
    /// What was recorded.
    pub mark: Mark,
    /// The hash of the same frame in the replay; `None` when it cannot be computed.
    pub found: Option<u64>,
}

impl Replay {
    /// Whether the session came out as it was recorded.
    #[must_use]
    pub fn is_same(&self) -> bool {
        self.differences.is_empty()
    }
}

impl Recording {
    /// Computes everything again from the start on, and compares it with the recorded hashes. States in the recording are not looked at.
    /// Calls `at` after each mark with its frame.
    ///
    /// # Errors
    /// When the recording holds what no timeline can be.
    pub fn replay(&self, at: &mut dyn FnMut(Frame)) -> Result<Replay, RecordingError> {
        let mut timeline = bare(&self.start)?;
        let mut replay = Replay::default();
        for event in &self.events {
            match event {
                Event::Order(order) => match super::obey(&mut timeline, order) {
                    Ok(()) => replay.orders += 1,
                    Err(_) => replay.refused += 1,
                },
                Event::Restart(parts) => timeline = bare(parts)?,
                Event::Mark(mark) => {
                    let found = go_to(&mut timeline, mark);
                    replay.marks += 1;
                    if found != Some(mark.hash) {
                        replay.differences.push(MarkDifference { mark: *mark, found });
                    }
                    (replay.hash, replay.last) = (found, timeline.horizon());
                    at(mark.frame);
                }
            }
        }
        Ok(replay)
    }
}

/// A timeline that computes all it is asked for, from its first states alone.
fn bare(parts: &TimelineParts) -> Result<Timeline, RecordingError> {
    let settings = TimelineSettings { lookahead: u32::MAX, bytes_max: None, ..parts.settings };
    let parts = TimelineParts { settings, frames: Vec::new(), ..parts.clone() };
    Timeline::from_parts(parts).map_err(RecordingError::impossible)
}

/// Computes what a mark is about; its hash.
fn go_to(timeline: &mut Timeline, mark: &Mark) -> Option<u64> {
    while timeline.valid_to() < mark.frame {
        if timeline.advance() == Progress::Idle {
            return None;
        }
    }
    let found = timeline.state_hash(mark.frame);
    // Forgets what the session had forgotten, and no more: later orders may act right after that.
    let past = u64::from(timeline.settings().past);
    timeline.set_display(mark.oldest.plus(past));
    found
}
