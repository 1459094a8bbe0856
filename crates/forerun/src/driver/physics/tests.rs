//! What the physics hears and learns, step by step and without its thread.

use forerun_timeline::{Change, Command, CommandKey, Order};

use super::super::decoupled::tests::{LOOKAHEAD, timeline};
use super::super::fork::Names;
use super::super::refusal::AdoptError;
use super::*;
use crate::{BodyId, TimelineSettings, Vec3};

/// A physics that is told things by hand, and both ends of its queues.
struct Bench {
    physics: Physics,
    messages: SyncSender<Message>,
    refusals: Receiver<Refusal>,
    forks: Receiver<Fork>,
}

fn bench(mut timeline: Timeline) -> Bench {
    let (messages, message_queue) = sync_channel(16);
    let (refusal_queue, refusals) = sync_channel(16);
    let (fork_queue, forks) = sync_channel(4);
    let names = Names::after(&mut timeline);
    let physics = Physics {
        shared: Arc::new(Shared::new(&timeline)),
        messages: message_queue,
        refusals: refusal_queue,
        forks: fork_queue,
        heard: Heard::new(names),
        command_capacity: 16,
        count_areas: false,
        reach: Reach::new(timeline.settings().lookahead),
        caught_up: false,
        pictures: 0,
        hinder: Box::new(|| {}),
        recorder: None,
        timeline,
    };
    Bench { physics, messages, refusals, forks }
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
