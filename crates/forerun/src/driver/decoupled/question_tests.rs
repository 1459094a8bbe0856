//! What the display may ask, and how long the stages take: through the threads.

use std::sync::atomic::{AtomicU64, Ordering};

use forerun_timeline::{Change, Preview};

use super::tests::{LOOKAHEAD, eventually, filled, full, timeline};
use super::*;
use crate::{Answer, Answered, BodyDef, Clock, Question, Shape, StageTimes, Ticket, Vec3};

/// The answer to a question, once it is there.
fn answer(driver: &mut Decoupled, ticket: Ticket) -> Answered {
    let mut found = None;
    assert!(eventually(|| {
        let answers = driver.answers().expect("the thread lives");
        found = answers.into_iter().find(|answered| answered.ticket == ticket);
        found.is_some()
    }));
    found.expect("it was found")
}

#[test]
fn a_frame_is_looked_into_beside_the_display() {
    let mut driver = filled();
    assert_eq!(driver.answers(), Ok(vec![]));
    let ticket = driver.ask(Question::Inspect { frame: Frame(7) }).expect("a thread");
    let Ok(Answer::Inspect(inspection)) = answer(&mut driver, ticket).answer else { panic!("no answer") };
    let snapshot = driver.last_picture().snapshot;
    assert_eq!(Some(inspection), snapshot.inspect(Frame(7)));
    let ticket = driver.ask(Question::Inspect { frame: Frame(700) }).expect("a thread");
    assert!(answer(&mut driver, ticket).answer.is_err());
}

#[test]
fn a_preview_of_a_throw_is_what_the_throw_then_does() {
    let mut driver = filled();
    let ball = || {
        let mut ball = BodyDef::new(Shape::sphere(0.3).expect("a ball")).at(Vec3::new(-10.0, 3.0, 0.0));
        ball.velocity = Vec3::X * 20.0;
        ball
    };
    let body = driver.coming_body();
    let frame = driver.last_picture().frame.next();
    let changes = vec![Change::Add { body, def: Box::new(ball()) }];
    let frames = LOOKAHEAD - 1;
    let ticket = driver.ask(Question::Preview(Preview { frame, changes, frames, bodies: vec![] }));
    let answered = answer(&mut driver, ticket.expect("a thread"));
    let Ok(Answer::Preview(previewed)) = answered.answer else { panic!("{answered:?}") };
    assert_eq!(driver.last_picture().stats.edits.recomputed, 0, "nothing happened");
    assert_eq!(driver.add(ball()), Ok(body));
    let last = Frame(u64::from(LOOKAHEAD));
    assert!(eventually(|| full(&driver) && driver.last_picture().snapshot.state(body, last).is_some()));
    let snapshot = driver.last_picture().snapshot;
    let trail = previewed.trails.iter().find(|trail| trail.body == body).expect("it was thrown");
    assert_eq!((trail.from, previewed.to), (frame, last));
    for (k, pose) in trail.poses.iter().enumerate() {
        let time_s = frame.plus(k as u64).seconds(snapshot.frame_seconds());
        let truth = snapshot.pose(body, time_s).expect("it is there");
        assert_eq!((pose.position, pose.rotation), (truth.position, truth.rotation));
    }
}

#[test]
fn asking_waits_neither_for_physics_nor_for_answers() {
    let settings = DecoupledSettings::new(Threads::exactly(std::num::NonZeroU16::MIN).expect("one"));
    let slow_down = Duration::from_secs(1);
    let mut driver =
        Decoupled::start(timeline(), DecoupledSettings { slow_down, ..settings }).expect("a thread");
    driver.ask(Question::Inspect { frame: Frame(0) }).expect("a thread");
    let clock = Clock::system();
    let preview = Preview { frame: Frame(1), changes: vec![], frames: 10, bodies: vec![] };
    for k in 0..200 {
        driver.ask(Question::Inspect { frame: Frame(k % 2) }).expect("never full");
        driver.ask(Question::Preview(preview.clone())).expect("never full");
        let _ = driver.answers().expect("the thread lives");
    }
    assert!(clock.now() < Duration::from_millis(500), "{:?}", clock.now());
}

/// Milliseconds that a host's clock shows; every look takes one.
static LOOKS: AtomicU64 = AtomicU64::new(0);

fn host_s() -> f64 {
    0.001 * LOOKS.fetch_add(1, Ordering::Relaxed) as f64
}

#[test]
fn the_stages_of_every_computed_frame_are_measured_where_a_clock_is_given() {
    let settings = DecoupledSettings::new(Threads::exactly(std::num::NonZeroU16::MIN).expect("one"));
    let stage_clock = Some(Clock::host(host_s));
    let mut driver =
        Decoupled::start(timeline(), DecoupledSettings { stage_clock, ..settings }).expect("a thread");
    driver.show(0.0).expect("physics lives");
    assert!(eventually(|| full(&driver)));
    let mut times: Vec<StageTimes> = Vec::new();
    let next = driver.stage_times(0, &mut times);
    assert_eq!((next, times.len()), (u64::from(LOOKAHEAD), LOOKAHEAD as usize));
    for (k, times) in times.iter().enumerate() {
        assert_eq!((times.number, times.frame), (k as u64, Frame(k as u64 + 1)));
        assert_eq!((times.extended, times.recomputed), (true, 2));
        // One look at the end of each stage that there is, and one at the end of all.
        assert!((times.of(forerun_dynamics::Stage::Collisions) - 0.001).abs() < 1e-6, "{times:?}");
        let looks = times.seconds.iter().filter(|seconds| **seconds > 0.0).count() + 1;
        assert!((times.total_s() - 0.001 * looks as f32).abs() < 1e-5, "{times:?}");
    }
    // An edit is measured too, and counted apart.
    driver.change(Change::Release { body: BodyId(1) }).expect("room");
    assert!(eventually(|| {
        times.clear();
        driver.stage_times(next, &mut times) > next
    }));
    assert!(times.iter().all(|times| !times.extended && times.recomputed <= 1), "{times:?}");
    // Where there is no clock there is nothing to tell.
    assert_eq!(filled().stage_times(0, &mut times), 0);
}
