//! Frames: the numbers of stored simulation steps.

use std::fmt;

/// Number of a stored simulation step: frame `k` is time `k * frame_seconds`. Never a rendered picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Frame(pub u64);

impl Frame {
    /// The frame after this one.
    #[must_use]
    pub const fn next(self) -> Frame {
        Frame(self.0.saturating_add(1))
    }

    /// The frame `frames` later.
    #[must_use]
    pub const fn plus(self, frames: u64) -> Frame {
        Frame(self.0.saturating_add(frames))
    }

    /// The frame `frames` earlier, not before frame 0.
    #[must_use]
    pub const fn minus(self, frames: u64) -> Frame {
        Frame(self.0.saturating_sub(frames))
    }

    /// How many frames this one is after `earlier`; 0 when it is not after it.
    #[must_use]
    pub const fn since(self, earlier: Frame) -> u64 {
        self.0.saturating_sub(earlier.0)
    }

    /// The time of the frame. Seconds.
    #[must_use]
    pub fn seconds(self, frame_seconds: f32) -> f64 {
        self.0 as f64 * f64::from(frame_seconds)
    }
}

impl fmt::Display for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "frame {}", self.0)
    }
}
