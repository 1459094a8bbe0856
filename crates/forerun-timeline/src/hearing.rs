//! Hearing: commands are checked, noted, and what they put out of date is marked. Nothing is computed here.

use std::sync::Arc;

use forerun_dynamics::{Body, BodyDef, BodyId, BodyKind, Environment};

use crate::order::LOCAL;
use crate::stale::same_body;
use crate::stats::Edit;
use crate::timeline::{EDITS_KEPT, Timeline};
use crate::{Change, Command, CommandError, CommandKey, Frame, Order};

/// How far the id of an added body may be ahead of the names in use: ids index memory.
pub(crate) const NAMES_AHEAD: usize = 65_536;

impl Timeline {
    /// Accepts a command for a frame after the oldest. Undo does not know of it: [`Timeline::change`] and [`Timeline::obey`] do.
    ///
    /// It acts when its frame is next computed: call [`Timeline::advance`]. A command to
    /// a body that is not there at that frame does nothing and is counted in [`Stats::ignored`](crate::Stats::ignored).
    ///
    /// # Errors
    /// When it cannot be obeyed; then nothing changed.
    pub fn submit(&mut self, command: Command) -> Result<(), CommandError> {
        let Command { key, change } = command;
        self.check(&key, &change)?;
        if key.source == LOCAL {
            self.next_sequence = self.next_sequence.max(key.sequence.saturating_add(1));
        }
        let body = change.body();
        self.insert(key, change);
        self.note(body, key.frame);
        Ok(())
    }

    /// Takes an accepted command back, as if it had never been sent. Not remembered for undo: [`Timeline::obey`] does that. `false` when there is none of that key that acts after the oldest
    /// frame. The name of a body that is not added after all may only be used by that same command.
    pub fn retract(&mut self, key: &CommandKey) -> bool {
        let Some(change) = self.remove(key) else { return false };
        self.note(change.body(), key.frame);
        true
    }

    /// Puts another change in the place of an accepted command. Not remembered for undo: [`Timeline::obey`] does that.
    ///
    /// # Errors
    /// [`CommandError::UnknownCommand`], or as [`Timeline::submit`]; then the old command stands.
    pub fn replace(&mut self, key: &CommandKey, change: Change) -> Result<(), CommandError> {
        let before = self.remove(key).ok_or(CommandError::UnknownCommand(*key))?;
        if let Err(error) = self.check(key, &change) {
            self.insert(*key, before);
            return Err(error);
        }
        let bodies = (before.body(), change.body());
        self.insert(*key, change);
        self.note(bodies.0, key.frame);
        if bodies.1 != bodies.0 {
            self.note(bodies.1, key.frame);
        }
        Ok(())
    }

    /// Puts a command into the log, and notes how the body that it adds is made.
    fn insert(&mut self, key: CommandKey, change: Change) {
        if let Change::Add { body, def } = &change {
            let definitions = Arc::make_mut(&mut self.definitions);
            definitions.reserve(body.0 as usize + 1);
            definitions.set_def(*body, Some(Arc::new(BodyDef::clone(def))));
        }
        Arc::make_mut(&mut self.log).insert(key, change);
    }

    /// Takes a command out of the log; what it was.
    fn remove(&mut self, key: &CommandKey) -> Option<Change> {
        if !self.log.contains(key) {
            return None;
        }
        let change = Arc::make_mut(&mut self.log).remove(key)?;
        if let Change::Add { body, .. } = change {
            Arc::make_mut(&mut self.definitions).set_def(body, None);
        }
        Some(change)
    }

    /// Accepts commands in turn.
    ///
    /// # Errors
    /// At the first that cannot be obeyed; those before it are accepted.
    pub fn submit_all(&mut self, commands: impl IntoIterator<Item = Command>) -> Result<(), CommandError> {
        commands.into_iter().try_for_each(|command| self.submit(command))
    }

    /// Accepts a change by the local user (source 0, the next sequence number); it can be [undone](Timeline::undo).
    ///
    /// # Errors
    /// As [`Timeline::submit`].
    pub fn change(&mut self, frame: Frame, change: Change) -> Result<CommandKey, CommandError> {
        let key = CommandKey { frame, source: LOCAL, sequence: self.next_sequence };
        self.obey(Order::Submit(Command { key, change }))?;
        Ok(key)
    }

    fn check(&self, key: &CommandKey, change: &Change) -> Result<(), CommandError> {
        if key.frame <= self.oldest() {
            return Err(CommandError::TooOld { frame: key.frame, oldest: self.oldest() });
        }
        if self.log.contains(key) {
            return Err(CommandError::DuplicateKey(*key));
        }
        change.check_numbers()?;
        let names = self.definitions.names();
        match change {
            Change::Add { body, def } => {
                if body.0 as usize >= names + NAMES_AHEAD {
                    return Err(CommandError::UnknownBody(*body));
                }
                if self.definitions.def(*body).is_some() {
                    return Err(CommandError::BodyExists(*body));
                }
                Body::new(def).map_err(CommandError::Body)?;
            }
            Change::SetKind { body, kind } => {
                if let Some(def) = self.definitions.def(*body) {
                    let def = BodyDef { kind: *kind, ..BodyDef::clone(def) };
                    Body::new(&def).map_err(CommandError::Body)?;
                }
            }
            // What cannot be dynamic never has a mass.
            Change::SetMass { body, .. } => {
                if let Some(def) = self.definitions.def(*body) {
                    let def = BodyDef { kind: BodyKind::Dynamic, ..BodyDef::clone(def) };
                    Body::new(&def).map_err(CommandError::Body)?;
                }
            }
            _ => {}
        }
        match change.body() {
            Some(body) if body.0 as usize >= names && !matches!(change, Change::Add { .. }) => {
                Err(CommandError::UnknownBody(body))
            }
            _ => Ok(()),
        }
    }

    /// Notes what is out of date when there is another command, or one less, to a body (or to all) at a frame.
    fn note(&mut self, body: Option<BodyId>, frame: Frame) {
        let was_true = self.stale.is_empty();
        match body {
            Some(body) => self.note_body(body, frame),
            None => self.note_gravity(frame),
        }
        if self.recompute_all {
            for frame in (frame.0 - 1)..self.horizon().0 {
                self.stale.entry(Frame(frame)).or_default().everyone = true;
            }
        }
        if !self.stale.is_empty() {
            self.note_edit(frame, was_true);
        }
    }

    /// Counts a command to the edit that is being worked off, or begins a new one.
    fn note_edit(&mut self, frame: Frame, is_new: bool) {
        let bodies = self.table(self.horizon()).population() as u64;
        let horizon = self.horizon();
        let edits = Arc::make_mut(&mut self.edits);
        if is_new {
            if edits.len() == EDITS_KEPT {
                edits.pop_front();
            }
            edits.push_back(Edit { frame, ..Edit::default() });
        }
        if let Some(edit) = edits.back_mut() {
            edit.frame = edit.frame.min(frame);
            edit.commands += 1;
            edit.full = bodies * (horizon.since(edit.frame) + 1);
        }
    }

    fn note_body(&mut self, body: BodyId, frame: Frame) {
        let horizon = self.horizon();
        let definitions = Arc::make_mut(&mut self.definitions);
        let before = definitions.history(body);
        definitions.rebuild_body(body, frame, self.log.of_body_from(body, frame));
        for frame in (frame.0..horizon.0).map(Frame) {
            if !same_body(before.body(frame), definitions.body(body, frame)) {
                let stale = self.stale.entry(frame).or_default();
                stale.bodies.entry(body).or_insert_with(|| before.body(frame).cloned());
            }
        }
        if frame <= horizon {
            self.stale.entry(frame.minus(1)).or_default().touched.insert(body);
        }
    }

    fn note_gravity(&mut self, frame: Frame) {
        let horizon = self.horizon();
        let definitions = Arc::make_mut(&mut self.definitions);
        let before: Vec<Environment> =
            (frame.0..horizon.0).map(|k| definitions.environment(Frame(k))).collect();
        definitions.rebuild_environment(frame, self.log.gravities_from(frame));
        for (frame, before) in (frame.0..horizon.0).map(Frame).zip(before) {
            if definitions.environment(frame) != before {
                self.stale.entry(frame).or_default().everyone = true;
            }
        }
        // The command ends everybody's rest.
        if frame <= horizon {
            self.stale.entry(frame.minus(1)).or_default().all_touched = true;
        }
    }
}
