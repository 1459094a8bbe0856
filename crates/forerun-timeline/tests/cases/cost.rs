//! An edit costs what it touches: its islands from the edit on, and others from the moment they are met.

use std::collections::BTreeSet;

use forerun_dynamics::{BodyDef, BodyId};
use forerun_geometry::Vec3;
use forerun_timeline::Frame;

use crate::lab::{assert_equals_full_run, domino_lines, ideal, push, pyramids, run, timeline};

/// Pushes some bodies at a frame, and compares the work with what a brute-force search for islands finds necessary.
fn assert_cost_is_ideal(bodies: &[BodyDef], frames: u32, frame: Frame, pushed: &[BodyId], impulse: Vec3) {
    let mut timeline = timeline(bodies, frames);
    let before = timeline.fork();
    for body in pushed {
        timeline.change(frame, push(*body, impulse)).unwrap();
    }
    run(&mut timeline);
    let commanded: Vec<(Frame, BodyId)> = pushed.iter().map(|body| (frame, *body)).collect();
    let ideal: u64 = ideal(&before, &timeline, &commanded).iter().map(|set| set.len() as u64).sum();
    let edit = timeline.stats().last_edit;
    let ratio = edit.recomputed as f64 / ideal as f64;
    assert!(edit.affected > 0 && ratio <= 1.10, "{} pushed: {ratio} times the ideal, {edit:?}", pushed.len());
    // No island is forgotten either; that it is the right one says the full run.
    assert!(ratio >= 1.0, "{} pushed: {ratio} times the ideal, {edit:?}", pushed.len());
    assert_equals_full_run(&timeline, bodies);
}

#[test]
fn k_of_nine_pyramids() {
    let bodies = pyramids(9, 4);
    for k in [1, 2, 5, 9] {
        // The topmost cube of each.
        let pushed: Vec<BodyId> = (1..=k).map(|pyramid| BodyId(10 * pyramid)).collect();
        assert_cost_is_ideal(&bodies, 150, Frame(30), &pushed, Vec3::new(900.0, 0.0, 300.0));
    }
}

#[test]
fn k_of_eight_lines_of_dominoes() {
    let bodies = domino_lines(8);
    for k in [1, 2, 5, 8] {
        let pushed: Vec<BodyId> = (0..k).map(|line| BodyId(1 + 10 * line)).collect();
        assert_cost_is_ideal(&bodies, 150, Frame(30), &pushed, Vec3::new(25.0, 0.0, 0.0));
    }
}

#[test]
fn an_island_that_is_met_costs_from_the_meeting_on() {
    // One cube of a pyramid is thrown at the next pyramid.
    let bodies = pyramids(3, 4);
    let (thrown, met) = (BodyId(10), 11..=20);
    let mut timeline = timeline(&bodies, 150);
    let before = timeline.fork();
    timeline.change(Frame(30), push(thrown, Vec3::new(7000.0, 1000.0, 0.0))).unwrap();
    let work = run(&mut timeline);
    let ideal = ideal(&before, &timeline, &[(Frame(30), thrown)]);
    let touched = |set: &BTreeSet<BodyId>| set.iter().any(|body| met.contains(&body.0));
    let meeting = ideal.iter().position(touched).expect("they meet") as u64;
    assert!((40..100).contains(&meeting), "they meet at frame {meeting}");
    for done in &work {
        let needed = &ideal[done.frame.0 as usize - 1];
        assert_eq!(done.recomputed as usize, needed.len(), "to {}", done.frame);
        // The pyramid that was left and the third one are never part of it when they need not be.
        assert!(done.frame.0 > meeting || done.recomputed <= 10, "{done:?}");
        assert!(needed.iter().all(|body| body.0 <= 20), "the third pyramid is never reached");
    }
    assert_equals_full_run(&timeline, &bodies);
}
