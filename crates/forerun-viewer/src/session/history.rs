//! History: what the user did, in steps that are taken back and done again as a whole. A drag is one step, however many commands it took.
//!
//! The steps are kept on the display's side: taking one back retracts its commands, doing it again submits them with the keys that they had, so
//! that everything is bit for bit as it was before.

use forerun::{Change, Command, CommandKey, Frame};

/// So many steps can be taken back.
const STEPS_MAX: usize = 1000;

/// What is taken back as one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// As menus say it: `throw`.
    pub label: String,
    /// In the order in which they were given.
    pub commands: Vec<Command>,
}

/// What the user did, and took back.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// The last is the next to be taken back.
    done: Vec<Step>,
    /// The last is the next to be done again.
    undone: Vec<Step>,
    /// Whether what is given now belongs to the last step.
    open: bool,
}

impl History {
    /// What is given from now on, until the next end, is one step.
    pub fn begin(&mut self, label: &str) {
        self.end();
        if self.done.len() >= STEPS_MAX {
            self.done.remove(0);
        }
        self.done.push(Step { label: label.to_owned(), commands: Vec::new() });
        self.open = true;
    }

    /// What is given from now on does not belong to the step any more. A step in which nothing was given never was: whether one ends that is to be
    /// taken back next.
    pub fn end(&mut self) -> bool {
        let was_open = std::mem::take(&mut self.open);
        self.done.pop_if(|step| step.commands.is_empty()).is_none() && was_open
    }

    /// A command was given. What was taken back before cannot be done again.
    pub fn give(&mut self, command: Command) {
        self.undone.clear();
        if let Some(step) = self.done.last_mut().filter(|_| self.open) {
            step.commands.push(command);
        }
    }

    /// In place of the change that a command of the last step made, another.
    pub fn replace(&mut self, key: CommandKey, change: &Change) {
        let commands = self.done.last_mut().into_iter().flat_map(|step| &mut step.commands);
        for command in commands.filter(|command| command.key == key) {
            command.change = change.clone();
        }
    }

    /// A command was refused: it is no part of any step.
    pub fn forget(&mut self, key: CommandKey) {
        self.retain(|command| command.key != key);
    }

    /// What acted at or before a frame cannot be taken back any more.
    pub fn forget_to(&mut self, oldest: Frame) {
        let gone = |step: &Step| step.commands.iter().any(|command| command.key.frame <= oldest);
        if self.done.iter().chain(&self.undone).any(gone) {
            self.retain(|command| command.key.frame > oldest);
        }
    }

    fn retain(&mut self, kept: impl Fn(&Command) -> bool) {
        let last = self.done.len();
        for step in self.done.iter_mut().chain(&mut self.undone) {
            step.commands.retain(&kept);
        }
        // The step that is open may still be given something.
        let mut place = 0;
        self.done.retain(|step| {
            place += 1;
            !step.commands.is_empty() || (self.open && place == last)
        });
        self.undone.retain(|step| !step.commands.is_empty());
    }

    /// Takes the last step back: `retract` is told each command, the last first, and whether that could be ordered it says itself. What could not
    /// remains a step.
    pub fn undo(&mut self, mut retract: impl FnMut(&Command) -> bool) {
        self.end();
        let Some(mut step) = self.done.pop() else { return };
        let mut taken = Vec::new();
        while let Some(command) = step.commands.pop_if(|command| retract(command)) {
            taken.push(command);
        }
        taken.reverse();
        self.undone.push(Step { label: step.label.clone(), commands: taken });
        self.done.push(step);
        self.retain(|_| true);
    }

    /// Does again what was taken back last: `submit` is told each command, the first first.
    pub fn redo(&mut self, mut submit: impl FnMut(&Command) -> bool) {
        self.end();
        let Some(step) = self.undone.pop() else { return };
        let mut commands = step.commands.into_iter();
        let mut done = Vec::new();
        let mut left = Vec::new();
        for command in commands.by_ref() {
            if !submit(&command) {
                left.push(command);
                break;
            }
            done.push(command);
        }
        left.extend(commands);
        self.done.push(Step { label: step.label.clone(), commands: done });
        self.undone.push(Step { label: step.label, commands: left });
        self.retain(|_| true);
    }

    /// Nothing can be taken back or done again: the commands are another scene's.
    pub fn clear(&mut self) {
        *self = History::default();
    }

    /// What is taken back next, and how many steps there are.
    #[must_use]
    pub fn to_undo(&self) -> (Option<&Step>, usize) {
        let full = |step: &&Step| !step.commands.is_empty();
        (self.done.iter().rfind(full), self.done.iter().filter(full).count())
    }

    /// What is done again next, and how many steps there are.
    #[must_use]
    pub fn to_redo(&self) -> (Option<&Step>, usize) {
        (self.undone.last(), self.undone.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use forerun::BodyId;

    fn command(frame: u64, sequence: u64) -> Command {
        let key = CommandKey { frame: Frame(frame), source: 0, sequence };
        Command { key, change: Change::Release { body: BodyId(0) } }
    }

    fn labels(history: &History) -> (Option<&str>, usize, usize) {
        let (next, count) = history.to_undo();
        (next.map(|step| step.label.as_str()), count, history.to_redo().1)
    }

    fn two_steps() -> History {
        let mut history = History::default();
        history.begin("drag");
        history.give(command(3, 0));
        history.give(command(4, 1));
        history.begin("throw");
        history.give(command(9, 2));
        history.end();
        history
    }

    #[test]
    fn a_drag_is_one_step_and_comes_back_with_the_keys_that_it_had() {
        let mut history = two_steps();
        assert_eq!(labels(&history), (Some("throw"), 2, 0));
        let mut told = Vec::new();
        for _ in 0..2 {
            history.undo(|command| {
                told.push(command.key.sequence);
                true
            });
        }
        assert_eq!((told.as_slice(), labels(&history)), (&[2, 1, 0][..], (None, 0, 2)));
        told.clear();
        history.redo(|command| {
            told.push(command.key.sequence);
            true
        });
        assert_eq!((told.as_slice(), labels(&history)), (&[0, 1][..], (Some("drag"), 1, 1)));
        history.begin("push");
        history.give(command(9, 3));
        assert_eq!(labels(&history), (Some("push"), 2, 0), "what was taken back is gone");
    }

    #[test]
    fn what_there_is_no_room_for_stays_to_be_taken_back() {
        let mut history = two_steps();
        history.undo(|_| true);
        history.undo(|command| command.key.sequence == 1);
        assert_eq!(labels(&history), (Some("drag"), 1, 2));
        assert_eq!(history.to_undo().0.map(|step| step.commands.len()), Some(1));
        history.redo(|_| false);
        assert_eq!(labels(&history), (Some("drag"), 1, 2));
    }

    #[test]
    fn refused_forgotten_and_empty_steps_never_were() {
        let mut history = two_steps();
        history.forget(command(9, 2).key);
        assert_eq!(labels(&history), (Some("drag"), 1, 0));
        history.forget_to(Frame(3));
        assert_eq!(history.to_undo().0.map(|step| step.commands.len()), Some(1));
        history.begin("nothing");
        history.forget_to(Frame(4));
        assert_eq!(labels(&history), (None, 0, 0));
        history.give(command(12, 7));
        assert_eq!(labels(&history), (Some("nothing"), 1, 0), "it was still open");
        assert!(history.end());
        history.begin("nothing at all");
        assert!(!history.end(), "there is no such step to be taken back");
        assert!(!history.end(), "and the one before has ended long ago");
        assert_eq!(labels(&history), (Some("nothing"), 1, 0));
    }
}
