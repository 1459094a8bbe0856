//! Stall: physics that sleeps in every step does not delay a picture, whatever the user does meanwhile; under the traditional driver it does.
//!
//! Measured is what a picture costs in our calls (show, keys, mouse, report) on a real clock, without the time in which the system gave the processor to others:
//! waiting for a lock, for a queue or for a step counts, waiting for a processor does not. Drawing is not in it.

mod harness;

use std::time::Duration;

use forerun::Clock;
use forerun_viewer::SceneSource;
use forerun_viewer::view::Tool;
use harness::{INTERVAL_S, User};
use three_d::{Event, Key, Modifiers};

/// How long this thread was ready to run and did not get a processor, since it began. Seconds; 0 where the system does not say.
fn kept_waiting_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = text.split_whitespace().nth(1).and_then(|number| number.parse::<u64>().ok());
    nanoseconds.map_or(0.0, |nanoseconds| nanoseconds as f64 * 1e-9)
}

/// What the user does at a picture: throws, drags, pushes, takes back.
fn events(user: &mut User, picture: u32) -> Vec<Event> {
    let x = 500.0 + 3.0 * (picture % 90) as f32;
    let modifiers = Modifiers { ctrl: true, command: true, ..Modifiers::default() };
    match picture % 90 {
        0 => {
            user.take(Tool::Throw);
            vec![user.press([640.0, 380.0])]
        }
        20 => vec![user.release([640.0, 380.0])],
        30 => {
            user.take(Tool::Select);
            vec![user.press([x, 400.0])]
        }
        31..60 => vec![user.motion([x, 380.0])],
        60 => vec![user.release([x, 380.0])],
        70 => vec![Event::KeyPress { kind: Key::Z, modifiers, handled: false }],
        _ => Vec::new(),
    }
}

/// Shows pictures for some time at 60 a second while every step sleeps: the longest that a picture took, and how many were shown. Seconds.
fn longest(slow_down_s: f32, coupled: bool, seconds: f64) -> (f64, u32) {
    let mut user = User::of_source(SceneSource::BuiltIn("dominoes:60".to_owned()));
    user.session.slow_down_s = slow_down_s;
    if coupled {
        user.key(Key::K, Modifiers::default());
        assert!(user.play().is_coupled());
    }
    let clock = Clock::system();
    let begin_s = user.real_s;
    let (mut longest_s, mut picture) = (0.0_f64, 0_u32);
    while clock.now().as_secs_f64() < seconds {
        let due = Duration::from_secs_f64(f64::from(picture) * INTERVAL_S);
        std::thread::sleep(due.saturating_sub(clock.now()));
        let events = events(&mut user, picture);
        let (from, waited_s) = (clock.now(), kept_waiting_s());
        user.real_s = begin_s + from.as_secs_f64();
        user.picture_now(events);
        let report = user.report();
        let took_s = (clock.now() - from).as_secs_f64() - (kept_waiting_s() - waited_s);
        assert!(report.play.is_some(), "{:?}", report.failure);
        longest_s = longest_s.max(took_s);
        picture += 1;
    }
    (longest_s, picture)
}

#[test]
fn slow_physics_delays_no_picture() {
    for slow_down_s in [0.2, 0.5, 1.0] {
        let (longest_s, pictures) = longest(slow_down_s, false, 2.5);
        assert!(longest_s < INTERVAL_S, "a picture took {longest_s} s with sleeps of {slow_down_s} s");
        assert!(pictures > 20, "{pictures} pictures");
    }
}

#[test]
fn under_the_traditional_driver_it_does() {
    let (longest_s, pictures) = longest(0.2, true, 2.0);
    assert!(longest_s >= 0.2, "{longest_s} s");
    assert!(pictures < 15, "{pictures} pictures");
}

#[test]
#[ignore = "figures for the notes: takes a minute"]
#[allow(clippy::print_stdout, reason = "its output is the result")]
fn figures() {
    println!("sleep a step | decoupled: longest picture, pictures/s | coupled: longest picture, pictures/s");
    for slow_down_s in [0.0, 0.2, 0.5, 1.0] {
        let seconds = 6.0;
        let [(longest_s, pictures), (coupled_s, coupled)] =
            [false, true].map(|coupled| longest(slow_down_s, coupled, seconds));
        let rate = |pictures: u32| f64::from(pictures) / seconds;
        println!(
            "{slow_down_s:8.1} s   | {:9.2} ms {:8.1} /s | {:9.2} ms {:8.1} /s",
            1e3 * longest_s,
            rate(pictures),
            1e3 * coupled_s,
            rate(coupled)
        );
    }
}
