//! Inquiry: questions about what physics knows, answered later and beside it.
//!
//! What is inside a frame, and what would happen if, cost whole steps: nobody who draws can wait for them, and physics has better to do. So the
//! display asks, goes on, and finds the answer at a later picture. Of each kind of question the newest is the one that counts.

use std::fmt;
use std::sync::Arc;

use forerun_timeline::{CommandError, FrameInspection, Preview, PreviewRun, Previewed, Snapshot, Timeline};

use crate::Frame;

/// A question about what physics knows.
#[derive(Clone, Debug, PartialEq)]
pub enum Question {
    /// What is inside the step that leaves a stored frame.
    Inspect {
        /// The frame.
        frame: Frame,
    },
    /// What would happen if.
    Preview(Preview),
}

/// What there is to say.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// What is inside the frame.
    Inspect(FrameInspection),
    /// What would happen.
    Preview(Previewed),
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum InquiryError {
    /// The frame to be looked into is not stored.
    NotStored {
        /// The frame.
        frame: Frame,
        /// The oldest frame that was stored.
        oldest: Frame,
        /// The last frame that was stored.
        horizon: Frame,
    },
    /// A change of the preview is not possible.
    Command(CommandError),
}

/// Which question an answer is to. Later questions have higher numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Ticket(pub u64);

/// An answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Answered {
    /// To which question.
    pub ticket: Ticket,
    /// What there is to say, or why there is nothing.
    pub answer: Result<Answer, InquiryError>,
}

impl fmt::Display for InquiryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            InquiryError::NotStored { frame, oldest, horizon } => {
                write!(f, "{frame} is not stored: ask for one from {oldest} to {horizon}")
            }
            InquiryError::Command(error) => write!(f, "preview: {error}"),
        }
    }
}

impl std::error::Error for InquiryError {}

/// A preview that takes longer, while a newer one waits, is answered as far as it is known. Seconds.
const PATIENCE_S: f64 = 0.1;

/// Works at questions, about a frame at a time, in whatever thread it is called.
#[derive(Debug, Default)]
pub(super) struct Inquirer {
    inspect: Option<(Ticket, Arc<Snapshot>, Frame)>,
    preview: Option<(Ticket, Timeline, Preview)>,
    running: Option<Running>,
    /// Whether the last work was an inspection: then it is the preview's turn.
    inspected: bool,
}

/// A preview on its way.
#[derive(Debug)]
struct Running {
    ticket: Ticket,
    run: PreviewRun,
    since_s: f64,
}

impl Inquirer {
    /// Takes a question; one of its kind that waits is forgotten.
    pub(super) fn ask_inspect(&mut self, ticket: Ticket, snapshot: Arc<Snapshot>, frame: Frame) {
        self.inspect = Some((ticket, snapshot, frame));
    }

    pub(super) fn ask_preview(&mut self, ticket: Ticket, fork: Timeline, preview: Preview) {
        self.preview = Some((ticket, fork, preview));
    }

    /// Whether nothing is asked.
    pub(super) fn is_idle(&self) -> bool {
        self.inspect.is_none() && !self.previews()
    }

    fn previews(&self) -> bool {
        self.preview.is_some() || self.running.is_some()
    }

    /// Does a frame's worth of work; an answer, once there is one. `now_s` is a clock (seconds).
    pub(super) fn work(&mut self, now_s: f64) -> Option<Answered> {
        if !(self.inspected && self.previews())
            && let Some((ticket, snapshot, frame)) = self.inspect.take()
        {
            self.inspected = true;
            return Some(Answered { ticket, answer: inspect(&snapshot, frame) });
        }
        self.inspected = false;
        if self.running.is_none()
            && let Some((ticket, fork, preview)) = self.preview.take()
        {
            match PreviewRun::new(fork, preview) {
                Ok(run) => self.running = Some(Running { ticket, run, since_s: now_s }),
                Err(error) => return Some(Answered { ticket, answer: Err(InquiryError::Command(error)) }),
            }
        }
        let running = self.running.as_mut()?;
        let more = running.run.advance();
        // A newer one waits: what is known by now is better than what nobody asks for any more.
        let impatient = self.preview.is_some() && now_s - running.since_s >= PATIENCE_S;
        if more && !impatient {
            return None;
        }
        let Running { ticket, run, .. } = self.running.take()?;
        Some(Answered { ticket, answer: Ok(Answer::Preview(run.so_far())) })
    }
}

fn inspect(snapshot: &Snapshot, frame: Frame) -> Result<Answer, InquiryError> {
    let (oldest, horizon) = (snapshot.oldest(), snapshot.horizon());
    let inspection = snapshot.inspect(frame).ok_or(InquiryError::NotStored { frame, oldest, horizon })?;
    Ok(Answer::Inspect(inspection))
}

pub(super) mod desk;
#[cfg(test)]
mod tests;
