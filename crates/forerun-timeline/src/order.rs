//! Order: what may be asked of the commands of a timeline, and how the local user's orders are undone and done again.

use std::sync::Arc;

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
    /// Whether an order is on a command at or before `oldest`.
    pub(crate) fn begins_by(&self, oldest: Frame) -> bool {
        self.undo.iter().chain(&self.redo).any(|order| order.key().is_some_and(|key| key.frame <= oldest))
    }

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
                    let undo = Arc::make_mut(&mut self.undo);
                    undo.undo.push(inverse);
                    undo.redo.clear();
                }
                Ok(())
            }
        }
    }

    /// Takes back the local user's last order, also one in the past; the key of its command.
    ///
    /// # Errors
    /// [`CommandError::NothingToUndo`]: none is left whose frame is still kept. When it cannot be done for another reason, that; the next
    /// call goes on with the order before it.
    pub fn undo(&mut self) -> Result<CommandKey, CommandError> {
        while let Some(order) = Arc::make_mut(&mut self.undo).undo.pop() {
            if let Some((key, inverse)) = self.perform_known(order)? {
                Arc::make_mut(&mut self.undo).redo.push(inverse);
                return Ok(key);
            }
        }
        Err(CommandError::NothingToUndo)
    }

    /// Does again what was undone last; the key of its command.
    ///
    /// # Errors
    /// [`CommandError::NothingToRedo`]: nothing was undone since the local user's last order.
    pub fn redo(&mut self) -> Result<CommandKey, CommandError> {
        while let Some(order) = Arc::make_mut(&mut self.undo).redo.pop() {
            if let Some((key, inverse)) = self.perform_known(order)? {
                Arc::make_mut(&mut self.undo).undo.push(inverse);
                return Ok(key);
            }
        }
        Err(CommandError::NothingToRedo)
    }

    /// Performs a remembered order: the key of its command, and the order that takes it back. `None` when the command was taken away by
    /// other means than an order, so that there is nothing left to do.
    fn perform_known(&mut self, order: Order) -> Result<Option<(CommandKey, Order)>, CommandError> {
        let Some(key) = order.key() else { return Ok(None) };
        match self.perform(order) {
            Ok(inverse) => Ok(Some((key, inverse))),
            Err(CommandError::UnknownCommand(_) | CommandError::DuplicateKey(_)) => Ok(None),
            Err(error) => Err(error),
        }
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
