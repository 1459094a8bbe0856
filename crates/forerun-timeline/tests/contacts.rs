//! Recorded contacts against full runs, and events against the lists that they are made from.

mod contact_sessions;
mod scenes;

use contact_sessions::{SETTINGS, environment, plain_events, run, session};
use forerun_dynamics::{BodyDef, BodyId, Environment};
use forerun_geometry::{Pose, Shape, Vec3};
use forerun_timeline::check::Random;
use forerun_timeline::{
    Change, Command, ContactEvent, ContactKind, ContactListener, Frame, Keep, Timeline, TimelineSettings,
    Touch,
};

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
                .flat_map(|frame| plain_events(&snapshot, Frame(frame), 0.3))
                .collect();
            let (expected_hits, expected): (Vec<_>, Vec<_>) =
                expected.into_iter().partition(|event| event.kind == ContactKind::Hit);
            // Just before and just after frames, too.
            for (early, late) in [(0.0, 0.0), (0.3, 0.9)] {
                let range = ((from as f64 + early) * dt, (to as f64 + late) * dt);
                assert_eq!(snapshot.contact_events(range.0, range.1), expected);
                assert_eq!(snapshot.hits(range.0, range.1, 0.3), expected_hits);
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

/// What recording costs: `cargo test --release -p forerun-timeline --test contacts cost -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
#[allow(
    clippy::disallowed_types,
    clippy::print_stdout,
    reason = "a measurement has a clock and is read by people"
)]
fn cost_of_recording() {
    let cube = Shape::cuboid(Vec3::splat(0.5)).unwrap();
    let mut random = Random::new(4);
    let mut bodies = vec![BodyDef::fixed(Shape::HalfSpace)];
    for i in 0..1000_u32 {
        let (column, row, level) = ((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32);
        let place = Vec3::new(1.05 * column, 0.6 + 1.1 * level, 1.05 * row) + random.vector() * 0.3;
        bodies.push(BodyDef::new(cube.clone()).at(place));
    }
    for record_contacts in [false, true, false, true] {
        let settings = TimelineSettings { lookahead: 120, record_contacts, ..TimelineSettings::default() };
        let mut timeline = Timeline::new(&bodies, Environment::default(), settings).unwrap();
        let start = std::time::Instant::now();
        run(&mut timeline);
        let frame_ms = start.elapsed().as_secs_f64() * 1e3 / 120.0;
        let snapshot = timeline.snapshot();
        let touches: usize = (1..=120).map(|frame| snapshot.contacts(Frame(frame)).len()).sum();
        let body_frames = 1000.0 * 121.0;
        println!(
            "recording {record_contacts}: {frame_ms:.2} ms a frame, {:.1} bytes a body and frame, {:.2} touches a body and frame",
            timeline.state_bytes() as f64 / body_frames,
            touches as f64 / body_frames,
        );
        let mut listener = ContactListener::default();
        let (mut told, mut slowest) = (0, 0.0_f64);
        let start = std::time::Instant::now();
        for frame in 0..=120 {
            let begin = std::time::Instant::now();
            told += listener.pass(&snapshot, f64::from(frame) / 60.0 + 0.001).len();
            slowest = slowest.max(begin.elapsed().as_secs_f64() * 1e6);
        }
        let pass_us = start.elapsed().as_secs_f64() * 1e6 / 121.0;
        println!("    {told} told, {pass_us:.1} µs a picture, at most {slowest:.1} µs");
        let start = std::time::Instant::now();
        let events = snapshot.contact_events(0.0, 2.0).len();
        println!("    {events} events of 2 s in {:.2} ms", start.elapsed().as_secs_f64() * 1e3);
    }
}
