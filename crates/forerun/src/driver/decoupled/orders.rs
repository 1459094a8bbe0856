//! Orders: what the display asks of the physics. All of it goes into the bounded queue and none of it waits.

use std::sync::mpsc::TrySendError;

use forerun_timeline::{Change, Command, CommandKey, Order};

use super::Decoupled;
use crate::driver::driver_error::DriverError;
use crate::driver::fork::Fork;
use crate::driver::hearing::Message;
use crate::driver::refusal::Refusal;
use crate::{BodyDef, BodyId, Frame};

impl Decoupled {
    /// A change by the local user, from the first frame after the displayed one on: not a bit of what is on the screen changes.
    ///
    /// # Errors
    /// [`DriverError::QueueFull`] when too many orders wait; [`DriverError::Panicked`]. Whether the change is possible is found
    /// out by the physics thread: see [`Decoupled::refusals`].
    pub fn change(&mut self, change: Change) -> Result<CommandKey, DriverError> {
        self.change_at(self.displayed_frame().next(), change)
    }

    /// A change by the local user at a frame of its own, past or to come, after all that this user changes there already.
    ///
    /// # Errors
    /// As [`Decoupled::change`].
    pub fn change_at(&mut self, frame: Frame, change: Change) -> Result<CommandKey, DriverError> {
        let key = self.names.key_at(frame);
        self.submit(Command { key, change })?;
        Ok(key)
    }

    /// Adds a body from the first frame after the displayed one on.
    ///
    /// # Errors
    /// As [`Decoupled::change`].
    pub fn add(&mut self, def: BodyDef) -> Result<BodyId, DriverError> {
        let body = self.reserve_body();
        self.change(Change::Add { body, def: Box::new(def) })?;
        Ok(body)
    }

    /// A name for a body to be added by a command of one's own. The timeline learns it with that command.
    pub fn reserve_body(&mut self) -> BodyId {
        self.names.body()
    }

    /// A command with a frame of its own, possibly in the past, as they come from a network. Local changes use source 0, with sequence numbers
    /// above all that were submitted so.
    ///
    /// # Errors
    /// As [`Decoupled::change`].
    pub fn submit(&self, command: Command) -> Result<(), DriverError> {
        self.obey(Order::Submit(command))
    }

    /// Takes a command back, as if it had never been given. Where it acted before the displayed frame, what is drawn is blended over.
    ///
    /// # Errors
    /// As [`Decoupled::change`].
    pub fn retract(&self, key: CommandKey) -> Result<(), DriverError> {
        self.obey(Order::Retract(key))
    }

    /// Puts another change in the place of a command.
    ///
    /// # Errors
    /// As [`Decoupled::change`].
    pub fn replace(&self, key: CommandKey, change: Change) -> Result<(), DriverError> {
        self.obey(Order::Replace(Command { key, change }))
    }

    /// Takes back the local user's last order that still stands.
    ///
    /// # Errors
    /// As [`Decoupled::change`].
    pub fn undo(&self) -> Result<(), DriverError> {
        self.obey(Order::Undo)
    }

    /// Does again what was undone last.
    ///
    /// # Errors
    /// As [`Decoupled::change`].
    pub fn redo(&self) -> Result<(), DriverError> {
        self.obey(Order::Redo)
    }

    /// Any order; the physics obeys them in the order in which they came.
    ///
    /// # Errors
    /// As [`Decoupled::change`].
    pub fn obey(&self, order: Order) -> Result<(), DriverError> {
        // Now, as the next change may be ordered before the physics hears this.
        self.names.learn_sequence(&order);
        self.send(Message::Obey(order))
    }

    /// Asks for a fork: another future, to be tried beside the one that is shown. The physics makes it at its next frame, in microseconds.
    ///
    /// # Errors
    /// As [`Decoupled::change`]; [`DriverError::Elsewhere`] where the physics is in another process.
    pub fn request_fork(&self) -> Result<(), DriverError> {
        self.at_hand()?;
        self.send(Message::Fork)
    }

    /// The oldest fork that was asked for and is there; none while the physics has not come to it. At most 16 wait, the others are lost.
    #[must_use]
    pub fn take_fork(&mut self) -> Option<Fork> {
        self.forks.try_recv().ok()
    }

    /// Shows a fork's future from now on, with all that the physics was told since the fork was made. A fork that is too old, or has no
    /// states for what is shown, is dropped, and [`Refusal::Adopt`] says why: keep a clone to advance it further. Where it contradicts what is
    /// drawn, that is blended over.
    ///
    /// # Errors
    /// As [`Decoupled::request_fork`].
    pub fn adopt(&self, fork: Fork) -> Result<(), DriverError> {
        self.at_hand()?;
        self.send(Message::Adopt(Box::new(fork)))
    }

    /// What the physics was asked and did not do since the last call, and why. When nobody asks for long, the latest are lost.
    pub fn refusals(&mut self) -> Vec<Refusal> {
        self.refusals.try_iter().collect()
    }

    /// Timelines, which forks are, do not leave the process.
    fn at_hand(&self) -> Result<(), DriverError> {
        if self.physics.is_some() { Ok(()) } else { Err(DriverError::Elsewhere) }
    }

    fn send(&self, message: Message) -> Result<(), DriverError> {
        self.alive()?;
        match self.messages.try_send(message) {
            Ok(()) => {
                self.shared.wake();
                Ok(())
            }
            Err(TrySendError::Full(_)) => Err(DriverError::QueueFull),
            Err(TrySendError::Disconnected(_)) => Err(self.failure()),
        }
    }
}
