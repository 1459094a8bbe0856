//! What listeners tell, against the events of the timeline as it came out.

mod contact_sessions;
mod scenes;

use std::collections::BTreeSet;

use contact_sessions::{SETTINGS, environment, plain_events, run, session};
use forerun_dynamics::BodyId;
use forerun_timeline::check::{Random, random_change};
use forerun_timeline::{
    ContactEvent, ContactKind, ContactListener, ContactNotice, Frame, LateEdits, ListenerSettings, Timeline,
    TimelineSettings, Touch,
};

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
        let listen = ListenerSettings { hit_speed_min: 0.3, ..ListenerSettings::default() };
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
        let expected: Vec<ContactEvent> =
            (1..=timeline.display().0).flat_map(|frame| plain_events(&snapshot, Frame(frame), 0.3)).collect();
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
            let listen = ListenerSettings { hit_speed_min: 0.3, late_edits: LateEdits::Correct };
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
                .flat_map(|frame| plain_events(&snapshot, Frame(frame), 0.3))
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
        ContactListener::new(ListenerSettings { hit_speed_min: 0.0, ..ListenerSettings::default() });
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
