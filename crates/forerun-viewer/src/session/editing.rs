//! Editing: values of a body that are dragged in a panel. However often a value changes while it is dragged, it is one command, at the frame where
//! the drag began; each change of the value takes the place of the one before.

use std::mem::discriminant;

use forerun::Change;

use super::Play;
use super::acts::{Last, label_of};

/// A value that is being changed.
#[derive(Clone, Debug)]
pub(super) struct Editing {
    /// What was said last.
    change: Change,
    last: Option<Last>,
}

impl Play {
    /// Sets a value. As long as the same one is set again, and the edit has not ended, it stays one command.
    pub fn edit(&mut self, change: Change) {
        let same = |editing: &Editing| {
            editing.change.body() == change.body() && discriminant(&editing.change) == discriminant(&change)
        };
        if !self.editing.as_ref().is_some_and(same) {
            self.end_edit();
            self.begin(label_of(&change));
        }
        let last = self.editing.take().and_then(|editing| editing.last);
        let now = self.give_instead(last, change.clone());
        if last.is_none() {
            self.show_edit(now);
        }
        self.editing = Some(Editing { change, last: now });
    }

    /// What is being set, and was said last: what a panel shows until the scene does.
    #[must_use]
    pub fn edited(&self) -> Option<&Change> {
        self.editing.as_ref().map(|editing| &editing.change)
    }

    /// Nobody changes the value any more: the next change is another step.
    pub fn end_edit(&mut self) {
        if self.editing.take().is_some() {
            self.end();
        }
    }
}
