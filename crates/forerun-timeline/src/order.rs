//! Order: what may be asked of the commands of a timeline, and how the local user's orders are undone and done again.

use crate::command::{Command, CommandError, CommandKey};
use crate::{Frame, Timeline};

/// The source of the local user: whose orders can be undone.
pub(crate) const LOCAL: u32 = 0;

/// A change to the commands. Orders are plain values: they can be queued, sent and kept.
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// One command more.
    Submit(Command),
    /// One command less, as if it had never been given.
    Retract(CommandKey),
    /// In place of the command of this key, the change that comes with it.
    Replace(Command),
    /// Takes back the local user's last order that still stands.
    Undo,
    /// Does again what was undone last.
    Redo,
}

/// What takes back, or does again, the local user's orders. The last is the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct UndoLog {
    pub(crate) undo: Vec<Order>,
    pub(crate) redo: Vec<Order>,
}

impl UndoLog {
    /// Forgets the orders on commands at or before `oldest`.
    pub(crate) fn forget_to(&mut self, oldest: Frame) {
        let kept = |order: &Order| order.key().is_none_or(|key| key.frame > oldest);
        self.undo.retain(kept);
        self.redo.retain(kept);
    }
}

impl Order {
    fn key(&self) -> Option<CommandKey> {
        match self {
            Order::Submit(command) | Order::Replace(command) => Some(command.key),
            Order::Retract(key) => Some(*key),
            Order::Undo | Order::Redo => None,
        }
    }
}

impl Timeline {
    /// Obeys an order. Those on the local user's commands (source 0) are remembered, and can be undone as long as their frame is kept.
    ///
    /// # Errors
    /// When it cannot be obeyed; then nothing changed.
    pub fn obey(&mut self, order: Order) -> Result<(), CommandError> {
        match order {
            Order::Undo => self.undo().map(drop),
            Order::Redo => self.redo().map(drop),
            order => {
                let local = order.key().is_some_and(|key| key.source == LOCAL);
                let inverse = self.perform(order)?;
                if local {
                    self.undo.undo.push(inverse);
                    self.undo.redo.clear();
                }
                Ok(())
            }
        }
    }

    /// Takes back the local user's last order, also one in the past; the key of its command.
    ///
    /// # Errors
    /// [`CommandError::NothingToUndo`]: none is left whose frame is still kept.
    pub fn undo(&mut self) -> Result<CommandKey, CommandError> {
        let order = self.undo.undo.pop().ok_or(CommandError::NothingToUndo)?;
        let (key, inverse) = self.perform_known(order)?;
        self.undo.redo.push(inverse);
        Ok(key)
    }

    /// Does again what was undone last; the key of its command.
    ///
    /// # Errors
    /// [`CommandError::NothingToRedo`]: nothing was undone since the local user's last order.
    pub fn redo(&mut self) -> Result<CommandKey, CommandError> {
        let order = self.undo.redo.pop().ok_or(CommandError::NothingToRedo)?;
        let (key, inverse) = self.perform_known(order)?;
        self.undo.undo.push(inverse);
        Ok(key)
    }

    fn perform_known(&mut self, order: Order) -> Result<(CommandKey, Order), CommandError> {
        let key = order.key().ok_or(CommandError::NothingToUndo)?;
        Ok((key, self.perform(order)?))
    }

    /// Does what an order says about one command; the order that takes it back.
    fn perform(&mut self, order: Order) -> Result<Order, CommandError> {
        match order {
            Order::Submit(command) => {
                let key = command.key;
                self.submit(command).map(|()| Order::Retract(key))
            }
            Order::Retract(key) => {
                let change = self.log.get(&key).cloned().ok_or(CommandError::UnknownCommand(key))?;
                self.retract(&key);
                Ok(Order::Submit(Command { key, change }))
            }
            Order::Replace(Command { key, change }) => {
                let before = self.log.get(&key).cloned().ok_or(CommandError::UnknownCommand(key))?;
                self.replace(&key, change)?;
                Ok(Order::Replace(Command { key, change: before }))
            }
            Order::Undo | Order::Redo => Err(CommandError::NothingToUndo),
        }
    }
}
