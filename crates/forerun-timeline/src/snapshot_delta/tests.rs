//! Deltas of random sessions: what comes out is what was taken, bit for bit; bad ones are refused.

use super::*;
use crate::check::{Random, random_change};
use crate::{Progress, Timeline, TimelineSettings};
use forerun_geometry::shape::{Cuboid, Shape};

fn timeline() -> Timeline {
    let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
    let mut bodies = vec![BodyDef::fixed(Shape::HalfSpace)];
    bodies.extend((0..40).map(|i| {
        let (x, y) = (1.5 * (i % 10) as f32, 0.5 + 1.3 * (i / 10) as f32);
        BodyDef::new(cube.clone()).at(Vec3::new(x, y, 0.0))
    }));
    let mut environment = Environment::default();
    environment.settings.rest_seconds = 0.1;
    let settings = TimelineSettings { lookahead: 30, past: 10, ..TimelineSettings::default() };
    Timeline::new(&bodies, environment, settings).expect("plain bodies")
}

/// Whether two snapshots say the same about everything, bit for bit.
fn assert_same(mirror: &Snapshot, original: &Snapshot) {
    assert_eq!((mirror.oldest(), mirror.horizon()), (original.oldest(), original.horizon()));
    assert_eq!(mirror.valid_to(), original.valid_to());
    assert_eq!(mirror.doubtful, original.doubtful);
    assert!(mirror.commands().eq(original.commands()) && mirror.edits().eq(original.edits()));
    assert_eq!(mirror.can_undo(), original.can_undo());
    assert_eq!(mirror.can_redo(), original.can_redo());
    assert_eq!(mirror.grid, original.grid);
    let frame_s = f64::from(original.frame_seconds());
    let mut frame = original.oldest();
    while frame <= original.horizon().next() {
        if let (Some(a), Some(b)) = (mirror.tables.get(frame), original.tables.get(frame)) {
            assert_eq!(a.differences(b), [], "{frame}");
            assert_eq!(a.population(), b.population());
        }
        for body in (0..=original.definitions.names() as u32).map(BodyId) {
            assert_eq!(mirror.body_at(body, frame), original.body_at(body, frame), "{body:?} at {frame}");
        }
        for seconds in [frame.0 as f64 * frame_s, (frame.0 as f64 + 0.4) * frame_s] {
            let (mut mine, mut theirs) = (Vec::new(), Vec::new());
            mirror.sample_all(seconds, &mut mine);
            original.sample_all(seconds, &mut theirs);
            assert_eq!(mine, theirs, "{seconds}");
            assert_eq!(mirror.queue_min(seconds), original.queue_min(seconds));
            assert_eq!(mirror.queue_max(seconds), original.queue_max(seconds));
        }
        frame = frame.next();
    }
}

/// A random session; `published` is called with every snapshot that a display might get.
fn session(seed: u64, mut published: impl FnMut(&Snapshot)) {
    let mut timeline = timeline();
    let mut random = Random::new(seed);
    published(&timeline.snapshot());
    for _ in 0..60 {
        match random.below(8) {
            0 => {
                let (oldest, horizon) = (timeline.oldest(), timeline.horizon());
                let frame = oldest.plus(1 + random.below(horizon.since(oldest) + 3));
                let change = random_change(&mut timeline, frame, &mut random);
                // What is refused changes nothing.
                let _ = timeline.change(frame, change);
            }
            1 => drop(timeline.undo()),
            2 => drop(timeline.redo()),
            3 => timeline.set_display(timeline.display().plus(random.below(6))),
            _ => {
                for _ in 0..random.below(25) {
                    let _: Progress = timeline.advance();
                }
            }
        }
        published(&timeline.snapshot());
    }
}

#[test]
fn deltas_lead_a_mirror_through_any_session() {
    for seed in 0..12 {
        let (mut mirror, mut last): (Option<Arc<Snapshot>>, Option<Snapshot>) = (None, None);
        let mut count = 0_u64;
        session(seed, |snapshot| {
            count += 1;
            // Some are left out, as for a display that is behind.
            if count > 1 && (count + seed).is_multiple_of(3) {
                return;
            }
            let delta = SnapshotDelta::between(last.as_ref(), snapshot);
            let next = delta.apply(mirror.as_deref()).expect("it was made for this");
            assert_same(&next, snapshot);
            mirror = Some(next);
            last = Some(snapshot.clone());
        });
    }
}

#[test]
fn what_nothing_reached_stays_the_same_memory() {
    let mut original = timeline();
    while original.advance() != Progress::Idle {}
    let before = original.snapshot();
    let mirror = SnapshotDelta::between(None, &before).apply(None).expect("a whole snapshot");
    let push = Change::Push { body: BodyId(40), impulse: Vec3::Y * 900.0, at_point: None };
    original.change(Frame(20), push).expect("the body is there");
    while original.advance() != Progress::Idle {}
    let after = original.snapshot();
    let delta = SnapshotDelta::between(Some(&before), &after);
    assert!(delta.histories.is_empty() && delta.environments.is_none());
    assert!(delta.runs.iter().all(|run| run.from >= Frame(20) && run.entries.len() < 41));
    let next = delta.apply(Some(&mirror)).expect("it was made for this");
    let second_s = f64::from(before.frame_seconds()) * 25.0;
    assert_eq!(next.may_differ(&mirror, second_s), after.may_differ(&before, second_s));
    assert!(Arc::ptr_eq(&next.definitions, &mirror.definitions));
    for frame in (0..20).map(Frame) {
        assert!(Arc::ptr_eq(next.tables.at(frame), mirror.tables.at(frame)));
    }
    let nothing = SnapshotDelta::between(Some(&after), &original.snapshot());
    assert!(nothing.runs.is_empty() && nothing.effects.is_empty() && nothing.histories.is_empty());
}

#[test]
fn deltas_that_do_not_fit_are_refused() {
    let mut original = timeline();
    for _ in 0..10 {
        original.advance();
    }
    let first = original.snapshot();
    let whole = SnapshotDelta::between(None, &first);
    let mirror = whole.apply(None).expect("a whole snapshot");
    for _ in 0..10 {
        original.advance();
    }
    let good = SnapshotDelta::between(Some(&first), &original.snapshot());
    let refused = |change: fn(&mut SnapshotDelta), place: &'static str| {
        let mut bad = good.clone();
        assert!(bad.apply(Some(&mirror)).is_ok());
        change(&mut bad);
        let refusal = bad.apply(Some(&mirror)).map(drop).map_err(|error| error.place);
        assert_eq!(refusal, Err(place));
    };
    assert!(good.apply(None).is_err(), "there is nothing to put it into");
    refused(|delta| delta.horizon = Frame(u64::MAX), "horizon");
    refused(|delta| delta.valid_to = Frame(99), "horizon");
    refused(|delta| delta.horizon = delta.horizon.next(), "runs");
    refused(|delta| drop(delta.runs.remove(0)), "runs");
    refused(|delta| delta.runs[0].to = Frame(0), "runs");
    refused(|delta| delta.runs[0].base = DeltaBase::SameFrame, "runs");
    refused(|delta| delta.runs[0].entries.reverse(), "runs");
    refused(|delta| delta.runs[0].entries[0].0 = BodyId(u32::MAX), "runs");
    refused(|delta| delta.runs[0].entries[0].1.as_mut().unwrap().velocity.x = f32::NAN, "runs");
    refused(|delta| delta.doubts = vec![(BodyId(1), Frame(99), false)], "doubts");
    refused(|delta| delta.names = u32::MAX, "names");
    refused(|delta| delta.names = 3, "names");
    let history = HistoryDelta { body: BodyId(500), made: None, entries: Vec::new() };
    let mut bad = good.clone();
    bad.histories = vec![history];
    assert!(bad.apply(Some(&mirror)).is_err());
    refused(|delta| delta.area_m = 0.0, "area_m");
    let key = CommandKey { frame: Frame(3), source: 0, sequence: 0 };
    let mut bad = good.clone();
    bad.commands = vec![(Frame(4), vec![(key, Arc::new(Change::Release { body: BodyId(1) }))])];
    assert_eq!(bad.apply(Some(&mirror)).map(drop).map_err(|error| error.place), Err("commands"));
    refused(|delta| delta.environments = Some(Vec::new()), "environments");
    let mut whole = whole;
    whole.histories[3].entries[0].1.as_mut().expect("a body").gravity_scale = f32::NAN;
    assert_eq!(whole.apply(None).map(drop).map_err(|error| error.place), Err("histories"));
}
