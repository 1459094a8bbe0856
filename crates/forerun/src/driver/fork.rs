//! Fork: another future, tried beside the one that is shown.
//!
//! The physics thread clones its timeline at its next frame, which costs microseconds, and goes on. Whoever took the fork changes and advances it
//! in a thread of their own, drops it, or has it adopted.
//!
//! Promise: adopting loses no order. What the physics was told since the fork was made is told to the fork as well; names of bodies
//! and sequence numbers come from one counter, so that the two never mean different things by one name.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

use forerun_timeline::{Change, Command, CommandError, CommandKey, Frame, Order, Timeline};

use crate::{BodyDef, BodyId};

/// What has not been given to any body or local command yet.
#[derive(Debug)]
pub(super) struct Names {
    body: AtomicU32,
    sequence: AtomicU64,
}

impl Names {
    /// Counts on after those of a timeline.
    pub(super) fn after(timeline: &mut Timeline) -> Arc<Names> {
        Names::from(timeline.reserve_body().0, timeline.next_sequence())
    }

    /// Counts on from these.
    pub(super) fn from(body: u32, sequence: u64) -> Arc<Names> {
        Arc::new(Names { body: AtomicU32::new(body), sequence: AtomicU64::new(sequence) })
    }

    /// What is next given to a body, and to a local command.
    pub(super) fn next(&self) -> (u32, u64) {
        (self.body.load(Ordering::Relaxed), self.sequence.load(Ordering::Relaxed))
    }

    /// A number that nobody else gets is all that is asked: no order with other memory.
    pub(super) fn body(&self) -> BodyId {
        BodyId(self.body.fetch_add(1, Ordering::Relaxed))
    }

    /// The next name that is given.
    pub(super) fn coming_body(&self) -> BodyId {
        BodyId(self.body.load(Ordering::Relaxed))
    }

    /// Lets a timeline know the names up to that of a body which an order adds. Bodies are named from here for all forks, added to a few of them,
    /// and refused where their names are too far ahead.
    pub(super) fn reserve_for(&self, timeline: &mut Timeline, order: &Order) {
        let Some(body) = added_by(order) else { return };
        if body.0 < self.body.load(Ordering::Relaxed) {
            while timeline.names() < body.0 as usize {
                timeline.reserve_body();
            }
        }
    }

    /// Gives nobody the name of a body which an order added: who sent it did not get the name from here.
    pub(super) fn learn_body(&self, body: BodyId) {
        self.body.fetch_max(body.0.saturating_add(1), Ordering::Relaxed);
    }

    /// Gives no local command the sequence number that an order has.
    pub(super) fn learn_sequence(&self, order: &Order) {
        if let Order::Submit(Command { key: CommandKey { source: 0, sequence, .. }, .. }) = order {
            self.sequence.fetch_max(sequence.saturating_add(1), Ordering::Relaxed);
        }
    }

    pub(super) fn key_at(&self, frame: Frame) -> CommandKey {
        CommandKey { frame, source: 0, sequence: self.sequence.fetch_add(1, Ordering::Relaxed) }
    }
}

/// The body that an order adds.
pub(super) fn added_by(order: &Order) -> Option<BodyId> {
    match order {
        Order::Submit(Command { change: Change::Add { body, .. }, .. })
        | Order::Replace(Command { change: Change::Add { body, .. }, .. }) => Some(*body),
        _ => None,
    }
}

/// A timeline that goes its own way beside the driver's. It shares all states that do not differ. A clone is another fork of the same moment.
#[derive(Clone, Debug)]
pub struct Fork {
    pub(super) timeline: Timeline,
    pub(super) names: Arc<Names>,
    /// Orders that the physics had heard.
    pub(super) heard: u64,
    /// As long as there is one, the physics remembers what it hears.
    pub(super) _alive: Arc<()>,
}

impl Fork {
    /// The timeline: look at it, [diff](Timeline::diff) it.
    #[must_use]
    pub fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    /// The timeline, to advance it. Its own [`Timeline::change`] and [`Timeline::reserve_body`] give names that the driver may give too: take
    /// [`Fork::change`] and [`Fork::add`] for what is to be adopted.
    pub fn timeline_mut(&mut self) -> &mut Timeline {
        &mut self.timeline
    }

    /// A change by the local user, in this future alone.
    ///
    /// # Errors
    /// When the timeline cannot obey it; then nothing changed.
    pub fn change(&mut self, frame: Frame, change: Change) -> Result<CommandKey, CommandError> {
        let key = self.names.key_at(frame);
        let order = Order::Submit(Command { key, change });
        self.names.reserve_for(&mut self.timeline, &order);
        self.timeline.obey(order)?;
        Ok(key)
    }

    /// Adds a body, in this future alone.
    ///
    /// # Errors
    /// As [`Fork::change`].
    pub fn add(&mut self, frame: Frame, def: BodyDef) -> Result<BodyId, CommandError> {
        let body = self.names.body();
        self.change(frame, Change::Add { body, def: Box::new(def) })?;
        Ok(body)
    }
}
