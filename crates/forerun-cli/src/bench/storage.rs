//! Storage: what a timeline takes for a frame, in bytes and in time.

use forerun::Timeline;
use forerun::timeline::Progress;

use crate::bench::{Measurement, Run};

/// Frames that are computed for it, at most: the price per frame does not depend on how many there are.
const FRAMES_MAX: u32 = 120;

/// Runs the timeline ahead as long as the world was run, and adds to what was measured of the world. Nothing for a scene without bodies.
pub(crate) fn add_storage(measurement: &mut Measurement, mut timeline: Timeline, run: &Run) {
    run.threads.install(|| {
        settle(&mut timeline, run.settle);
        let (start, bytes_start) = (timeline.horizon(), timeline.state_bytes());
        timeline.set_lookahead(run.frames.min(FRAMES_MAX));
        let stopwatch = run.stopwatch();
        let start_ms = stopwatch.read_ms();
        while let Progress::Advanced(_) = timeline.advance() {}
        let passed_ms = stopwatch.read_ms() - start_ms;
        let frames = timeline.horizon().0 - start.0;
        let body_frames = timeline.bodies_at(timeline.horizon()).len() as u64 * frames;
        if body_frames > 0 {
            let bytes = timeline.state_bytes().saturating_sub(bytes_start);
            measurement.bytes_per_body_frame = Some(bytes as f64 / body_frames as f64);
            measurement.timeline_frame_ms = Some(passed_ms / frames as f64);
        }
    });
}

/// Lets frames pass of which none is kept but the last.
fn settle(timeline: &mut Timeline, frames: u32) {
    timeline.set_lookahead(1);
    for _ in 0..frames {
        while let Progress::Advanced(_) = timeline.advance() {}
        timeline.set_display(timeline.horizon());
    }
}
