//! The oracle: whatever was edited, in whatever order and however the work was cut up, every state of every body has the bits
//! of a full simulation by one thread that knew all commands from the start.

mod scenes;

use forerun_dynamics::{BodyDef, Environment};
use forerun_timeline::check::{CheckSettings, Random, check, full_run, mismatches, random_change};
use forerun_timeline::{Command, CommandKey, Frame, Mutation, Progress, Timeline, TimelineSettings};

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a small pool of threads")
}

/// Every other seed lets bodies come to rest soon, so that resting islands are edited too.
fn environment(seed: u64) -> Environment {
    let mut environment = Environment::default();
    if seed % 2 == 1 {
        environment.settings.rest_seconds = 0.1;
    }
    environment
}

/// What one random session did.
struct Session {
    timeline: Timeline,
    commands: Vec<Command>,
}

/// Edits of all kinds in the past, the present and the future, between frames of work and in batches; some arrive late and out of
/// order. Then everything is worked off.
fn session(bodies: &[BodyDef], seed: u64, frames: u64) -> Session {
    let settings = TimelineSettings { lookahead: 25, past: 30, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(bodies, environment(seed), settings).expect("bodies are possible");
    let mut random = Random::new(seed);
    let mut commands = Vec::new();
    let mut held_back: Vec<Command> = Vec::new();
    let mut sequence = 0;
    while timeline.display().0 < frames {
        match random.below(10) {
            0..2 => {
                for _ in 0..=random.below(3) {
                    let from = timeline.oldest().0 + 1;
                    let frame = Frame(from + random.below(timeline.horizon().0 + 8 - from));
                    let change = random_change(&mut timeline, frame, &mut random);
                    sequence += 1;
                    let key = CommandKey { frame, source: random.below(3) as u32, sequence };
                    held_back.push(Command { key, change });
                }
            }
            2..4 => {
                // Latest first: the order in which commands arrive is not that in which they were given.
                while let Some(command) = held_back.pop() {
                    if timeline.submit(command.clone()).is_ok() {
                        commands.push(command);
                    }
                }
            }
            4 => {
                let index = random.below(commands.len() as u64 + 1) as usize;
                if index < commands.len() && timeline.retract(&commands[index].key) {
                    commands.swap_remove(index);
                }
            }
            5 => {
                let ahead = 1 + random.below(6);
                timeline.set_display(Frame(timeline.display().0 + ahead));
            }
            _ => {
                for _ in 0..=random.below(12) {
                    let _ = timeline.advance();
                }
                let snapshot = timeline.snapshot();
                let valid_to = snapshot.valid_to();
                assert_eq!(timeline.audit(valid_to.minus(1 + random.below(3))), None);
            }
        }
    }
    while timeline.advance() != Progress::Idle {}
    Session { timeline, commands }
}

fn assert_equals_full_run(scene: &str, bodies: &[BodyDef], seed: u64, session: &Session) {
    let frames = session.timeline.horizon().0 as u32;
    let commands = session.commands.clone();
    let full = pool(1)
        .install(|| full_run(bodies, commands, environment(seed), frames))
        .expect("what was accepted once is accepted again");
    let (count, first) = mismatches(&session.timeline, &full);
    if let Some(first) = first {
        for Command { key, change } in session.commands.iter().filter(|c| c.key.frame <= first.frame) {
            let change: String = format!("{change:?}").chars().take(90).collect();
            eprintln!("{key:?} {change}");
        }
        panic!("scene {scene}, seed {seed}: {count} body-frames differ; {first}");
    }
    assert_eq!(session.timeline.horizon(), full.horizon());
}

#[test]
fn sessions_with_one_thread() {
    for (name, bodies) in scenes::all() {
        for seed in 0..12 {
            let session = pool(1).install(|| session(&bodies, seed, 60));
            assert_equals_full_run(name, &bodies, seed, &session);
        }
    }
}

#[test]
fn sessions_with_two_and_four_threads() {
    for threads in [2, 4] {
        let pool = pool(threads);
        for (name, bodies) in scenes::all() {
            for seed in 100..104 {
                let session = pool.install(|| session(&bodies, seed, 60));
                assert_equals_full_run(name, &bodies, seed, &session);
            }
        }
    }
}

#[test]
fn edits_one_by_one() {
    for (name, bodies) in scenes::all() {
        for seed in [6, 7] {
            let settings = CheckSettings { edits: 10, seed, frames: 90, ..CheckSettings::default() };
            let report = pool(1)
                .install(|| check(&bodies, environment(seed), &settings, &mut |_| {}))
                .expect("bodies are possible");
            if let Some(first) = report.first_mismatch {
                panic!("scene {name}, seed {seed}: {} body-frames differ; {first}", report.mismatches);
            }
            assert!(report.recomputed <= report.full, "{report:?}");
        }
    }
}

/// After the scene has settled, with a display that moves on, and compared once for some edits: the same answer, and still a rule that
/// is left out is found.
#[test]
fn edits_in_batches_behind_a_moving_display() {
    let settings = |seed, mutation| CheckSettings {
        edits: 12,
        seed,
        frames: 50,
        settle: 30,
        display_step: 3,
        compare_every: 4,
        mutation,
    };
    let mut found = 0;
    for (name, bodies) in scenes::all() {
        for seed in [8, 9] {
            let differ = |mutation| {
                let settings = settings(seed, mutation);
                let report = check(&bodies, environment(seed), &settings, &mut |_| {});
                report.expect("bodies are possible").mismatches
            };
            assert_eq!(differ(Mutation::None), 0, "scene {name}, seed {seed}");
            found += differ(Mutation::NoOldIsland);
        }
    }
    assert!(found > 0);
}

/// Many more sessions: `cargo test -p forerun-timeline --test oracle -- --ignored`.
#[test]
#[ignore = "takes minutes"]
fn sessions_at_length() {
    let pool = pool(2);
    for seed in 1000..1150 {
        for (name, bodies) in scenes::all() {
            let session = pool.install(|| session(&bodies, seed, 60 + seed % 3 * 40));
            assert_equals_full_run(name, &bodies, seed, &session);
        }
    }
}
