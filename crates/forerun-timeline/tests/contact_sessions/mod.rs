//! Timelines that record contacts and are edited at random, and the events by comparing whole lists.
#![allow(dead_code, reason = "each test file uses its own part")]

use forerun_dynamics::{BodyDef, Environment};
use forerun_timeline::check::{Random, random_change};
use forerun_timeline::{
    Command, CommandKey, ContactEvent, ContactKind, Frame, Progress, Snapshot, Timeline, TimelineSettings,
    Touch,
};

pub(crate) const SETTINGS: TimelineSettings =
    TimelineSettings { lookahead: 25, past: 30, bytes_max: None, area_m: None, record_contacts: true };

pub(crate) fn environment(seed: u64) -> Environment {
    let mut environment = Environment::default();
    if seed % 2 == 1 {
        environment.settings.rest_seconds = 0.1;
    }
    environment
}

pub(crate) fn run(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}

/// Random edits of the stored past and the future between frames of work; commands may be taken back. `at` is called as the display goes on.
pub(crate) fn session(
    bodies: &[BodyDef],
    seed: u64,
    settings: TimelineSettings,
    mut at: impl FnMut(&Timeline),
) -> (Timeline, Vec<Command>) {
    let mut timeline = Timeline::new(bodies, environment(seed), settings).unwrap();
    let mut random = Random::new(seed);
    let mut commands: Vec<Command> = Vec::new();
    let mut sequence = 0;
    while timeline.display() < Frame(70) {
        match random.below(9) {
            0..2 => {
                let from = timeline.oldest().0 + 1;
                let frame = Frame(from + random.below(timeline.horizon().0 + 8 - from));
                let change = random_change(&mut timeline, frame, &mut random);
                sequence += 1;
                let command = Command { key: CommandKey { frame, source: 1, sequence }, change };
                if timeline.submit(command.clone()).is_ok() {
                    commands.push(command);
                }
            }
            2 => {
                let index = random.below(commands.len() as u64 + 1) as usize;
                if index < commands.len() && timeline.retract(&commands[index].key) {
                    commands.swap_remove(index);
                }
            }
            3 => timeline.set_display(Frame(timeline.display().0 + 1 + random.below(5))),
            _ => {
                for _ in 0..=random.below(12) {
                    let _ = timeline.advance();
                }
            }
        }
        at(&timeline);
    }
    run(&mut timeline);
    at(&timeline);
    (timeline, commands)
}

/// Events by comparing whole lists.
pub(crate) fn plain_events(snapshot: &Snapshot, frame: Frame, speed_min: f32) -> Vec<ContactEvent> {
    let (before, now) = (snapshot.contacts(Frame(frame.0 - 1)), snapshot.contacts(frame));
    let find = |list: &[Touch], t: &Touch| -> Option<Touch> {
        list.iter().find(|o| (o.first, o.second) == (t.first, t.second)).copied()
    };
    let mut events = Vec::new();
    for touch in &now {
        let last = find(&before, touch);
        if last.is_none() {
            events.push(ContactEvent { frame, kind: ContactKind::Begin, touch: *touch });
        }
        if touch.speed >= speed_min && last.is_none_or(|last| last.speed < speed_min) {
            events.push(ContactEvent { frame, kind: ContactKind::Hit, touch: *touch });
        }
    }
    for touch in before.iter().filter(|touch| find(&now, touch).is_none()) {
        events.push(ContactEvent { frame, kind: ContactKind::End, touch: *touch });
    }
    events.sort_by_key(|event| (event.touch.first, event.touch.second, event.kind));
    events
}
