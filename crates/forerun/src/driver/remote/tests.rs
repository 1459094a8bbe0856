//! A display and a physics that share no memory: the same pictures, and no harm from messages that are spoiled.

use forerun_timeline::check::Random;
use forerun_timeline::{Change, CommandError, Preview, Progress};

use super::*;
use crate::driver::decoupled::Decoupled;
use crate::driver::decoupled::tests::{LOOKAHEAD, timeline};
use crate::driver::driver_error::DriverError;
use crate::driver::inquiry::{Answer, InquiryError, Question, Ticket};
use crate::driver::refusal::Refusal;
use crate::{BodyDef, BodyId, Cuboid, Frame, Order, Pose, Sample, Shape, Sphere, Timeline, Vec3};

const FRAME_S: f64 = (1.0_f32 / 60.0) as f64;

/// A display and a physics that could be on two machines.
struct Pair {
    display: Decoupled,
    courier: Courier,
    physics: RemotePhysics,
}

impl Pair {
    fn of(timeline: Timeline) -> Pair {
        let mut physics = RemotePhysics::new(timeline, RemoteSettings::default()).expect("plain settings");
        let first = physics.publish().expect("the first report");
        let (display, courier) = Decoupled::remote(&first).expect("it was made for this");
        Pair { display, courier, physics }
    }

    /// Letters go there, a few frames are computed, and what is new comes back.
    fn exchange(&mut self, frames: usize) {
        for letter in self.courier.outgoing() {
            self.physics.receive(&letter).expect("it was written here");
        }
        for _ in 0..frames {
            let _: Progress = self.physics.turn();
        }
        if let Some(report) = self.physics.publish() {
            self.courier.receive(&report).expect("it was written here");
        }
    }

    fn settle(&mut self) {
        self.exchange(0);
        while self.physics.turn() != Progress::Idle {}
        self.exchange(1);
        self.exchange(0);
    }

    fn samples(&self, seconds: f64) -> Vec<(BodyId, Sample)> {
        let mut samples = Vec::new();
        self.display.last_picture().snapshot.sample_all(seconds, &mut samples);
        samples
    }
}

#[test]
fn pictures_are_those_of_the_timeline_whatever_is_ordered() {
    let mut pair = Pair::of(timeline());
    let mut local = timeline();
    let mut random = Random::new(5);
    let hull = Shape::hull(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]).expect("four points");
    for picture in 0..120_u64 {
        let shown = pair.display.show(picture as f64 * 0.5 * FRAME_S).expect("physics lives");
        let next = shown.frame.next();
        local.set_display(shown.frame);
        let body = BodyId(1 + random.below(2) as u32);
        let change = match random.below(12) {
            0 => Change::Push { body, impulse: random.vector() * 300.0, at_point: None },
            1 => Change::SetMaterial { body, material: crate::Material::new(0.2, 0.5) },
            2 => Change::SetGravity { gravity: Vec3::new(0.0, -9.81, random.signed()) },
            3 => {
                let def = BodyDef::new(hull.clone()).at(random.vector() * 4.0 + Vec3::Y * 5.0);
                let body = pair.display.reserve_body();
                assert_eq!(local.reserve_body(), body);
                Change::Add { body, def: Box::new(def) }
            }
            4 => {
                assert_eq!(pair.display.undo(), Ok(()));
                let _ = local.undo();
                continue;
            }
            _ => {
                pair.exchange(random.below(3) as usize);
                continue;
            }
        };
        let key = pair.display.change(change.clone()).expect("the queue has room");
        assert_eq!(key.frame, next);
        local.obey(Order::Submit(crate::Command { key, change })).expect("a plain change");
    }
    // Every picture lets the physics go further ahead again.
    for _ in 0..20 {
        pair.display.show(60.0 * FRAME_S).expect("physics lives");
        pair.settle();
    }
    local.set_display(pair.display.last_picture().frame);
    while local.advance() != Progress::Idle {}
    let (mirror, own) = (pair.display.last_picture().snapshot, local.snapshot());
    assert_eq!((mirror.horizon(), mirror.valid_to()), (own.horizon(), own.valid_to()));
    let mut samples = Vec::new();
    for half in 2 * own.oldest().0..2 * own.horizon().0 {
        let seconds = half as f64 * 0.5 * FRAME_S;
        own.sample_all(seconds, &mut samples);
        assert_eq!(pair.samples(seconds), samples, "{seconds}");
    }
    assert!(samples.len() > 3, "bodies were added");
    assert_eq!(pair.physics.timeline().stats().state_bytes, pair.display.last_picture().stats.state_bytes);
}

#[test]
fn physics_runs_ahead_of_what_is_shown_and_says_when_it_is_done() {
    let mut pair = Pair::of(timeline());
    pair.display.show(0.0).expect("physics lives");
    pair.settle();
    assert_eq!(pair.display.last_picture().snapshot.horizon(), Frame(u64::from(LOOKAHEAD)));
    let shared = &pair.physics.timeline().settings();
    assert_eq!(shared.lookahead, LOOKAHEAD);
    // All is done: display time goes on at full rate to the end of what there is.
    let picture = pair.display.show(FRAME_S * 7.0).expect("physics lives");
    assert!(picture.rate > 0.999 && picture.frame == Frame(7), "{picture:?}");
    assert!(picture.note.is_some(), "notes come along");
    pair.settle();
    assert_eq!(pair.display.last_picture().snapshot.horizon(), Frame(7 + u64::from(LOOKAHEAD)));
    assert!(pair.physics.publish().is_none(), "there is nothing new");
    assert!(pair.courier.outgoing().is_empty() || pair.courier.outgoing().is_empty());
}

#[test]
fn a_physics_that_does_not_listen_gets_it_all_in_a_bounded_number_of_letters() {
    let mut pair = Pair::of(timeline());
    let mut letters = Vec::new();
    for picture in 0..500_u32 {
        pair.display.show(f64::from(picture) * 0.001).expect("physics lives");
        if picture % 50 == 0 {
            let change = Change::Push { body: BodyId(1), impulse: Vec3::X, at_point: None };
            pair.display.change(change).expect("the queue has room");
        }
        letters.extend(pair.courier.outgoing());
    }
    // One of them said that the first report was taken.
    assert_eq!(letters.len() as u64, LETTERS_MAX);
    for letter in &letters {
        pair.physics.receive(letter).expect("it was written here");
    }
    pair.settle();
    pair.settle();
    let commands = |snapshot: &forerun_timeline::Snapshot| snapshot.commands().count();
    assert_eq!(commands(&pair.physics.timeline().snapshot()), 10);
    assert_eq!(commands(&pair.display.last_picture().snapshot), 10);
    // Where nothing is new but that, the display hears that its letters were taken: neither side ever waits for the other.
    for picture in 500..2000_u32 {
        pair.display.show(f64::from(picture) * 1e-9).expect("physics lives");
        pair.exchange(1);
        assert!(pair.courier.letters - pair.courier.heard < LETTERS_MAX, "{picture}");
    }
}

#[test]
fn long_reports_wait_for_each_other_and_too_long_a_message_is_not_read() {
    let mut pair = Pair::of(timeline());
    pair.display.show(0.0).expect("physics lives");
    for _ in 0..2 {
        let _: Progress = pair.physics.turn();
        assert!(pair.physics.publish().is_some());
    }
    *pair.physics.waiting.back_mut().expect("nobody took it") = WAITING_BYTES_MAX;
    let _: Progress = pair.physics.turn();
    assert!(pair.physics.publish().is_none());
    let long = vec![0; MESSAGE_BYTES_MAX + 1];
    assert!(
        matches!(pair.physics.receive(&long), Err(RemoteError::Damaged(what)) if what.contains("longer"))
    );
}

#[test]
fn a_display_that_does_not_listen_gets_it_all_in_a_few_reports() {
    let mut pair = Pair::of(timeline());
    let mut reports = Vec::new();
    for _ in 0..LOOKAHEAD {
        let _: Progress = pair.physics.turn();
        reports.extend(pair.physics.publish());
    }
    assert_eq!(reports.len() as u64, REPORTS_MAX - 1, "the first is not acknowledged either");
    for report in reports {
        pair.courier.receive(&report).expect("it was written here");
    }
    assert_eq!(pair.display.last_picture().snapshot.horizon(), Frame(REPORTS_MAX - 1));
    pair.exchange(0);
    assert_eq!(pair.display.last_picture().snapshot.horizon(), Frame(u64::from(LOOKAHEAD)));
}

#[test]
fn what_is_refused_comes_back_and_an_edit_says_how_far_it_threw_back() {
    let mut pair = Pair::of(timeline());
    pair.display.show(0.0).expect("physics lives");
    pair.settle();
    pair.display.change(Change::Push { body: BodyId(1), impulse: Vec3::X, at_point: None }).expect("room");
    let key = pair.display.change(Change::Release { body: BodyId(77) }).expect("the queue has room");
    let nan = Pose { position: Vec3::NAN, ..Pose::IDENTITY };
    let moved = pair.display.change(Change::Move { body: BodyId(1), pose: nan }).expect("room");
    pair.exchange(1);
    let refusals = pair.display.refusals();
    assert_eq!(refusals[0], Refusal::Submit(key, CommandError::UnknownBody(BodyId(77))));
    assert_eq!(refusals[1].key(), Some(moved));
    assert_eq!(pair.display.show(0.0).expect("physics lives").dropped_to, Some(Frame(0)));
    assert!(matches!(pair.display.request_fork(), Err(DriverError::Elsewhere)));
}

#[test]
fn a_body_is_added_before_the_physics_knows_its_name() {
    let mut pair = Pair::of(timeline());
    pair.display.show(0.0).expect("physics lives");
    let names: Vec<BodyId> = (0..3).map(|_| pair.display.reserve_body()).collect();
    let ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.3 })).at(Vec3::Y * 3.0);
    let added = pair.display.add(ball).expect("the queue has room");
    assert!(names.iter().all(|name| *name < added));
    pair.settle();
    assert_eq!(pair.display.refusals(), []);
    assert!(pair.samples(FRAME_S * 3.0).iter().any(|(body, _)| *body == added));
}

#[test]
fn a_message_that_is_lost_doubled_or_damaged_is_an_error_and_changes_nothing() {
    let mut pair = Pair::of(timeline());
    pair.display.show(0.0).expect("physics lives");
    let mut letters = pair.courier.outgoing();
    pair.display.show(0.01).expect("physics lives");
    letters.extend(pair.courier.outgoing());
    let due = |result: Result<(), RemoteError>| match result {
        Err(RemoteError::OutOfTurn { due, number }) => (due, number),
        other => panic!("{other:?}"),
    };
    assert_eq!(due(pair.physics.receive(&letters[1])), (1, 2));
    pair.physics.receive(&letters[0]).expect("it is due");
    assert_eq!(due(pair.physics.receive(&letters[0])), (2, 1));
    pair.physics.turn();
    let first = pair.physics.publish().expect("a frame is new");
    pair.physics.turn();
    let second = pair.physics.publish().expect("a frame is new");
    assert_eq!(due(pair.courier.receive(&second)), (2, 3));
    let before = pair.display.last_picture().snapshot;
    for index in 0..first.len() {
        let mut damaged = first.clone();
        damaged[index] ^= 0x10;
        assert!(matches!(pair.courier.receive(&damaged), Err(RemoteError::Damaged(_))), "byte {index}");
        assert!(pair.courier.receive(&first[..index]).is_err(), "{index} bytes");
    }
    assert!(std::sync::Arc::ptr_eq(&before, &pair.display.last_picture().snapshot));
    pair.courier.receive(&first).expect("it is due");
    pair.courier.receive(&second).expect("it is due");
    assert!(Decoupled::remote(&second).is_err(), "it is not the first");
}

/// Who writes the checksum too gets further; not to a panic.
#[test]
fn whatever_the_bytes_say_nothing_panics() {
    let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
    let mut random = Random::new(11);
    for round in 0..300 {
        let mut pair = Pair::of(timeline());
        pair.display.show(0.0).expect("physics lives");
        pair.display.add(BodyDef::new(cube.clone()).at(Vec3::Y * 9.0)).expect("room");
        let mut letter = pair.courier.outgoing().remove(0);
        spoil(&mut letter, &mut random);
        let _ = pair.physics.receive(&letter);
        for _ in 0..3 {
            pair.physics.turn();
        }
        let mut report = pair.physics.publish().expect("frames are new");
        spoil(&mut report, &mut random);
        let _ = pair.courier.receive(&report);
        let picture = pair.display.show(0.02).expect("physics lives");
        let mut samples = Vec::new();
        pair.display.sample_all(&picture, &mut samples);
        assert!(samples.iter().all(|(_, sample)| sample.pose.position.is_finite()), "round {round}");
    }
}

fn spoil(message: &mut [u8], random: &mut Random) {
    let content = message.len() - 4;
    for _ in 0..=random.below(3) {
        message[4 + random.below(content as u64 - 4) as usize] = random.bits() as u8;
    }
    let sum = crc32fast::hash(&message[..content]).to_le_bytes();
    message[content..].copy_from_slice(&sum);
}

#[test]
fn a_physics_that_ended_is_an_error_and_what_it_said_can_still_be_shown() {
    let mut pair = Pair::of(timeline());
    pair.display.show(0.0).expect("physics lives");
    pair.courier.fail("the worker ended");
    assert_eq!(pair.display.show(0.1).err(), Some(DriverError::Panicked("the worker ended".to_owned())));
    assert!(pair.display.undo().is_err());
    assert_eq!(pair.display.last_picture().frame, Frame(0));
    let Pair { display, courier, .. } = Pair::of(timeline());
    drop(courier);
    assert!(display.undo().is_err(), "nobody carries it");
}

#[test]
fn questions_are_answered_from_afar() {
    let mut pair = Pair::of(timeline());
    pair.display.show(0.0).expect("physics lives");
    pair.settle();
    let inspection = pair.display.ask(Question::Inspect { frame: Frame(10) }).expect("physics lives");
    let throw = Change::Push { body: BodyId(1), impulse: Vec3::X * 900.0, at_point: None };
    let preview = Preview { frame: Frame(1), changes: vec![throw], frames: 15, bodies: Vec::new() };
    let preview = pair.display.ask(Question::Preview(preview)).expect("physics lives");
    let nowhere = pair.display.ask(Question::Inspect { frame: Frame(999) });
    let nowhere = nowhere.expect("physics lives");
    assert!(inspection < preview && preview < nowhere);
    pair.exchange(1);
    while pair.physics.answer(0.0) {}
    pair.exchange(1);
    let answers = pair.display.answers().expect("physics lives");
    let of = |ticket: Ticket| answers.iter().find(|answered| answered.ticket == ticket);
    assert_eq!(of(inspection), None, "a newer question of its kind came before it was carried");
    let refused = of(nowhere).map(|answered| answered.answer.clone());
    assert!(matches!(refused, Some(Err(InquiryError::NotStored { frame: Frame(999), .. }))), "{refused:?}");
    let Some(Ok(Answer::Preview(previewed))) = of(preview).map(|answered| answered.answer.clone()) else {
        panic!("{answers:?}")
    };
    assert_eq!((previewed.frame, previewed.to), (Frame(1), Frame(16)));
    assert!(previewed.trails[0].body == BodyId(1) && previewed.trails[0].poses.len() == 17);
    let asked = pair.display.ask(Question::Inspect { frame: Frame(10) }).expect("physics lives");
    pair.exchange(1);
    while pair.physics.answer(0.0) {}
    pair.exchange(1);
    let inspected = pair.display.answers().expect("physics lives").remove(0);
    let own = pair.physics.timeline().snapshot().inspect(Frame(10)).expect("it is stored");
    assert_eq!((inspected.ticket, inspected.answer), (asked, Ok(Answer::Inspect(own))));
}

#[test]
fn stage_times_come_along() {
    let settings = RemoteSettings { stage_clock: Some(Clock::by_hand()), ..RemoteSettings::default() };
    let mut physics = RemotePhysics::new(timeline(), settings).expect("plain settings");
    let first = physics.publish().expect("the first report");
    let (display, mut courier) = Decoupled::remote(&first).expect("it was made for this");
    while physics.turn() != Progress::Idle {}
    courier.receive(&physics.publish().expect("frames are new")).expect("it was written here");
    let mut times = Vec::new();
    assert_eq!(display.stage_times(0, &mut times), u64::from(LOOKAHEAD));
    let frames: Vec<u64> = times.iter().map(|times| times.frame.0).collect();
    assert_eq!(frames, (1..=u64::from(LOOKAHEAD)).collect::<Vec<_>>());
    assert!(times[0].extended && times[0].recomputed > 0);
}
