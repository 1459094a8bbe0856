//! Fuzz: whatever is done to a timeline, in whatever order and with whatever numbers, nothing panics, what is refused changes nothing,
//! every state has the bits of a full run, and when everything is taken back the timeline is as it was at first.
//!
//! A failure is shrunk to the shortest session that still fails. More sessions, or others:
//! `FORERUN_FUZZ_SESSIONS=10000 FORERUN_FUZZ_SEED=7 cargo test -p forerun-timeline --test fuzz`.

mod edits;

use std::collections::BTreeMap;

use edits::{At, Edit, Session, What, session};
use forerun_dynamics::{BodyDef, Environment};
use forerun_geometry::Shape;
use forerun_timeline::check::{full_run, mismatches};
use forerun_timeline::{
    Change, Command, CommandError, CommandKey, Frame, Keep, Order, Progress, Timeline, TimelineSettings,
};
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner};

/// The display goes no further: full runs are to stay short.
const LAST_DISPLAY: u64 = 60;

/// A timeline and what is known of it.
#[derive(Clone)]
struct Run {
    timeline: Timeline,
    /// All commands in force, the forgotten ones too.
    commands: BTreeMap<CommandKey, Change>,
}

/// A session under way.
struct Fuzz {
    bodies: Vec<BodyDef>,
    environment: Environment,
    run: Run,
    forks: Vec<Run>,
    sequence: u64,
}

impl Fuzz {
    fn new(session: &Session) -> Option<Fuzz> {
        let ground = BodyDef::fixed(Shape::HalfSpace);
        let bodies: Vec<BodyDef> =
            std::iter::once(ground).chain(session.bodies.iter().map(|spec| spec.def())).collect();
        let mut environment = Environment::default();
        if session.restful {
            environment.settings.rest_seconds = 0.1;
        }
        let settings = TimelineSettings {
            lookahead: session.lookahead,
            past: session.past,
            bytes_max: session.bytes_max,
            record_contacts: session.record_contacts,
            ..TimelineSettings::default()
        };
        let timeline = Timeline::new(&bodies, environment, settings).ok()?;
        let run = Run { timeline, commands: BTreeMap::new() };
        Some(Fuzz { bodies, environment, run, forks: Vec::new(), sequence: 0 })
    }

    fn act(&mut self, edit: &Edit) -> Result<(), String> {
        match edit {
            Edit::Submit { at, source, change } => self.submit(*at, *source, change)?,
            Edit::Again(index) => self.again(*index)?,
            Edit::Retract(index) => self.retract(*index)?,
            Edit::Replace(index, change) => self.replace(*index, change)?,
            Edit::Undo => self.undo(Order::Undo)?,
            Edit::Redo => self.undo(Order::Redo)?,
            Edit::Advance(frames) => {
                for _ in 0..*frames {
                    let _ = self.run.timeline.advance();
                }
            }
            Edit::Finish => finish(&mut self.run.timeline),
            Edit::Display(frames) => {
                let display = self.run.timeline.display().0.saturating_add_signed(i64::from(*frames));
                self.run.timeline.set_display(Frame(display.min(LAST_DISPLAY)));
            }
            Edit::SaveAndLoad(with_states) => self.save_and_load(*with_states)?,
            Edit::Fork if self.forks.len() < 3 => self.forks.push(self.run.clone()),
            Edit::Fork => {}
            Edit::Swap(index) => {
                let count = self.forks.len().max(1);
                if let Some(fork) = self.forks.get_mut(usize::from(*index) % count) {
                    std::mem::swap(fork, &mut self.run);
                }
            }
            Edit::Adopt(index) => {
                let count = self.forks.len().max(1);
                if usize::from(*index) % count < self.forks.len() {
                    let fork = self.forks.swap_remove(usize::from(*index) % count);
                    self.run.timeline.adopt(fork.timeline);
                    self.run.commands = fork.commands;
                }
            }
            Edit::Compare => self.compare(&self.run)?,
        }
        let (valid_to, horizon) = (self.run.timeline.valid_to(), self.run.timeline.horizon());
        ensure(self.run.timeline.oldest() <= valid_to && valid_to <= horizon, || {
            format!("true up to {valid_to}, horizon {horizon}")
        })
    }

    fn submit(&mut self, at: At, source: u32, what: &What) -> Result<(), String> {
        let timeline = &mut self.run.timeline;
        let frame = frame_of(at, timeline);
        let change = what.change(timeline.names());
        self.sequence += 1;
        let key = CommandKey { frame, source, sequence: self.sequence };
        let before = summary(timeline);
        let is_used = is_made(&change, &self.bodies, &self.run.commands);
        match timeline.obey(Order::Submit(Command { key, change: change.clone() })) {
            Ok(()) => {
                ensure(frame > timeline.oldest(), || format!("{key:?} is too old and was accepted"))?;
                ensure(what.is_finite() && !is_used, || format!("{change:?} was accepted"))?;
                self.run.commands.insert(key, change);
                Ok(())
            }
            Err(error) => {
                let expected = match (&error, what) {
                    (CommandError::TooOld { .. }, _) => frame <= timeline.oldest(),
                    _ => is_used || may_refuse(what),
                };
                ensure(expected, || format!("{change:?} for {frame} was refused: {error}"))?;
                ensure(before == summary(timeline), || format!("refusing {change:?} changed something"))
            }
        }
    }

    fn replace(&mut self, index: u8, what: &What) -> Result<(), String> {
        let Some((key, old)) = pick(&self.run.commands, index) else { return Ok(()) };
        let timeline = &mut self.run.timeline;
        let before = summary(timeline);
        let change = what.change(timeline.names());
        let mut others = self.run.commands.clone();
        others.remove(&key);
        let is_used = is_made(&change, &self.bodies, &others);
        match timeline.obey(Order::Replace(Command { key, change: change.clone() })) {
            Ok(()) => {
                ensure(key.frame > timeline.oldest(), || format!("{key:?} is too old and was replaced"))?;
                ensure(what.is_finite() && !is_used, || format!("{change:?} was accepted"))?;
                self.run.commands.insert(key, change);
                Ok(())
            }
            Err(error) => {
                let expected = match &error {
                    CommandError::UnknownCommand(_) => key.frame <= timeline.oldest(),
                    _ => is_used || may_refuse(what),
                };
                ensure(expected, || format!("{change:?} in place of {old:?} was refused: {error}"))?;
                ensure(before == summary(timeline), || format!("refusing {change:?} changed something"))
            }
        }
    }

    /// What the timeline says it did is taken over; the commands before the oldest frame nobody can touch.
    fn undo(&mut self, order: Order) -> Result<(), String> {
        let timeline = &mut self.run.timeline;
        let before = summary(timeline);
        match timeline.obey(order.clone()) {
            Ok(()) => {
                let oldest = timeline.oldest();
                self.run.commands.retain(|key, _| key.frame <= oldest);
                self.run.commands.extend(timeline.commands().map(|(key, change)| (*key, change.clone())));
                Ok(())
            }
            Err(error) => {
                // Another body may have the name by now.
                let expected = [CommandError::NothingToUndo, CommandError::NothingToRedo].contains(&error)
                    || matches!(error, CommandError::BodyExists(_));
                ensure(expected, || format!("{order:?} was refused: {error}"))?;
                ensure(before == summary(timeline), || format!("refusing {order:?} changed something"))
            }
        }
    }

    fn save_and_load(&mut self, with_states: bool) -> Result<(), String> {
        let timeline = &self.run.timeline;
        let parts = timeline.parts(if with_states { Keep::States } else { Keep::Commands });
        let loaded = Timeline::from_parts(parts.clone()).map_err(|error| format!("loading: {error}"))?;
        let last = if with_states { timeline.valid_to() } else { timeline.oldest() };
        // What is shared in memory is not the same: where memory is short, less may be kept.
        let whole = loaded.valid_to() == last && loaded.oldest() == timeline.oldest();
        let short = timeline.settings().bytes_max.is_some() && loaded.valid_to() <= last;
        ensure((whole || short) && loaded.horizon() == loaded.valid_to(), || {
            format!("saved up to {last}, loaded up to {}", loaded.valid_to())
        })?;
        ensure(loaded.diff(timeline).is_none(), || "loaded states differ".to_owned())?;
        let again = loaded.parts(if with_states { Keep::States } else { Keep::Commands });
        ensure(again == parts || !whole, || format!("saved\n{parts:?}\nand again\n{again:?}"))?;
        self.run.timeline = loaded;
        Ok(())
    }

    fn again(&mut self, index: u8) -> Result<(), String> {
        let Some((key, change)) = pick(&self.run.commands, index) else { return Ok(()) };
        let timeline = &mut self.run.timeline;
        let before = summary(timeline);
        let refused = timeline.submit(Command { key, change });
        let expected = match refused {
            Err(CommandError::DuplicateKey(_)) => key.frame > timeline.oldest(),
            Err(CommandError::TooOld { .. }) => key.frame <= timeline.oldest(),
            _ => false,
        };
        ensure(expected, || format!("{key:?} was sent twice: {refused:?}"))?;
        ensure(before == summary(timeline), || format!("refusing {key:?} changed something"))
    }

    fn retract(&mut self, index: u8) -> Result<(), String> {
        let Some((key, _)) = pick(&self.run.commands, index) else { return Ok(()) };
        let kept = key.frame > self.run.timeline.oldest();
        let done = self.run.timeline.obey(Order::Retract(key)).is_ok();
        ensure(done == kept, || format!("retracting {key:?}: {done}"))?;
        if done {
            self.run.commands.remove(&key);
        }
        Ok(())
    }

    /// All that is known to be true has the bits of a full run.
    fn compare(&self, run: &Run) -> Result<(), String> {
        let timeline = &run.timeline;
        let commands = run.commands.iter().map(|(key, change)| Command { key: *key, change: change.clone() });
        let frames = timeline.valid_to().0.max(1) as u32;
        let full = full_run(&self.bodies, commands, self.environment, frames)
            .map_err(|error| format!("no full run: {error}"))?;
        match mismatches(timeline, &full).1.filter(|first| first.frame <= timeline.valid_to()) {
            Some(first) => Err(format!("true up to {}: {first}", timeline.valid_to())),
            None => Ok(()),
        }
    }

    /// Everything is worked off and compared; then all is taken back.
    fn end(mut self) -> Result<(), String> {
        let forks = std::mem::take(&mut self.forks);
        for mut run in forks.into_iter().chain([self.run.clone()]) {
            finish(&mut run.timeline);
            self.compare(&run)?;
            let finite = |frame: Frame| {
                let bodies = run.timeline.bodies_at(frame);
                bodies.iter().all(|body| run.timeline.state(*body, frame).is_some_and(|s| s.is_finite()))
            };
            let (oldest, horizon) = (run.timeline.oldest(), run.timeline.horizon());
            ensure((oldest.0..=horizon.0).map(Frame).all(finite), || "a state is not finite".to_owned())?;
            if oldest == Frame(0) {
                self.take_back(run)?;
            }
        }
        Ok(())
    }

    /// Without its commands the timeline is as it was at first.
    fn take_back(&self, mut run: Run) -> Result<(), String> {
        while run.timeline.undo().is_ok() {}
        let keys: Vec<CommandKey> = run.timeline.commands().map(|(key, _)| *key).collect();
        for key in keys {
            ensure(run.timeline.retract(&key), || format!("{key:?} cannot be taken back"))?;
        }
        finish(&mut run.timeline);
        let frames = run.timeline.horizon();
        let first = full_run(&self.bodies, [], self.environment, frames.0.max(1) as u32)
            .map_err(|error| format!("no full run: {error}"))?;
        let hashes = (run.timeline.state_hash(frames), first.state_hash(frames));
        ensure(hashes.0.is_some() && hashes.0 == hashes.1, || {
            format!("after taking back everything: {:?}", mismatches(&run.timeline, &first).1)
        })
    }
}

/// Whether a change adds a body by a name that another was made by.
fn is_made(change: &Change, bodies: &[BodyDef], commands: &BTreeMap<CommandKey, Change>) -> bool {
    let Change::Add { body, .. } = change else { return false };
    let adds = |other: &Change| matches!(other, Change::Add { body: made, .. } if made == body);
    (body.0 as usize) < bodies.len() || commands.values().any(adds)
}

/// Whether a change may be refused, though it is for a possible frame and no body is made twice.
fn may_refuse(what: &What) -> bool {
    match what {
        // The ground bounds no volume, and there are bodies of next to no mass.
        What::SetKind(..) | What::SetMass(..) => true,
        _ => !what.is_plain(),
    }
}

fn pick(commands: &BTreeMap<CommandKey, Change>, index: u8) -> Option<(CommandKey, Change)> {
    let count = commands.len().max(1);
    commands.iter().nth(usize::from(index) % count).map(|(key, change)| (*key, change.clone()))
}

fn frame_of(at: At, timeline: &Timeline) -> Frame {
    let first = timeline.oldest().0 + 1;
    match at {
        At::TooOld => timeline.oldest(),
        At::Past(frames) => Frame(first + u64::from(frames)),
        At::Display(frames) => {
            Frame((timeline.display().0 + 1).saturating_add_signed(i64::from(frames)).max(first))
        }
        At::Never(frames) => Frame(u64::MAX - u64::from(frames)),
        At::Horizon(frames) => {
            Frame(timeline.horizon().0.saturating_add_signed(i64::from(frames)).max(first))
        }
    }
}

/// What a refused command may not change.
fn summary(timeline: &Timeline) -> (Frame, Frame, usize, u64) {
    (timeline.valid_to(), timeline.horizon(), timeline.commands().count(), timeline.next_sequence())
}

fn finish(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}

fn ensure(holds: bool, otherwise: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(otherwise()) }
}

fn play(session: &Session) -> Result<(), String> {
    let Some(mut fuzz) = Fuzz::new(session) else { return Ok(()) };
    for (index, edit) in session.edits.iter().enumerate() {
        fuzz.act(edit).map_err(|error| format!("edit {index}: {error}"))?;
    }
    fuzz.end()
}

fn number(variable: &str, default: u64) -> u64 {
    std::env::var(variable).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

#[test]
fn sessions_of_all_kinds() {
    let mut seed = [0; 32];
    seed[..8].copy_from_slice(&number("FORERUN_FUZZ_SEED", 1).to_le_bytes());
    let cases = number("FORERUN_FUZZ_SESSIONS", 500) as u32;
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 20_000, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &seed));
    let outcome = runner.run(&session(), |session| play(&session).map_err(TestCaseError::fail));
    match outcome {
        Ok(()) => {}
        Err(TestError::Fail(reason, session)) => panic!("{reason}\nthe shortest such session: {session:#?}"),
        Err(TestError::Abort(reason)) => panic!("{reason}"),
    }
}
