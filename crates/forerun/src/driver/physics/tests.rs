//! What the physics hears and learns, step by step and without its thread.

use forerun_timeline::{Change, Command, CommandKey, Order};

use super::super::decoupled::tests::{LOOKAHEAD, timeline};
use super::super::fork::Names;
use super::super::refusal::AdoptError;
use super::*;
use crate::recording::Event;
use crate::{BodyDef, BodyId, Recording, Shape, TimelineSettings, Vec3};

/// A physics that is told things by hand, and both ends of its queues.
struct Bench {
    physics: Physics,
    messages: SyncSender<Message>,
    refusals: Receiver<Refusal>,
    forks: Receiver<Fork>,
    names: Arc<Names>,
}

fn bench(mut timeline: Timeline) -> Bench {
    let (messages, message_queue) = sync_channel(16);
    let (refusal_queue, refusals) = sync_channel(16);
    let (fork_queue, forks) = sync_channel(4);
    let names = Names::after(&mut timeline);
    let physics = Physics {
        shared: Arc::new(Shared::new(Published::of(&timeline), &timeline.settings(), timeline.display())),
        messages: message_queue,
        refusals: refusal_queue,
        forks: fork_queue,
        heard: Heard::new(Arc::clone(&names)),
        command_capacity: 16,
        count_areas: false,
        stage_watch: None,
        reach: Reach::new(timeline.settings().lookahead),
        caught_up: false,
        pictures: 0,
        hinder: Box::new(|| {}),
        recorder: None,
        timeline,
    };
    Bench { physics, messages, refusals, forks, names }
}

impl Bench {
    fn tell(&self, message: Message) {
        self.messages.try_send(message).expect("room");
    }

    fn work(&mut self) {
        while self.physics.advance() != Progress::Idle {}
    }

    fn refused(&self) -> Vec<Refusal> {
        self.refusals.try_iter().collect()
    }
}

/// A recorder of what the physics is told from now on, and its file.
fn recorded(bench: &mut Bench, name: &str) -> (Recorder, std::path::PathBuf) {
    let path = std::env::temp_dir().join(format!("forerun-physics-{}-{name}.forerun", std::process::id()));
    let recorder = Recorder::create(&path, &bench.physics.timeline).expect("a place to write");
    bench.physics.recorder = Some(recorder.clone());
    (recorder, path)
}

/// What was recorded; the file is gone after.
fn read((recorder, path): (Recorder, std::path::PathBuf)) -> Recording {
    recorder.finish().expect("a place to write");
    let recording = Recording::read(&path).expect("it is whole");
    std::fs::remove_file(&path).expect("it was there");
    recording
}

fn orders_of(recording: &Recording) -> Vec<Order> {
    let order = |event: &Event| match event {
        Event::Order(order) => Some(order.clone()),
        Event::Mark(_) | Event::Restart(_) => None,
    };
    recording.events.iter().filter_map(order).collect()
}

fn push(frame: u64, sequence: u64) -> Order {
    let velocity = Vec3::X;
    let change = Change::SetVelocity { body: BodyId(1), velocity, angular_velocity: Vec3::ZERO };
    Order::Submit(Command { key: CommandKey { frame: Frame(frame), source: 0, sequence }, change })
}

#[test]
fn a_fork_is_judged_by_what_is_shown_when_it_is_adopted() {
    let mut bench = bench(timeline());
    bench.work();
    bench.tell(Message::Fork);
    bench.physics.catch_up();
    let fork = bench.forks.try_recv().expect("it was asked for");
    let horizon = Frame(u64::from(LOOKAHEAD));
    bench.physics.shared.tell_display(Frame(15));
    bench.physics.catch_up();
    bench.work();
    // The display goes on past the fork, and the physics has not learned that yet.
    let displayed = Frame(25);
    bench.physics.shared.tell_display(displayed);
    bench.tell(Message::Adopt(Box::new(fork)));
    bench.physics.catch_up();
    let error = AdoptError::NotDisplayed { displayed, oldest: Frame(0), horizon };
    assert_eq!(bench.refused(), [Refusal::Adopt(error)]);
    assert_eq!((bench.physics.timeline.display(), bench.physics.timeline.horizon()), (displayed, Frame(35)));
}

#[test]
fn without_a_past_an_order_still_comes_before_the_frame_that_was_shown_after_it() {
    let settings = TimelineSettings { lookahead: LOOKAHEAD, past: 0, ..TimelineSettings::default() };
    let bodies =
        crate::timeline::parts::TimelineParts { settings, ..timeline().parts(crate::Keep::Commands) };
    let mut bench = bench(Timeline::from_parts(bodies).expect("they were parts"));
    bench.work();
    for displayed in [0, 2, 4] {
        // Ordered while one frame was shown, heard when the next but one is.
        bench.tell(Message::Obey(push(displayed + 1, displayed)));
        bench.physics.shared.tell_display(Frame(displayed + 2));
        bench.physics.catch_up();
        assert_eq!(bench.refused(), []);
        bench.work();
        bench.physics.catch_up();
        assert_eq!(bench.physics.timeline.oldest(), Frame(displayed + 2));
    }
}

#[test]
fn what_was_obeyed_is_recorded_as_it_was_said_and_what_was_refused_is_not() {
    let mut bench = bench(timeline());
    let file = recorded(&mut bench, "as-said");
    let said = [push(3, 0), Order::Undo, Order::Redo, push(4, 1), Order::Undo];
    for order in &said {
        bench.tell(Message::Obey(order.clone()));
    }
    // Of the same key as one that stands.
    bench.tell(Message::Obey(push(3, 0)));
    bench.physics.catch_up();
    assert_eq!(bench.refused().len(), 1);
    let recording = read(file);
    assert_eq!(orders_of(&recording), said);
    let (is, was) = (recording.timeline().expect("it was one"), &bench.physics.timeline);
    assert_eq!(is.parts(crate::Keep::Commands), was.parts(crate::Keep::Commands));
}

#[test]
fn a_name_that_goes_from_one_command_to_another_in_one_batch_is_replayed() {
    let mut bench = bench(timeline());
    let file = recorded(&mut bench, "handed-on");
    let key = |frame| CommandKey { frame: Frame(frame), source: 1, sequence: 0 };
    let add = |radius| {
        let def = BodyDef::new(Shape::sphere(radius).expect("a ball")).at(Vec3::Y * 20.0);
        Change::Add { body: BodyId(3), def: Box::new(def) }
    };
    bench.tell(Message::Obey(Order::Submit(Command { key: key(5), change: add(0.5) })));
    bench.physics.catch_up();
    let release = Change::Release { body: BodyId(1) };
    bench.tell(Message::Obey(Order::Replace(Command { key: key(5), change: release })));
    bench.tell(Message::Obey(Order::Submit(Command { key: key(4), change: add(0.25) })));
    bench.physics.catch_up();
    assert_eq!(bench.refused(), []);
    let replay = read(file).replay(&mut |_| {}).expect("it was recorded");
    assert_eq!((replay.orders, replay.refused), (3, 0));
}

#[test]
fn what_is_refused_neither_shortens_the_reach_nor_publishes() {
    let mut bench = bench(timeline());
    let reach = bench.physics.reach;
    let published = bench.physics.shared.published.load_full();
    bench.tell(Message::Obey(Order::Undo));
    bench.physics.catch_up();
    assert_eq!(bench.refused().len(), 1);
    assert_eq!(bench.physics.reach, reach);
    assert!(Arc::ptr_eq(&published, &bench.physics.shared.published.load_full()));
    assert_eq!(bench.physics.shared.take_drop(), None);
    bench.tell(Message::Obey(push(3, 0)));
    bench.physics.catch_up();
    assert!(bench.physics.reach != reach);
    assert_eq!(bench.physics.shared.take_drop(), Some(Frame(0)));
}

#[test]
fn a_body_named_after_many_others_is_in_the_recording() {
    let mut bench = bench(timeline());
    let file = recorded(&mut bench, "many-names");
    for _ in 0..200_000 {
        bench.names.body();
    }
    let body = bench.names.body();
    let def = BodyDef::new(Shape::sphere(0.5).expect("a ball")).at(Vec3::Y * 20.0);
    let key = CommandKey { frame: Frame(5), source: 0, sequence: 0 };
    let add = Order::Submit(Command { key, change: Change::Add { body, def: Box::new(def) } });
    for order in [push(3, 1), add, push(4, 2)] {
        bench.tell(Message::Obey(order));
    }
    bench.physics.catch_up();
    bench.work();
    assert_eq!(bench.refused(), []);
    let recording = read(file);
    let mut again = recording.timeline().expect("it was one");
    while again.advance() != Progress::Idle {}
    assert_eq!(again.diff(&bench.physics.timeline), None);
    assert!(again.state(body, Frame(6)).is_some());
    let replay = recording.replay(&mut |_| {}).expect("it was recorded");
    assert!(replay.is_same() && replay.refused == 0, "{replay:?}");
}

#[test]
fn an_undo_that_fails_is_recorded_as_it_is_not_tried_again() {
    let mut bench = bench(timeline());
    let file = recorded(&mut bench, "failing-undo");
    let def = || Box::new(BodyDef::new(Shape::sphere(0.5).expect("a ball")).at(Vec3::Y * 20.0));
    let body = BodyId(3);
    let key = CommandKey { frame: Frame(4), source: 0, sequence: 1 };
    let others = CommandKey { source: 1, ..key };
    let orders = [
        push(3, 0),
        Order::Submit(Command { key, change: Change::Add { body, def: def() } }),
        Order::Retract(key),
        Order::Submit(Command { key: others, change: Change::Add { body, def: def() } }),
        // The body cannot be added again, and the push is undone next.
        Order::Undo,
        Order::Undo,
        Order::Undo,
    ];
    for order in &orders {
        bench.tell(Message::Obey(order.clone()));
    }
    bench.physics.catch_up();
    let refused = bench.refused();
    assert!(matches!(&refused[..], [Refusal::Undo(_), Refusal::Undo(_)]), "{refused:?}");
    assert_eq!(bench.physics.timeline.commands().count(), 1);
    let recording = read(file);
    assert_eq!(orders_of(&recording), orders[..6]);
    let again = recording.timeline().expect("it was one");
    assert_eq!(again.parts(crate::Keep::Commands), bench.physics.timeline.parts(crate::Keep::Commands));
    let replay = recording.replay(&mut |_| {}).expect("it was recorded");
    assert_eq!((replay.orders, replay.refused), (5, 1));
}
