//! Edits as marks of the strip, in words.

use forerun::{Change, CommandKey};

use crate::session::Play;

/// Commands that lie so close that one mark stands for them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mark {
    /// Where. Points.
    pub(super) x: f32,
    /// What its tooltip says: one line a command.
    pub(super) lines: Vec<String>,
    /// Commands that it says no more of.
    pub(super) more: usize,
}

/// Lines of a tooltip.
const LINES_MAX: usize = 8;
/// Marks closer than this are one. Points.
const APART: f32 = 4.0;

/// The marks of all commands that are in force.
pub(super) fn marks(play: &Play, x_of: impl Fn(f64) -> f32) -> Vec<Mark> {
    let seconds = play.picture.snapshot.frame_seconds();
    let mut marks: Vec<Mark> = Vec::new();
    for (key, change) in play.picture.snapshot.commands() {
        let x = x_of(key.frame.seconds(seconds));
        match marks.last_mut() {
            Some(last) if x - last.x < APART && last.lines.len() < LINES_MAX => {
                last.lines.push(line(key, change, seconds))
            }
            Some(last) if x - last.x < APART => last.more += 1,
            _ => marks.push(Mark { x, lines: vec![line(key, change, seconds)], more: 0 }),
        }
    }
    marks
}

fn line(key: &CommandKey, change: &Change, seconds: f32) -> String {
    format!("{:.3} s  {}", key.frame.seconds(seconds), told(change))
}

/// A change in words.
fn told(change: &Change) -> String {
    let what = match change {
        Change::Add { .. } => "add",
        Change::Remove { .. } => "remove",
        Change::Move { .. } => "move",
        Change::Push { .. } => "push",
        Change::SetVelocity { .. } => "velocity of",
        Change::Hold { .. } => "hold",
        Change::Release { .. } => "let go of",
        Change::SetMaterial { .. } => "surface of",
        Change::SetForce { .. } => "force on",
        Change::SetGravityScale { .. } => "gravity on",
        Change::SetMass { .. } => "mass of",
        Change::SetKind { .. } => "kind of",
        Change::SetGravity { gravity } => {
            return format!("gravity {:.2}, {:.2}, {:.2} m/s²", gravity.x, gravity.y, gravity.z);
        }
    };
    match change.body() {
        Some(body) => format!("{what} body {}", body.0),
        None => what.to_owned(),
    }
}
