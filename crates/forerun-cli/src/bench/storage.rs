//! Storage: how many bytes a timeline keeps for a body and a frame.

use forerun::Timeline;
use forerun::timeline::Progress;

/// Frames that are computed for it, at most: the price per frame does not depend on how many there are.
const FRAMES_MAX: u32 = 120;

/// Runs the timeline ahead and divides what it stores by bodies and frames. None for a scene without bodies.
pub(crate) fn bytes_per_body_frame(mut timeline: Timeline, frames: u32) -> Option<f64> {
    timeline.set_lookahead(frames.min(FRAMES_MAX));
    while let Progress::Advanced(_) = timeline.advance() {}
    let body_frames = timeline.bodies_at(timeline.horizon()).len() as u64 * timeline.horizon().0;
    (body_frames > 0).then(|| timeline.state_bytes() as f64 / body_frames as f64)
}
