//! Command log: the accepted commands, by when they act and by body.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use forerun_dynamics::BodyId;
use forerun_geometry::Vec3;

use crate::Frame;
use crate::command::{Change, CommandKey};

/// Commands by the frame at which they act; those of a frame sorted by key. Snapshots share it: to touch it is to copy the frames, not the commands.
pub(crate) type CommandsByFrame = BTreeMap<Frame, Arc<Vec<(CommandKey, Arc<Change>)>>>;

/// The accepted commands that are not older than the oldest frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct CommandLog {
    by_frame: Arc<CommandsByFrame>,
    by_body: BTreeSet<(BodyId, CommandKey)>,
}

impl CommandLog {
    pub(crate) fn contains(&self, key: &CommandKey) -> bool {
        self.get(key).is_some()
    }

    pub(crate) fn get(&self, key: &CommandKey) -> Option<&Change> {
        let commands = self.by_frame.get(&key.frame)?;
        let place = commands.binary_search_by_key(key, |(key, _)| *key).ok()?;
        Some(commands[place].1.as_ref())
    }

    /// All commands, to be shared.
    pub(crate) fn by_frame(&self) -> &Arc<CommandsByFrame> {
        &self.by_frame
    }

    /// Whether a command acts at or before a frame.
    pub(crate) fn begins_by(&self, frame: Frame) -> bool {
        self.by_frame.first_key_value().is_some_and(|(first, _)| *first <= frame)
    }

    pub(crate) fn insert(&mut self, key: CommandKey, change: Change) {
        if let Some(body) = change.body() {
            self.by_body.insert((body, key));
        }
        let commands = Arc::make_mut(&mut self.by_frame).entry(key.frame).or_default();
        let commands = Arc::make_mut(commands);
        match commands.binary_search_by_key(&key, |(key, _)| *key) {
            Ok(place) => commands[place].1 = Arc::new(change),
            Err(place) => commands.insert(place, (key, Arc::new(change))),
        }
    }

    /// Takes a command back; what it was.
    pub(crate) fn remove(&mut self, key: &CommandKey) -> Option<Change> {
        let place = self.by_frame.get(&key.frame)?.binary_search_by_key(key, |(key, _)| *key).ok()?;
        let by_frame = Arc::make_mut(&mut self.by_frame);
        let commands = Arc::make_mut(by_frame.get_mut(&key.frame)?);
        let change = Arc::unwrap_or_clone(commands.remove(place).1);
        if commands.is_empty() {
            by_frame.remove(&key.frame);
        }
        if let Some(body) = change.body() {
            self.by_body.remove(&(body, *key));
        }
        Some(change)
    }

    /// The commands of a frame in the order in which they act.
    pub(crate) fn at(&self, frame: Frame) -> impl Iterator<Item = &Change> {
        let commands = self.by_frame.get(&frame);
        commands.into_iter().flat_map(|commands| commands.iter()).map(|(_, change)| change.as_ref())
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
        let later = self.by_frame.range(frame..).flat_map(|(_, commands)| commands.iter());
        later.filter_map(|(key, change)| match change.as_ref() {
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
        in_order(&self.by_frame)
    }

    /// Forgets the commands at or before `oldest`; the bodies they changed.
    pub(crate) fn forget_to(&mut self, oldest: Frame) -> BTreeSet<BodyId> {
        let by_frame = Arc::make_mut(&mut self.by_frame);
        let kept = by_frame.split_off(&oldest.next());
        let forgotten = std::mem::replace(by_frame, kept);
        let mut bodies = BTreeSet::new();
        for (key, change) in forgotten.values().flat_map(|commands| commands.iter()) {
            if let Some(body) = change.body() {
                self.by_body.remove(&(body, *key));
                bodies.insert(body);
            }
        }
        bodies
    }
}

/// Commands in the order in which they act.
pub(crate) fn in_order(commands: &CommandsByFrame) -> impl Iterator<Item = (&CommandKey, &Change)> {
    let all = commands.values().flat_map(|commands| commands.iter());
    all.map(|(key, change)| (key, change.as_ref()))
}

fn first_key(frame: Frame) -> CommandKey {
    CommandKey { frame, source: 0, sequence: 0 }
}

fn last_key(frame: Frame) -> CommandKey {
    CommandKey { frame, source: u32::MAX, sequence: u64::MAX }
}
