//! Oracle: the same commands, known from the start, every body computed in every frame; what is still kept is compared bit for bit.
//!
//! The physics forgets its past, and commands with it. So the log is put together from forks that are taken on the way: each says which
//! commands stand after its oldest frame, and what stands at or before that can no longer change.

use std::collections::BTreeMap;

use forerun::timeline::Progress;
use forerun::timeline::check::{Mismatch, mismatches};
use forerun::{BodyDef, Change, Command, CommandKey, Environment, Frame, Timeline, TimelineSettings};

use crate::failure::Failure;

/// Frames computed at a time, so that no more than the compared ones are kept.
const STRIDE: u32 = 100;

/// All commands that ever stood, without those that were taken back.
#[derive(Clone, Debug, Default)]
pub(super) struct Log {
    commands: BTreeMap<CommandKey, Change>,
}

impl Log {
    /// Learns from a fork which commands stand.
    pub(super) fn learn(&mut self, timeline: &Timeline) {
        let oldest = timeline.oldest();
        self.commands.retain(|key, _| key.frame <= oldest);
        self.commands.extend(timeline.commands().map(|(key, change)| (*key, change.clone())));
    }

    pub(super) fn len(&self) -> usize {
        self.commands.len()
    }
}

/// What the comparison found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Compared {
    pub(super) frames: u64,
    pub(super) mismatches: u64,
    pub(super) first: Option<Mismatch>,
}

/// Compares a timeline, whose frames are all computed, with a full simulation.
pub(super) fn compare(
    timeline: &Timeline,
    log: &Log,
    bodies: &[BodyDef],
    environment: Environment,
) -> Result<Compared, Failure> {
    let (oldest, horizon) = (timeline.oldest(), timeline.horizon());
    let past = horizon.since(oldest) as u32;
    let settings = TimelineSettings { lookahead: STRIDE, past, ..TimelineSettings::default() };
    let differs =
        |error: &dyn std::fmt::Display| Failure::Check(format!("no full run to compare with: {error}"));
    let mut reference = Timeline::new(bodies, environment, settings).map_err(|error| differs(&error))?;
    reference.recompute_all();
    while reference.names() < timeline.names() {
        reference.reserve_body();
    }
    for (key, change) in &log.commands {
        let command = Command { key: *key, change: change.clone() };
        reference.submit(command).map_err(|error| differs(&error))?;
    }
    let mut display = Frame(0);
    loop {
        while reference.horizon() < horizon && reference.advance() != Progress::Idle {}
        if reference.horizon() >= horizon {
            break;
        }
        display = display.plus(u64::from(STRIDE));
        reference.set_display(display);
    }
    let (count, first) = mismatches(timeline, &reference);
    let from = oldest.max(reference.oldest());
    Ok(Compared { frames: horizon.since(from) + 1, mismatches: count, first })
}

#[cfg(test)]
mod tests {
    use super::*;
    use forerun::{BodyId, Shape, Sphere, Vec3};

    fn push(body: u32) -> Change {
        Change::Push { body: BodyId(body), impulse: Vec3::Y * 900.0, at_point: None }
    }

    #[test]
    fn a_log_that_was_put_together_from_forks_gives_the_same_bits_and_one_that_lacks_a_command_does_not() {
        let ball = |x: f32| BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 })).at(Vec3::X * x);
        let bodies = [ball(0.0), ball(0.9), ball(5.0)];
        let settings = TimelineSettings { lookahead: 20, past: 60, ..TimelineSettings::default() };
        let environment = Environment::default();
        let mut timeline = Timeline::new(&bodies, environment, settings).expect("plain balls");
        let mut log = Log::default();
        for display in 1..400 {
            timeline.set_display(Frame(display));
            if display % 7 == 0 {
                let late = Frame(display).minus(5);
                let key = timeline.change(late, push(display as u32 % 3)).expect("a plain change");
                if display % 3 == 0 {
                    assert!(timeline.retract(&key));
                }
            }
            while timeline.advance() != Progress::Idle {}
            if display % 20 == 0 {
                log.learn(&timeline);
            }
        }
        log.learn(&timeline);
        let compared = compare(&timeline, &log, &bodies, environment).expect("a full run");
        assert_eq!((compared.frames, compared.mismatches), (81, 0), "{compared:?}");
        assert_eq!(log.len(), 38);
        let first = *log.commands.keys().next().expect("commands");
        log.commands.remove(&first);
        assert!(compare(&timeline, &log, &bodies, environment).expect("a full run").mismatches > 0);
    }
}
