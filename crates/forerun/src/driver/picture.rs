//! Picture: what there is to draw at a display time.

use std::sync::Arc;

use forerun_timeline::{Frame, Snapshot, Stats};

use super::frame_notes::FrameNote;

/// A picture whose clock went slower than this was slowed; less is rounding.
const FULL_RATE: f64 = 1.0 - 1e-6;

/// What there is to draw at a display time.
#[derive(Clone, Debug)]
pub struct Picture {
    /// All that physics knew when the picture was taken: sample it at `time_s`.
    pub snapshot: Arc<Snapshot>,
    /// Display time T. Seconds. Less than in the picture before only after [`Decoupled::seek`](crate::Decoupled::seek). It does not go on past the
    /// horizon, and stands still where that comes to lie before it: when a fork that goes less far is adopted, or memory is short.
    pub time_s: f64,
    /// What T would be if physics had never been late. Seconds.
    pub wished_s: f64,
    /// The caller's clock when the picture was asked for. Seconds.
    pub real_s: f64,
    /// How fast T went since the picture before, against the caller's clock times the speed: below 1 where physics was late, at most 1.05
    /// where lost time is being made good. 1 in the first picture and after [`Decoupled::seek`](crate::Decoupled::seek).
    pub rate: f64,
    /// The frame shown: the last one at or before `time_s`.
    pub frame: Frame,
    /// How that frame was computed; none while it is not.
    pub note: Option<FrameNote>,
    /// How far back commands threw the physics since the picture before: the last frame that was true for all bodies right after.
    pub dropped_to: Option<Frame>,
    /// Work of the physics so far.
    pub stats: Stats,
}

impl Picture {
    /// Whether the clock was slowed because physics was late.
    #[must_use]
    pub fn is_slowed(&self) -> bool {
        self.rate < FULL_RATE
    }
}
