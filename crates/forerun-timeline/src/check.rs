//! Check: random edits on a timeline, and after them the question whether every state of every body has the bits of a full simulation.
//! For tests and the command line.

use std::collections::BTreeMap;

use forerun_dynamics::{BodyDef, Environment};

use crate::affected::Mutation;
pub use crate::random_change::{Random, random_change};
use crate::reference::run;
pub use crate::reference::{FullRunError, Mismatch, full_run, mismatches};
use crate::{Change, Command, CommandKey, Frame, Order, Timeline, TimelineSettings};

/// What is to be checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckSettings {
    /// How many random edits are made, one after the other.
    pub edits: u32,
    /// From which all that is random follows.
    pub seed: u64,
    /// How many frames are computed ahead of the display, and kept behind it.
    pub frames: u32,
    /// How many frames pass, and the display with them, before the first edit: for a scene that has to settle. Edits act after it.
    pub settle: u32,
    /// How many frames the display moves on after each edit.
    pub display_step: u32,
    /// The reference computes once for so many edits, and everything is compared then. 1 or more; more is faster, and finds the same but
    /// cannot say after which of the edits.
    pub compare_every: u32,
    /// A rule left out, to show that the check notices.
    #[doc(hidden)]
    pub mutation: Mutation,
}

impl Default for CheckSettings {
    fn default() -> Self {
        CheckSettings {
            edits: 20,
            seed: 1,
            frames: 200,
            settle: 0,
            display_step: 0,
            compare_every: 1,
            mutation: Mutation::None,
        }
    }
}

/// A moment in a check: who has a clock may look at it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckMoment {
    /// The scene has settled: everything is true, and nothing was edited.
    Settled,
    /// An edit is about to be made.
    EditBegins,
    /// All frames are true again.
    EditEnds {
        /// From the edit's to the horizon: what a full re-simulation would compute. 0 when the edit was refused and nothing changed.
        frames: u64,
    },
    /// The reference has heard of the edits since it was last compared, and is about to compute.
    FullBegins,
    /// The reference is done.
    FullEnds {
        /// From that of the earliest of these edits to the horizon; 0 when there were none.
        frames: u64,
    },
}

/// What a check found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CheckReport {
    /// Body-frames whose bits differ from the full run, after each edit (or so many as are compared at once) and at the end.
    pub mismatches: u64,
    /// The first of them.
    pub first_mismatch: Option<Mismatch>,
    /// Body-frames that the edits truly changed.
    pub affected: u64,
    /// Body-frames that were computed again for it.
    pub recomputed: u64,
    /// Body-frames that a full re-simulation from each edit on would have computed.
    pub full: u64,
}

/// Makes random edits on a timeline of the bodies and compares it with full simulations. Calls `at` at the moments of each edit.
///
/// # Errors
/// When the environment or a body is not possible, or a full run refuses a command that the timeline accepted: then nothing is shown.
pub fn check(
    bodies: &[BodyDef],
    environment: Environment,
    settings: &CheckSettings,
    at: &mut dyn FnMut(CheckMoment),
) -> Result<CheckReport, FullRunError> {
    let mut session = Session::new(bodies, environment, settings)?;
    at(CheckMoment::Settled);
    session.compare();
    let batch = settings.compare_every.max(1);
    for edit in 1..=settings.edits {
        session.edit(at);
        if edit % batch == 0 || edit == settings.edits {
            session.hear()?;
            at(CheckMoment::FullBegins);
            run(&mut session.reference);
            let horizon = session.reference.horizon();
            let frames = session.earliest.take().map_or(0, |frame| horizon.since(frame) + 1);
            at(CheckMoment::FullEnds { frames });
            session.compare();
        }
    }
    // The reference was edited too, and began where the timeline had settled: compare with one that knew everything from the start.
    let commands = session.in_force.into_iter().map(|(key, change)| Command { key, change });
    let frames = session.timeline.horizon().0 as u32;
    session.report.add_fresh(&session.timeline, full_run(bodies, commands, environment, frames))?;
    let edits = session.timeline.stats().edits;
    Ok(CheckReport { affected: edits.affected, recomputed: edits.recomputed, ..session.report })
}

/// A check under way.
struct Session {
    settings: CheckSettings,
    random: Random,
    timeline: Timeline,
    /// Computes everything after the earliest edit that it hears of.
    reference: Timeline,
    /// What the reference has not heard of yet: commands given, replaced or, where there is none any more, taken back.
    unheard: BTreeMap<CommandKey, Option<Change>>,
    /// The frame of the earliest of those.
    earliest: Option<Frame>,
    /// All commands that were given and not taken back.
    in_force: BTreeMap<CommandKey, Change>,
    report: CheckReport,
}

impl Session {
    fn new(
        bodies: &[BodyDef],
        environment: Environment,
        settings: &CheckSettings,
    ) -> Result<Session, FullRunError> {
        let frames = TimelineSettings {
            lookahead: settings.frames,
            past: settings.frames,
            ..TimelineSettings::default()
        };
        let mut timeline = Timeline::new(bodies, environment, frames).map_err(FullRunError::Start)?;
        timeline.mutate(settings.mutation);
        // What has settled is not computed twice: the full run at the end says whether it is right.
        let unsettled = (settings.settle == 0).then(|| timeline.fork());
        run(&mut timeline);
        for display in 1..=settings.settle {
            timeline.set_display(Frame(u64::from(display)));
            run(&mut timeline);
        }
        let mut reference = unsettled.unwrap_or_else(|| timeline.fork());
        // It hears of edits later than the timeline does, and has to know the frames on which they act.
        let late = settings.display_step.saturating_mul(settings.compare_every);
        reference.settings.past = settings.frames.saturating_add(late);
        reference.recompute_all();
        run(&mut reference);
        Ok(Session {
            settings: *settings,
            random: Random::new(settings.seed),
            timeline,
            reference,
            unheard: BTreeMap::new(),
            earliest: None,
            in_force: BTreeMap::new(),
            report: CheckReport::default(),
        })
    }

    /// Makes an edit, lets the timeline work it off, and moves the display on.
    fn edit(&mut self, at: &mut dyn FnMut(CheckMoment)) {
        let order = self.random_order();
        at(CheckMoment::EditBegins);
        let heard = match order {
            Order::Undo => self.timeline.undo(),
            Order::Redo => self.timeline.redo(),
            Order::Submit(Command { key, .. })
            | Order::Replace(Command { key, .. })
            | Order::Retract(key) => self.timeline.obey(order).map(|()| key),
        };
        run(&mut self.timeline);
        // What is refused changed nothing.
        let Ok(key) = heard else {
            at(CheckMoment::EditEnds { frames: 0 });
            return;
        };
        at(CheckMoment::EditEnds { frames: self.timeline.horizon().since(key.frame) + 1 });
        self.note(key);
        let display = self.timeline.display().plus(u64::from(self.settings.display_step));
        self.timeline.set_display(display);
        run(&mut self.timeline);
    }

    /// Something new, or, of ten edits, three times something about an earlier one.
    fn random_order(&mut self) -> Order {
        let first = self.timeline.oldest().0.max(u64::from(self.settings.settle)) + 1;
        let kept = self.in_force.range(CommandKey { frame: Frame(first), source: 0, sequence: 0 }..);
        let earlier: Vec<CommandKey> = kept.map(|(key, _)| *key).collect();
        let pick = earlier.get(self.random.below(earlier.len() as u64) as usize).copied();
        match (self.random.below(20), pick) {
            (0..2, Some(key)) => Order::Retract(key),
            (2..4, Some(key)) => {
                let change = random_change(&mut self.timeline, key.frame, &mut self.random);
                Order::Replace(Command { key, change })
            }
            (4, Some(_)) => Order::Undo,
            (5, Some(_)) => Order::Redo,
            _ => {
                let frame = Frame(first + self.random.below(self.timeline.horizon().0 + 1 - first));
                let key = CommandKey { frame, source: 0, sequence: self.timeline.next_sequence() };
                let change = random_change(&mut self.timeline, frame, &mut self.random);
                Order::Submit(Command { key, change })
            }
        }
    }

    /// Notes what an edit made of a command.
    fn note(&mut self, key: CommandKey) {
        self.report.full += self.timeline.stats().last_edit.full;
        self.earliest = Some(self.earliest.map_or(key.frame, |frame| frame.min(key.frame)));
        let change = self.timeline.log.get(&key).cloned();
        match change.clone() {
            Some(change) => self.in_force.insert(key, change),
            None => self.in_force.remove(&key),
        };
        self.unheard.insert(key, change);
    }

    /// Tells the reference what it has not heard of yet.
    fn hear(&mut self) -> Result<(), FullRunError> {
        while self.reference.names() < self.timeline.names() {
            self.reference.reserve_body();
        }
        let unheard = std::mem::take(&mut self.unheard);
        for key in unheard.keys() {
            self.reference.retract(key);
        }
        let given = unheard.into_iter().filter_map(|(key, change)| Some(Command { key, change: change? }));
        self.reference.submit_all(given).map_err(FullRunError::Command)?;
        self.reference.set_display(self.timeline.display());
        Ok(())
    }

    fn compare(&mut self) {
        self.report.add(&self.timeline, &self.reference);
    }
}

impl CheckReport {
    fn add(&mut self, timeline: &Timeline, reference: &Timeline) {
        let (count, first) = mismatches(timeline, reference);
        // Frames that only one of them has do not agree either.
        self.mismatches += count + timeline.horizon().0.abs_diff(reference.horizon().0);
        self.first_mismatch = self.first_mismatch.or(first);
    }

    /// A comparison that cannot be made is no agreement.
    fn add_fresh(
        &mut self,
        timeline: &Timeline,
        fresh: Result<Timeline, FullRunError>,
    ) -> Result<(), FullRunError> {
        self.add(timeline, &fresh?);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CommandError;
    use forerun_dynamics::BodyId;
    use forerun_geometry::Vec3;
    use forerun_geometry::shape::{Shape, Sphere};

    #[test]
    fn a_full_run_that_refuses_a_command_is_an_error_and_no_agreement() {
        let bodies = [BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 }))];
        let timeline = full_run(&bodies, [], Environment::default(), 5).unwrap();
        let key = CommandKey { frame: Frame(2), source: 0, sequence: 0 };
        let unknown = Command { key, change: Change::Release { body: BodyId(u32::MAX) } };
        let mut report = CheckReport::default();
        let refused = full_run(&bodies, [unknown], Environment::default(), 5);
        assert_eq!(
            report.add_fresh(&timeline, refused),
            Err(FullRunError::Command(CommandError::UnknownBody(BodyId(u32::MAX))))
        );
        // The same with a run that fell differently is seen.
        let push = Change::Push { body: BodyId(0), impulse: Vec3::X, at_point: None };
        let pushed = full_run(&bodies, [Command { key, change: push }], Environment::default(), 5);
        report.add_fresh(&timeline, pushed).unwrap();
        assert_eq!(report.mismatches, 4);
    }
}
