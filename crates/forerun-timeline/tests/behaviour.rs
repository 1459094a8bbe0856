//! What a timeline promises besides equal bits: work in proportion to what changed, bounds, errors, order, sharing.

use std::sync::Arc;

use forerun_dynamics::{BodyDef, BodyId, BodyKind, Environment};
use forerun_geometry::shape::{Cuboid, Shape};
use forerun_geometry::{Pose, Vec3};
use forerun_timeline::check::mismatches;
use forerun_timeline::{
    Certainty, Change, Command, CommandError, CommandKey, Frame, Progress, Timeline, TimelineSettings,
};

const DT: f64 = (1.0_f32 / 60.0) as f64;

fn run(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}

fn timeline(bodies: &[BodyDef], lookahead: u32) -> Timeline {
    let settings = TimelineSettings { lookahead, past: 1000, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(bodies, Environment::default(), settings).unwrap();
    run(&mut timeline);
    timeline
}

fn cube(x: f32, y: f32) -> BodyDef {
    BodyDef::new(Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) })).at(Vec3::new(x, y, 0.0))
}

/// Ten piles of three boxes, ten metres apart, on one ground.
fn far_piles() -> Vec<BodyDef> {
    let ground = Shape::Cuboid(Cuboid { half_extents: Vec3::new(200.0, 1.0, 200.0) });
    let mut bodies = vec![BodyDef::fixed(ground).at(Vec3::new(0.0, -1.0, 0.0))];
    for pile in 0..10 {
        for level in 0..3 {
            bodies.push(cube(10.0 * pile as f32, 0.5 + level as f32));
        }
    }
    bodies
}

fn push(body: u32, impulse: Vec3) -> Change {
    Change::Push { body: BodyId(body), impulse, at_point: None }
}

#[test]
fn an_edit_costs_what_it_touches() {
    let mut timeline = timeline(&far_piles(), 100);
    let before = timeline.clone();
    timeline.change(Frame(20), push(5, Vec3::new(2000.0, 0.0, 0.0))).unwrap();
    run(&mut timeline);
    let edit = timeline.stats().last_edit;
    // Three bodies from the step that leaves frame 19 to the one that leaves frame 99.
    assert!(edit.recomputed <= 3 * 81, "{edit:?}");
    assert!(edit.affected >= 80, "{edit:?}");
    for frame in (0..=100).map(Frame) {
        for body in (0..31).map(BodyId).filter(|body| !(4..=6).contains(&body.0)) {
            assert_eq!(timeline.state(body, frame), before.state(body, frame));
        }
    }
}

#[test]
fn an_edit_that_changes_nothing_stops_at_once() {
    let mut bodies = far_piles();
    bodies.push(cube(55.0, 100.0));
    let mut timeline = timeline(&bodies, 60);
    let before = timeline.clone();
    timeline.change(Frame(20), push(31, Vec3::ZERO)).unwrap();
    run(&mut timeline);
    let edit = timeline.stats().last_edit;
    assert_eq!((edit.recomputed, edit.affected, edit.frames), (1, 0, 1));
    assert_eq!(mismatches(&timeline, &before).0, 0);
}

#[test]
fn a_body_that_comes_and_goes_far_away_leaves_no_trace() {
    let mut timeline = timeline(&far_piles(), 60);
    let before = timeline.clone();
    let body = timeline.reserve_body();
    let def = Box::new(cube(500.0, 500.0));
    timeline.change(Frame(10), Change::Add { body, def }).unwrap();
    timeline.change(Frame(13), Change::Remove { body }).unwrap();
    run(&mut timeline);
    assert!(timeline.stats().last_edit.recomputed <= 3, "{:?}", timeline.stats().last_edit);
    assert_eq!(timeline.state(body, Frame(9)), None);
    assert!(timeline.state(body, Frame(10)).is_some() && timeline.state(body, Frame(12)).is_some());
    assert_eq!(timeline.state(body, Frame(13)), None);
    for frame in (0..=60).map(Frame) {
        for body in (0..31).map(BodyId) {
            assert_eq!(timeline.state(body, frame), before.state(body, frame));
        }
    }
}

#[test]
fn what_is_at_rest_costs_neither_work_nor_memory() {
    let mut environment = Environment::default();
    environment.settings.rest_seconds = 0.1;
    let settings = TimelineSettings { lookahead: 400, past: 10, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(&far_piles(), environment, settings).unwrap();
    let mut last = 0;
    while let Progress::Advanced(done) = timeline.advance() {
        last = done.recomputed;
    }
    assert_eq!(last, 0, "the piles did not come to rest");
    let bytes = timeline.state_bytes();
    timeline.set_display(Frame(100));
    run(&mut timeline);
    timeline.set_display(Frame(390));
    run(&mut timeline);
    // One block of bodies is left, shared by all frames.
    let rest = timeline.state_bytes();
    assert!(rest < 2048 && rest < bytes, "{rest} of {bytes}");
    assert_eq!(timeline.areas_active(Frame(389)), 0);
}

#[test]
fn arrival_order_does_not_matter() {
    let commands: Vec<Command> = (0..6)
        .map(|i| {
            let key = CommandKey { frame: Frame(10), source: i % 3, sequence: u64::from(i) };
            // Neither order nor repetition of these commutes.
            let change = match i {
                0 | 3 => push(4, Vec3::new(700.0, 0.0, 0.0)),
                1 | 4 => Change::SetVelocity {
                    body: BodyId(4),
                    velocity: Vec3::new(i as f32, 1.0, 0.0),
                    angular_velocity: Vec3::ZERO,
                },
                _ => Change::Move {
                    body: BodyId(4),
                    pose: Pose::from_position(Vec3::new(10.0, 4.0, i as f32)),
                },
            };
            Command { key, change }
        })
        .collect();
    let mut forward = timeline(&far_piles(), 40);
    forward.submit_all(commands.clone()).unwrap();
    run(&mut forward);
    let mut backward = timeline(&far_piles(), 40);
    for command in commands.into_iter().rev() {
        backward.submit(command).unwrap();
        let _ = backward.advance();
    }
    run(&mut backward);
    assert_eq!(mismatches(&forward, &backward).0, 0);
}

#[test]
fn a_command_taken_back_leaves_no_trace() {
    let mut timeline = timeline(&far_piles(), 40);
    let before = timeline.clone();
    let removed = timeline.change(Frame(10), Change::Remove { body: BodyId(1) }).unwrap();
    run(&mut timeline);
    let gravity = timeline.change(Frame(12), Change::SetGravity { gravity: Vec3::X }).unwrap();
    for _ in 0..7 {
        let _ = timeline.advance();
    }
    assert!(timeline.retract(&removed) && timeline.retract(&gravity) && !timeline.retract(&removed));
    run(&mut timeline);
    assert_eq!(mismatches(&timeline, &before), (0, None));
    assert_eq!(timeline.commands().count(), 0);
}

#[test]
fn the_lookahead_is_bounded_and_the_past_is_dropped() {
    let settings = TimelineSettings { lookahead: 30, past: 5, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(&far_piles(), Environment::default(), settings).unwrap();
    for display in 0..50 {
        timeline.set_display(Frame(display));
        run(&mut timeline);
        assert_eq!(timeline.horizon(), Frame(display + 30));
        assert_eq!(timeline.oldest(), Frame(display.saturating_sub(5)));
    }
    // A display that runs ahead of the physics takes nothing away that is needed.
    timeline.set_display(Frame(1000));
    assert!(timeline.oldest() < timeline.horizon());
    assert!(matches!(timeline.advance(), Progress::Advanced(_)));
}

#[test]
fn commands_that_cannot_be_obeyed_are_refused_with_a_reason() {
    let mut timeline = timeline(&far_piles(), 20);
    let refused = |timeline: &mut Timeline, change: Change| timeline.change(Frame(5), change).unwrap_err();
    assert!(matches!(
        timeline.change(Frame(0), push(1, Vec3::X)),
        Err(CommandError::TooOld { frame: Frame(0), oldest: Frame(0) })
    ));
    assert_eq!(refused(&mut timeline, push(99, Vec3::X)), CommandError::UnknownBody(BodyId(99)));
    let again = Change::Add { body: BodyId(3), def: Box::new(cube(0.0, 9.0)) };
    assert_eq!(refused(&mut timeline, again), CommandError::BodyExists(BodyId(3)));
    let error = refused(&mut timeline, push(1, Vec3::new(f32::NAN, 0.0, 0.0)));
    assert!(error.to_string().starts_with("impulse: must be finite"), "{error}");
    let body = timeline.reserve_body();
    let mut def = cube(0.0, 9.0);
    def.gravity_scale = f32::INFINITY;
    assert!(matches!(
        refused(&mut timeline, Change::Add { body, def: Box::new(def) }),
        CommandError::Body(_)
    ));
    let key = timeline.change(Frame(5), push(1, Vec3::X)).unwrap();
    let twice = timeline.submit(Command { key, change: push(2, Vec3::X) });
    assert_eq!(twice, Err(CommandError::DuplicateKey(key)));
}

#[test]
fn what_is_not_possible_makes_no_timeline() {
    let refused = |bodies: &[BodyDef], change: fn(&mut Environment)| {
        let mut environment = Environment::default();
        change(&mut environment);
        Timeline::new(bodies, environment, TimelineSettings::default()).unwrap_err().to_string()
    };
    assert_eq!(
        refused(&[], |e| e.settings.frame_seconds = -1.0),
        "environment: frame_seconds: must be from 0.00001 to 1, is -1"
    );
    assert!(refused(&[], |e| e.settings.substeps = 0).starts_with("environment: substeps: "));
    assert!(refused(&[], |e| e.gravity.z = f32::INFINITY).starts_with("environment: gravity: "));
    let bodies = [cube(0.0, 0.0), cube(f32::NAN, 0.0)];
    assert!(refused(&bodies, |_| ()).starts_with("body 1: position: must be finite"));
}

#[test]
fn commands_without_effect_are_counted_once() {
    let mut timeline = timeline(&far_piles(), 30);
    timeline.change(Frame(10), Change::Remove { body: BodyId(3) }).unwrap();
    timeline.change(Frame(15), push(3, Vec3::X)).unwrap();
    // Finite, but the velocity would not be.
    timeline
        .change(
            Frame(15),
            Change::SetVelocity {
                body: BodyId(6),
                velocity: Vec3::splat(3e38),
                angular_velocity: Vec3::ZERO,
            },
        )
        .unwrap();
    timeline.change(Frame(16), Change::Remove { body: BodyId(6) }).unwrap();
    timeline.change(Frame(15), push(6, Vec3::splat(3e38))).unwrap();
    run(&mut timeline);
    timeline.change(Frame(9), push(3, Vec3::X)).unwrap();
    run(&mut timeline);
    assert_eq!(timeline.stats().ignored, 1);
    timeline.set_display(Frame(2000));
    assert_eq!(timeline.stats().ignored, 1);
}

#[test]
fn kinds_change_and_fixed_bodies_stay() {
    let mut timeline = timeline(&far_piles(), 60);
    let top = BodyId(3);
    timeline.change(Frame(10), Change::SetKind { body: top, kind: BodyKind::Fixed }).unwrap();
    timeline.change(Frame(12), Change::Remove { body: BodyId(2) }).unwrap();
    timeline.change(Frame(40), Change::SetKind { body: top, kind: BodyKind::Dynamic }).unwrap();
    run(&mut timeline);
    let height = |frame: u64| timeline.state(top, Frame(frame)).unwrap().position.y;
    assert_eq!(height(10).to_bits(), height(40).to_bits());
    assert!(height(60) < height(40) - 0.3, "{} {}", height(40), height(60));
}

#[test]
fn areas_are_active_where_something_moves() {
    let settings =
        TimelineSettings { lookahead: 10, past: 10, area_m: Some(4.0), ..TimelineSettings::default() };
    let mut faller = cube(2.0, 202.0);
    faller.pose.position.z = 2.0;
    faller.gravity_scale = 0.0;
    faller.velocity = Vec3::new(60.0, 0.0, 0.0);
    let mut sleeper = cube(2.0, 302.0);
    sleeper.gravity_scale = 0.0;
    let mut timeline = Timeline::new(&[faller, sleeper], Environment::default(), settings).unwrap();
    run(&mut timeline);
    // One metre a frame: the bound of the next 1.2 m stays in the first area, then reaches into the second.
    assert_eq!(timeline.areas_active(Frame(0)), 1);
    assert_eq!(timeline.areas_active(Frame(1)), 2);
    assert_eq!(timeline.areas_active(Frame(3)), 1);
    assert_eq!(timeline.areas_active(Frame(99)), 0);
}

#[test]
fn a_fork_goes_its_own_way() {
    let timeline = timeline(&far_piles(), 50);
    let mut fork = timeline.clone();
    fork.change(Frame(5), push(3, Vec3::new(0.0, 9000.0, 0.0))).unwrap();
    run(&mut fork);
    let height = |t: &Timeline| t.state(BodyId(3), Frame(30)).unwrap().position.y;
    assert!(height(&fork) > height(&timeline) + 1.0);
}

#[test]
fn snapshots_sample_what_was_true_when_they_were_made() {
    let mut bodies = far_piles();
    bodies.push(cube(55.0, 100.0));
    let mut timeline = timeline(&bodies, 60);
    let snapshot = timeline.snapshot();
    timeline.change(Frame(10), Change::Remove { body: BodyId(31) }).unwrap();
    run(&mut timeline);
    let faller = BodyId(31);
    for frame in [0, 7, 33, 60] {
        let sample = snapshot.sample(faller, Frame(frame).seconds(snapshot.frame_seconds())).unwrap();
        assert_eq!(sample.pose.position, snapshot.state(faller, Frame(frame)).unwrap().position);
        assert_eq!(sample.certainty, Certainty::Exact);
    }
    // Free fall between frames, to what f32 can tell at 100 m.
    for seconds in [0.1234, 0.5, 0.777] {
        let y = f64::from(snapshot.sample(faller, seconds).unwrap().pose.position.y);
        let expected = 100.0 - 0.5 * 9.81 * seconds * seconds;
        assert!((y - expected).abs() < 3.5e-3, "at {seconds} s: {y}, formula {expected}");
    }
    let late = snapshot.sample(faller, 5.0).unwrap();
    assert_eq!(late.pose.position, snapshot.state(faller, Frame(60)).unwrap().position);
    assert_eq!(late.certainty, Certainty::Held);
    assert_eq!((snapshot.queue_min(10.2 * DT), snapshot.queue_max(10.2 * DT)), (50, 50));
    let mut all = Vec::new();
    snapshot.sample_all(0.3, &mut all);
    assert_eq!(all.len(), 32);
    assert!(timeline.snapshot().sample(faller, 0.5).is_none());
    assert!(Arc::strong_count(&snapshot) == 1);
}

#[test]
fn what_waits_to_be_recomputed_goes_on_and_then_holds() {
    let mut timeline = timeline(&far_piles(), 60);
    timeline.change(Frame(20), push(3, Vec3::new(0.0, 5000.0, 0.0))).unwrap();
    let snapshot = timeline.snapshot();
    assert_eq!((snapshot.valid_to(), snapshot.horizon()), (Frame(19), Frame(60)));
    assert_eq!((snapshot.queue_min(15.0 * DT), snapshot.queue_max(15.0 * DT)), (4, 45));
    let certainty = |body: u32, frames: f64| snapshot.sample(BodyId(body), frames * DT).unwrap().certainty;
    assert_eq!(certainty(3, 19.0), Certainty::Exact);
    assert_eq!(certainty(3, 20.5), Certainty::Extrapolated);
    assert_eq!(certainty(3, 25.0), Certainty::Held);
    assert_eq!(certainty(9, 19.0), Certainty::Exact);
    assert_eq!(certainty(9, 19.5), Certainty::Presumed);
    assert_eq!(certainty(9, 25.0), Certainty::Presumed);
    let areas = timeline.area_clocks();
    assert!(!areas.is_empty() && areas.iter().all(|(_, clock)| *clock == Frame(19)));
    let _ = timeline.advance();
    assert_eq!(timeline.valid_to(), Frame(20));
}

#[test]
fn a_change_of_gravity_changes_nothing_that_is_shown_before_it() {
    let mut bodies = far_piles();
    let mut faller = cube(55.0, 1.2);
    faller.velocity = Vec3::new(3.0, -4.0, 0.0);
    bodies.push(faller);
    let mut timeline = timeline(&bodies, 60);
    let seconds = 8.6 * DT;
    let shown = |timeline: &Timeline| -> Vec<(BodyId, Pose, Vec3)> {
        let mut samples = Vec::new();
        timeline.snapshot().sample_all(seconds, &mut samples);
        samples.into_iter().map(|(body, sample)| (body, sample.pose, sample.velocity)).collect()
    };
    let before = shown(&timeline);
    timeline.change(Frame(9), Change::SetGravity { gravity: Vec3::new(2.0, 5.0, 0.0) }).unwrap();
    for _ in 0..3 {
        assert!(shown(&timeline) == before);
        let _ = timeline.advance();
    }
    // Beyond it, all wait to be recomputed, and say so.
    timeline.change(Frame(9), Change::SetGravity { gravity: Vec3::new(-2.0, 5.0, 0.0) }).unwrap();
    let late = timeline.snapshot().sample(BodyId(31), 9.5 * DT).unwrap();
    assert_eq!(late.certainty, Certainty::Extrapolated);
}

#[test]
fn what_a_body_was_made_of_is_not_kept_when_it_is_gone_for_good() {
    let settings = TimelineSettings { lookahead: 20, past: 10, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(&far_piles(), Environment::default(), settings).unwrap();
    let points: Vec<Vec3> =
        (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32)).collect();
    let hull = Arc::new(forerun_geometry::shape::Hull::new(&points).unwrap());
    let watched = Arc::downgrade(&hull);
    let body = timeline.reserve_body();
    let def = BodyDef::new(Shape::Hull(hull)).at(Vec3::new(150.0, 1.0, 0.0));
    timeline.change(Frame(2), Change::Add { body, def: Box::new(def) }).unwrap();
    timeline.change(Frame(5), Change::Remove { body }).unwrap();
    for display in 0..40 {
        assert_eq!(watched.strong_count() > 0, display <= 15, "at {display}");
        timeline.set_display(Frame(display));
        run(&mut timeline);
    }
    let again = Change::Add { body, def: Box::new(cube(150.0, 1.0)) };
    assert_eq!(timeline.change(Frame(45), again), Err(CommandError::BodyExists(body)));
}

#[test]
fn a_time_that_is_forgotten_is_held_and_no_number_is_no_time() {
    let settings = TimelineSettings { lookahead: 20, past: 10, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(&far_piles(), Environment::default(), settings).unwrap();
    timeline.set_display(Frame(100));
    run(&mut timeline);
    let snapshot = timeline.snapshot();
    let certainty = |seconds: f64| snapshot.sample(BodyId(3), seconds).map(|sample| sample.certainty);
    assert_eq!(certainty(90.0 * DT), Some(Certainty::Exact));
    assert_eq!(certainty(89.9 * DT), Some(Certainty::Held));
    assert_eq!(certainty(-1.0), Some(Certainty::Held));
    assert_eq!(certainty(f64::NAN), None);
}
