//! Cost of an edit: in proportion to the islands that it touches, from the edit on, and those that it meets, from the meeting on.

use forerun::timeline::{Frame, Timeline};
use forerun::{BodyDef, BodyId, Clock, Environment, Vec3};

use crate::validate::Figure;
use crate::validate::lab::built_in;
use crate::validate::timelines::{computed, edit, first_difference, push, wrong};

/// How much more than the ideal may be computed.
const ALLOWANCE: f64 = 1.10;
const FRAMES: u32 = 300;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    groups(&mut figures, &Groups { scene: "many_pyramids", count: 196, size: 55, pushed: 54 });
    groups(&mut figures, &Groups { scene: "domino_lines:40", count: 40, size: 25, pushed: 12 });
    meeting(&mut figures);
    figures
}

/// Groups of bodies that never meet, after the ground.
struct Groups {
    scene: &'static str,
    count: u32,
    /// Bodies of each.
    size: u32,
    /// The one of each that is pushed.
    pushed: u32,
}

/// A body of 1, 2, 5, 20 and all groups is pushed at the second frame.
fn groups(figures: &mut Vec<Figure>, groups: &Groups) {
    const EDIT: Frame = Frame(2);
    let Groups { scene: name, count, size, pushed } = *groups;
    let scene = built_in(name);
    let clock = Clock::system();
    let before = computed(&scene, FRAMES);
    for k in [1, 2, 5, 20, count] {
        let mut timeline = before.fork();
        let pushes: Vec<_> = (0..k)
            .map(|i| BodyId(1 + size * (i * count / k) + pushed))
            .map(|body| (EDIT, push(&before, body, Vec3::new(1.0, 0.0, 0.5))))
            .collect();
        let began = clock.now();
        edit(&mut timeline, pushes);
        let ms = 1000.0 * (clock.now() - began).as_secs_f64();
        let done = timeline.stats().last_edit;
        // From the step to the edit's frame to the one to the last.
        let ideal = f64::from(k * size) * (FRAMES as f64 - EDIT.0 as f64 + 1.0);
        let title = format!("{name}, {k} of {count} pushed");
        figures.push(Figure::at_most(
            format!("{title}: computed over ideal"),
            done.recomputed as f64 / ideal,
            ALLOWANCE,
        ));
        figures.push(Figure::reported(
            format!("{title}: computed over changed"),
            done.recomputed as f64 / done.affected as f64,
        ));
        if k == 1 {
            let full_ms = full_ms(&scene, &clock);
            let limit = 1.5 * full_ms / f64::from(count) + 0.5;
            figures.push(Figure::reported(format!("{name}: full run, ms"), full_ms));
            figures.push(Figure::time_at_most(format!("{title}: ms"), ms, limit));
        } else {
            figures.push(Figure::reported(format!("{title}: ms"), ms));
        }
        if k == count {
            let name = format!("{title}: states that are not those of a full run");
            figures.push(Figure::at_most(name, wrong(&timeline, &scene), 0.0));
        }
    }
}

/// How long a full run takes that computes all bodies in every frame. Milliseconds.
fn full_ms((bodies, environment): &(Vec<BodyDef>, Environment), clock: &Clock) -> f64 {
    let began = clock.now();
    let run = forerun::timeline::check::full_run(bodies, [], *environment, FRAMES);
    debug_assert!(run.is_ok(), "the bodies are possible");
    1000.0 * (clock.now() - began).as_secs_f64()
}

/// Group A, four bodies, is pushed long before it meets group B, three bodies.
fn meeting(figures: &mut Vec<Figure>) {
    const EDIT: Frame = Frame(100);
    let scene = built_in("meeting");
    let before = computed(&scene, 480);
    let mut after = before.fork();
    edit(&mut after, [(EDIT, push(&before, BodyId(2), Vec3::Z * 0.01))]);
    let b = (5..8).filter_map(|body| first_difference(&before, &after, BodyId(body))).min();
    let from = |frame: Frame| (after.horizon().since(frame) + 1) as f64;
    let ideal = 4.0 * from(EDIT) + b.map_or(0.0, |meeting| 3.0 * from(meeting));
    figures.push(Figure::at_most(
        "meeting, pushed before: computed over ideal",
        recomputed(&after) / ideal,
        ALLOWANCE,
    ));
    figures.push(Figure::at_most(
        "meeting, pushed before: states that are not those of a full run",
        wrong(&after, &scene),
        0.0,
    ));
}

fn recomputed(timeline: &Timeline) -> f64 {
    timeline.stats().last_edit.recomputed as f64
}
