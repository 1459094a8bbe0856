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
    /// Orders that were refused: none that the recorded session obeyed should be.
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
        self.refused == 0 && self.differences.is_empty()
    }
}

impl Recording {
    /// Computes everything again from the start on, and compares it with the recorded hashes. States in the recording are not looked at.
    /// Calls `at` after each mark with its frame.
    ///
    /// # Errors
    /// When the recording holds what no timeline can be.
    pub fn replay(&self, at: &mut dyn FnMut(Frame)) -> Result<Replay, RecordingError> {
        let settings = TimelineSettings { lookahead: u32::MAX, bytes_max: None, ..self.start.settings };
        let start = TimelineParts { settings, frames: Vec::new(), ..self.start.clone() };
        let mut timeline = Timeline::from_parts(start).map_err(RecordingError::impossible)?;
        let mut replay = Replay::default();
        for event in &self.events {
            match event {
                Event::Order(order) => match timeline.obey(order.clone()) {
                    Ok(()) => replay.orders += 1,
                    Err(_) => replay.refused += 1,
                },
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
