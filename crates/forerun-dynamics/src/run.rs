//! Run: what a run through a frame, or through its slices, writes, and what it is asked to note.

use crate::close_up::CloseUp;
use crate::solver::Batch;
use crate::touch::Ledger;
use crate::{BodyState, Observer};

/// Where the states of a run go, and what it did.
pub(crate) struct Run<'a> {
    pub(crate) observer: &'a mut dyn Observer,
    /// By member of the group.
    pub(crate) next: &'a mut [BodyState],
    /// Where somebody asks for touches.
    pub(crate) notes: Option<Ledger>,
    /// Where somebody looks into the step.
    pub(crate) close_up: Option<CloseUp>,
    /// Islands that ended too deep and may still be cut finer.
    pub(crate) too_deep: Vec<u32>,
}

/// What batches add up for those who ask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Recorded {
    Nothing,
    Impulses,
    Friction,
}

impl Run<'_> {
    /// What its batches are to add up.
    pub(crate) fn recorded(&self) -> Recorded {
        match (&self.close_up, &self.notes) {
            (Some(_), _) => Recorded::Friction,
            (None, Some(_)) => Recorded::Impulses,
            (None, None) => Recorded::Nothing,
        }
    }
}

impl Recorded {
    /// Has a batch do it.
    pub(crate) fn by(self, batch: &mut Batch) {
        if self != Recorded::Nothing {
            batch.record_impulses();
        }
        if self == Recorded::Friction {
            batch.record_friction();
        }
    }
}
