//! What the display may rely on, whatever the physics thread does.

use std::sync::Weak;

use forerun_timeline::{Change, CommandError};

use super::*;
use crate::{BodyDef, Clock, Cuboid, Environment, Pose, Shape, Sphere, TimelineSettings, Vec3};

pub(in crate::driver) const LOOKAHEAD: u32 = 20;
pub(super) const FRAME_S: f64 = (1.0_f32 / 60.0) as f64;

/// A ball above the ground and another far away.
pub(in crate::driver) fn timeline() -> Timeline {
    let ball = Shape::Sphere(Sphere { radius: 0.5 });
    let bodies = [
        BodyDef::fixed(Shape::Cuboid(Cuboid { half_extents: Vec3::new(50.0, 1.0, 50.0) })).at(Vec3::NEG_Y),
        BodyDef::new(ball.clone()).at(Vec3::Y * 5.0),
        BodyDef::new(ball).at(Vec3::new(30.0, 5.0, 0.0)),
    ];
    let settings = TimelineSettings { lookahead: LOOKAHEAD, ..TimelineSettings::default() };
    Timeline::new(&bodies, Environment::default(), settings).expect("plain bodies")
}

fn settings() -> DecoupledSettings {
    DecoupledSettings::new(Threads::exactly(std::num::NonZeroU16::MIN).expect("one thread"))
}

fn slow(millis: u64) -> Decoupled {
    let slow_down = Duration::from_millis(millis);
    Decoupled::start(timeline(), DecoupledSettings { slow_down, ..settings() }).expect("a thread")
}

/// Asks until the answer is yes, for ten seconds at most.
pub(super) fn eventually(mut ask: impl FnMut() -> bool) -> bool {
    let clock = Clock::system();
    while clock.now() < Duration::from_secs(10) {
        if ask() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    false
}

pub(super) fn full(driver: &Decoupled) -> bool {
    let picture = driver.last_picture();
    picture.snapshot.valid_to() == picture.frame.plus(u64::from(LOOKAHEAD))
}

/// At time 0, with as much ahead as there may be.
pub(super) fn filled() -> Decoupled {
    let mut driver = slow(0);
    driver.show(0.0).expect("physics lives");
    assert!(eventually(|| full(&driver) && driver.shared.is_physics_done()));
    driver
}

#[test]
fn the_display_never_waits_while_physics_sleeps_half_a_second_a_frame() {
    let mut driver = slow(500);
    let clock = Clock::system();
    for picture in 0..200 {
        driver.show(f64::from(picture) * 0.01).expect("physics lives");
        driver.change(Change::Release { body: BodyId(1) }).expect("the queue has room");
    }
    assert!(clock.now() < Duration::from_millis(250), "200 pictures took {:?}", clock.now());
}

#[test]
fn the_longest_past_and_lookahead_are_bounded_by_bytes_alone() {
    let bounds = TimelineSettings {
        past: u32::MAX,
        lookahead: u32::MAX,
        bytes_max: Some(1 << 20),
        ..TimelineSettings::default()
    };
    let timeline = Timeline::new(&[BodyDef::fixed(Shape::HalfSpace)], Environment::default(), bounds);
    let mut driver = Decoupled::start(timeline.expect("a plain body"), settings()).expect("a thread");
    assert_eq!(driver.show(0.0).expect("physics lives").frame, Frame(0));
    assert!(eventually(|| driver.last_picture().snapshot.horizon() > Frame(100)));
    driver.show(FRAME_S).expect("physics lives");
    assert!(eventually(|| driver.last_picture().stats.lookahead_frames > 0));
    driver.show(2.0 * FRAME_S).expect("physics lives");
}

#[test]
fn display_time_never_goes_back() {
    let mut driver = filled();
    let times: Vec<f64> =
        [0.1, 0.0, 0.15].into_iter().map(|t| driver.show(t).expect("physics lives").time_s).collect();
    assert_eq!(times, [0.1, 0.1, 0.15]);
}

#[test]
fn physics_runs_ahead_as_far_as_it_may_and_then_sleeps() {
    let mut driver = filled();
    let work = driver.last_picture().stats;
    std::thread::sleep(Duration::from_millis(20));
    assert_eq!(driver.last_picture().snapshot.horizon(), Frame(u64::from(LOOKAHEAD)));
    assert_eq!(driver.last_picture().stats, work);
    driver.show(10.0 * FRAME_S).expect("physics lives");
    assert!(eventually(|| full(&driver)), "the display moved on, and nobody woke the physics");
    assert_eq!(driver.last_picture().snapshot.horizon(), Frame(10 + u64::from(LOOKAHEAD)));
}

#[test]
fn a_local_change_acts_on_the_first_frame_after_the_displayed_one() {
    let mut driver = filled();
    let before = driver.show(10.5 * FRAME_S).expect("physics lives");
    assert_eq!(before.frame, Frame(10));
    let impulse = Vec3::X * 500.0;
    let key = driver.change(Change::Push { body: BodyId(1), impulse, at_point: None }).expect("room");
    assert_eq!(key.frame, Frame(11));
    // Each picture lets the physics go further again.
    assert!(eventually(|| {
        driver.show(10.5 * FRAME_S).expect("physics lives");
        driver.last_picture().stats.edits.recomputed > 0 && full(&driver)
    }));
    let after = driver.last_picture();
    let state =
        |picture: &Picture, body, frame| *picture.snapshot.state(BodyId(body), Frame(frame)).expect("kept");
    assert!(state(&after, 1, 10).same_bits(&state(&before, 1, 10)), "a state on the screen was taken back");
    assert!(state(&after, 1, 11).velocity.x > 0.5);
    assert!(state(&after, 2, 20).same_bits(&state(&before, 2, 20)), "a body out of reach was changed");
}

#[test]
fn a_timeline_that_was_shown_before_goes_on_from_there() {
    let mut timeline = timeline();
    timeline.set_display(Frame(30));
    let mut driver = Decoupled::start(timeline, settings()).expect("a thread");
    assert!(eventually(|| full(&driver)));
    let picture = driver.show(1000.0).expect("physics lives");
    assert_eq!((picture.frame, picture.time_s), (Frame(30), 30.0 * FRAME_S));
    assert_eq!(picture.snapshot.horizon(), Frame(30 + u64::from(LOOKAHEAD)));
}

#[test]
fn the_queue_has_its_bound_whatever_the_display_does() {
    let mut driver = filled();
    let mut real_s = 0.0;
    for (speed, pictures) in [(1.0, 20), (0.0, 20), (10.0, 40), (0.5, 20)] {
        driver.set_speed(speed).expect("a possible speed");
        for _ in 0..pictures {
            real_s += FRAME_S;
            let before = driver.last_picture().time_s;
            let shown = driver.show(real_s).expect("physics lives");
            assert!(shown.time_s >= before && shown.time_s <= before + 1.05 * speed * FRAME_S + 1e-9);
            std::thread::sleep(Duration::from_millis(1));
            let now = driver.last_picture();
            assert!(now.snapshot.horizon() <= now.frame.plus(u64::from(LOOKAHEAD)), "{now:?}");
        }
    }
}

/// A drag of a body far from the others: a command at every picture, which physics hears of before the next. The fewest frames ahead.
fn dragged(driver: &mut Decoupled, mut after: impl FnMut(&Decoupled)) -> u64 {
    let mut fewest = u64::MAX;
    for picture in 1..=60 {
        let shown = driver.show(f64::from(picture) * FRAME_S).expect("physics lives");
        fewest = fewest.min(shown.snapshot.horizon().since(shown.frame));
        let others = shown.snapshot.sample(BodyId(1), shown.time_s).expect("the body is there");
        assert!(others.certainty <= forerun_timeline::Certainty::Presumed, "picture {picture}: {others:?}");
        let target = Vec3::new(30.0, 5.0 + 0.05 * f64::from(picture) as f32, 0.0);
        let spring =
            crate::dynamics::Spring { anchor: Vec3::ZERO, target, frequency_hz: 5.0, damping_ratio: 1.0 };
        driver.change(Change::Hold { body: BodyId(2), spring }).expect("room");
        after(driver);
    }
    fewest
}

#[test]
fn a_cheap_drag_leaves_the_queue_full() {
    let mut driver = filled();
    let fewest = dragged(&mut driver, |driver| assert!(eventually(|| full(driver))));
    assert!(fewest >= u64::from(LOOKAHEAD) - 1, "{fewest}");
    let picture = driver.last_picture();
    let held = picture.snapshot.sample(BodyId(2), picture.time_s).expect("it is there");
    assert!(held.certainty == forerun_timeline::Certainty::Exact && held.pose.position.y > 6.0, "{held:?}");
}

#[test]
fn a_costly_drag_keeps_physics_from_computing_what_the_next_move_throws_away() {
    // Two milliseconds a frame: eight or so from one picture to the next, and not twenty.
    let mut driver = slow(2);
    driver.show(0.0).expect("physics lives");
    assert!(eventually(|| full(&driver)));
    let before = driver.last_picture().stats;
    dragged(&mut driver, |_| std::thread::sleep(Duration::from_millis(16)));
    let after = driver.last_picture().stats;
    let again = after.edits.frames - before.edits.frames;
    assert!(again < 60 * u64::from(LOOKAHEAD) * 3 / 4, "{again} frames for 60 pictures");
    assert!(driver.last_picture().snapshot.horizon() > driver.last_picture().frame);
}

#[test]
fn display_time_waits_at_the_horizon_and_commands_are_taken() {
    let mut driver = slow(50);
    driver.show(0.0).expect("physics lives");
    assert!(eventually(|| driver.last_picture().snapshot.horizon() >= Frame(2)));
    let picture = driver.show(100.0).expect("physics lives");
    let horizon_s = picture.snapshot.horizon().seconds(picture.snapshot.frame_seconds());
    assert!(picture.time_s > 0.0 && picture.time_s <= horizon_s, "{picture:?}");
    assert!(picture.is_slowed() && picture.wished_s > 99.0, "{picture:?}");
    assert!(driver.change(Change::Release { body: BodyId(1) }).is_ok());
}

#[test]
fn the_speed_is_the_callers_and_a_pause_shows_what_is_changed() {
    let mut driver = filled();
    driver.set_speed(10.0).expect("a possible speed");
    let shown = |driver: &mut Decoupled, real_s: f64| {
        (1e9 * driver.show(real_s).expect("physics lives").time_s).round() as u64
    };
    assert_eq!(shown(&mut driver, 0.02), 200_000_000);
    driver.set_speed(0.0).expect("a possible speed");
    assert_eq!(shown(&mut driver, 5.0), 200_000_000);
    driver.set_speed(1.0).expect("a possible speed");
    assert!(eventually(|| full(&driver)));
    assert_eq!(shown(&mut driver, 5.05), 250_000_000);
    for speed in [-1.0, f64::NAN, f64::INFINITY, 1001.0] {
        let refused = driver.set_speed(speed);
        assert!(matches!(refused, Err(DriverError::Setting { field: "speed", .. })), "{refused:?}");
    }
    assert_eq!(driver.speed(), 1.0);
}

#[test]
fn any_kept_time_can_be_seeked_and_what_follows_be_changed() {
    let mut driver = filled();
    for real in 0..50 {
        driver.show(f64::from(real) * FRAME_S).expect("physics lives");
        assert!(eventually(|| full(&driver)));
    }
    let snapshot = driver.last_picture().snapshot;
    let there_s = 12.25 * FRAME_S;
    assert_eq!(driver.seek(there_s), Ok(there_s));
    let picture = driver.show(49.0 * FRAME_S).expect("physics lives");
    assert_eq!((picture.time_s, picture.frame), (there_s, Frame(12)));
    assert_eq!(snapshot.sample(BodyId(1), there_s), picture.snapshot.sample(BodyId(1), there_s));
    let key = driver.change(Change::Move { body: BodyId(1), pose: Pose::IDENTITY }).expect("room");
    assert_eq!(key.frame, Frame(13));
    assert!(eventually(|| driver.last_picture().stats.edits.recomputed > 0));
    let picture = driver.show(50.0 * FRAME_S).expect("physics lives");
    assert_eq!(picture.time_s, there_s + (50.0 * FRAME_S - 49.0 * FRAME_S));
    // What was shown before the edit is as it was.
    let state = |frame: u64| *picture.snapshot.state(BodyId(1), Frame(frame)).expect("kept");
    assert_eq!(Some(&state(12)), snapshot.state(BodyId(1), Frame(12)));
    assert_eq!(state(13).position, Vec3::ZERO);
    // Beyond what is kept there is nothing to show.
    let horizon_s = picture.snapshot.horizon().seconds(picture.snapshot.frame_seconds());
    assert_eq!((driver.seek(-5.0), driver.seek(1e9)), (Ok(0.0), Ok(horizon_s)));
    assert!(driver.seek(f64::NAN).is_err());
}

#[test]
fn a_queue_that_cannot_be_is_refused_at_the_start() {
    for command_capacity in [0, usize::MAX] {
        let refused =
            Decoupled::start(timeline(), DecoupledSettings { command_capacity, ..settings() }).err();
        let Some(DriverError::Setting { field, message }) = refused else { panic!("{refused:?}") };
        assert_eq!(field, "command_capacity");
        assert_eq!(message, format!("must be from 1 to 65536, is {command_capacity}"));
    }
}

#[test]
fn a_full_queue_pushes_back_at_once_and_takes_commands_again_later() {
    let slow_down = Duration::from_millis(100);
    let mut driver =
        Decoupled::start(timeline(), DecoupledSettings { slow_down, command_capacity: 4, ..settings() })
            .expect("a thread");
    let mut change = || driver.change(Change::Release { body: BodyId(1) });
    // One queue full may be heard in between, not more: physics sleeps.
    let refused = (0..20).find_map(|_| change().err());
    assert_eq!(refused, Some(DriverError::QueueFull));
    assert!(eventually(|| change().is_ok()));
}

#[test]
fn a_command_that_the_timeline_refuses_comes_back_with_the_reason() {
    let mut driver = slow(0);
    let key = driver.change(Change::Remove { body: BodyId(77) }).expect("the queue has room");
    let mut refusals = Vec::new();
    assert!(eventually(|| {
        refusals.extend(driver.refusals());
        !refusals.is_empty()
    }));
    assert_eq!(refusals, [Refusal::Submit(key, CommandError::UnknownBody(BodyId(77)))]);
}

#[test]
fn local_changes_count_on_after_the_commands_that_the_timeline_had() {
    let mut timeline = timeline();
    let staged = timeline.change(Frame(1), Change::Release { body: BodyId(1) }).expect("a plain change");
    let mut driver = Decoupled::start(timeline, settings()).expect("a thread");
    let key = driver.change(Change::Release { body: BodyId(2) }).expect("the queue has room");
    assert_eq!((key.frame, key.sequence), (staged.frame, staged.sequence + 1));
    assert!(eventually(|| {
        driver.show(0.0).expect("physics lives");
        full(&driver)
    }));
    assert_eq!(driver.refusals(), []);
}

#[test]
fn added_bodies_get_their_names_without_asking_the_physics() {
    let mut driver = slow(0);
    let ball = || BodyDef::new(Shape::Sphere(Sphere { radius: 0.1 })).at(Vec3::new(-20.0, 3.0, 0.0));
    let (first, unused) = (driver.add(ball()).expect("room"), driver.reserve_body());
    let second = driver.add(ball()).expect("room");
    assert_eq!((first, unused, second), (BodyId(3), BodyId(4), BodyId(5)));
    let last = Frame(u64::from(LOOKAHEAD));
    assert!(eventually(|| {
        driver.show(0.0).expect("physics lives");
        full(&driver) && driver.last_picture().snapshot.state(second, last).is_some()
    }));
    assert_eq!(driver.refusals(), []);
}

#[test]
fn a_panic_of_the_physics_reaches_the_display_with_its_message() {
    let mut frames = 0;
    let hinder = move || {
        frames += 1;
        assert!(frames < 5, "the fifth frame is one too many");
    };
    let mut driver = Decoupled::start_hindered(timeline(), settings(), Box::new(hinder)).expect("a thread");
    let mut failure = None;
    assert!(eventually(|| {
        failure = driver.show(0.0).err();
        failure.is_some()
    }));
    let Some(DriverError::Panicked(message)) = failure else { panic!("{failure:?}") };
    assert!(message.contains("the fifth frame is one too many"), "{message}");
    assert_eq!(driver.last_picture().snapshot.horizon(), Frame(4));
    assert!(matches!(driver.change(Change::Release { body: BodyId(1) }), Err(DriverError::Panicked(_))));
}

#[test]
fn dropping_the_driver_ends_the_thread() {
    let driver = slow(5);
    let shared: Weak<Shared> = Arc::downgrade(&driver.shared);
    drop(driver);
    assert!(shared.upgrade().is_none(), "the thread still holds what it shares");
}
