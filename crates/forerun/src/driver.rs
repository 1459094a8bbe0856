//! Drivers: who steps the physics, in which thread, and against which clock.
//!
//! *Architecture invariant:* this is the lowest floor that knows a thread or a clock; see README.md beside the rooms.

mod blend;
mod clock;
mod coupled;
mod decoupled;
mod direct_change;
mod driver_error;
mod frame_notes;
mod pace;
mod physics;
mod reach;
mod threads;

pub use blend::{Blending, Offset};
pub use clock::Clock;
pub use coupled::{Coupled, StepLimits};
pub use decoupled::{Decoupled, DecoupledSettings, Picture};
pub use direct_change::ChangeError;
pub use driver_error::DriverError;
pub use frame_notes::FrameNote;
pub use threads::{Threads, ThreadsError};
