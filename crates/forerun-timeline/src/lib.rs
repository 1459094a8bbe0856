//! Simulation states over time: tracks, commands, incremental re-simulation, sampling.
//!
//! *Architecture invariant:* for every body and every frame up to [`Timeline::valid_to`], the timeline equals a full
//! simulation with the same commands, bit for bit, whatever the order in which commands arrived, the number of threads, and
//! how often anything was re-simulated.
//!
//! *Architecture invariant:* this crate knows no physics and reads no clock.

mod activity;
mod affected;
mod areas;
pub mod check;
pub mod command;
mod command_log;
mod commanding;
mod definitions;
mod effect;
pub mod frame;
mod frame_table;
mod sample;
pub mod snapshot;
mod stale;
pub mod timeline;
mod wavefront;

#[doc(hidden)]
pub use affected::Mutation;
pub use areas::Area;
pub use command::{Change, Command, CommandError, CommandKey};
pub use frame::Frame;
pub use snapshot::{Certainty, Sample, Snapshot};
pub use timeline::{Advance, Counters, Progress, Stats, Timeline, TimelineError, TimelineSettings};
