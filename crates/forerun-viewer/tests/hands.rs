//! What mouse and keys do to a scene, checked by its states.

mod harness;

use forerun::{BodyId, Frame, Vec3};
use forerun_viewer::view::{Missile, Tool};
use harness::{BOXES, User};
use three_d::{Event, Key, Modifiers};

/// The box that stands alone.
const ALONE: u32 = 3;
/// The ball that hangs in the air.
const HANGING: u32 = 4;

/// Drags what is under a pixel by an offset, in twenty pictures, and lets go.
fn drag(user: &mut User, from: [f32; 2], offset: [f32; 2]) {
    let at = |part: f32| [from[0] + offset[0] * part, from[1] + offset[1] * part];
    let press = user.press(from);
    user.picture(vec![press]);
    for i in 1_u8..=20 {
        user.settle();
        let motion = user.motion(at(f32::from(i) / 20.0));
        user.picture(vec![motion]);
    }
    let release = user.release(at(1.0));
    user.picture(vec![release]);
}

#[test]
fn a_click_picks_another_adds_and_one_into_the_sky_picks_nothing() {
    let mut user = User::of(BOXES);
    let (alone, hanging) = (user.pixel(ALONE), user.pixel(HANGING));
    user.click(alone);
    assert_eq!(user.play().selection.bodies(), [BodyId(ALONE)]);
    user.modifiers.ctrl = true;
    user.click(hanging);
    assert_eq!(user.play().selection.bodies(), [BodyId(ALONE), BodyId(HANGING)]);
    user.click(hanging);
    assert_eq!(user.play().selection.bodies(), [BodyId(ALONE)]);
    user.modifiers.ctrl = false;
    // The ground has no end: a click on it is one beside everything.
    for nothing in [[10.0, 10.0], [1000.0, 700.0]] {
        user.click(alone);
        user.click(nothing);
        assert_eq!(user.play().selection.bodies(), []);
    }
    assert_eq!(user.report().play.expect("plays").undo, 0, "clicks are no commands");
}

#[test]
fn a_body_is_dragged_by_a_spring_and_one_undo_puts_all_back() {
    let mut user = User::of(BOXES);
    user.pictures(5);
    user.settle();
    let before = user.states_to(80);
    let from = user.pixel(HANGING);
    let start = user.pose_at(HANGING, 5).position;
    drag(&mut user, from, [-100.0, -80.0]);
    user.settle();
    // A hundred pixels to the left at this distance, and eighty up.
    let per_pixel = 2.0 * user.camera.half_height() * user.camera.distance / 720.0;
    let dragged = user.pose_at(HANGING, 28).position - start;
    let asked = Vec3::new(-100.0, 80.0, 0.0) * per_pixel;
    assert!((dragged - asked).dot(Vec3::X).abs() < 0.5 * asked.x.abs(), "{dragged} where {asked} was asked");
    assert!(dragged.y > 0.4 * asked.y, "{dragged} where {asked} was asked");
    assert_ne!(user.states_to(80), before);
    let report = user.report().play.expect("plays");
    assert_eq!((report.undo, report.undo_label.as_deref()), (1, Some("drag")));
    let held = user.play().picture.snapshot.body_at(BodyId(HANGING), Frame(40)).map(|body| body.spring);
    assert_eq!(held, Some(None), "it was let go");
    user.ctrl(Key::Z);
    user.settle();
    assert_eq!(user.states_to(80), before, "bit for bit");
    assert_eq!(user.report().play.expect("plays").redo, 1);
    user.ctrl(Key::Y);
    user.settle();
    assert_eq!(user.pose_at(HANGING, 28).position - start, dragged);
    assert_eq!(user.play().notice.last(), None);
}

#[test]
fn in_a_pause_a_body_is_put_where_the_mouse_is() {
    let mut user = User::of(BOXES);
    user.pictures(3);
    user.key(Key::Space, Modifiers::default());
    user.settle();
    let frame = user.play().picture.frame.0;
    let from = user.pixel(HANGING);
    drag(&mut user, from, [60.0, 0.0]);
    user.settle();
    let commands = user.play().to_undo().0.map(|step| step.commands.clone()).expect("a step");
    assert_eq!(commands.len(), 1, "one command, however often the mouse moved: {commands:?}");
    assert_eq!(user.play().picture.frame.0, frame + 1, "where it acts is what is shown");
    // What is drawn is led there within some pictures.
    user.pictures(15);
    let to = user.pixel(HANGING);
    assert!((to[0] - from[0] - 60.0).abs() < 2.0 && (to[1] - from[1]).abs() < 2.0, "{from:?} to {to:?}");
}

#[test]
fn shift_drags_along_the_ground() {
    let mut user = User::of(BOXES);
    user.key(Key::Space, Modifiers::default());
    let start = user.pose_at(ALONE, 0).position;
    let from = user.pixel(ALONE);
    let press = user.press(from);
    user.picture(vec![press]);
    user.modifiers.shift = true;
    let (motion, release) = (user.motion([from[0], from[1] + 40.0]), user.release([from[0], from[1] + 40.0]));
    user.picture(vec![motion, release]);
    user.settle();
    let moved = user.pose_at(ALONE, 1).position - start;
    assert!(moved.y.abs() < 1e-3 && moved.z > 0.3, "{moved}");
}

#[test]
fn escape_leaves_off_a_drag_as_if_it_had_not_begun() {
    let mut user = User::of(BOXES);
    user.pictures(2);
    user.settle();
    let before = user.states_to(80);
    let from = user.pixel(HANGING);
    let press = user.press(from);
    user.picture(vec![press]);
    for i in 1_u8..6 {
        let motion = user.motion([from[0] + 9.0 * f32::from(i), from[1]]);
        user.picture(vec![motion]);
    }
    assert_eq!(user.report().play.expect("plays").dragged, Some(HANGING));
    user.key(Key::Escape, Modifiers::default());
    let release = user.release(from);
    user.picture_now(vec![release]);
    user.settle();
    assert_eq!(user.states_to(80), before);
    assert_eq!(user.play().selection.bodies(), [BodyId(HANGING)], "the next one picks nothing");
    user.key(Key::Escape, Modifiers::default());
    assert_eq!(user.play().selection.bodies(), []);
}

#[test]
fn a_click_with_shift_picks_one_more_and_a_drag_with_shift_picks_nothing() {
    let mut user = User::of(BOXES);
    let (alone, hanging) = (user.pixel(ALONE), user.pixel(HANGING));
    user.click(hanging);
    user.modifiers.shift = true;
    drag(&mut user, alone, [40.0, 0.0]);
    assert_eq!(user.play().selection.bodies(), [BodyId(HANGING)]);
    assert_eq!(user.play().to_undo().1, 1, "it was dragged");
    let alone = user.pixel(ALONE);
    user.click(alone);
    assert_eq!(user.play().selection.bodies(), [BodyId(HANGING), BodyId(ALONE)]);
    user.click(alone);
    assert_eq!(user.play().selection.bodies(), [BodyId(HANGING)]);
    // What nothing drags is picked at once.
    let ground = user.press([1000.0, 700.0]);
    user.picture(vec![ground]);
    assert_eq!(user.play().selection.bodies(), [BodyId(HANGING), BodyId(0)]);
}

/// Presses on a body and drags it some pixels to the right, over six pictures.
fn begin_drag(user: &mut User, body: u32) {
    let from = user.pixel(body);
    let press = user.press(from);
    user.picture(vec![press]);
    for i in 1_u8..6 {
        user.settle();
        let motion = user.motion([from[0] + 9.0 * f32::from(i), from[1]]);
        user.picture(vec![motion]);
    }
    assert_eq!(user.hands.dragged(), Some(BodyId(body)));
}

/// The frames at which a spring holds a body.
fn held_at(user: &mut User, body: u32, to: u64) -> Vec<u64> {
    user.settle();
    let snapshot = user.play().picture.snapshot.clone();
    let held =
        |frame: &u64| snapshot.body_at(BodyId(body), Frame(*frame)).is_some_and(|body| body.spring.is_some());
    (0..=to).filter(held).collect()
}

#[test]
fn no_spring_is_left_where_time_goes_back_in_a_drag() {
    let mut user = User::of(BOXES);
    user.pictures(20);
    begin_drag(&mut user, HANGING);
    user.key(Key::Home, Modifiers::default());
    user.picture(Vec::new());
    assert_eq!(user.hands.dragged(), None, "it ends there");
    let held = held_at(&mut user, HANGING, 60);
    assert!(!held.is_empty() && held.iter().all(|frame| (20..30).contains(frame)), "{held:?}");
    // And with it the step.
    assert_eq!(user.play().to_undo().1, 1);
    user.ctrl(Key::Z);
    assert!(held_at(&mut user, HANGING, 60).is_empty());
}

#[test]
fn no_spring_is_left_on_a_body_that_is_gone_before_it_was_thrown() {
    let mut user = User::of(BOXES);
    user.pictures(10);
    user.key(Key::Insert, Modifiers::default());
    user.pictures(5);
    let added = user.play().added.expect("added").0;
    begin_drag(&mut user, added);
    user.key(Key::Home, Modifiers::default());
    user.pictures(1);
    assert!(user.play().sample(BodyId(added)).is_none() && user.hands.dragged().is_none());
    let held = held_at(&mut user, added, 60);
    assert!(!held.is_empty() && held.len() < 12, "{held:?}");
}

#[test]
fn what_is_in_hand_is_let_go_when_the_mouse_is_lost() {
    for by_focus in [false, true] {
        let mut user = User::of(BOXES);
        user.pictures(3);
        begin_drag(&mut user, HANGING);
        if by_focus {
            user.desk().lose_focus();
        } else {
            user.picture(vec![Event::MouseLeave]);
        }
        assert_eq!(user.hands.dragged(), None);
        let held = held_at(&mut user, HANGING, 60);
        assert!(held.len() < 8, "{held:?}");
        // The mouse comes back with its button down, or seems to: the picture stays as it is.
        let camera = user.camera;
        for x in [600.0, 700.0] {
            let motion = user.motion([x, 300.0]);
            user.picture(vec![motion]);
        }
        assert!((camera.yaw - user.camera.yaw).abs() < 1e-6);
        assert_eq!(user.play().to_undo().1, 1);
        // What is aimed is not thrown.
        user.take(Tool::Throw);
        let press = user.press([640.0, 360.0]);
        user.picture(vec![press]);
        user.picture(vec![Event::MouseLeave]);
        let release = user.release([640.0, 360.0]);
        user.picture(vec![release]);
        assert_eq!(user.play().added, None);
    }
}

#[test]
fn another_step_in_a_drag_ends_it_before() {
    let mut user = User::of(BOXES);
    user.pictures(3);
    begin_drag(&mut user, HANGING);
    user.play().selection.pick(BodyId(ALONE));
    user.key(Key::Delete, Modifiers::default());
    assert_eq!(user.hands.dragged(), None);
    let labels = |user: &mut User| user.play().to_undo().0.map(|step| step.label.clone());
    assert_eq!(labels(&mut user).as_deref(), Some("remove"));
    user.ctrl(Key::Z);
    assert_eq!(labels(&mut user).as_deref(), Some("drag"));
    assert!(held_at(&mut user, HANGING, 60).len() < 8);
}

#[test]
fn what_is_let_go_before_it_is_made_is_thrown_when_it_is() {
    let mut user = User::of(BOXES);
    user.take(Tool::Throw);
    user.view.grip.missile = Missile::Torus;
    user.click([640.0, 360.0]);
    user.wait("it is thrown", |user| {
        user.picture(Vec::new());
        user.play().added.is_some()
    });
    user.pictures(2);
    assert_eq!((user.play().samples.len(), user.play().to_undo().1), (6, 1));
    user.key(Key::Insert, Modifiers::default());
    user.pictures(2);
    assert_eq!(user.play().samples.len(), 7);
}

#[test]
fn what_is_thrown_flies_as_the_preview_said() {
    for missile in [Missile::Ball, Missile::Box, Missile::Torus, Missile::Selected] {
        let mut user = User::of(BOXES);
        user.pictures(2);
        user.settle();
        let before = user.states_to(80);
        user.play().selection.pick(BodyId(ALONE));
        user.take(Tool::Throw);
        user.view.grip.missile = missile;
        user.key(Key::Space, Modifiers::default());
        let at = user.pixel(1);
        let press = user.press(at);
        user.picture_now(vec![press]);
        user.wait("the preview is there", |user| {
            user.picture_now(Vec::new());
            user.play().is_preview_known()
        });
        let previewed = user.play().preview().expect("known").clone();
        assert!(user.report().play.expect("plays").aiming);
        assert!(!user.hands.extras.preview.is_empty() && user.hands.extras.held.is_some());
        let release = user.release(at);
        user.picture_now(vec![release]);
        user.settle();
        let thrown = user.play().added.expect("thrown");
        // The missile, and what it hit: bit for bit.
        assert!(previewed.trails.len() > 1, "{missile:?} hit nothing");
        for trail in &previewed.trails {
            for (i, pose) in trail.poses.iter().enumerate() {
                let frame = trail.from.plus(i as u64);
                assert_eq!(user.pose_at(trail.body.0, frame.0), *pose, "{missile:?} {trail:?} {frame}");
            }
        }
        let own = previewed.trails.iter().find(|trail| trail.body == thrown).expect("it was told of");
        assert_eq!(own.poses.len(), 91, "one and a half seconds");
        // It meets the box that was aimed at.
        let nearest = |trail: &forerun::Trail| {
            trail.poses.iter().map(|pose| pose.position.distance(Vec3::Y * 0.5)).fold(f32::INFINITY, f32::min)
        };
        assert!(nearest(own) < 1.6, "{missile:?}: {}", nearest(own));
        user.ctrl(Key::Z);
        user.settle();
        assert_eq!(user.states_to(80), before, "{missile:?}");
        assert_eq!(user.play().notice.last(), None);
    }
}

#[test]
fn escape_throws_nothing() {
    let mut user = User::of(BOXES);
    user.take(Tool::Throw);
    let press = user.press([640.0, 360.0]);
    user.picture(vec![press]);
    user.key(Key::Escape, Modifiers::default());
    let release = user.release([640.0, 360.0]);
    user.picture(vec![release]);
    user.settle();
    assert_eq!((user.play().samples.len(), user.play().added), (5, None));
}

#[test]
fn a_push_changes_the_velocity_by_what_it_says() {
    let mut user = User::of(BOXES);
    user.take(Tool::Push);
    user.view.grip.push = 2.0;
    let at = user.pixel(HANGING);
    user.click(at);
    user.settle();
    let velocity = user.play().picture.snapshot.state(BodyId(HANGING), Frame(1)).expect("there").velocity;
    assert!((velocity.length() - 2.0).abs() < 0.01, "{velocity}");
    assert!(velocity.dot(user.camera.forward()) > 1.9, "away from the eye: {velocity}");
    assert_eq!(user.report().play.expect("plays").undo_label.as_deref(), Some("push"));
}

#[test]
fn bodies_are_added_copied_selected_and_removed() {
    let mut user = User::of(BOXES);
    user.key(Key::Insert, Modifiers::default());
    user.pictures(2);
    let added = user.play().added.expect("added");
    assert_eq!(user.play().selection.bodies(), [added], "it is picked as soon as it is there");
    assert_eq!(user.play().samples.len(), 6);
    user.ctrl(Key::A);
    assert_eq!(user.play().selection.bodies().len(), 5);
    user.ctrl(Key::D);
    user.pictures(2);
    assert_eq!((user.play().samples.len(), user.play().selection.bodies().len()), (11, 5));
    user.key(Key::Delete, Modifiers::default());
    user.pictures(2);
    assert_eq!(user.play().samples.len(), 6);
    let report = user.report().play.expect("plays");
    assert_eq!((report.undo, report.undo_label.as_deref()), (3, Some("remove 5 bodies")));
    for bodies in [11, 6, 5] {
        user.ctrl(Key::Z);
        user.pictures(1);
        assert_eq!(user.play().samples.len(), bodies);
    }
    user.ctrl(Key::Z);
    for bodies in [6, 11, 6] {
        user.ctrl(Key::Y);
        user.pictures(1);
        assert_eq!(user.play().samples.len(), bodies);
    }
    assert_eq!(user.play().notice.last(), None);
}

#[test]
fn an_edit_in_the_past_changes_what_came_after_it_and_nothing_before() {
    let mut user = User::of(BOXES);
    user.pictures(60);
    user.key(Key::Space, Modifiers::default());
    user.settle();
    let before = user.states_to(90);
    let past_s = user.play().seconds_of(Frame(10));
    user.play().seek(past_s);
    user.settle();
    user.take(Tool::Push);
    let at = user.pixel(ALONE);
    user.click(at);
    user.settle();
    assert_eq!(user.play().to_undo().0.map(|step| step.commands[0].key.frame), Some(Frame(11)));
    let after = user.states_to(90);
    let differs = |frame: u64| {
        let at = |states: &[(u64, BodyId, forerun::BodyState)]| {
            states.iter().filter(|(of, ..)| *of == frame).copied().collect::<Vec<_>>()
        };
        at(&before) != at(&after)
    };
    assert!((0..=10).all(|frame| !differs(frame)));
    assert!((11..=90).all(differs));
    user.ctrl(Key::Z);
    user.settle();
    assert_eq!(user.states_to(90), before);
}
