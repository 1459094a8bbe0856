//! Questions: what physics is asked beside its work, and what it answered. Nobody waits for it.

use forerun::{
    Answer, Answered, BodyId, Change, DriverError, Frame, FrameInspection, Preview, Previewed, Question,
    Ticket,
};

use super::Play;

/// What was asked, and what is known.
#[derive(Debug, Default)]
pub(super) struct Questions {
    preview: Option<(Ticket, Preview)>,
    previewed: Option<Previewed>,
    /// Whether the answer is to what was asked last.
    preview_known: bool,
    inspection: Option<(Ticket, Asked)>,
    inspected: Option<(Asked, FrameInspection)>,
}

/// What tells one look into a frame from another: its states may have become others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Asked {
    frame: Frame,
    /// Whether the frame was known to be true.
    valid: bool,
    /// Body-frames that edits have cost so far.
    edited: u64,
}

impl Questions {
    pub(super) fn learn(&mut self, answers: Vec<Answered>) {
        for Answered { ticket, answer } in answers {
            match answer {
                Ok(Answer::Preview(previewed)) => {
                    if let Some((asked, _)) = self.preview.as_ref().filter(|(asked, _)| ticket <= *asked) {
                        self.preview_known = ticket == *asked;
                        self.previewed = Some(previewed);
                    }
                }
                Ok(Answer::Inspect(inspection)) => {
                    if let Some((_, asked)) = self.inspection.take_if(|(asked, _)| *asked == ticket) {
                        self.inspected = Some((asked, inspection));
                    }
                }
                // A frame that is not stored any more: the next picture asks again. Or a throw that is not possible: nothing comes of it.
                Err(_) => {
                    self.inspection.take_if(|(asked, _)| *asked == ticket);
                    if self.preview.as_ref().is_some_and(|(asked, _)| *asked == ticket) {
                        self.previewed = None;
                    }
                }
            }
        }
    }

    fn forget_preview(&mut self) {
        (self.preview, self.previewed, self.preview_known) = (None, None, false);
    }
}

impl Play {
    /// Asks what would come of changes at the next frame, for so many frames; what is known of it by then is in [`Play::preview`]. Asking the same
    /// again costs nothing.
    pub fn ask_preview(&mut self, changes: Vec<Change>, frames: u32, bodies: Vec<BodyId>) {
        if self.coupled.is_some() {
            return;
        }
        let preview = Preview { frame: self.edit_frame(), changes, frames, bodies };
        if self.questions.preview.as_ref().is_some_and(|(_, asked)| *asked == preview) {
            return;
        }
        match self.driver.ask(Question::Preview(preview.clone())) {
            Ok(ticket) => {
                self.questions.preview = Some((ticket, preview));
                self.questions.preview_known = false;
            }
            Err(error) => self.unanswered(&error),
        }
    }

    /// What is known of what would come of the changes that were asked about last, or of those before.
    #[must_use]
    pub fn preview(&self) -> Option<&Previewed> {
        self.questions.previewed.as_ref()
    }

    /// Whether that is the answer to what was asked last.
    #[must_use]
    pub fn is_preview_known(&self) -> bool {
        self.questions.preview_known
    }

    /// Nobody aims any more.
    pub fn forget_preview(&mut self) {
        self.questions.forget_preview();
    }

    /// Asks what is inside the frame that is shown. What is known of it by then, or of a frame shown shortly before, is in [`Play::inspection`].
    pub fn ask_inspection(&mut self) {
        let snapshot = &self.picture.snapshot;
        let frame = self.picture.frame.min(snapshot.horizon());
        let edited = self.picture.stats.edits.affected;
        let asked = Asked { frame, valid: snapshot.valid_to() > frame, edited };
        let known = self.questions.inspected.as_ref().is_some_and(|(known, _)| *known == asked);
        // The next one is asked when this one is answered, or all would be dropped for the newest.
        if known || self.questions.inspection.is_some() {
            return;
        }
        if self.coupled.is_some() {
            // Who waits for every step waits for this one too.
            self.questions.inspected = snapshot.inspect(frame).map(|inspection| (asked, inspection));
            return;
        }
        match self.driver.ask(Question::Inspect { frame }) {
            Ok(ticket) => self.questions.inspection = Some((ticket, asked)),
            Err(error) => self.unanswered(&error),
        }
    }

    /// What is inside a frame: the one that is shown, or one shortly before.
    #[must_use]
    pub fn inspection(&self) -> Option<&FrameInspection> {
        self.questions.inspected.as_ref().map(|(_, inspection)| inspection)
    }

    fn unanswered(&mut self, error: &DriverError) {
        self.notice.tell(error.to_string());
    }
}
