//! Timelines: what the cases about them share: edits, and what an edit cost.

use forerun::timeline::check::{full_run, mismatches};
use forerun::timeline::{Advance, Change, Command, Frame, Progress, Timeline, TimelineSettings};
use forerun::{BodyDef, BodyId, Environment, Vec3};

/// All frames to `frames`, computed and kept.
///
/// # Panics
/// When a body is refused, as above.
pub(crate) fn computed((bodies, environment): &(Vec<BodyDef>, Environment), frames: u32) -> Timeline {
    let settings = TimelineSettings { lookahead: frames, past: frames, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(bodies, *environment, settings).expect("the bodies are possible");
    run(&mut timeline);
    timeline
}

/// Computes until everything is true; what each frame of work was.
pub(crate) fn run(timeline: &mut Timeline) -> Vec<Advance> {
    let mut work = Vec::new();
    while let Progress::Advanced(done) = timeline.advance() {
        work.push(done);
    }
    work
}

/// Makes changes in one batch and works them off.
///
/// # Panics
/// When a change is refused: a mistake in the case.
pub(crate) fn edit(
    timeline: &mut Timeline,
    changes: impl IntoIterator<Item = (Frame, Change)>,
) -> Vec<Advance> {
    for (frame, change) in changes {
        timeline.change(frame, change).expect("the change is possible");
    }
    run(timeline)
}

/// Body-frames whose bits are not those of a full simulation with the same commands.
///
/// # Panics
/// When a full simulation refuses a command that the timeline accepted.
pub(crate) fn wrong(timeline: &Timeline, (bodies, environment): &(Vec<BodyDef>, Environment)) -> f64 {
    let in_force = timeline.commands().map(|(key, change)| Command { key: *key, change: change.clone() });
    let full = full_run(bodies, in_force, *environment, timeline.horizon().0 as u32);
    mismatches(timeline, &full.expect("what was accepted once is accepted again")).0 as f64
}

/// The first frame at which a body's state is another one in the two.
pub(crate) fn first_difference(a: &Timeline, b: &Timeline, body: BodyId) -> Option<Frame> {
    let differs = |frame: &Frame| match (a.state(body, *frame), b.state(body, *frame)) {
        (Some(a), Some(b)) => !a.same_bits(b),
        (a, b) => a.is_some() != b.is_some(),
    };
    (a.oldest().0..=a.horizon().0).map(Frame).find(differs)
}

/// An impulse that gives a body this velocity. m/s
pub(crate) fn push(timeline: &Timeline, body: BodyId, velocity: Vec3) -> Change {
    let inverse_mass = timeline.body_at(body, timeline.oldest()).map_or(1.0, |body| body.inverse_mass);
    Change::Push { body, impulse: velocity / inverse_mass, at_point: None }
}
