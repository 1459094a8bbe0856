//! An edit ends where it makes no difference any more, and not before.

use forerun_dynamics::{BodyDef, BodyId, BodyKind, Material};
use forerun_geometry::{Pose, Vec3};
use forerun_timeline::{Change, Command, CommandKey, Frame, Timeline};

use crate::lab::{assert_equals_full_run, cuboid, first_difference, ground, push, run, timeline};

const FALLING: BodyId = BodyId(1);
const STANDING: BodyId = BodyId(2);
const WALL: BodyId = BodyId(3);

/// A box that falls all the time, one that stands on the ground, and far away a wall that moves as it is told.
fn scene() -> Vec<BodyDef> {
    let mut wall = cuboid(0.2, 2.0, 2.0).at(Vec3::new(200.0, 2.0, 0.0));
    wall.kind = BodyKind::Kinematic;
    vec![
        ground(),
        cuboid(0.5, 0.5, 0.5).at(Vec3::new(0.0, 500.0, 0.0)),
        cuboid(0.5, 0.5, 0.5).at(Vec3::new(20.0, 0.5, 0.0)),
        wall,
    ]
}

/// Submits commands of the local user for a frame each, in one batch.
fn submit(timeline: &mut Timeline, changes: Vec<(u64, Change)>) {
    for (frame, change) in changes {
        let sequence = timeline.next_sequence();
        let key = CommandKey { frame: Frame(frame), source: 0, sequence };
        timeline.submit(Command { key, change }).unwrap();
    }
}

#[test]
fn what_changes_nothing_is_cut_off_within_a_frame() {
    let before = timeline(&scene(), 60);
    let state = *before.state(FALLING, Frame(20)).unwrap();
    let body = FALLING;
    let comes = BodyId(before.names() as u32);
    let def = Box::new(cuboid(0.5, 0.5, 0.5).at(Vec3::new(50.0, 300.0, 0.0)));
    let no_ops = vec![
        vec![push(body, Vec3::ZERO)],
        vec![Change::Move { body, pose: Pose::new(state.position, state.rotation) }],
        vec![Change::SetVelocity {
            body,
            velocity: state.velocity,
            angular_velocity: state.angular_velocity,
        }],
        vec![Change::SetMaterial { body, material: Material::default() }],
        vec![Change::SetGravityScale { body, scale: 1.0 }],
        vec![Change::SetMass { body, mass: 1.0 / before.body_at(body, Frame(20)).unwrap().inverse_mass }],
        vec![Change::SetForce { body, force: Vec3::ZERO, torque: Vec3::ZERO }],
        vec![Change::SetKind { body, kind: BodyKind::Dynamic }],
        vec![Change::Release { body }],
        vec![Change::Add { body: comes, def }, Change::Remove { body: comes }],
        // Elsewhere and back.
        vec![
            Change::Move { body, pose: Pose::from_position(Vec3::new(9.0, 9.0, 9.0)) },
            Change::Move { body, pose: Pose::new(state.position, state.rotation) },
        ],
    ];
    for changes in no_ops {
        let what = format!("{changes:?}");
        let mut timeline = before.fork();
        assert_eq!(timeline.reserve_body(), comes);
        submit(&mut timeline, changes.into_iter().map(|change| (20, change)).collect());
        let work = run(&mut timeline);
        assert!(work.len() <= 1 && work.iter().all(|done| done.affected == 0), "{what}: {work:?}");
        assert_equals_full_run(&timeline, &scene());
    }
}

#[test]
fn what_is_taken_back_after_some_frames_is_cut_off_there() {
    let at = |x: f32| Change::Move { body: WALL, pose: Pose::from_position(Vec3::new(x, 2.0, 0.0)) };
    for n in [1, 5, 30] {
        let mut timeline = timeline(&scene(), 100);
        let before = timeline.fork();
        submit(&mut timeline, vec![(20, at(210.0)), (20 + n, at(200.0))]);
        let work = run(&mut timeline);
        assert!(work.len() as u64 <= n + 2, "{n}: {} frames of work", work.len());
        assert!(work.iter().all(|done| done.recomputed <= 1), "{n}: {work:?}");
        let differing = (0..=100).filter(|k| {
            let states = [&timeline, &before].map(|t| *t.state(WALL, Frame(*k)).unwrap());
            !states[0].same_bits(&states[1])
        });
        assert_eq!(differing.collect::<Vec<_>>(), (20..20 + n).collect::<Vec<_>>());
        assert_equals_full_run(&timeline, &scene());
    }
}

#[test]
fn a_body_that_comes_to_rest_as_it_was_is_cut_off_there() {
    let mut timeline = timeline(&scene(), 200);
    let before = timeline.fork();
    let rest = timeline.state(STANDING, Frame(100)).unwrap().rest;
    let full = timeline.environment_at(Frame(0)).settings.rest_frames();
    assert!(rest > full, "the box is at rest: {rest}");
    submit(&mut timeline, vec![(100, push(STANDING, Vec3::ZERO))]);
    let work = run(&mut timeline);
    // It was woken, counts again, and is then what it was.
    assert_eq!(first_difference(&timeline, &before, STANDING), Some(Frame(100)));
    assert_eq!(timeline.state(STANDING, Frame(100)).unwrap().rest, 0);
    assert!(
        timeline.state(STANDING, Frame(200)).unwrap().same_bits(before.state(STANDING, Frame(200)).unwrap())
    );
    assert!(work.len() as u32 <= full + 3, "{} frames of work", work.len());
    assert_equals_full_run(&timeline, &scene());
}

/// Poses and velocities are the same, and only since when is not: what comes is another future all the same.
#[test]
fn a_difference_in_rest_alone_is_not_cut_off() {
    let mut timeline = timeline(&scene(), 200);
    let before = timeline.fork();
    let quiet = |t: &Timeline, frame: u64| *t.state(STANDING, Frame(frame)).unwrap();
    // While it counts, and is not yet at rest.
    let full = timeline.environment_at(Frame(0)).settings.rest_frames();
    let counting = (1..200).find(|k| (2..full).contains(&quiet(&before, *k).rest)).expect("it comes to rest");
    submit(&mut timeline, vec![(counting, push(STANDING, Vec3::ZERO))]);
    let work = run(&mut timeline);
    let (now, then) = (quiet(&timeline, counting), quiet(&before, counting));
    assert_eq!(
        (now.pose(), now.velocity, now.angular_velocity),
        (then.pose(), then.velocity, then.angular_velocity)
    );
    assert!(now.rest != then.rest);
    assert!(work.len() > 1, "{work:?}");
    // It comes to rest later than it did.
    let rests = |t: &Timeline| (counting..200).find(|k| quiet(t, *k).rest >= full).unwrap();
    assert!(rests(&timeline) > rests(&before), "{} {}", rests(&timeline), rests(&before));
    assert_equals_full_run(&timeline, &scene());
}

#[test]
fn a_difference_in_velocity_alone_is_not_cut_off() {
    let before = timeline(&scene(), 60);
    let state = *before.state(FALLING, Frame(20)).unwrap();
    let velocity = state.velocity + Vec3::new(0.0, 1e-5, 0.0);
    let angular_velocity = Vec3::new(1e-20, 0.0, 0.0);
    // The second turns the box by less than an f32 shows, at all times.
    for change in [
        Change::SetVelocity { body: FALLING, velocity, angular_velocity: Vec3::ZERO },
        Change::SetVelocity { body: FALLING, velocity: state.velocity, angular_velocity },
    ] {
        let mut timeline = before.fork();
        submit(&mut timeline, vec![(20, change)]);
        let work = run(&mut timeline);
        let now = timeline.state(FALLING, Frame(20)).unwrap();
        assert_eq!(now.pose(), state.pose());
        assert!(!now.same_bits(&state));
        assert_eq!(work.len(), 41, "each frame from 20 to 60");
        assert_equals_full_run(&timeline, &scene());
    }
}
