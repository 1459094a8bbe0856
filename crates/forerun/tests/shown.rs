//! What was shown stays: a command acts from its frame on, and nothing that is seen before depends on it.

use forerun::dynamics::Spring;
use forerun::timeline::{Progress, Sample};
use forerun::{
    BodyDef, BodyId, BodyKind, Change, Cuboid, Environment, Frame, Material, Pose, Quat, Shape, Snapshot,
    Sphere, Timeline, TimelineSettings, Vec3,
};

const FRAME_S: f64 = (1.0_f32 / 60.0) as f64;
const FLYING: BodyId = BodyId(1);
const SLIDING: BodyId = BodyId(2);
const NEW: BodyId = BodyId(5);

/// A ground, a ball that flies and spins, a box that slides, and a stack of two.
fn timeline() -> Timeline {
    let cube = || Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
    let ball = Shape::Sphere(Sphere { radius: 0.3 });
    let bodies = [
        BodyDef::fixed(Shape::HalfSpace),
        BodyDef {
            velocity: Vec3::new(1.0, 4.0, 0.0),
            angular_velocity: Vec3::new(9.0, 3.0, 1.0),
            ..BodyDef::new(ball).at(Vec3::new(-3.0, 3.0, 0.0))
        },
        BodyDef { velocity: Vec3::X * 3.0, ..BodyDef::new(cube()).at(Vec3::new(0.0, 0.5, 0.0)) },
        BodyDef::new(cube()).at(Vec3::new(9.0, 0.5, 0.0)),
        BodyDef::new(cube()).at(Vec3::new(9.0, 1.5, 0.0)),
    ];
    let settings = TimelineSettings { lookahead: 40, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(&bodies, Environment::default(), settings).expect("plain bodies");
    run(&mut timeline);
    timeline
}

fn run(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}

fn changes() -> Vec<Change> {
    let pose = Pose { position: Vec3::new(5.0, 7.0, -2.0), rotation: Quat::from_xyzw(0.0, 1.0, 0.0, 0.0) };
    let spring = Spring { anchor: Vec3::ZERO, target: Vec3::Y * 9.0, frequency_hz: 5.0, damping_ratio: 1.0 };
    let mut changes = Vec::new();
    for body in [FLYING, SLIDING, BodyId(3), BodyId(4)] {
        changes.extend([
            Change::Push { body, impulse: Vec3::new(0.0, 900.0, 300.0), at_point: Some(Vec3::ONE) },
            Change::Move { body, pose },
            Change::Remove { body },
            Change::SetVelocity { body, velocity: Vec3::Z * 20.0, angular_velocity: Vec3::X * 9.0 },
            Change::Hold { body, spring },
            Change::SetKind { body, kind: BodyKind::Fixed },
            Change::SetMaterial { body, material: Material::default() },
            Change::SetForce { body, force: Vec3::X * 9000.0, torque: Vec3::Y * 500.0 },
        ]);
    }
    let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
    let def = BodyDef { velocity: Vec3::NEG_Y, ..BodyDef::new(cube).at(Vec3::new(9.0, 2.6, 0.0)) };
    changes.push(Change::Add { body: NEW, def: Box::new(def) });
    changes.push(Change::SetGravity { gravity: Vec3::Y * 5.0 });
    changes
}

/// Pose and velocities of all bodies. How sure they are may be another matter.
fn shown(snapshot: &Snapshot, frames: f64) -> Vec<(BodyId, Vec<u32>)> {
    let mut samples = Vec::new();
    snapshot.sample_all(frames * FRAME_S, &mut samples);
    samples.into_iter().map(|(body, sample)| (body, bits(&sample))).collect()
}

fn bits(sample: &Sample) -> Vec<u32> {
    let Sample { pose, velocity, angular_velocity, .. } = sample;
    let vectors = [pose.position, *velocity, *angular_velocity].into_iter().flat_map(|v| v.to_array());
    vectors.chain(pose.rotation.to_array()).map(f32::to_bits).collect()
}

#[test]
fn a_command_after_what_is_shown_changes_not_a_bit_of_it() {
    let timeline = timeline();
    let before = timeline.snapshot();
    for change in changes() {
        for displayed in [7.0, 7.37, 7.999, 30.5] {
            let mut timeline = timeline.fork();
            timeline.reserve_body();
            // The first frame after the displayed one, as the driver stamps it.
            timeline.change(Frame(displayed as u64 + 1), change.clone()).expect("a possible change");
            // Gravity puts all bodies out of date: until they are computed they are extrapolated, and say so.
            if !matches!(change, Change::SetGravity { .. }) {
                let heard = timeline.snapshot();
                assert_eq!(shown(&heard, displayed), shown(&before, displayed), "{change:?} heard");
            }
            run(&mut timeline);
            let after = timeline.snapshot();
            assert_eq!(shown(&after, displayed), shown(&before, displayed), "{change:?} at {displayed}");
        }
    }
}

#[test]
fn a_second_command_of_the_same_frame_changes_nothing_either() {
    let mut timeline = timeline();
    let before = timeline.snapshot();
    for change in changes() {
        // Those after a removal do nothing.
        if !matches!(change, Change::Add { .. } | Change::SetGravity { .. }) {
            timeline.change(Frame(12), change).expect("a possible change");
            assert_eq!(shown(&timeline.snapshot(), 11.6), shown(&before, 11.6), "heard");
            run(&mut timeline);
            assert_eq!(shown(&timeline.snapshot(), 11.6), shown(&before, 11.6), "computed");
        }
    }
}

#[test]
fn a_body_that_is_put_elsewhere_appears_there_at_its_frame() {
    let mut timeline = timeline();
    let at = |timeline: &Timeline, frames: f64| {
        timeline.snapshot().sample(FLYING, frames * FRAME_S).expect("it is there").pose.position
    };
    let there = Vec3::new(100.0, 50.0, 0.0);
    let (before, arrived) = (at(&timeline, 19.0), at(&timeline, 20.0));
    let pose = Pose { position: there, ..Pose::IDENTITY };
    timeline.change(Frame(20), Change::Move { body: FLYING, pose }).expect("a possible change");
    run(&mut timeline);
    for part in [0.1, 0.5, 0.99] {
        let shown = at(&timeline, 19.0 + part);
        let straight = before + (arrived - before) * part as f32;
        assert!(shown.distance(straight) < 1e-3, "{shown} after {part} of the frame");
    }
    assert_eq!(at(&timeline, 20.0), there);
    assert!(at(&timeline, 20.5).distance(there) < 0.2);
}

#[test]
fn a_flight_is_as_smooth_before_a_push_as_without_one() {
    let plain = timeline();
    let mut pushed = plain.fork();
    let impulse = Vec3::X * 4000.0;
    pushed.change(Frame(20), Change::Push { body: FLYING, impulse, at_point: None }).expect("possible");
    run(&mut pushed);
    // The parabola, exactly: h = v t - g t^2 / 2.
    let sample = |timeline: &Timeline, frames: f64| {
        timeline.snapshot().sample(FLYING, frames * FRAME_S).expect("it is there")
    };
    let start = sample(&plain, 19.0);
    for part in [0.25_f32, 0.5, 0.75] {
        let t = part * FRAME_S as f32;
        let expected = start.pose.position + start.velocity * t + Vec3::NEG_Y * (0.5 * 9.81 * t * t);
        let found = sample(&pushed, 19.0 + f64::from(part)).pose.position;
        assert!(found.distance(expected) < 2e-6, "{found}, {expected}");
    }
}
