//! Orders and forks through the driver.

use forerun_timeline::check::mismatches;
use forerun_timeline::{Change, Command, CommandError, CommandKey, Progress};

use super::tests::{FRAME_S, LOOKAHEAD, eventually, filled, full, timeline};
use super::*;
use crate::{AdoptError, BodyDef, Shape, Sphere, Vec3};

fn push(body: u32, speed: f32) -> Change {
    let velocity = Vec3::X * speed;
    Change::SetVelocity { body: BodyId(body), velocity, angular_velocity: Vec3::ZERO }
}

/// Shows the same time until all that was ordered is computed.
fn settle(driver: &mut Decoupled, real_s: f64) {
    driver.request_fork().expect("room");
    assert!(eventually(|| driver.take_fork().is_some()), "orders are heard in turn, a fork after them");
    assert!(eventually(|| {
        driver.show(real_s).expect("physics lives");
        full(driver)
    }));
}

/// What the physics would know had it been told only these commands, from the start.
fn expected(commands: &[Command]) -> Timeline {
    let mut expected = timeline();
    expected.submit_all(commands.iter().cloned()).expect("plain commands");
    while expected.advance() != Progress::Idle {}
    expected
}

fn differences(driver: &mut Decoupled, commands: &[Command]) -> u64 {
    driver.request_fork().expect("room");
    let mut fork = None;
    assert!(eventually(|| {
        fork = driver.take_fork();
        fork.is_some()
    }));
    let fork = fork.expect("it was there");
    assert_eq!(fork.timeline().valid_to(), fork.timeline().horizon());
    mismatches(fork.timeline(), &expected(commands)).0
}

#[test]
fn commands_are_taken_back_replaced_undone_and_done_again() {
    let mut driver = filled();
    let first = driver.change(push(1, 2.0)).expect("room");
    let key = CommandKey { frame: Frame(5), source: 3, sequence: 0 };
    driver.submit(Command { key, change: push(2, -1.0) }).expect("room");
    let first_command = Command { key: first, change: push(1, 2.0) };
    let submitted = Command { key, change: push(2, -1.0) };
    settle(&mut driver, 0.0);
    assert_eq!(differences(&mut driver, &[first_command.clone(), submitted]), 0);
    let replaced = Command { key, change: push(2, 4.0) };
    driver.replace(key, push(2, 4.0)).expect("room");
    driver.undo().expect("room");
    settle(&mut driver, 0.0);
    // Others' orders are not the local user's to undo.
    assert_eq!(differences(&mut driver, std::slice::from_ref(&replaced)), 0);
    driver.redo().expect("room");
    driver.retract(key).expect("room");
    settle(&mut driver, 0.0);
    assert_eq!(differences(&mut driver, &[first_command]), 0);
    assert_eq!(driver.refusals(), []);
    driver.redo().expect("room");
    driver.retract(key).expect("room");
    settle(&mut driver, 0.0);
    let refused = [
        Refusal::Redo(CommandError::NothingToRedo),
        Refusal::Retract(key, CommandError::UnknownCommand(key)),
    ];
    assert_eq!(driver.refusals(), refused);
}

fn fork_of(driver: &mut Decoupled) -> Fork {
    driver.request_fork().expect("room");
    let mut fork = None;
    assert!(eventually(|| {
        fork = driver.take_fork();
        fork.is_some()
    }));
    fork.expect("it was there")
}

#[test]
fn a_fork_that_is_adopted_has_what_was_ordered_in_the_meantime() {
    let mut driver = filled();
    let before = driver.change(push(1, 1.0)).expect("room");
    settle(&mut driver, 0.0);
    let mut fork = fork_of(&mut driver);
    // In the fork one ball flies; meanwhile the user changes the other, takes the first back, and says and unsays something else.
    let tried = fork.change(Frame(4), push(1, 5.0)).expect("a plain change");
    driver.retract(before).expect("room");
    let meanwhile = driver.change(push(2, 3.0)).expect("room");
    driver.change(push(2, 9.0)).expect("room");
    driver.undo().expect("room");
    assert!(tried.sequence != meanwhile.sequence);
    while fork.timeline_mut().advance() != Progress::Idle {}
    driver.adopt(fork).expect("room");
    settle(&mut driver, 0.0);
    let commands =
        [Command { key: tried, change: push(1, 5.0) }, Command { key: meanwhile, change: push(2, 3.0) }];
    assert_eq!(differences(&mut driver, &commands), 0);
    assert_eq!(driver.refusals(), []);
    // And it goes on.
    let last = Frame(10 + u64::from(LOOKAHEAD));
    driver.show(10.0 * FRAME_S).expect("physics lives");
    assert!(eventually(|| driver.last_picture().snapshot.horizon() == last));
}

#[test]
fn a_fork_that_is_too_old_is_refused() {
    let mut driver = filled();
    let (first, second) = (fork_of(&mut driver), fork_of(&mut driver));
    driver.adopt(second).expect("room");
    driver.adopt(first).expect("room");
    settle(&mut driver, 0.0);
    assert_eq!(driver.refusals(), [Refusal::Adopt(AdoptError::TooOld)]);
    let behind = fork_of(&mut driver);
    for picture in 1..=2 {
        let displayed = u64::from(LOOKAHEAD) * picture;
        driver.show(displayed as f64 * FRAME_S).expect("physics lives");
        assert!(eventually(|| full(&driver)), "{displayed}");
    }
    let displayed = driver.last_picture().frame;
    driver.adopt(behind).expect("room");
    settle(&mut driver, 0.0);
    let horizon = Frame(u64::from(LOOKAHEAD));
    let refused = AdoptError::NotDisplayed { displayed, oldest: Frame(0), horizon };
    assert_eq!(driver.refusals(), [Refusal::Adopt(refused)]);
}

#[test]
fn bodies_added_beside_each_other_have_names_of_their_own() {
    let mut driver = filled();
    let mut fork = fork_of(&mut driver);
    let ball = |x: f32| BodyDef::new(Shape::Sphere(Sphere { radius: 0.1 })).at(Vec3::new(x, 3.0, 0.0));
    let there = fork.add(Frame(3), ball(-20.0)).expect("a plain ball");
    let here = driver.add(ball(-30.0)).expect("room");
    assert!(here != there);
    driver.adopt(fork).expect("room");
    settle(&mut driver, 0.0);
    assert_eq!(driver.refusals(), []);
    let snapshot = driver.last_picture().snapshot;
    assert!(snapshot.state(here, Frame(9)).is_some() && snapshot.state(there, Frame(9)).is_some());
}

#[test]
fn without_forks_nothing_is_remembered() {
    let mut plain = timeline();
    let mut heard = Heard::new(Names::after(&mut plain));
    let order = |sequence| {
        let key = CommandKey { frame: Frame(2), source: 0, sequence };
        crate::Order::Submit(Command { key, change: push(1, 1.0) })
    };
    heard.obey(&mut plain, order(0)).expect("a plain order");
    assert_eq!(heard.remembers(), 0);
    let fork = heard.fork(&plain);
    heard.obey(&mut plain, order(1)).expect("a plain order");
    assert_eq!(heard.remembers(), 1);
    drop(fork);
    heard.obey(&mut plain, order(2)).expect("a plain order");
    assert_eq!(heard.remembers(), 0);
}

#[test]
fn a_late_command_is_blended_in_and_a_local_one_changes_nothing_that_was_drawn() {
    let mut driver = filled();
    let mut samples = Vec::new();
    for picture in 0..=30 {
        let shown = driver.show(0.016 * f64::from(picture)).expect("physics lives");
        assert_eq!(driver.sample_all(&shown, &mut samples), Blending::default());
        assert!(eventually(|| full(&driver)));
    }
    let at = |samples: &[(BodyId, Sample)]| samples[2].1.pose.position;
    let drawn = at(&samples);
    driver.change(push(2, 3.0)).expect("room");
    settle(&mut driver, 0.48);
    let shown = driver.show(0.48).expect("physics lives");
    assert_eq!(driver.sample_all(&shown, &mut samples), Blending::default());
    assert_eq!(at(&samples), drawn, "a local change was seen at once");
    // Twenty frames ago it was given another velocity, somebody says now.
    let key = CommandKey { frame: Frame(shown.frame.0 - 20), source: 1, sequence: 0 };
    driver.submit(Command { key, change: push(2, -6.0) }).expect("room");
    settle(&mut driver, 0.48);
    let shown = driver.show(0.48).expect("physics lives");
    let blending = driver.sample_all(&shown, &mut samples);
    assert!(blending.bodies == 1 && blending.off_max_m > 1.0, "{blending:?}");
    assert!(at(&samples).distance(drawn) < 1e-4, "{} where {drawn} was drawn", at(&samples));
    assert_eq!(driver.offsets()[0].0, BodyId(2));
    // A second later it is where it is.
    let shown = driver.show(1.48).expect("physics lives");
    assert_eq!(driver.sample_all(&shown, &mut samples), Blending::default());
    assert_eq!(driver.offsets(), []);
}

#[test]
fn a_body_is_added_however_many_were_added_to_forks() {
    let mut plain = timeline();
    let names = Names::after(&mut plain);
    let mut heard = Heard::new(Arc::clone(&names));
    let mut fork = heard.fork(&plain);
    for _ in 0..70_000 {
        names.body();
    }
    let ball = |x: f32| BodyDef::new(Shape::Sphere(Sphere { radius: 0.1 })).at(Vec3::new(x, 3.0, 0.0));
    let add = |sequence, body, x| {
        let key = CommandKey { frame: Frame(2), source: 0, sequence };
        crate::Order::Submit(Command { key, change: Change::Add { body, def: Box::new(ball(x)) } })
    };
    // Also to a fork, and to one that is adopted after it was ordered elsewhere.
    fork.add(Frame(2), ball(-20.0)).expect("a plain ball");
    assert_eq!(heard.obey(&mut plain, add(100, names.body(), -30.0)), Ok(()));
    assert_eq!(
        heard.adopt(&mut plain, fork.clone(), Frame(0)).expect_err("it has no frames"),
        AdoptError::NotDisplayed { displayed: Frame(0), oldest: Frame(0), horizon: Frame(0) }
    );
    let mut adopted = fork;
    adopted.timeline_mut().advance();
    assert_eq!(heard.adopt(&mut plain, adopted, Frame(0)), Ok(Vec::new()));
    assert_eq!(plain.commands().count(), 2);
    // A name that nobody was given is not reserved for.
    let wild = BodyId(u32::MAX);
    let refused = Refusal::Submit(
        CommandKey { frame: Frame(2), source: 0, sequence: 101 },
        CommandError::UnknownBody(wild),
    );
    assert_eq!(heard.obey(&mut plain, add(101, wild, 0.0)), Err(refused));
    // One that somebody else gave is not given again.
    let other = BodyId(plain.names() as u32 + 5);
    assert_eq!(heard.obey(&mut plain, add(102, other, -40.0)), Ok(()));
    assert_eq!(names.body(), BodyId(other.0 + 1));
}

#[test]
fn a_change_after_a_command_with_a_number_of_its_own_has_another() {
    let mut driver = filled();
    let next = driver.last_picture().frame.next();
    let key = CommandKey { frame: next, source: 0, sequence: 0 };
    driver.submit(Command { key, change: push(1, 1.0) }).expect("room");
    assert_eq!(driver.change(push(2, 2.0)), Ok(CommandKey { sequence: 1, ..key }));
    // Others count for themselves.
    driver
        .submit(Command { key: CommandKey { source: 7, sequence: 900, ..key }, change: push(1, 3.0) })
        .expect("room");
    assert_eq!(driver.change(push(2, 4.0)), Ok(CommandKey { sequence: 2, ..key }));
    settle(&mut driver, 0.0);
    assert_eq!(driver.refusals(), []);
}
