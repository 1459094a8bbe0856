//! Simulation states over time: tracks, commands, incremental re-simulation, sampling.
//!
//! *Architecture invariant:* for every body and every frame up to [`Timeline::valid_to`], the timeline equals a full
//! simulation with the same commands, bit for bit, whatever the order in which commands arrived, the number of threads, and
//! how often anything was re-simulated.
//!
//! *Architecture invariant:* this crate knows no physics and reads no clock.

pub mod command;
pub mod frame;
pub mod snapshot;
pub mod timeline;

pub use command::{Change, Command, CommandError, CommandKey};
pub use frame::Frame;
pub use snapshot::{Certainty, Sample, Snapshot};
pub use timeline::{Advance, Counters, Progress, Stats, Timeline, TimelineError, TimelineSettings};
