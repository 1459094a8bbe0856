//! Every kept frame can be shown at once, and shows what was computed, bit for bit.

use forerun_dynamics::{BodyId, BodyState};
use forerun_geometry::Vec3;
use forerun_timeline::check::Random;
use forerun_timeline::{Certainty, Frame, Progress, Snapshot, Timeline, TimelineSettings};

use crate::lab::{domino_lines, environment, push, pyramids, run};

const FRAMES: u64 = 240;

/// By frame and body: the states, copied when their frame was computed and before any other was.
type Recording = Vec<Vec<(BodyId, BodyState)>>;

fn states(timeline: &Timeline, frame: Frame) -> Vec<(BodyId, BodyState)> {
    let ids = timeline.bodies_at(frame).into_iter();
    ids.filter_map(|id| Some((id, *timeline.state(id, frame)?))).collect()
}

/// Plays to the end with the display close behind, and keeps all frames.
fn played(bodies: &[forerun_dynamics::BodyDef]) -> (Timeline, Recording) {
    let settings = TimelineSettings { lookahead: 12, past: FRAMES as u32, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(bodies, environment(), settings).unwrap();
    timeline.change(Frame(20), push(BodyId(1), Vec3::new(25.0, 0.0, 5.0))).unwrap();
    let mut recording = vec![states(&timeline, Frame(0))];
    while timeline.horizon() < Frame(FRAMES) {
        match timeline.advance() {
            Progress::Advanced(done) => {
                assert_eq!(done.frame.0, recording.len() as u64);
                recording.push(states(&timeline, done.frame));
            }
            Progress::Idle => timeline.set_display(timeline.display().next()),
        }
    }
    (timeline, recording)
}

#[track_caller]
fn assert_shows(snapshot: &Snapshot, frame: u64, recording: &Recording) {
    let seconds = Frame(frame).seconds(snapshot.frame_seconds());
    let mut samples = Vec::new();
    snapshot.sample_all(seconds, &mut samples);
    assert_eq!(samples.len(), recording[frame as usize].len());
    for ((id, sample), (recorded_id, state)) in samples.iter().zip(&recording[frame as usize]) {
        assert_eq!(id, recorded_id);
        assert_eq!(sample.certainty, Certainty::Exact);
        let body = snapshot.body_at(*id, Frame(frame)).unwrap();
        assert_eq!(sample.pose, body.own_pose(state), "frame {frame}, body {}", id.0);
        assert!(snapshot.state(*id, Frame(frame)).unwrap().same_bits(state));
    }
}

#[test]
fn random_seeks_and_steady_scrubs_show_the_computed_bits() {
    for bodies in [pyramids(3, 4), domino_lines(4)] {
        let (timeline, recording) = played(&bodies);
        let snapshot = timeline.snapshot();
        let mut random = Random::new(3);
        for _ in 0..500 {
            assert_shows(&snapshot, random.below(FRAMES + 1), &recording);
        }
        let backwards_twice = (0..=FRAMES).rev().step_by(2);
        let backwards = (0..=FRAMES).rev();
        let forwards_four_times = (0..=FRAMES).step_by(4);
        for frame in backwards_twice.chain(backwards).chain(forwards_four_times) {
            assert_shows(&snapshot, frame, &recording);
        }
    }
}

#[test]
fn scrubbing_back_computes_nothing_and_loses_nothing() {
    let (mut timeline, recording) = played(&pyramids(2, 4));
    run(&mut timeline);
    let done = timeline.stats();
    let mut random = Random::new(9);
    for _ in 0..50 {
        // Never ahead of where it was: there is nothing to compute.
        timeline.set_display(Frame(random.below(timeline.display().0.max(1))));
        assert!(run(&mut timeline).is_empty());
        let shown = timeline.display().0;
        assert_shows(&timeline.snapshot(), shown, &recording);
    }
    let after = timeline.stats();
    assert_eq!((after.ahead, after.edits), (done.ahead, done.edits));
    for frame in 0..=FRAMES {
        assert_shows(&timeline.snapshot(), frame, &recording);
    }
}

/// To go back and go on differently is an edit like any other.
#[test]
fn going_on_differently_from_an_earlier_frame_keeps_what_was_before_it() {
    let bodies = pyramids(3, 4);
    let (mut timeline, recording) = played(&bodies);
    timeline.set_display(Frame(90));
    timeline.change(Frame(91), push(BodyId(10), Vec3::new(900.0, 0.0, 0.0))).unwrap();
    run(&mut timeline);
    let snapshot = timeline.snapshot();
    for frame in 0..=90 {
        assert_shows(&snapshot, frame, &recording);
    }
    let pushed = |t: &[(BodyId, BodyState)]| t.iter().find(|(id, _)| *id == BodyId(10)).map(|(_, s)| *s);
    assert_ne!(pushed(&states(&timeline, Frame(91))), pushed(&recording[91]));
    crate::lab::assert_equals_full_run(&timeline, &bodies);
}
