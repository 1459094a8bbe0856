//! Drivers: who steps the physics, in which thread, and against which clock.
//!
//! *Architecture invariant:* this is the lowest floor that knows a thread or a clock; see README.md beside the rooms.

mod clock;
mod coupled;
mod decoupled;
mod direct_change;
mod frame_notes;
mod physics;
mod reach;
mod threads;

pub use clock::Clock;
pub use coupled::{Coupled, StepLimits};
pub use decoupled::{Decoupled, DecoupledSettings, DriverError, Picture};
pub use direct_change::ChangeError;
pub use frame_notes::FrameNote;
pub use threads::{Threads, ThreadsError};
