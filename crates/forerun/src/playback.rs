//! Playback: a scene against the clock, with a record of every picture.

mod log;
mod play;
mod report;
mod settings;
mod show;

pub use log::{QueueRow, write_queue_csv};
pub use play::{Playback, play};
pub use report::Report;
pub use settings::{DriverKind, PlaybackError, PlaybackSettings};
