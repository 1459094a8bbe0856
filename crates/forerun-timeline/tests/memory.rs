//! Memory: budgets of frames and of bytes are kept, are told, and change no bit (case D04); rest costs nothing.

mod scenes;

use forerun_dynamics::{BodyDef, BodyId, Environment};
use forerun_geometry::Vec3;
use forerun_geometry::shape::{Shape, Sphere};
use forerun_timeline::check::{Random, mismatches, random_change};
use forerun_timeline::{Change, Frame, Progress, Timeline, TimelineSettings};

fn run(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}

/// Balls that fall for ever: every state differs from the one before.
fn falling(count: usize) -> Vec<BodyDef> {
    let ball = Shape::Sphere(Sphere { radius: 0.1 });
    (0..count).map(|i| BodyDef::new(ball.clone()).at(Vec3::new(i as f32, 0.0, 0.0))).collect()
}

fn timeline(bodies: &[BodyDef], settings: TimelineSettings) -> Timeline {
    Timeline::new(bodies, Environment::default(), settings).unwrap()
}

#[test]
fn a_moving_body_costs_less_than_64_bytes_a_frame() {
    let settings = TimelineSettings { lookahead: 100, ..TimelineSettings::default() };
    let mut timeline = timeline(&falling(1024), settings);
    let first = timeline.state_bytes();
    run(&mut timeline);
    let per_state = (timeline.state_bytes() - first) as f64 / (100.0 * 1024.0);
    assert!(per_state > 56.0 && per_state <= 64.0, "{per_state} bytes");
}

#[test]
fn the_oldest_past_goes_first_and_then_the_depth_shrinks() {
    let frame_bytes = 57 * 320;
    let wide = TimelineSettings { lookahead: 50, past: 50, ..TimelineSettings::default() };
    for (frames, past, lookahead) in [(200, 50, 50), (80, 29, 50), (40, 0, 38), (1, 0, 1)] {
        let settings = TimelineSettings { bytes_max: Some(frames * frame_bytes), ..wide };
        let mut bound = timeline(&falling(320), settings);
        let mut free = timeline(&falling(320), wide);
        for display in 0..120 {
            bound.set_display(Frame(display));
            free.set_display(Frame(display));
            run(&mut bound);
            run(&mut free);
            let stats = bound.stats();
            assert!(stats.state_bytes <= (frames * frame_bytes).max(3 * frame_bytes), "{stats:?}");
            assert_eq!(mismatches(&bound, &free), (0, None));
        }
        let stats = bound.stats();
        let near = |found: u64, expected: u64| found.abs_diff(expected) <= expected / 10 + 1;
        assert!(
            near(stats.past_frames, past) && near(stats.lookahead_frames, lookahead),
            "{frames}: {stats:?}"
        );
        assert_eq!(stats.memory_bound, frames < 100, "{frames}: {stats:?}");
        assert!(!free.stats().memory_bound);
    }
}

/// What was computed, thrown away for lack of memory, and computed again, is what it would have been.
#[test]
fn edits_under_little_memory_change_no_bit() {
    for (name, bodies) in scenes::all() {
        for seed in 0..4 {
            let wide = TimelineSettings { lookahead: 25, past: 20, ..TimelineSettings::default() };
            let mut free = timeline(&bodies, wide);
            run(&mut free);
            let budget = (10 + 10 * seed as usize) * free.state_bytes() / 46;
            let settings = TimelineSettings { bytes_max: Some(budget), ..wide };
            let mut bound = timeline(&bodies, settings);
            let mut random = Random::new(seed);
            for display in 0..60 {
                bound.set_display(Frame(display));
                free.set_display(Frame(display));
                if random.below(4) == 0 {
                    let first = bound.oldest().0 + 1;
                    let frame = Frame(first + random.below(free.horizon().0 + 3 - first));
                    let change = random_change(&mut free, frame, &mut random);
                    while bound.names() < free.names() {
                        bound.reserve_body();
                    }
                    assert_eq!(bound.change(frame, change.clone()), free.change(frame, change));
                }
                for _ in 0..random.below(40) {
                    let _ = bound.advance();
                }
                run(&mut free);
            }
            run(&mut bound);
            assert!(bound.horizon() > bound.display(), "{name}, seed {seed}");
            assert_eq!(mismatches(&bound, &free), (0, None), "{name}, seed {seed}");
        }
    }
}

#[test]
fn an_hour_of_rest_costs_what_a_second_does() {
    let settings = TimelineSettings { lookahead: 60, past: 1_000_000, ..TimelineSettings::default() };
    let mut timeline = timeline(&scenes::all()[0].1, settings);
    run(&mut timeline);
    timeline.set_display(Frame(600));
    run(&mut timeline);
    let (bytes, computed) = (timeline.state_bytes(), timeline.stats().ahead.recomputed);
    timeline.set_display(Frame(216_600));
    run(&mut timeline);
    assert_eq!(timeline.state_bytes(), bytes);
    assert_eq!(timeline.stats().ahead.recomputed, computed);
    assert_eq!((timeline.oldest(), timeline.horizon()), (Frame(0), Frame(216_660)));
    // And a push wakes it as if it had slept for a second.
    let push = Change::Push { body: BodyId(4), impulse: Vec3::Z * 2000.0, at_point: None };
    timeline.change(Frame(216_650), push).unwrap();
    run(&mut timeline);
    let edit = timeline.stats().last_edit;
    assert!(edit.affected > 5 && edit.recomputed <= 24 * 11, "{edit:?}");
    assert!(timeline.state_bytes() < bytes + 12 * 3000);
}

#[test]
fn a_display_that_jumps_leaves_no_more_past_than_is_asked_for() {
    let settings = TimelineSettings { lookahead: 20, past: 10, ..TimelineSettings::default() };
    let mut timeline = timeline(&falling(40), settings);
    timeline.set_display(Frame(300));
    run(&mut timeline);
    assert_eq!((timeline.oldest(), timeline.horizon()), (Frame(290), Frame(320)));
}
