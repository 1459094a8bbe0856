//! Scrubbing: after an hour's worth of seeks to random frames, every state shown has the bits that were computed; what a seek costs.

use forerun::timeline::check::Random;
use forerun::timeline::{Frame, Progress, Sample, Snapshot, Timeline, TimelineSettings};
use forerun::{BodyId, Clock};

use crate::stats::Spread;
use crate::validate::Figure;
use crate::validate::lab::built_in;

const FRAMES: u32 = 3600;
const SEEKS: u32 = 10_000;
/// At full size: frames that a resting scene has anyway.
const SCENES: [&str; 3] = ["many_pyramids", "rings:100", "large_pyramid"];

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for scene in SCENES {
        scrub(&mut figures, scene);
    }
    figures
}

fn scrub(figures: &mut Vec<Figure>, name: &str) {
    let (bodies, environment) = built_in(name);
    let settings = TimelineSettings { lookahead: 60, past: FRAMES, ..TimelineSettings::default() };
    let Ok(mut timeline) = Timeline::new(&bodies, environment, settings) else { return };
    let sums = play(&mut timeline);
    let snapshot = timeline.snapshot();
    let frames = sums.len() as u64;
    let mut random = Random::new(7);
    let at_random = (0..SEEKS).map(|_| random.below(frames)).collect();
    let scrubs: [(&str, Vec<u64>); 4] = [
        ("random seeks", at_random),
        ("backwards, every second frame", (0..frames).rev().step_by(2).collect()),
        ("backwards", (0..frames).rev().collect()),
        ("every fourth frame", (0..frames).step_by(4).collect()),
    ];
    let clock = Clock::system();
    for (what, order) in scrubs {
        let (mut samples, mut times_ms, mut wrong) = (Vec::new(), Vec::new(), 0);
        for frame in order {
            let began = clock.now();
            snapshot.sample_all(Frame(frame).seconds(snapshot.frame_seconds()), &mut samples);
            times_ms.push(1000.0 * (clock.now() - began).as_secs_f64());
            wrong += u32::from(shown(&samples) != sums[frame as usize].shown);
            wrong += u32::from(
                what == "random seeks" && stored(&snapshot, Frame(frame)) != sums[frame as usize].stored,
            );
        }
        figures.push(Figure::at_most(
            format!("{name}, {what}: frames with other bits"),
            f64::from(wrong),
            0.0,
        ));
        let p99 = Spread::of(&times_ms).p99;
        figures.push(Figure::time_at_most(format!("{name}, {what}: p99, ms"), p99, 5.0));
    }
    let body_frames = bodies.len() as f64 * frames as f64;
    let bytes = timeline.state_bytes() as f64;
    figures.push(Figure::reported(format!("{name}: bytes for a body and frame"), bytes / body_frames));
    figures.push(Figure::reported(
        format!("{name}: states that move, part of all"),
        moving(&timeline) / body_frames,
    ));
}

/// Sums over the bits of a frame.
struct Sums {
    /// Of the poses of its bodies.
    shown: u64,
    /// Of their states.
    stored: u64,
}

/// Plays all frames; their sums, taken from the states as soon as they were computed.
fn play(timeline: &mut Timeline) -> Vec<Sums> {
    let mut sums = vec![sums_of(timeline, Frame(0))];
    while timeline.horizon() < Frame(u64::from(FRAMES)) {
        match timeline.advance() {
            Progress::Advanced(done) => sums.push(sums_of(timeline, done.frame)),
            Progress::Idle => timeline.set_display(timeline.display().next()),
        }
    }
    sums
}

fn sums_of(timeline: &Timeline, frame: Frame) -> Sums {
    let (mut shown, mut stored) = (Sum::default(), Sum::default());
    for id in timeline.bodies_at(frame) {
        if let (Some(body), Some(state)) = (timeline.body_at(id, frame), timeline.state(id, frame)) {
            shown.add_pose(id, &body.own_pose(state));
            stored.add_state(id, state);
        }
    }
    Sums { shown: shown.0, stored: stored.0 }
}

fn shown(samples: &[(BodyId, Sample)]) -> u64 {
    let mut sum = Sum::default();
    for (id, sample) in samples {
        sum.add_pose(*id, &sample.pose);
    }
    sum.0
}

fn stored(snapshot: &Snapshot, frame: Frame) -> u64 {
    let mut sum = Sum::default();
    for id in snapshot.bodies_at(frame) {
        if let Some(state) = snapshot.state(id, frame) {
            sum.add_state(id, state);
        }
    }
    sum.0
}

/// States that are not those of the frame before.
fn moving(timeline: &Timeline) -> f64 {
    let mut count = 0.0;
    for frame in (1..=timeline.horizon().0).map(Frame) {
        for id in timeline.bodies_at(frame) {
            let states = (timeline.state(id, frame), timeline.state(id, frame.minus(1)));
            let same = matches!(states, (Some(a), Some(b)) if a.same_bits(b));
            count += f64::from(u8::from(!same));
        }
    }
    count
}

/// FNV-1a over words: a sum that another bit anywhere changes.
struct Sum(u64);

impl Default for Sum {
    fn default() -> Sum {
        Sum(0xcbf2_9ce4_8422_2325)
    }
}

impl Sum {
    fn add(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3);
    }

    fn add_pose(&mut self, id: BodyId, pose: &forerun::Pose) {
        self.add(id.0);
        pose.position.to_array().iter().for_each(|x| self.add(x.to_bits()));
        pose.rotation.to_array().iter().for_each(|x| self.add(x.to_bits()));
    }

    fn add_state(&mut self, id: BodyId, state: &forerun::dynamics::BodyState) {
        self.add_pose(id, &state.pose());
        state.velocity.to_array().iter().for_each(|x| self.add(x.to_bits()));
        state.angular_velocity.to_array().iter().for_each(|x| self.add(x.to_bits()));
        self.add(state.rest);
    }
}
