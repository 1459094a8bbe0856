//! Commands act in the order of frame, source and sequence: when they arrive never matters.

use forerun_dynamics::{BodyDef, BodyId};
use forerun_geometry::{Pose, Vec3};
use forerun_timeline::check::{Random, mismatches};
use forerun_timeline::{Change, Command, CommandError, CommandKey, Frame, Timeline, TimelineSettings};

use crate::lab::{assert_equals_full_run, cuboid, environment, push, pyramids, run, timeline};

/// What a client does: no two of these commute.
fn client(source: u32) -> Vec<Command> {
    let added = BodyId(100 + source);
    let spot = Vec3::new(source as f32, 5.0, 0.0);
    let at = |frame: u64, sequence: u64, change: Change| {
        let key = CommandKey { frame: Frame(frame), source, sequence };
        Command { key, change }
    };
    let velocity = Vec3::new(source as f32, 2.0, -1.0);
    vec![
        at(10, 0, push(BodyId(10), Vec3::new(500.0 * source as f32, 0.0, 0.0))),
        at(10, 1, Change::Move { body: BodyId(10), pose: Pose::from_position(spot) }),
        at(10, 2, Change::SetVelocity { body: BodyId(10), velocity, angular_velocity: Vec3::ZERO }),
        at(10, 3, Change::Add { body: added, def: Box::new(cuboid(0.4, 0.4, 0.4).at(spot + Vec3::Y)) }),
        // Gone when the other client's push comes, or not yet there.
        at(
            25,
            0,
            if source == 1 { Change::Remove { body: BodyId(9) } } else { push(BodyId(9), spot * 300.0) },
        ),
        at(25, 1, Change::SetGravity { gravity: Vec3::new(0.0, -5.0 - source as f32, 0.0) }),
        at(25, 2, push(BodyId(203 - added.0), Vec3::new(0.0, 900.0, 100.0))),
    ]
}

#[test]
fn two_clients_in_all_kinds_of_arrival() {
    let bodies = pyramids(1, 4);
    let (a, b) = (client(1), client(2));
    let one_after_the_other = [a.clone(), b.clone()].concat();
    let the_other_first = [b.clone(), a.clone()].concat();
    let in_turn: Vec<Command> = a.iter().zip(&b).flat_map(|(a, b)| [b.clone(), a.clone()]).collect();
    let latest_first: Vec<Command> = one_after_the_other.iter().rev().cloned().collect();
    let mut results: Vec<Timeline> = Vec::new();
    for commands in [one_after_the_other, the_other_first, in_turn, latest_first] {
        for frames_between in [0, 1, 7] {
            let mut timeline = timeline(&bodies, 60);
            while timeline.names() < 103 {
                let _ = timeline.reserve_body();
            }
            for command in commands.clone() {
                timeline.submit(command).unwrap();
                for _ in 0..frames_between {
                    let _ = timeline.advance();
                }
            }
            run(&mut timeline);
            results.push(timeline);
        }
    }
    for other in &results[1..] {
        assert_eq!(mismatches(&results[0], other), (0, None));
    }
    assert_equals_full_run(&results[0], &bodies);
}

#[test]
fn a_thousand_edits_in_one_frame_are_one_batch() {
    let bodies = pyramids(4, 4);
    let mut random = Random::new(5);
    let mut commands: Vec<Command> = (0..1000)
        .map(|sequence| {
            let body = BodyId(1 + random.below(40) as u32);
            let key = CommandKey { frame: Frame(30), source: random.below(3) as u32, sequence };
            let (v, w) = (random.vector(), random.vector());
            let change = match random.below(3) {
                0 => push(body, v * 200.0),
                1 => Change::SetVelocity { body, velocity: v, angular_velocity: w },
                _ => Change::SetGravityScale { body, scale: 1.0 + 0.1 * v.x },
            };
            Command { key, change }
        })
        .collect();
    let mut forward = timeline(&bodies, 80);
    forward.submit_all(commands.clone()).unwrap();
    let work = run(&mut forward);
    // Each frame once, all bodies at most.
    assert!(work.len() <= 51 && work.iter().all(|done| done.recomputed <= 40), "{} frames", work.len());
    assert_eq!(forward.stats().last_edit.commands, 1000);
    commands.reverse();
    let mut backward = timeline(&bodies, 80);
    backward.submit_all(commands).unwrap();
    run(&mut backward);
    assert_eq!(mismatches(&forward, &backward), (0, None));
    assert_equals_full_run(&forward, &bodies);
}

/// A timeline whose display is at frame 40 and whose past reaches to frame 20.
fn displayed(bodies: &[BodyDef]) -> Timeline {
    let settings = TimelineSettings { lookahead: 30, past: 20, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(bodies, environment(), settings).unwrap();
    for display in 0..=40 {
        timeline.set_display(Frame(display));
        run(&mut timeline);
    }
    timeline
}

#[test]
fn commands_around_the_display() {
    let bodies = pyramids(1, 4);
    // In the kept past, just after what is kept, at the display, after it, at the horizon and beyond it.
    for frame in [30, 21, 40, 41, 70, 75] {
        let mut timeline = displayed(&bodies);
        let before = timeline.fork();
        let shown = timeline.snapshot();
        timeline.change(Frame(frame), push(BodyId(10), Vec3::new(900.0, 0.0, 0.0))).unwrap();
        run(&mut timeline);
        timeline.set_display(Frame(50));
        run(&mut timeline);
        // Nothing earlier changes, and what was handed to the display stays as it was.
        for k in 20..=70 {
            for body in (0..11).map(BodyId) {
                assert_eq!(shown.state(body, Frame(k)), before.state(body, Frame(k)));
                if k < frame && k >= timeline.oldest().0 {
                    assert_eq!(timeline.state(body, Frame(k)), before.state(body, Frame(k)));
                }
            }
        }
        let acts = Frame(frame.max(timeline.oldest().0));
        assert_ne!(timeline.state(BodyId(10), acts), before.state(BodyId(10), acts));
        if frame > timeline.oldest().0 {
            assert_equals_full_run(&timeline, &bodies);
        }
    }
}

#[test]
fn what_is_older_than_the_kept_past_is_refused_and_changes_nothing() {
    let mut timeline = displayed(&pyramids(1, 4));
    let before = timeline.fork();
    for frame in [0, 7, 20] {
        let refused = timeline.change(Frame(frame), push(BodyId(10), Vec3::X));
        assert_eq!(refused, Err(CommandError::TooOld { frame: Frame(frame), oldest: Frame(20) }));
    }
    assert!(run(&mut timeline).is_empty());
    assert_eq!(mismatches(&timeline, &before), (0, None));
}
