//! Soak: a display that goes on for minutes while everything is changed and physics stalls.

mod editor;
mod machine;
mod oracle;
mod session;
mod witness;

pub(crate) use editor::Edits;
pub(crate) use machine::Lateness;
pub(crate) use session::{Soaked, soak};
pub(crate) use witness::Seen;

use std::num::NonZeroU16;

/// What is done to a scene and its display.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SoakSettings {
    /// Seconds of real time.
    pub(crate) seconds: f64,
    /// Pictures per second.
    pub(crate) fps: f64,
    pub(crate) edits_per_second: f64,
    /// Whether a body is dragged all the time, by a command at every picture.
    pub(crate) drag: bool,
    /// Longest stall of the physics. Seconds; 0 for none.
    pub(crate) stall_s: f64,
    /// From one stall to the next, in the mean. Seconds.
    pub(crate) stall_every_s: f64,
    /// What every computed frame takes longer. Seconds.
    pub(crate) slow_s: f64,
    pub(crate) lookahead: u32,
    /// States that are ahead before the first picture.
    pub(crate) prefill: u32,
    /// Threads that do nothing but keep a processor busy.
    pub(crate) hogs: u16,
    pub(crate) threads: Option<NonZeroU16>,
    pub(crate) seed: u64,
}
