//! Refusal: what the physics was asked and did not do.

use std::fmt;

use forerun_timeline::{CommandError, CommandKey, Frame};

/// What the physics was asked and did not do, and why. Nothing changed.
#[derive(Clone, Debug, PartialEq)]
pub enum Refusal {
    /// A command was not accepted.
    Submit(CommandKey, CommandError),
    /// A command was not taken back.
    Retract(CommandKey, CommandError),
    /// A command was not replaced.
    Replace(CommandKey, CommandError),
    /// There was nothing to undo.
    Undo(CommandError),
    /// There was nothing to do again.
    Redo(CommandError),
    /// A fork was not adopted.
    Adopt(AdoptError),
}

/// Why a fork is not adopted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AdoptError {
    /// Since it was made another fork was adopted, or more orders came than are remembered.
    TooOld,
    /// The fork has no states for what is shown next.
    NotDisplayed {
        /// The displayed frame.
        displayed: Frame,
        /// The fork's oldest frame.
        oldest: Frame,
        /// The fork's last frame.
        horizon: Frame,
    },
}

impl Refusal {
    /// Whether what was asked is forgotten all the same: an undo that fails is not tried again, but the one before it.
    pub(super) fn forgets(&self) -> bool {
        match self {
            Refusal::Undo(error) | Refusal::Redo(error) => {
                !matches!(error, CommandError::NothingToUndo | CommandError::NothingToRedo)
            }
            Refusal::Submit(..) | Refusal::Retract(..) | Refusal::Replace(..) | Refusal::Adopt(_) => false,
        }
    }

    /// The command that it is about, if it is about one.
    #[must_use]
    pub fn key(&self) -> Option<CommandKey> {
        match self {
            Refusal::Submit(key, _) | Refusal::Retract(key, _) | Refusal::Replace(key, _) => Some(*key),
            Refusal::Undo(_) | Refusal::Redo(_) | Refusal::Adopt(_) => None,
        }
    }
}

impl fmt::Display for AdoptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AdoptError::TooOld => f.write_str(
                "the fork is too old: another was adopted since, or too many orders came; take a new one",
            ),
            AdoptError::NotDisplayed { displayed, oldest, horizon } => write!(
                f,
                "the fork has {oldest} to {horizon} and {displayed} is shown: advance it further, or take a new one"
            ),
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Refusal::Submit(_, error) => write!(f, "{error}"),
            Refusal::Retract(_, error) => write!(f, "not taken back: {error}"),
            Refusal::Replace(_, error) => write!(f, "not replaced: {error}"),
            Refusal::Undo(error) => write!(f, "not undone: {error}"),
            Refusal::Redo(error) => write!(f, "not done again: {error}"),
            Refusal::Adopt(error) => write!(f, "not adopted: {error}"),
        }
    }
}

impl std::error::Error for Refusal {}
