//! Marks: what a display draws along the time: the commands, what they cost, what can be undone, and what waits to be recomputed.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use crate::command_log::{CommandsByFrame, in_order};
use crate::{Change, CommandKey, Edit, Frame, Snapshot, Timeline};

/// What a snapshot knows of the commands. A copy shares all of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Marks {
    pub(crate) commands: Arc<CommandsByFrame>,
    pub(crate) edits: Arc<VecDeque<Edit>>,
    pub(crate) can_undo: bool,
    pub(crate) can_redo: bool,
}

impl Timeline {
    pub(crate) fn marks(&self) -> Marks {
        Marks {
            commands: Arc::clone(self.log.by_frame()),
            edits: Arc::clone(&self.edits),
            can_undo: !self.undo.undo.is_empty(),
            can_redo: !self.undo.redo.is_empty(),
        }
    }
}

impl Snapshot {
    /// The accepted commands that act after the oldest frame, also beyond the horizon, in the order in which they act.
    pub fn commands(&self) -> impl Iterator<Item = (&CommandKey, &Change)> {
        in_order(&self.marks.commands)
    }

    /// Whether the local user has ordered something whose frame is kept and that can be undone.
    #[must_use]
    pub fn can_undo(&self) -> bool {
        self.marks.can_undo
    }

    /// Whether something was undone that can be done again.
    #[must_use]
    pub fn can_redo(&self) -> bool {
        self.marks.can_redo
    }

    /// What the last 64 batches of commands cost, the latest last: that one may not be worked off yet.
    pub fn edits(&self) -> impl DoubleEndedIterator<Item = &Edit> {
        self.marks.edits.iter()
    }

    /// What is out of date: so many bodies wait to be recomputed after such a frame, the last at which they are known to be true. Sorted by frame; empty
    /// when everything is true up to the horizon. Whom these bodies will reach is not known yet.
    #[must_use]
    pub fn waiting(&self) -> Vec<(Frame, u32)> {
        let mut waiting: BTreeMap<Frame, u32> = BTreeMap::new();
        for doubt in &self.doubtful {
            *waiting.entry(doubt.known_to).or_default() += 1;
        }
        waiting.into_iter().collect()
    }
}
