//! A change reaches whom it meets, from the meeting on, and nobody else.
//!
//! Group A slides towards group B and meets it at frame 60; group Z is far away and moves all the time.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use forerun_dynamics::{BodyDef, BodyId, Material};
use forerun_geometry::Vec3;
use forerun_geometry::shape::{Shape, Sphere};
use forerun_timeline::{Advance, Change, Frame, Timeline};

use crate::lab::{
    assert_equals_full_run, cuboid, first_difference, ground, ideal, push, run, timeline, touching,
};

const SLED: BodyId = BodyId(1);
const CARGO: BodyId = BodyId(2);
const B: RangeInclusive<u32> = 3..=4;
const Z: RangeInclusive<u32> = 5..=8;
/// Frame of the edits.
const EDIT: Frame = Frame(20);

/// A sled without friction with a box on it, 4 m away from a stack, at 4 m/s; and far away a ball that bounces and dominoes that fall.
fn scene() -> Vec<BodyDef> {
    let mut bodies = vec![ground()];
    let velocity = Vec3::new(4.0, 0.0, 0.0);
    let mut sled = cuboid(0.4, 0.1, 0.3).at(Vec3::new(-4.4, 0.1, 0.0));
    (sled.material, sled.velocity) = (Material::new(0.0, 0.0), velocity);
    let mut cargo = cuboid(0.2, 0.2, 0.2).at(Vec3::new(-4.4, 0.4, 0.0));
    cargo.velocity = velocity;
    bodies.extend([sled, cargo]);
    for level in 0..2 {
        bodies.push(cuboid(0.3, 0.2, 0.3).at(Vec3::new(0.3, 0.2 + 0.4 * level as f32, 0.0)));
    }
    let mut ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.25 })).at(Vec3::new(0.0, 2.0, 30.0));
    ball.material.restitution = 1.0;
    bodies.push(ball);
    for i in 0..3 {
        bodies.push(cuboid(0.05, 0.25, 0.125).at(Vec3::new(1.0 + 0.2 * i as f32, 0.25, 30.0)));
    }
    bodies[6].angular_velocity = Vec3::new(0.0, 0.0, -4.0);
    bodies
}

/// The first frame at whose step a body of A touches one of B.
fn meeting(timeline: &Timeline) -> Option<Frame> {
    let is_a = |body: BodyId| body == SLED || body == CARGO;
    let meets = |(a, b): (BodyId, BodyId)| is_a(a) && B.contains(&b.0) || is_a(b) && B.contains(&a.0);
    (0..timeline.horizon().0).map(Frame).find(|frame| touching(timeline, *frame).into_iter().any(meets))
}

struct Edited {
    before: Timeline,
    after: Timeline,
    work: Vec<Advance>,
    /// By frame that a step leaves: who had to be advanced again.
    ideal: Vec<BTreeSet<BodyId>>,
}

/// Makes the changes to group A, and shows what all of them have in common.
fn edited(changes: &[Change]) -> Edited {
    let before = timeline(&scene(), 130);
    let mut after = before.fork();
    for change in changes {
        after.change(EDIT, change.clone()).unwrap();
    }
    let work = run(&mut after);
    assert_equals_full_run(&after, &scene());
    let commanded: Vec<_> = changes.iter().filter_map(|change| Some((EDIT, change.body()?))).collect();
    let ideal = ideal(&before, &after, &commanded);
    for body in Z.map(BodyId) {
        assert_eq!(first_difference(&before, &after, body), None, "Z: no bit changes");
        assert!(ideal.iter().all(|needed| !needed.contains(&body)));
    }
    // Exactly those that need it are advanced again, so none of Z.
    for done in &work {
        assert_eq!(done.recomputed as usize, ideal[done.frame.0 as usize - 1].len(), "to {}", done.frame);
    }
    Edited { before, after, work, ideal }
}

impl Edited {
    /// B is not touched before the first of the two meetings, and is advanced again from there on only.
    fn assert_b_is_left_alone_until(&self, meeting: Frame) {
        for body in B.map(BodyId) {
            let first =
                first_difference(&self.before, &self.after, body).expect("the meeting is another one");
            assert!(first > meeting, "B differs at {first}, they meet at {meeting}");
        }
        let advanced = |needed: &BTreeSet<BodyId>| needed.iter().any(|body| B.contains(&body.0));
        let first = self.ideal.iter().position(advanced).expect("B is met") as u64;
        assert_eq!(first, meeting.0, "B is advanced again from the meeting on");
        let until = self.work.iter().filter(|done| done.frame <= meeting);
        assert!(until.clone().count() > 10 && until.clone().all(|done| done.recomputed <= 2));
    }
}

#[test]
fn they_meet_at_frame_60() {
    let meeting = meeting(&timeline(&scene(), 130)).unwrap();
    assert!((55..=60).contains(&meeting.0), "{meeting}");
}

#[test]
fn a_small_push_reaches_b_with_the_meeting() {
    let mass = 1.0 / timeline(&scene(), 1).body_at(CARGO, Frame(0)).unwrap().inverse_mass;
    let edited = edited(&[push(CARGO, Vec3::new(0.0, 0.0, 0.05 * mass))]);
    let meetings = [&edited.before, &edited.after].map(|t| meeting(t).unwrap());
    edited.assert_b_is_left_alone_until(meetings[0].min(meetings[1]));
}

#[test]
fn when_they_never_meet_b_gets_a_future_of_its_own() {
    let edited = edited(&[Change::Remove { body: SLED }]);
    assert_eq!(meeting(&edited.after), None);
    edited.assert_b_is_left_alone_until(meeting(&edited.before).unwrap());
    // The stack stands as it stood, where it had been knocked about.
    for body in B.map(BodyId) {
        let at = |t: &Timeline, frame: u64| t.state(body, Frame(frame)).unwrap().position;
        assert_eq!(at(&edited.after, 130), at(&edited.before, 50));
    }
    let bottom = |t: &Timeline| t.state(BodyId(3), Frame(130)).unwrap().position.x;
    assert!(bottom(&edited.before) > bottom(&edited.after) + 0.05, "{}", bottom(&edited.before));
}

#[test]
fn when_they_meet_earlier_b_changes_from_there() {
    let faster = |body: BodyId| Change::SetVelocity {
        body,
        velocity: Vec3::new(6.0, 0.0, 0.0),
        angular_velocity: Vec3::ZERO,
    };
    let edited = edited(&[faster(SLED), faster(CARGO)]);
    let (old, new) = (meeting(&edited.before).unwrap(), meeting(&edited.after).unwrap());
    assert!(new.0 + 10 < old.0, "{new} {old}");
    edited.assert_b_is_left_alone_until(new);
}
