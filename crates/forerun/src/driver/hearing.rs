//! Hearing: what the display tells the physics, and how the physics takes it.

use std::collections::BTreeMap;
use std::sync::Arc;

use forerun_timeline::{Change, Command, CommandError, CommandKey, Frame, Order, Timeline};

use super::fork::{Fork, Names, added_by};
use super::refusal::{AdoptError, Refusal};

/// So many commands are remembered for the forks that are about. Some hours of what a user does.
const REMEMBERED_MAX: usize = 65_536;

/// What the display tells the physics.
#[derive(Debug)]
pub(super) enum Message {
    Obey(Order),
    /// Make a fork.
    Fork,
    Adopt(Box<Fork>),
}

/// What the physics heard.
#[derive(Debug)]
pub(super) struct Heard {
    names: Arc<Names>,
    /// Orders obeyed so far.
    orders: u64,
    /// What became of each command that was ordered while there were forks: the number of the last order, and its change if it stands.
    remembered: BTreeMap<CommandKey, (u64, Option<Change>)>,
    /// Forks made before so many orders were obeyed cannot be brought up to date.
    complete_from: u64,
    /// Held by every fork.
    alive: Arc<()>,
}

impl Heard {
    pub(super) fn new(names: Arc<Names>) -> Heard {
        Heard { names, orders: 0, remembered: BTreeMap::new(), complete_from: 0, alive: Arc::default() }
    }

    pub(super) fn fork(&self, timeline: &Timeline) -> Fork {
        Fork {
            timeline: timeline.fork(),
            names: Arc::clone(&self.names),
            heard: self.orders,
            _alive: Arc::clone(&self.alive),
        }
    }

    pub(super) fn obey(&mut self, timeline: &mut Timeline, order: Order) -> Result<(), Refusal> {
        let added = added_by(&order);
        self.names.reserve_for(timeline, &order);
        let (key, change) = match order {
            Order::Submit(Command { key, change }) => {
                let kept = self.has_forks().then(|| change.clone());
                let order = Order::Submit(Command { key, change });
                timeline.obey(order).map_err(|error| Refusal::Submit(key, error))?;
                (key, kept)
            }
            Order::Replace(Command { key, change }) => {
                let kept = self.has_forks().then(|| change.clone());
                let order = Order::Replace(Command { key, change });
                timeline.obey(order).map_err(|error| Refusal::Replace(key, error))?;
                (key, kept)
            }
            Order::Retract(key) => {
                timeline.obey(Order::Retract(key)).map_err(|error| Refusal::Retract(key, error))?;
                (key, None)
            }
            Order::Undo => self.undone(timeline, Timeline::undo).map_err(Refusal::Undo)?,
            Order::Redo => self.undone(timeline, Timeline::redo).map_err(Refusal::Redo)?,
        };
        if let Some(body) = added {
            self.names.learn_body(body);
        }
        self.orders += 1;
        self.remember(key, change);
        Ok(())
    }

    /// Undoes or does again; the command that this was about, and its change if it stands now.
    fn undone(
        &self,
        timeline: &mut Timeline,
        undo: fn(&mut Timeline) -> Result<CommandKey, CommandError>,
    ) -> Result<(CommandKey, Option<Change>), CommandError> {
        let key = undo(timeline)?;
        let stands = if self.has_forks() { timeline.command(&key).cloned() } else { None };
        Ok((key, stands))
    }

    fn has_forks(&self) -> bool {
        Arc::strong_count(&self.alive) > 1
    }

    /// How many commands are remembered for forks.
    #[cfg(test)]
    pub(super) fn remembers(&self) -> usize {
        self.remembered.len()
    }

    fn remember(&mut self, key: CommandKey, change: Option<Change>) {
        // Without forks nobody asks, and with too much of it nobody is told.
        if !self.has_forks() || self.remembered.len() >= REMEMBERED_MAX {
            self.remembered.clear();
            self.complete_from = self.orders;
        } else {
            self.remembered.insert(key, (self.orders, change));
        }
    }

    /// A fork takes the timeline's place, and what was ordered since it was made is ordered again. `displayed` is shown now; the timeline may
    /// not have learned it yet.
    pub(super) fn adopt(
        &mut self,
        timeline: &mut Timeline,
        fork: Fork,
        displayed: Frame,
    ) -> Result<Vec<Refusal>, AdoptError> {
        let (oldest, horizon) = (fork.timeline.oldest(), fork.timeline.horizon());
        if oldest > displayed || horizon <= displayed {
            return Err(AdoptError::NotDisplayed { displayed, oldest, horizon });
        }
        if fork.heard < self.complete_from {
            return Err(AdoptError::TooOld);
        }
        let Fork { timeline: forked, heard, .. } = fork;
        timeline.adopt(forked);
        let since: Vec<(CommandKey, Option<Change>)> = self
            .remembered
            .iter()
            .filter(|(_, (order, _))| *order > heard)
            .map(|(key, (_, change))| (*key, change.clone()))
            .collect();
        // Other forks do not know what this one did.
        self.orders += 1;
        self.remembered.clear();
        self.complete_from = self.orders;
        Ok(since.into_iter().filter_map(|(key, change)| self.ensure(timeline, key, change).err()).collect())
    }

    /// Sees to it that a command stands with this change, or that there is none.
    fn ensure(
        &self,
        timeline: &mut Timeline,
        key: CommandKey,
        change: Option<Change>,
    ) -> Result<(), Refusal> {
        let standing = timeline.command(&key);
        let order = match change {
            Some(change) if standing.is_none() => Order::Submit(Command { key, change }),
            Some(change) if standing != Some(&change) => Order::Replace(Command { key, change }),
            None if standing.is_some() => Order::Retract(key),
            _ => return Ok(()),
        };
        self.names.reserve_for(timeline, &order);
        let refusal = match order {
            Order::Submit(_) => Refusal::Submit,
            Order::Replace(_) => Refusal::Replace,
            _ => Refusal::Retract,
        };
        timeline.obey(order).map_err(|error| refusal(key, error))
    }
}
