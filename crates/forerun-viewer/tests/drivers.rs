//! The switch between the drivers, values that are edited in a panel, and what a second scene does to the first.

mod harness;

use forerun::{BodyId, Change, Frame, Pose, Vec3};
use forerun_viewer::SceneSource;
use forerun_viewer::series::Series;
use forerun_viewer::view::Tool;
use harness::{BOXES, User};
use three_d::{Key, Modifiers};

const ALONE: BodyId = BodyId(3);
const HANGING: BodyId = BodyId(4);

fn positions(user: &mut User) -> Vec<(BodyId, Vec3)> {
    user.play().samples.iter().map(|(id, sample)| (*id, sample.pose.position)).collect()
}

#[test]
fn the_scene_goes_on_under_the_traditional_driver_and_back() {
    let mut user = User::of(BOXES);
    user.take(Tool::Push);
    let at = user.pixel(HANGING.0);
    user.click(at);
    user.pictures(10);
    let (before, time_s) = (positions(&mut user), user.play().picture.time_s);
    user.key(Key::K, Modifiers::default());
    let play = user.play();
    assert!(play.is_coupled());
    assert!((play.picture.time_s - time_s).abs() < 1e-9, "{} s from {time_s} s", play.picture.time_s);
    assert_eq!(play.to_undo().1, 0, "the commands stayed behind");
    for ((id, now), (_, then)) in positions(&mut user).iter().zip(&before) {
        assert!(now.distance(*then) < 1e-4, "{id:?} jumped by {} m", now.distance(*then));
    }
    // Commands go to it: a throw, and something is removed.
    user.take(Tool::Throw);
    let press = user.press([640.0, 360.0]);
    let release = user.release([640.0, 360.0]);
    user.picture(vec![press, release]);
    user.picture(Vec::new());
    user.play().selection.pick(ALONE);
    user.key(Key::Delete, Modifiers::default());
    user.wait("some steps", |user| {
        user.picture(Vec::new());
        user.play().picture.time_s > time_s + 0.1
    });
    assert_eq!(user.play().samples.len(), 5, "one more, one less");
    assert!(user.play().sample(ALONE).is_none());
    assert!(user.play().notice.last().is_some_and(|notice| notice.contains("cannot be undone any more")));
    // It flies on at the speed that it had.
    let flown = user.play().sample(HANGING).expect("there").pose.position - before[4].1;
    let seconds = (user.play().picture.time_s - time_s) as f32;
    assert!((flown.length() - 3.0 * seconds).abs() < 0.05, "{flown} in {seconds} s");
    let (before, time_s) = (positions(&mut user), user.play().picture.time_s);
    user.key(Key::K, Modifiers::default());
    assert!(!user.play().is_coupled());
    user.settle();
    for ((id, now), (_, then)) in positions(&mut user).iter().zip(&before) {
        assert!(now.distance(*then) < 0.2, "{id:?} jumped by {} m", now.distance(*then));
    }
    let now_s = user.play().picture.time_s;
    assert!((now_s - time_s).abs() < 0.02, "{now_s} s from {time_s} s");
    // And there is a future again, which commands change.
    let click = user.pixel(HANGING.0);
    user.take(Tool::Push);
    user.click(click);
    assert_eq!(user.play().to_undo().1, 1);
    user.pictures(3);
}

#[test]
fn a_switch_that_takes_nothing_away_says_nothing() {
    let mut user = User::of(BOXES);
    for _ in 0..2 {
        user.key(Key::K, Modifiers::default());
        user.picture(Vec::new());
    }
    assert!(!user.play().is_coupled());
    assert_eq!(user.play().notice.last(), None);
}

#[test]
fn a_picture_that_was_put_off_on_purpose_has_no_interval() {
    let mut user = User::of(BOXES);
    let mut series = Series::default();
    let mut intervals = Vec::new();
    for picture in 0..6 {
        user.picture(Vec::new());
        if picture == 3 {
            user.real_s += 0.1;
            series.leave_out_interval();
        }
        let (opened, real_s) = (user.session.opened, user.real_s);
        series.take(user.play(), opened, real_s);
        intervals.push(series.pictures.last().expect("just taken").row.interval_ms.round() as u32);
    }
    assert_eq!(intervals, [0, 17, 17, 0, 17, 17]);
}

#[test]
fn a_pause_holds_the_traditional_driver_too() {
    let mut user = User::of(BOXES);
    user.key(Key::Space, Modifiers::default());
    user.key(Key::K, Modifiers::default());
    let time_s = user.play().picture.time_s;
    for _ in 0..5 {
        user.picture(Vec::new());
    }
    assert!((user.play().picture.time_s - time_s).abs() < 1e-12);
    user.key(Key::Space, Modifiers::default());
    user.wait("it goes on", |user| {
        user.picture(Vec::new());
        user.play().picture.time_s > time_s
    });
}

#[test]
fn a_value_that_is_dragged_is_one_command_and_one_step() {
    let mut user = User::of(BOXES);
    user.pictures(4);
    user.settle();
    let before = user.states_to(60);
    for i in 0_u8..30 {
        let velocity = Vec3::X * f32::from(i);
        let change = Change::SetVelocity { body: HANGING, velocity, angular_velocity: Vec3::ZERO };
        user.play().edit(change);
        user.picture(Vec::new());
    }
    user.play().end_edit();
    user.settle();
    let step = user.play().to_undo().0.cloned().expect("a step");
    assert_eq!((step.label.as_str(), step.commands.len()), ("set velocity", 1));
    let key = step.commands[0].key;
    let velocity = user.play().picture.snapshot.state(HANGING, key.frame).expect("there").velocity;
    assert_eq!(velocity, Vec3::X * 29.0, "it acts where the drag began");
    // Another value is another step.
    user.play().edit(Change::SetGravityScale { body: ALONE, scale: -1.0 });
    user.play().edit(Change::SetGravity { gravity: Vec3::X });
    user.play().end_edit();
    assert_eq!(user.play().to_undo().1, 3);
    for _ in 0..3 {
        user.ctrl(Key::Z);
    }
    user.settle();
    assert_eq!(user.states_to(60), before);
    assert_eq!(user.play().notice.last(), None);
}

#[test]
fn a_body_gets_another_mass_and_stays_the_one_that_it_is() {
    let mut user = User::of(BOXES);
    user.key(Key::Space, Modifiers::default());
    user.settle();
    let before = user.states_to(60);
    user.play().selection.pick(ALONE);
    for mass in [100.0, 250.0, 500.0] {
        user.play().edit(Change::SetMass { body: ALONE, mass });
        user.settle();
    }
    user.play().end_edit();
    assert_eq!(user.play().selection.active(), Some(ALONE));
    let body = user.play().body(ALONE).expect("there").clone();
    assert!((body.inverse_mass * 500.0 - 1.0).abs() < 1e-5);
    // A cube of 1 m: m/6.
    assert!((body.inverse_inertia * 500.0 / 6.0 - Vec3::ONE).length() < 1e-4, "{}", body.inverse_inertia);
    assert_eq!(user.play().to_undo().1, 1);
    user.ctrl(Key::Z);
    user.settle();
    assert_eq!(user.states_to(60), before);
    // The ground has none.
    user.play().change(Change::SetMass { body: BodyId(0), mass: 5.0 });
    user.settle();
    assert_eq!(user.play().to_undo().1, 0);
    assert!(
        user.play().notice.last().is_some_and(|notice| notice.contains("volume")),
        "{:?}",
        user.play().notice
    );
    // Under the traditional driver too, and back.
    user.key(Key::K, Modifiers::default());
    user.play().change(Change::SetMass { body: ALONE, mass: 20.0 });
    user.picture(Vec::new());
    user.key(Key::K, Modifiers::default());
    user.settle();
    let body = user.play().body(ALONE).expect("there").clone();
    assert!((body.inverse_mass * 20.0 - 1.0).abs() < 1e-5, "{}", body.inverse_mass);
}

#[test]
fn in_a_pause_an_edit_is_shown_where_it_acts() {
    let mut user = User::of(BOXES);
    user.key(Key::Space, Modifiers::default());
    let pose = Pose { position: Vec3::new(5.0, 3.0, 0.0), ..Pose::IDENTITY };
    user.play().change(Change::Move { body: HANGING, pose });
    user.settle();
    assert_eq!(user.play().picture.frame, Frame(1));
    assert_eq!(user.pose_at(HANGING.0, 1), pose);
}

#[test]
fn what_is_refused_is_no_step_and_is_said() {
    let mut user = User::of(BOXES);
    user.play().change(Change::SetGravityScale { body: ALONE, scale: f32::NAN });
    user.settle();
    assert_eq!(user.play().to_undo().1, 0);
    assert!(user.play().notice.last().is_some_and(|notice| notice.contains("scale")));
}

#[test]
fn another_scene_starts_anew() {
    let mut user = User::of(BOXES);
    user.click([640.0, 360.0]);
    user.session.slow_down_s = 1.0;
    user.picture(Vec::new());
    // Nobody waits for the step that physics is in.
    let clock = forerun::Clock::system();
    user.session.open(SceneSource::BuiltIn("pyramid:3".to_owned()));
    assert!(clock.now().as_secs_f64() < 0.5);
    user.session.slow_down_s = 0.0;
    // The one before plays until it is there.
    assert!(user.session.play().is_some() && user.session.opened == 1);
    user.wait("it starts", |user| {
        user.picture(Vec::new());
        user.session.opened == 2
    });
    user.settle();
    assert_eq!(user.play().to_undo().1, 0);
    assert!(user.play().selection.bodies().is_empty());
}

#[test]
fn a_rewind_ends_at_the_oldest_frame_and_stands_still() {
    let mut user = User::of(BOXES);
    user.pictures(30);
    user.play().set_rewinding(true);
    user.wait("it comes to the start", |user| {
        user.picture(Vec::new());
        !user.play().rewinding
    });
    assert!(user.play().paused && user.play().picture.time_s < 1e-6);
    user.play().set_paused(false);
    user.pictures(10);
    assert!(user.play().picture.time_s > 0.0);
}

#[test]
fn what_an_impossible_value_did_not_replace_can_be_undone() {
    let mut user = User::of(BOXES);
    user.play().set_paused(true);
    user.settle();
    for scale in [2.0, f32::NAN] {
        user.play().edit(Change::SetGravityScale { body: ALONE, scale });
        user.settle();
    }
    user.play().end_edit();
    assert!(user.play().notice.last().is_some_and(|notice| notice.contains("scale")));
    assert_eq!(user.play().to_undo().1, 1);
    user.play().undo();
    user.settle();
    assert!((user.play().body(ALONE).expect("it is there").gravity_scale - 1.0).abs() < 1e-6);
}
