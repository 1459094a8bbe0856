//! Lab: what the cases share: scenes, full runs, and the islands of a frame by brute force.

use std::collections::BTreeSet;

use forerun_dynamics::narrow_phase::find_contacts;
use forerun_dynamics::{BodyDef, BodyId, Environment, Member};
use forerun_geometry::Vec3;
use forerun_geometry::shape::{Cuboid, Shape};
use forerun_timeline::check::{full_run, mismatches};
use forerun_timeline::{Advance, Change, Command, Frame, Progress, Timeline, TimelineSettings};

/// Bodies that come to rest after half a second of quiet, so that small runs have resting islands.
pub(crate) fn environment() -> Environment {
    let mut environment = Environment::default();
    environment.settings.rest_seconds = 0.5;
    environment
}

/// All frames to `frames`, computed and kept.
pub(crate) fn timeline(bodies: &[BodyDef], frames: u32) -> Timeline {
    let settings = TimelineSettings { lookahead: frames, past: 10_000, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(bodies, environment(), settings).unwrap();
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

/// Every state has the bits of a full simulation with the commands that are in force now.
#[track_caller]
pub(crate) fn assert_equals_full_run(timeline: &Timeline, bodies: &[BodyDef]) {
    let in_force = timeline.commands().map(|(key, change)| Command { key: *key, change: change.clone() });
    let frames = timeline.horizon().0 as u32;
    let full = full_run(bodies, in_force, environment(), frames).unwrap();
    let (count, first) = mismatches(timeline, &full);
    assert!(first.is_none(), "{count} body-frames differ; {}", first.unwrap());
}

/// The first frame at which a body's state is another one in the two.
pub(crate) fn first_difference(a: &Timeline, b: &Timeline, body: BodyId) -> Option<Frame> {
    let differs = |frame: &Frame| match (a.state(body, *frame), b.state(body, *frame)) {
        (Some(a), Some(b)) => !a.same_bits(b),
        (a, b) => a.is_some() != b.is_some(),
    };
    (0..=a.horizon().0).map(Frame).find(differs)
}

/// Pairs of dynamic bodies with a contact in the step that leaves a frame: each with each, no grid, no sweep.
pub(crate) fn touching(timeline: &Timeline, frame: Frame) -> Vec<(BodyId, BodyId)> {
    let ids = timeline.bodies_at(frame);
    let member = |id: &BodyId| {
        let (body, state) = (timeline.body_at(*id, frame)?, timeline.state(*id, frame)?);
        body.is_dynamic().then_some(Member { id: *id, body, state: *state })
    };
    let members: Vec<Member> = ids.iter().filter_map(member).collect();
    let count = members.len() as u32;
    let pairs: Vec<(u32, u32)> = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))).collect();
    let contacts = find_contacts(&members, &pairs, &timeline.environment_at(frame));
    contacts.iter().map(|c| (members[c.first as usize].id, members[c.second as usize].id)).collect()
}

/// By frame that a step leaves: the bodies that have to be advanced again when `before` becomes `after`. That is whoever is another one
/// there or is commanded in the next frame, and who is in an island with it before or after.
pub(crate) fn ideal(
    before: &Timeline,
    after: &Timeline,
    commanded: &[(Frame, BodyId)],
) -> Vec<BTreeSet<BodyId>> {
    (0..after.horizon().0)
        .map(Frame)
        .map(|frame| {
            let mut ids = before.bodies_at(frame);
            ids.extend(after.bodies_at(frame));
            let changed = |id: &BodyId| {
                let states = (before.state(*id, frame), after.state(*id, frame));
                let same = match states {
                    (Some(a), Some(b)) => a.same_bits(b),
                    (a, b) => a.is_some() == b.is_some(),
                };
                !same || commanded.contains(&(frame.next(), *id))
            };
            let mut needed: BTreeSet<BodyId> = ids.into_iter().filter(changed).collect();
            let mut links = touching(before, frame);
            links.extend(touching(after, frame));
            loop {
                let size = needed.len();
                for (a, b) in &links {
                    if needed.contains(a) || needed.contains(b) {
                        needed.extend([a, b]);
                    }
                }
                if needed.len() == size {
                    // Who is gone has no next state.
                    needed.retain(|body| after.state(*body, frame).is_some());
                    return needed;
                }
            }
        })
        .collect()
}

pub(crate) fn cuboid(x: f32, y: f32, z: f32) -> BodyDef {
    BodyDef::new(Shape::Cuboid(Cuboid { half_extents: Vec3::new(x, y, z) }))
}

pub(crate) fn ground() -> BodyDef {
    BodyDef::fixed(Shape::HalfSpace)
}

/// Walls of cubes in the form of pyramids, `rows` high, six metres apart; the ground is body 0.
pub(crate) fn pyramids(count: u32, rows: u32) -> Vec<BodyDef> {
    let mut bodies = vec![ground()];
    for pyramid in 0..count {
        for row in 0..rows {
            for i in 0..rows - row {
                let x = i as f32 + 0.5 * row as f32;
                let foot = Vec3::new(6.0 * (pyramid % 3) as f32, 0.0, 6.0 * (pyramid / 3) as f32);
                bodies.push(cuboid(0.5, 0.5, 0.5).at(foot + Vec3::new(x, 0.5 + row as f32, 0.0)));
            }
        }
    }
    bodies
}

/// Lines of ten dominoes, two metres apart, all still standing; the ground is body 0.
pub(crate) fn domino_lines(count: u32) -> Vec<BodyDef> {
    let mut bodies = vec![ground()];
    for line in 0..count {
        for i in 0..10 {
            bodies.push(cuboid(0.05, 0.25, 0.125).at(Vec3::new(0.2 * i as f32, 0.25, 2.0 * line as f32)));
        }
    }
    bodies
}

pub(crate) fn push(body: BodyId, impulse: Vec3) -> Change {
    Change::Push { body, impulse, at_point: None }
}
