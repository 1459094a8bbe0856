//! The traditional model by a hand-turned clock, and its way from a timeline and back.

use std::sync::atomic::{AtomicU32, Ordering};

use super::*;
use crate::{BodyDef, Cuboid, Environment, Shape, Sphere, Vec3};

fn coupled(clock: &Clock) -> Coupled {
    let mut world = World::new(Environment::default());
    let ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.1 })).at(Vec3::Y * 100.0);
    world.add(&ball).expect("a plain ball");
    Coupled::new(world, clock.clone(), Threads::all().expect("threads"), StepLimits::default())
        .expect("the limits are possible")
}

#[test]
fn impossible_limits_and_environments_are_refused_at_the_start() {
    let refused = |limits: (f64, f64), environment: Environment| {
        let limits = StepLimits { min_s: limits.0, max_s: limits.1 };
        let threads = Threads::all().expect("threads");
        Coupled::new(World::new(environment), Clock::by_hand(), threads, limits).err()
    };
    assert_eq!(refused((0.000_01, 1.0), Environment::default()), None);
    assert_eq!(refused((0.02, 0.02), Environment::default()), None);
    for (limits, at_fault) in [
        ((0.0, 0.04), "min_s"),
        ((f64::NAN, 0.04), "min_s"),
        ((0.01, 1.5), "max_s"),
        ((0.04, 0.01), "max_s"),
        ((0.01, f64::NAN), "max_s"),
    ] {
        let error = refused(limits, Environment::default());
        assert!(matches!(error, Some(DriverError::Setting { field, .. }) if field == at_fault), "{error:?}");
    }
    let mut environment = Environment::default();
    environment.settings.substeps = 0;
    let error = refused((0.001, 0.042), environment).map(|error| error.to_string());
    assert_eq!(error.as_deref(), Some("environment: substeps: must be from 1 to 64, is 0"));
}

#[test]
fn a_step_is_as_long_as_the_cycle_before() {
    let clock = Clock::by_hand();
    let mut driver = coupled(&clock);
    driver.show();
    for (cycle_ms, step_ms) in [(20, 20.0), (35, 35.0), (500, 42.0), (0, 1.0)] {
        clock.turn(Duration::from_millis(cycle_ms));
        let before = driver.time_s();
        driver.show();
        assert!((1000.0 * (driver.time_s() - before) - step_ms).abs() < 1e-9, "cycle of {cycle_ms} ms");
    }
}

#[test]
fn a_step_takes_as_long_by_the_clock_of_a_display_as_by_the_machines() {
    // Every look at this clock finds it 1 ms later.
    static LOOKS: AtomicU32 = AtomicU32::new(0);
    let clock = Clock::host(|| f64::from(LOOKS.fetch_add(1, Ordering::Relaxed)) * 1e-3);
    let mut driver = coupled(&clock).with_slow_down(Duration::from_millis(190));
    assert!(driver.is_due(7.0));
    driver.show_at(7.0);
    assert!(driver.is_due(7.0), "the first shows what there is");
    // A film of 25 pictures a second: one step in five pictures, each of the longest that is allowed.
    let mut stepped = 0;
    for picture in 1_u8..=50 {
        let now_s = 7.0 + f64::from(picture) * 0.04;
        if driver.is_due(now_s) {
            let before = driver.time_s();
            driver.show_at(now_s);
            stepped += 1;
            let step_s = driver.time_s() - before;
            assert!((step_s - if stepped == 1 { 0.04 } else { 0.042 }).abs() < 1e-9, "{step_s} s");
            assert!((0.19..0.2).contains(&driver.cost_s()), "{} s", driver.cost_s());
        }
    }
    assert_eq!(stepped, 10);
    driver.pause();
    assert!(driver.is_due(9.001), "who paused waits for no step");
    driver.show_at(f64::NAN);
}

#[test]
fn rest_is_a_matter_of_time_and_not_of_how_many_frames_it_took() {
    let clock = Clock::by_hand();
    let mut world = World::default();
    world.add(&BodyDef::fixed(Shape::HalfSpace)).expect("the ground");
    let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
    world.add(&BodyDef::new(cube).at(Vec3::Y * 0.5)).expect("a plain cube");
    world.environment.settings.overlap_allowed_m = 0.0;
    let threads = Threads::all().expect("threads");
    let mut driver = Coupled::new(world, clock.clone(), threads, StepLimits::default()).expect("defaults");
    let cycles = |driver: &mut Coupled, count: u32, millis: u64| {
        for _ in 0..count {
            clock.turn(Duration::from_millis(millis));
            driver.show();
        }
        let rest = driver.world().states()[1].rest;
        (rest, driver.world().environment.settings.rest_frames())
    };
    // A tenth of a second of quiet is a twentieth of what it takes, however few frames that now is.
    cycles(&mut driver, 101, 1);
    let (rest, full) = cycles(&mut driver, 1, 42);
    assert!((2..=4).contains(&rest), "{rest} of {full}");
    let (rest, full) = cycles(&mut driver, 200, 20);
    assert_eq!(rest, full + 1, "at rest");
    for millis in [21, 17, 30, 1] {
        let (rest, full) = cycles(&mut driver, 1, millis);
        assert_eq!(rest, full + 1, "still at rest in a cycle of {millis} ms");
    }
}

#[test]
fn a_cycle_beyond_the_longest_step_is_never_made_up_for() {
    let clock = Clock::by_hand();
    let mut driver = coupled(&clock);
    driver.show();
    clock.turn(Duration::from_secs(1));
    driver.show();
    for _ in 0..100 {
        clock.turn(Duration::from_millis(33));
        driver.show();
    }
    assert!((clock.now().as_secs_f64() - driver.time_s() - 0.958).abs() < 1e-9);
}

/// A timeline of a ball that falls and two boxes on the ground, one of which is soon gone.
fn falling() -> Timeline {
    let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
    let mut ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 })).at(Vec3::Y * 30.0);
    ball.velocity = Vec3::X;
    let bodies = [
        BodyDef::fixed(Shape::HalfSpace),
        BodyDef::new(cube.clone()).at(Vec3::new(5.0, 0.5, 0.0)),
        BodyDef::new(cube).at(Vec3::new(9.0, 0.5, 0.0)),
        ball,
    ];
    let mut timeline =
        Timeline::new(&bodies, Environment::default(), TimelineSettings::default()).expect("plain bodies");
    timeline.change(Frame(10), Change::Remove { body: BodyId(1) }).expect("it is there");
    timeline.change(Frame(20), Change::SetGravityScale { body: BodyId(3), scale: 0.5 }).expect("it is there");
    while timeline.advance() != forerun_timeline::Progress::Idle {}
    timeline
}

#[test]
fn it_goes_on_from_what_another_driver_shows_and_back_again() {
    let (clock, threads) = (Clock::by_hand(), Threads::all().expect("threads"));
    let snapshot = falling().snapshot();
    let time_s = 60.25 / 60.0;
    let limits = StepLimits::default();
    let mut driver = Coupled::of_snapshot(&snapshot, time_s, clock.clone(), threads, limits).expect("finite");
    assert_eq!(driver.names(), [0, 2, 3].map(BodyId));
    let mut drawn = Vec::new();
    driver.sample_all(&mut drawn);
    let mut shown = Vec::new();
    snapshot.sample_all(time_s, &mut shown);
    assert_eq!(drawn, shown);
    // The first cycle shows that, the next goes on: with half the gravity, as the command said.
    driver.show();
    let before = drawn[2].1;
    for _ in 0..30 {
        clock.turn(Duration::from_millis(20));
        driver.show();
    }
    driver.sample_all(&mut drawn);
    let after = drawn[2].1;
    assert!((after.velocity.y - (before.velocity.y - 0.5 * 9.81 * 0.6)).abs() < 1e-3, "{after:?}");
    assert!((driver.time_s() - (time_s + 0.6)).abs() < 1e-9);
    let picture = driver.picture();
    assert_eq!((picture.time_s, picture.frame), (driver.time_s(), Frame(96)));
    assert!((picture.wished_s - driver.time_s()).abs() < 1e-9 && (picture.rate - 1.0).abs() < 1e-9);
    let mut queried = Vec::new();
    picture.snapshot.sample_all(picture.time_s, &mut queried);
    assert_eq!(queried.len(), 3);
    for ((id, queried), (body, drawn)) in queried.iter().zip(&drawn) {
        assert_eq!((id, queried.pose.position), (body, drawn.pose.position));
    }
    assert!(picture.snapshot.inspect(picture.frame).is_some());

    let timeline = driver.timeline(TimelineSettings::default()).expect("plain states");
    assert_eq!((timeline.oldest(), timeline.display()), (Frame(96), Frame(96)));
    assert_eq!(timeline.bodies_at(Frame(96)), driver.names());
    assert_eq!(timeline.environment_at(Frame(96)), snapshot.environment_at(Frame(60)));
    for (name, state) in driver.names().iter().zip(driver.world().states()) {
        let there = timeline.state(*name, Frame(96)).expect("it is there");
        assert_eq!((there.position, there.velocity), (state.position, state.velocity));
    }
    assert_eq!(timeline.body_at(BodyId(3), Frame(96)).map(|body| body.gravity_scale), Some(0.5));
    // Names go on where they were.
    assert_eq!((timeline.names(), driver.coming_body()), (4, BodyId(4)));
}

#[test]
fn bodies_come_and_go_and_keep_their_names() {
    let clock = Clock::by_hand();
    let mut driver = coupled(&clock);
    let ball = || BodyDef::new(Shape::Sphere(Sphere { radius: 0.1 }));
    assert_eq!(driver.add(ball().at(Vec3::X * 5.0)), Ok(BodyId(1)));
    assert_eq!(driver.picture().snapshot.bodies_at(Frame(0)).count(), 2);
    assert_eq!(driver.change(&Change::Remove { body: BodyId(0) }), Ok(()));
    let gone = Change::Remove { body: BodyId(0) };
    assert_eq!(driver.change(&gone), Err(ChangeError::UnknownBody(BodyId(0))));
    let velocity = Change::SetVelocity { body: BodyId(1), velocity: Vec3::Z, angular_velocity: Vec3::ZERO };
    assert_eq!(driver.change(&velocity), Ok(()));
    assert_eq!(driver.add(ball().at(Vec3::X * 8.0)), Ok(BodyId(2)));
    assert_eq!(driver.names(), [1, 2].map(BodyId));
    let snapshot = driver.picture().snapshot;
    assert_eq!(snapshot.bodies_at(Frame(0)).collect::<Vec<_>>(), [1, 2].map(BodyId));
    assert_eq!(snapshot.state(BodyId(1), Frame(0)).map(|state| state.velocity), Some(Vec3::Z));
    // A world of which it is not known how its bodies were made is brought to a timeline all the same.
    let mut worldly = coupled(&clock);
    worldly.change(&Change::SetGravityScale { body: BodyId(0), scale: 2.0 }).expect("it is there");
    let timeline = worldly.timeline(TimelineSettings::default()).expect("plain states");
    let (is, was) = (timeline.body_at(BodyId(0), Frame(0)).expect("there"), &worldly.world().bodies()[0]);
    assert_eq!((is.gravity_scale, is.frame), (2.0, was.frame));
    assert!((is.inverse_mass / was.inverse_mass - 1.0).abs() < 1e-6);
}

#[test]
fn after_a_pause_time_goes_on_where_it_stood_and_stages_are_measured() {
    let clock = Clock::by_hand();
    let mut driver = coupled(&clock).with_stage_times();
    driver.show();
    clock.turn(Duration::from_millis(20));
    driver.show();
    assert_eq!(driver.stage_times().number, 1);
    driver.pause();
    clock.turn(Duration::from_secs(60));
    driver.show();
    assert!((driver.time_s() - 0.02).abs() < 1e-9);
    clock.turn(Duration::from_millis(30));
    driver.show();
    assert!((driver.time_s() - 0.05).abs() < 1e-9);
    assert!((driver.picture().wished_s - 0.05).abs() < 1e-9);
    // A hand-turned clock stands during a step.
    assert_eq!((driver.stage_times().number, driver.stage_times().total_s()), (2, 0.0));
}
