//! Recorded contacts against full runs, events against the lists that they are made from, and what listeners tell against both.

mod scenes;

use std::collections::BTreeSet;

use forerun_dynamics::{BodyDef, BodyId, Environment};
use forerun_geometry::{Pose, Shape, Vec3};
use forerun_timeline::check::{Random, random_change};
use forerun_timeline::{
    Change, Command, CommandKey, ContactEvent, ContactKind, ContactListener, ContactNotice, Frame, Keep,
    LateEdits, ListenerSettings, Progress, Snapshot, Timeline, TimelineSettings, Touch,
};

const SETTINGS: TimelineSettings =
    TimelineSettings { lookahead: 25, past: 30, bytes_max: None, area_m: None, record_contacts: true };

fn environment(seed: u64) -> Environment {
    let mut environment = Environment::default();
    if seed % 2 == 1 {
        environment.settings.rest_seconds = 0.1;
    }
    environment
}

fn run(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}

/// Random edits of the stored past and the future between frames of work; commands may be taken back. `at` is called as the display goes on.
fn session(
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

/// A full simulation by one thread that knows all commands from the start, computes all bodies in every frame, and records.
fn full_run(bodies: &[BodyDef], commands: &[Command], seed: u64, like: &Timeline) -> Timeline {
    let frames = like.horizon().0 as u32;
    let settings = TimelineSettings { lookahead: frames, past: frames, ..SETTINGS };
    let mut full = Timeline::new(bodies, environment(seed), settings).unwrap();
    full.recompute_all();
    while full.names() < like.names() {
        full.reserve_body();
    }
    let mut commands = commands.to_vec();
    commands.sort_by_key(|command| (!matches!(command.change, Change::Add { .. }), command.key));
    full.submit_all(commands).expect("what was accepted once is accepted again");
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    one.install(|| run(&mut full));
    full
}

/// How many touches there are; panics at the first that differs.
fn assert_same_contacts(scene: &str, seed: u64, found: &Timeline, full: &Timeline) -> usize {
    let (snapshot, reference) = (found.snapshot(), full.snapshot());
    let mut count = 0;
    for frame in (found.oldest().0..=found.horizon().0).map(Frame) {
        let (a, b) = (snapshot.contacts(frame), reference.contacts(frame));
        let same = a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| a.same_bits(b));
        if !same {
            let only = |a: &[Touch], b: &[Touch]| -> Vec<Touch> {
                a.iter().filter(|a| !b.iter().any(|b| a.same_bits(b))).copied().collect()
            };
            panic!("{scene}, seed {seed}, {frame}: found {:?}, a full run {:?}", only(&a, &b), only(&b, &a));
        }
        count += a.len();
    }
    count
}

#[test]
fn contacts_are_those_of_a_full_run() {
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        for (scene, bodies) in scenes::all() {
            let mut touches = 0;
            for seed in 0..6 {
                let seed = seed + 100 * threads as u64;
                let (timeline, commands) = pool.install(|| session(&bodies, seed, SETTINGS, |_| ()));
                let full = full_run(&bodies, &commands, seed, &timeline);
                touches += assert_same_contacts(scene, seed, &timeline, &full);
            }
            assert!(touches > 500, "{scene}: {touches}");
        }
    }
}

/// Many more sessions: `cargo test -p forerun-timeline --test contacts -- --ignored`.
#[test]
#[ignore = "takes minutes"]
fn contacts_at_length() {
    for seed in 1000..1100 {
        for (scene, bodies) in scenes::all() {
            let (timeline, commands) = session(&bodies, seed, SETTINGS, |_| ());
            let full = full_run(&bodies, &commands, seed, &timeline);
            assert_same_contacts(scene, seed, &timeline, &full);
        }
    }
}

#[test]
fn recording_changes_no_state_and_not_recording_keeps_nothing() {
    for (_, bodies) in scenes::all() {
        let without = TimelineSettings { record_contacts: false, ..SETTINGS };
        let (with, _) = session(&bodies, 3, SETTINGS, |_| ());
        let (without, _) = session(&bodies, 3, without, |_| ());
        assert_eq!(with.diff(&without), None);
        assert!(with.state_bytes() > without.state_bytes());
        let snapshot = without.snapshot();
        assert!((0..=without.horizon().0).all(|frame| snapshot.contacts(Frame(frame)).is_empty()));
        assert_eq!(snapshot.contact_events(0.0, 9.0), []);
    }
}

/// A timeline that is made again of its parts: in the middle of things, and when all has long been at rest.
#[test]
fn contacts_are_known_again_after_loading() {
    let mut touches = 0;
    for (scene, bodies) in scenes::all() {
        let settings = TimelineSettings { lookahead: 30, past: 10, ..SETTINGS };
        let mut timeline = Timeline::new(&bodies, environment(1), settings).unwrap();
        for display in [8, 90] {
            while timeline.display() < Frame(display) {
                timeline.set_display(timeline.display().next());
                run(&mut timeline);
            }
            for keep in [Keep::Commands, Keep::States] {
                let mut again = Timeline::from_parts(timeline.parts(keep)).unwrap();
                run(&mut again);
                assert_eq!((again.oldest(), again.horizon()), (timeline.oldest(), timeline.horizon()));
                assert_eq!(again.diff(&timeline), None);
                let (a, b) = (again.snapshot(), timeline.snapshot());
                // Those of the oldest frame are not known: the step that led to it is not done again.
                for frame in (timeline.oldest().0 + 1..=timeline.horizon().0).map(Frame) {
                    let (a, b) = (a.contacts(frame), b.contacts(frame));
                    let same = a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| a.same_bits(b));
                    assert!(same, "{scene}, {keep:?}, {frame}: {a:?} {b:?}");
                    touches += a.len();
                }
            }
        }
    }
    assert!(touches > 5000, "{touches}");
}

#[test]
fn what_rests_costs_nothing() {
    let mut timeline = Timeline::new(&scenes::piles(), environment(1), SETTINGS).unwrap();
    let mut bytes = Vec::new();
    for display in [60, 120, 200] {
        timeline.set_display(Frame(display));
        run(&mut timeline);
        bytes.push(timeline.state_bytes());
        assert_eq!(timeline.snapshot().contacts(timeline.horizon()).len(), 24);
    }
    assert!(bytes[2] == bytes[1] && bytes[1] < 20_000, "{bytes:?}");
}

/// Events by comparing whole lists.
fn plain_events(snapshot: &Snapshot, frame: Frame, impulse_min: f32) -> Vec<ContactEvent> {
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
        if touch.impulse - last.map_or(0.0, |last| last.impulse) >= impulse_min {
            events.push(ContactEvent { frame, kind: ContactKind::Hit, touch: *touch });
        }
    }
    for touch in before.iter().filter(|touch| find(&now, touch).is_none()) {
        events.push(ContactEvent { frame, kind: ContactKind::End, touch: *touch });
    }
    events.sort_by_key(|event| (event.touch.first, event.touch.second, event.kind));
    events
}

#[test]
fn events_are_what_the_lists_say() {
    let (mut begins, mut ends, mut hits) = (0, 0, 0);
    for (_, bodies) in scenes::all() {
        let (timeline, _) = session(&bodies, 5, SETTINGS, |_| ());
        let snapshot = timeline.snapshot();
        let dt = f64::from(snapshot.frame_seconds());
        let (oldest, horizon) = (timeline.oldest().0, timeline.horizon().0);
        for (from, to) in
            [(0, horizon), (oldest, oldest + 9), (oldest + 20, horizon), (oldest + 7, oldest + 7)]
        {
            let expected: Vec<ContactEvent> = (from.max(oldest) + 1..=to)
                .flat_map(|frame| plain_events(&snapshot, Frame(frame), 50.0))
                .collect();
            let (expected_hits, expected): (Vec<_>, Vec<_>) =
                expected.into_iter().partition(|event| event.kind == ContactKind::Hit);
            // Just before and just after frames, too.
            for (early, late) in [(0.0, 0.0), (0.3, 0.9)] {
                let range = ((from as f64 + early) * dt, (to as f64 + late) * dt);
                assert_eq!(snapshot.contact_events(range.0, range.1), expected);
                assert_eq!(snapshot.hits(range.0, range.1, 50.0), expected_hits);
            }
            begins += expected.iter().filter(|event| event.kind == ContactKind::Begin).count();
            ends += expected.iter().filter(|event| event.kind == ContactKind::End).count();
            hits += expected_hits.len();
        }
        assert_eq!(snapshot.contact_events(f64::NAN, 1.0), []);
        assert_eq!(snapshot.contact_events(0.0, f64::NAN), []);
    }
    assert!(begins > 100 && ends > 50 && hits > 100, "{begins} begins, {ends} ends, {hits} hits");
}

type Key = (Frame, BodyId, BodyId, ContactKind);

fn key(event: &ContactEvent) -> Key {
    (event.frame, event.touch.first, event.touch.second, event.kind)
}

fn display_s(timeline: &Timeline) -> f64 {
    (timeline.display().0 as f64 + 0.4)
        * f64::from(timeline.environment_at(timeline.oldest()).settings.frame_seconds)
}

#[test]
fn edits_of_the_future_are_told_as_they_come_true_and_only_once() {
    for (scene, bodies) in scenes::all() {
        let settings = TimelineSettings { past: 1000, ..SETTINGS };
        let mut timeline = Timeline::new(&bodies, environment(1), settings).unwrap();
        let mut random = Random::new(77);
        let listen = ListenerSettings { hit_impulse_min: 20.0, ..ListenerSettings::default() };
        let mut listener = ContactListener::new(listen);
        let mut told: Vec<ContactEvent> = Vec::new();
        let mut undone = 0;
        let mut foreseen: BTreeSet<Key> = BTreeSet::new();
        while timeline.display() < Frame(80) {
            if random.below(4) == 0 {
                let frame = Frame(timeline.display().0 + 1 + random.below(20));
                let change = random_change(&mut timeline, frame, &mut random);
                let _ = timeline.change(frame, change);
            }
            // Physics is late at times.
            for _ in 0..random.below(30) {
                let _ = timeline.advance();
            }
            timeline.set_display(Frame(timeline.display().0 + random.below(3)));
            let (snapshot, now) = (timeline.snapshot(), display_s(&timeline));
            for notice in listener.pass(&snapshot, now) {
                let ContactNotice::Happened(event) = notice else { panic!("{notice:?}") };
                assert!(event.frame <= timeline.display() && event.frame <= snapshot.valid_to(), "{event:?}");
                told.push(event);
            }
            foreseen.extend(snapshot.contact_events(now, 100.0).iter().map(key));
        }
        run(&mut timeline);
        let (snapshot, now) = (timeline.snapshot(), display_s(&timeline));
        told.extend(listener.pass(&snapshot, now).into_iter().map(|notice| match notice {
            ContactNotice::Happened(event) => event,
            ContactNotice::Retracted(event) => panic!("{event:?}"),
        }));
        let expected: Vec<ContactEvent> = (1..=timeline.display().0)
            .flat_map(|frame| plain_events(&snapshot, Frame(frame), 20.0))
            .collect();
        assert_eq!(told, expected, "{scene}");
        let true_now: BTreeSet<Key> = expected.iter().map(key).collect();
        undone += foreseen.iter().filter(|k| k.0 <= timeline.display() && !true_now.contains(*k)).count();
        assert!(told.len() > 5 && undone > 0, "{scene}: {} told, {undone} undone", told.len());
    }
}

#[test]
fn late_edits_are_let_be_in_balance() {
    for (scene, bodies) in scenes::all() {
        for seed in 20..24 {
            let mut listener = ContactListener::default();
            let mut touching: BTreeSet<(BodyId, BodyId)> = BTreeSet::new();
            let mut last = Frame(0);
            let (timeline, _) = session(&bodies, seed, SETTINGS, |timeline| {
                for notice in listener.pass(&timeline.snapshot(), display_s(timeline)) {
                    let ContactNotice::Happened(event) = notice else { panic!("{notice:?}") };
                    assert!(event.frame >= last && event.frame <= timeline.display(), "{event:?}");
                    last = event.frame;
                    let pair = (event.touch.first, event.touch.second);
                    let news = match event.kind {
                        ContactKind::Begin => touching.insert(pair),
                        ContactKind::End => touching.remove(&pair),
                        ContactKind::Hit => false,
                    };
                    assert!(news, "{scene}, seed {seed}: {event:?}");
                }
            });
            // One more frame settles what late edits left behind.
            let mut timeline = timeline;
            timeline.set_display(timeline.display().next());
            run(&mut timeline);
            let snapshot = timeline.snapshot();
            for notice in listener.pass(&snapshot, display_s(&timeline)) {
                let ContactNotice::Happened(event) = notice else { panic!("{notice:?}") };
                let pair = (event.touch.first, event.touch.second);
                let news = if event.kind == ContactKind::Begin {
                    touching.insert(pair)
                } else {
                    touching.remove(&pair)
                };
                assert!(news);
            }
            let now = snapshot.contacts(timeline.display());
            assert_eq!(
                touching,
                now.iter().map(|touch| (touch.first, touch.second)).collect(),
                "{scene}, seed {seed}"
            );
        }
    }
}

#[test]
fn late_edits_are_corrected_where_that_is_asked_for() {
    let mut retracted = 0;
    for (scene, bodies) in scenes::all() {
        for seed in 30..34 {
            let listen = ListenerSettings { hit_impulse_min: 30.0, late_edits: LateEdits::Correct };
            let mut listener = ContactListener::new(listen);
            let mut told: BTreeSet<Key> = BTreeSet::new();
            let settings = TimelineSettings { past: 1000, ..SETTINGS };
            let (timeline, _) = session(&bodies, seed, settings, |timeline| {
                for notice in listener.pass(&timeline.snapshot(), display_s(timeline)) {
                    let news = match notice {
                        ContactNotice::Happened(event) => told.insert(key(&event)),
                        ContactNotice::Retracted(event) => told.remove(&key(&event)),
                    };
                    retracted += u32::from(matches!(notice, ContactNotice::Retracted(_)));
                    assert!(news, "{scene}, seed {seed}: {notice:?}");
                }
            });
            let snapshot = timeline.snapshot();
            let expected: BTreeSet<Key> = (1..=timeline.display().0)
                .flat_map(|frame| plain_events(&snapshot, Frame(frame), 30.0))
                .map(|event| key(&event))
                .collect();
            assert_eq!(told, expected, "{scene}, seed {seed}");
        }
    }
    assert!(retracted > 100, "{retracted}");
}

#[test]
fn whoever_begins_to_listen_late_hears_what_touches() {
    let bodies = scenes::piles();
    let mut timeline = Timeline::new(&bodies, environment(0), SETTINGS).unwrap();
    timeline.set_display(Frame(10));
    run(&mut timeline);
    let snapshot = timeline.snapshot();
    let mut listener =
        ContactListener::new(ListenerSettings { hit_impulse_min: 0.0, ..ListenerSettings::default() });
    let first = listener.pass(&snapshot, 0.205);
    let begins: Vec<Touch> = first
        .iter()
        .map(|notice| match notice {
            ContactNotice::Happened(ContactEvent { frame: Frame(12), kind: ContactKind::Begin, touch }) => {
                *touch
            }
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(begins, snapshot.contacts(Frame(12)));
    assert_eq!(begins.len(), 24);
    assert_eq!(listener.pass(&snapshot, 0.205), []);
    assert_eq!(listener.pass(&snapshot, 0.1), []);
    assert_eq!(listener.pass(&snapshot, f64::NAN), []);
    listener.restart();
    assert_eq!(listener.pass(&snapshot, 0.205), first);
}

#[test]
fn a_body_that_is_taken_away_ends_its_touches() {
    let ball = |x: f32| BodyDef::new(Shape::sphere(0.5).unwrap()).at(Vec3::new(x, 0.5, 0.0));
    let bodies = [ball(0.0), BodyDef::fixed(Shape::HalfSpace), ball(3.0), ball(6.0)];
    let mut timeline = Timeline::new(&bodies, Environment::default(), SETTINGS).unwrap();
    run(&mut timeline);
    timeline.change(Frame(10), Change::Remove { body: BodyId(0) }).unwrap();
    let away = Pose::from_position(Vec3::Y * 9.0);
    timeline.change(Frame(12), Change::Move { body: BodyId(2), pose: away }).unwrap();
    let kind = forerun_dynamics::BodyKind::Fixed;
    timeline.change(Frame(14), Change::SetKind { body: BodyId(3), kind }).unwrap();
    run(&mut timeline);
    let events = timeline.snapshot().contact_events(0.05, 1.0);
    let found: Vec<_> = events.iter().map(|event| (event.frame.0, event.kind, event.touch.first.0)).collect();
    // The step that leads to the frame of a command is done before it.
    assert_eq!(found, [(11, ContactKind::End, 0), (13, ContactKind::End, 1), (15, ContactKind::End, 1)]);
}
