//! Remote: a display and a physics that share no memory, such as a page and its worker.
//!
//! ```text
//!   display's side                                    physics' side
//!   ──────────────                                    ─────────────
//!   Decoupled ── queue ──▶ Courier::outgoing ── letter ──▶ RemotePhysics::receive
//!             ◀─ root ──── Courier::receive ◀── report ─── RemotePhysics::publish
//! ```
//!
//! Both halves are plain values without a thread or a clock; whoever has them carries bytes from one to the other, in order. The display's
//! half is the same [`Decoupled`](crate::Decoupled) as with a physics thread: pace, blending, orders and undo are one code.
//!
//! Promise: the display gets the snapshots that a thread would have given it, bit for bit. A message that is lost, damaged or not from here is
//! an error, never a panic, and changes nothing. Messages that the other side has not taken are bounded, in number ([`REPORTS_MAX`], [`LETTERS_MAX`])
//! and in bytes ([`WAITING_BYTES_MAX`]); what happens meanwhile is in the next one.

mod answer_value;
mod courier;
mod delta_value;
mod refusal_value;
mod remote_physics;
#[cfg(test)]
mod tests;
mod wire;

use std::fmt;

use crate::Clock;

pub use courier::Courier;
pub use remote_physics::RemotePhysics;

/// Reports that may be under way or unread at a time.
const REPORTS_MAX: u64 = 4;

/// Letters that may be, but for those that say that a report was taken: as many as there are reports.
const LETTERS_MAX: u64 = 64;

/// While reports of so many bytes are under way or unread, no other is made.
const WAITING_BYTES_MAX: usize = 64 << 20;

/// Nobody reads a longer message. Bytes.
const MESSAGE_BYTES_MAX: usize = 512 << 20;

/// How a physics works that is elsewhere than its display.
#[derive(Clone, Debug)]
pub struct RemoteSettings {
    /// Orders that may wait for the physics; more are refused. 1 to 65536, default 1024.
    pub command_capacity: usize,
    /// As [`DecoupledSettings::count_areas`](crate::DecoupledSettings::count_areas). Default false.
    pub count_areas: bool,
    /// As [`DecoupledSettings::stage_clock`](crate::DecoupledSettings::stage_clock). Default none.
    pub stage_clock: Option<Clock>,
}

impl Default for RemoteSettings {
    fn default() -> Self {
        RemoteSettings { command_capacity: 1024, count_areas: false, stage_clock: None }
    }
}

/// Why a message is not taken. Nothing changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RemoteError {
    /// It is damaged, or was made by something else or another version.
    Damaged(String),
    /// One before it was lost, or it comes a second time.
    OutOfTurn {
        /// The number that was due.
        due: u64,
        /// Its number.
        number: u64,
    },
    /// It says what cannot be.
    Impossible(String),
}

impl fmt::Display for RemoteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RemoteError::Damaged(what) => {
                write!(f, "the message is damaged or of another version ({what}): begin anew")
            }
            RemoteError::OutOfTurn { due, number } => {
                write!(f, "message {number} came where {due} was due: begin anew")
            }
            RemoteError::Impossible(what) => write!(f, "the message says what cannot be: {what}"),
        }
    }
}

impl std::error::Error for RemoteError {}
