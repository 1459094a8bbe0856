//! Causality: in the scene `meeting`, an edit to group A reaches group B when they meet, and group Z never.

use std::ops::Range;

use forerun::timeline::{Change, Frame, Timeline};
use forerun::{BodyId, Vec3};

use crate::validate::Figure;
use crate::validate::lab::built_in;
use crate::validate::timelines::{computed, edit, first_difference, push, wrong};

const FRAMES: u32 = 480;
const EDIT: Frame = Frame(100);
/// The groups, in the order of the scene's bodies; 0 is the ground.
const A: Range<u32> = 1..5;
const B: Range<u32> = 5..8;
const Z: Range<u32> = 8..17;

pub(crate) fn run() -> Vec<Figure> {
    let scene = built_in("meeting");
    let before = computed(&scene, FRAMES);
    let mut figures = vec![Figure::near("they meet at frame", met(&before) as f64, 300.0, 5.0)];
    let faster = |body: u32| Change::SetVelocity {
        body: BodyId(body),
        velocity: Vec3::X * (8.0 / 3.0),
        angular_velocity: Vec3::ZERO,
    };
    let cases = [
        ("pushed a little", vec![push(&before, BodyId(2), Vec3::Z * 0.01)]),
        ("never meet", vec![Change::Remove { body: BodyId(1) }]),
        ("meet earlier", A.map(faster).collect()),
    ];
    for (what, changes) in cases {
        let mut after = before.fork();
        let work = edit(&mut after, changes.into_iter().map(|change| (EDIT, change)));
        let changed = |group: Range<u32>| {
            group
                .filter_map(|body| first_difference(&before, &after, BodyId(body)))
                .min()
                .map(|frame| frame.0)
        };
        let meeting = met(&before).min(met(&after));
        let (groups_a, groups_ab) = (A.len() as u32, A.len() as u32 + B.len() as u32);
        // One state more than A's may be due to the removed body.
        let too_early =
            work.iter().filter(|done| done.frame.0 < meeting && done.recomputed > groups_a).count();
        let too_many = work.iter().filter(|done| done.recomputed > groups_ab).count();
        let z = Z.filter(|body| first_difference(&before, &after, BodyId(*body)).is_some()).count();
        let b_early = changed(B).map_or(0, |frame| meeting.saturating_sub(frame));
        figures.extend([
            Figure::at_most(format!("{what}: bodies of Z that change"), z as f64, 0.0),
            Figure::at_most(
                format!("{what}: frames in which more than A and B are computed"),
                too_many as f64,
                0.0,
            ),
            Figure::at_most(
                format!("{what}: frames before the meeting in which more than A is computed"),
                too_early as f64,
                0.0,
            ),
            Figure::at_most(
                format!("{what}: frames before the meeting in which B changes"),
                b_early as f64,
                0.0,
            ),
            Figure::at_most(
                format!("{what}: states that are not those of a full run"),
                wrong(&after, &scene),
                0.0,
            ),
        ]);
        if what == "never meet" {
            figures.push(Figure::at_most("never meet: motion of B, m", f64::from(motion(&after)), 0.0));
        }
    }
    figures
}

/// The frame at which B is first moved, the last one where it never is.
fn met(timeline: &Timeline) -> u64 {
    let quiet = |frame: u64| {
        let speed =
            |body: u32| timeline.state(BodyId(body), Frame(frame)).map_or(0.0, |s| s.velocity.length());
        B.map(speed).fold(0.0, f32::max) < 0.01
    };
    (EDIT.0..timeline.horizon().0).find(|frame| !quiet(*frame)).unwrap_or(timeline.horizon().0)
}

/// How far B is from where it stood before anything met it. Metres.
fn motion(timeline: &Timeline) -> f32 {
    let at = |body: u32, frame: Frame| timeline.state(BodyId(body), frame).map_or(Vec3::ZERO, |s| s.position);
    B.map(|body| at(body, timeline.horizon()).distance(at(body, EDIT))).fold(0.0, f32::max)
}
