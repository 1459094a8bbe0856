//! Questions: what the display asks about what physics knows, and finds answered at a later picture. None of it waits.

use std::sync::Arc;

use super::Decoupled;
use crate::BodyId;
use crate::driver::driver_error::DriverError;
use crate::driver::inquiry::desk::{AskedInspection, Inquiry};
use crate::driver::inquiry::{Answered, Question, Ticket};
use crate::driver::stage_times::StageTimes;

impl Decoupled {
    /// Asks a question. What is stored, and what was ordered before, counts as it is now. Of each kind the newest question wins: an older one that still
    /// waits is never answered. The first question starts the thread that answers, which is the only thing to wait for.
    ///
    /// # Errors
    /// [`DriverError::Panicked`], [`DriverError::AnswersPanicked`]; [`DriverError::NotStarted`] when the system refuses a thread.
    pub fn ask(&mut self, question: Question) -> Result<Ticket, DriverError> {
        self.alive()?;
        let inquiry = match &mut self.inquiry {
            Some(inquiry) => inquiry,
            none => none.insert(Inquiry::start()?),
        };
        let ticket = Ticket(self.tickets);
        match question {
            Question::Inspect { frame } => {
                let snapshot = Arc::clone(&self.shared.published.load().snapshot);
                inquiry.ask_inspection(AskedInspection { ticket, snapshot, frame })?;
            }
            Question::Preview(preview) => self.shared.ask_preview(inquiry.preview(ticket, preview)?),
        }
        self.tickets += 1;
        Ok(ticket)
    }

    /// What was answered since the last call; empty when nothing was asked. When nobody takes the answers for long, the latest are lost.
    ///
    /// # Errors
    /// [`DriverError::AnswersPanicked`] when the thread that answers has panicked: a question that waits will not be answered.
    pub fn answers(&mut self) -> Result<Vec<Answered>, DriverError> {
        self.inquiry.as_ref().map_or_else(|| Ok(Vec::new()), Inquiry::answers)
    }

    /// The name that the next body added will get, unless somebody else is given it first. It is not used up: this is the name for a body in a
    /// [`Preview`](crate::Preview) of adding it.
    #[must_use]
    pub fn coming_body(&self) -> BodyId {
        self.names.coming_body()
    }

    /// Adds to `found` how long the stages of the frames took that physics computed, from the one with this number on, as far as they are kept (the last
    /// 1024). Returns the number to ask from the next time. Nothing without
    /// [`DecoupledSettings::stage_clock`](crate::DecoupledSettings::stage_clock).
    pub fn stage_times(&self, from: u64, found: &mut Vec<StageTimes>) -> u64 {
        self.shared.stage_times.read(from, found)
    }
}
