//! Marks: the commands and what they cost, as what differs from another snapshot.

use std::collections::VecDeque;
use std::sync::Arc;

use super::{DeltaError, SnapshotDelta, wrong};
use crate::command_log::CommandsByFrame;
use crate::marks::Marks;
use crate::{Change, CommandKey, Edit, Frame};

/// What is in force at a frame.
type Commands = Vec<(CommandKey, Arc<Change>)>;

/// The frames with other commands.
pub(super) fn commands_delta(
    before: Option<&CommandsByFrame>,
    after: &CommandsByFrame,
) -> Vec<(Frame, Commands)> {
    if before.is_some_and(|before| std::ptr::eq(before, after)) {
        return Vec::new();
    }
    let nothing = CommandsByFrame::new();
    let before = before.unwrap_or(&nothing);
    let gone = before.keys().filter(|frame| !after.contains_key(frame)).map(|frame| (*frame, Vec::new()));
    let other =
        after.iter().filter(|(frame, now)| !before.get(frame).is_some_and(|old| Arc::ptr_eq(old, now)));
    let other = other.map(|(frame, now)| (*frame, Commands::clone(now)));
    let mut commands: Vec<_> = gone.chain(other).collect();
    commands.sort_unstable_by_key(|(frame, _)| *frame);
    commands
}

pub(super) fn edits_delta(
    before: Option<&Arc<VecDeque<Edit>>>,
    after: &Arc<VecDeque<Edit>>,
) -> Option<Vec<Edit>> {
    let same = before.is_some_and(|before| Arc::ptr_eq(before, after));
    (!same).then(|| after.iter().copied().collect())
}

/// The marks that a delta leads to.
pub(super) fn apply(before: Option<&Marks>, delta: &SnapshotDelta) -> Result<Marks, DeltaError> {
    let mut marks = before.cloned().unwrap_or_default();
    (marks.can_undo, marks.can_redo) = delta.undoable;
    if let Some(edits) = &delta.edits {
        marks.edits = Arc::new(edits.iter().copied().collect());
    }
    if delta.commands.is_empty() {
        return Ok(marks);
    }
    let by_frame = Arc::make_mut(&mut marks.commands);
    for (frame, commands) in &delta.commands {
        let of_frame = commands.iter().all(|(key, _)| key.frame == *frame);
        if !of_frame || !commands.is_sorted_by(|(a, _), (b, _)| a < b) {
            return Err(wrong("commands", format!("those of {frame} are not in their order")));
        }
        for (_, change) in commands {
            change.check_numbers().map_err(|error| wrong("commands", error))?;
        }
        if commands.is_empty() {
            by_frame.remove(frame);
        } else {
            by_frame.insert(*frame, Arc::new(commands.clone()));
        }
    }
    Ok(marks)
}
