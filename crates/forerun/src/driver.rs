//! Drivers: who steps the physics, in which thread, and against which clock.
//!
//! *Architecture invariant:* this is the lowest floor that knows a thread or a clock; see README.md beside the rooms.

mod blend;
mod clock;
mod coupled;
mod decoupled;
mod direct_change;
mod driver_error;
mod fork;
mod frame_notes;
mod hearing;
mod inquiry;
mod pace;
mod physics;
mod picture;
mod reach;
mod refusal;
mod remote;
mod stage_times;
mod threads;

pub use blend::{Blending, Offset};
pub use clock::Clock;
pub use coupled::{Coupled, StepLimits};
pub use decoupled::{Decoupled, DecoupledSettings};
pub use direct_change::ChangeError;
pub use driver_error::DriverError;
pub use fork::Fork;
pub use frame_notes::FrameNote;
pub use inquiry::{Answer, Answered, InquiryError, Question, Ticket};
pub use physics::Hinder;
pub use picture::Picture;
pub use refusal::{AdoptError, Refusal};
pub use remote::{Courier, RemoteError, RemotePhysics, RemoteSettings};
pub use stage_times::StageTimes;
pub use threads::{Threads, ThreadsError};
