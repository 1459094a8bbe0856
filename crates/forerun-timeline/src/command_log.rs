//! Command log: the accepted commands, by when they act and by body.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use forerun_dynamics::BodyId;
use forerun_geometry::Vec3;

use crate::Frame;
use crate::command::{Change, CommandKey};

/// The accepted commands that are not older than the oldest frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct CommandLog {
    /// Copies of a log share the changes.
    by_key: BTreeMap<CommandKey, Arc<Change>>,
    by_body: BTreeSet<(BodyId, CommandKey)>,
}

impl CommandLog {
    pub(crate) fn contains(&self, key: &CommandKey) -> bool {
        self.by_key.contains_key(key)
    }

    pub(crate) fn get(&self, key: &CommandKey) -> Option<&Change> {
        self.by_key.get(key).map(AsRef::as_ref)
    }

    /// Whether a command acts at or before a frame.
    pub(crate) fn begins_by(&self, frame: Frame) -> bool {
        self.by_key.first_key_value().is_some_and(|(key, _)| key.frame <= frame)
    }

    pub(crate) fn insert(&mut self, key: CommandKey, change: Change) {
        if let Some(body) = change.body() {
            self.by_body.insert((body, key));
        }
        self.by_key.insert(key, Arc::new(change));
    }

    /// Takes a command back; what it was.
    pub(crate) fn remove(&mut self, key: &CommandKey) -> Option<Change> {
        let change = Arc::unwrap_or_clone(self.by_key.remove(key)?);
        if let Some(body) = change.body() {
            self.by_body.remove(&(body, *key));
        }
        Some(change)
    }

    /// The commands of a frame in the order in which they act.
    pub(crate) fn at(&self, frame: Frame) -> impl Iterator<Item = &Change> {
        self.by_key.range(first_key(frame)..=last_key(frame)).map(|(_, change)| change.as_ref())
    }

    /// The commands to one body at a frame in the order in which they act.
    pub(crate) fn of_body_at(&self, body: BodyId, frame: Frame) -> impl Iterator<Item = &Change> {
        let keys = self.by_body.range((body, first_key(frame))..=(body, last_key(frame)));
        keys.filter_map(|(_, key)| self.get(key))
    }

    /// The commands to one body at a frame or later.
    pub(crate) fn of_body_from(
        &self,
        body: BodyId,
        frame: Frame,
    ) -> impl Iterator<Item = (CommandKey, &Change)> {
        let keys = self.by_body.range((body, first_key(frame))..=(body, last_key(Frame(u64::MAX))));
        keys.filter_map(|(_, key)| Some((*key, self.get(key)?)))
    }

    /// The changes of gravity at a frame or later.
    pub(crate) fn gravities_from(&self, frame: Frame) -> impl Iterator<Item = (Frame, Vec3)> {
        self.by_key.range(first_key(frame)..).filter_map(|(key, change)| match change.as_ref() {
            // Adding +0 makes -0 positive: equal gravity has equal bits.
            Change::SetGravity { gravity } => Some((key.frame, *gravity + Vec3::ZERO)),
            _ => None,
        })
    }

    /// The bodies that have commands at a frame, in the order of their ids.
    pub(crate) fn bodies_at(&self, frame: Frame) -> BTreeSet<BodyId> {
        self.at(frame).filter_map(Change::body).collect()
    }

    /// Whether gravity is changed at a frame.
    pub(crate) fn changes_gravity_at(&self, frame: Frame) -> bool {
        self.at(frame).any(|change| matches!(change, Change::SetGravity { .. }))
    }

    /// All commands in the order in which they act.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&CommandKey, &Change)> {
        self.by_key.iter().map(|(key, change)| (key, change.as_ref()))
    }

    /// Forgets the commands at or before `oldest`; the bodies they changed.
    pub(crate) fn forget_to(&mut self, oldest: Frame) -> BTreeSet<BodyId> {
        let kept = self.by_key.split_off(&first_key(oldest.next()));
        let forgotten = std::mem::replace(&mut self.by_key, kept);
        let mut bodies = BTreeSet::new();
        for (key, change) in forgotten {
            if let Some(body) = change.body() {
                self.by_body.remove(&(body, key));
                bodies.insert(body);
            }
        }
        bodies
    }
}

fn first_key(frame: Frame) -> CommandKey {
    CommandKey { frame, source: 0, sequence: 0 }
}

fn last_key(frame: Frame) -> CommandKey {
    CommandKey { frame, source: u32::MAX, sequence: u64::MAX }
}
