//! Playback: a scene against the clock, with a record of every picture.

mod log;
mod report;

pub use log::{QueueRow, write_queue_csv};
pub use report::Report;
