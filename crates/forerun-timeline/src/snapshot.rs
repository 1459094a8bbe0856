//! Snapshot: an immutable picture of the timeline that a display keeps and samples without locks.

use forerun_dynamics::{BodyId, BodyState};
use forerun_geometry::{Pose, Vec3};

use crate::Frame;

/// How sure a sampled state is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Certainty {
    /// From states that are known to be true for all commands accepted before the snapshot.
    Exact,
    /// Physics has not yet recomputed the body so far: it goes on at its last velocity for a few frames.
    Extrapolated,
    /// Physics is late: the last state that is known, held.
    Held,
}

/// A body at some time, not only at a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Where the body's own frame is.
    pub pose: Pose,
    /// Velocity of the centre of mass. m/s.
    pub velocity: Vec3,
    /// Angular velocity in the world. rad/s.
    pub angular_velocity: Vec3,
    /// How sure this is.
    pub certainty: Certainty,
}

/// States of all bodies from [`oldest`](Snapshot::oldest) to [`horizon`](Snapshot::horizon), as they were known when it was made.
/// Making one costs a reference count per frame; it never changes.
#[derive(Clone, Debug)]
pub struct Snapshot {
    pub(crate) oldest: Frame,
    pub(crate) horizon: Frame,
    pub(crate) valid_to: Frame,
    pub(crate) frame_seconds: f32,
}

impl Snapshot {
    /// The oldest frame kept.
    #[must_use]
    pub fn oldest(&self) -> Frame {
        self.oldest
    }

    /// The last frame computed.
    #[must_use]
    pub fn horizon(&self) -> Frame {
        self.horizon
    }

    /// The last frame that is known to be true for all bodies.
    #[must_use]
    pub fn valid_to(&self) -> Frame {
        self.valid_to
    }

    /// Length of a frame. Seconds.
    #[must_use]
    pub fn frame_seconds(&self) -> f32 {
        self.frame_seconds
    }

    /// The stored state of a body; `None` when there is none at that frame.
    #[must_use]
    pub fn state(&self, body: BodyId, frame: Frame) -> Option<&BodyState> {
        let _ = (body, frame);
        None
    }

    /// The body at a time (seconds since frame 0): exactly the stored state at a frame, between two of them interpolated, past the
    /// last one that is known held. `None` where the body does not exist.
    #[must_use]
    pub fn sample(&self, body: BodyId, seconds: f64) -> Option<Sample> {
        let _ = (body, seconds);
        None
    }

    /// All bodies at a time, in the order of their ids. `samples` is emptied first and keeps its memory.
    pub fn sample_all(&self, seconds: f64, samples: &mut Vec<(BodyId, Sample)>) {
        let _ = seconds;
        samples.clear();
    }

    /// The fewest states that a body has stored ahead of a display time (seconds) and that are known to be true.
    #[must_use]
    pub fn queue_min(&self, seconds: f64) -> u64 {
        let _ = seconds;
        0
    }

    /// The most states that a body has stored ahead of a display time (seconds) and that are known to be true.
    #[must_use]
    pub fn queue_max(&self, seconds: f64) -> u64 {
        let _ = seconds;
        0
    }
}
