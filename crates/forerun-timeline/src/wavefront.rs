//! Wavefront: one frame of work, the same for running ahead and for re-simulating.
//!
//! A frame beyond the horizon is guessed to be like the last one, as if the last step had been done again; where a body moved, the
//! guess is out of date. So a new frame is re-simulated like any other, and what is at rest costs nothing.

use std::collections::BTreeMap;
use std::sync::Arc;

use forerun_dynamics::step::{Group, advance, advance_touching};
use forerun_dynamics::{
    BodyId, BodyKind, BodyState, Environment, Observer, Stage, StepReport, StepScratch, Touches, Unobserved,
};

use crate::Frame;
use crate::affected::{Affected, Inputs, Mutation, affected};
use crate::areas::Until;
use crate::commanding::{Arrival, FrameEffects, ignored};
use crate::frame_table::Entry;
use crate::stale::Stale;
use crate::stats::Advance;
use crate::timeline::{Progress, Timeline};
use crate::touch_table::Told;

impl Timeline {
    /// Computes one frame: the earliest that is out of date, or else a new one while the lookahead has room. Between two calls all
    /// frames up to [`valid_to`](Timeline::valid_to) are true, and commands may come.
    pub fn advance(&mut self) -> Progress {
        self.advance_observed(&mut Unobserved)
    }

    /// As [`Timeline::advance`], with an observer of the stages of the step.
    pub fn advance_observed(&mut self, observer: &mut dyn Observer) -> Progress {
        // Here and not after the work, in which the display may have moved on.
        self.set_display(self.display());
        self.fit_memory();
        while let Some((frame, stale)) = self.stale.pop_first() {
            let out_of_date = self.out_of_date(frame, &stale);
            // Nothing is left to do where a change was taken back or came out as it was: the early cutoff.
            if !out_of_date.is_empty() {
                return Progress::Advanced(self.compute(frame, &stale, &out_of_date, observer));
            }
        }
        let horizon = self.horizon();
        if horizon >= self.display().plus(u64::from(self.settings.lookahead)) || !self.has_room() {
            return Progress::Idle;
        }
        let stale = self.stale_beyond_horizon();
        let out_of_date = self.out_of_date(horizon, &stale);
        Progress::Advanced(self.compute(horizon, &stale, &out_of_date, observer))
    }

    pub(crate) fn out_of_date(&self, frame: Frame, stale: &Stale) -> Vec<BodyId> {
        stale.out_of_date(self.table(frame), |body| self.definitions.body(body, frame))
    }

    /// What is out of date when the step from the horizon is guessed to give what the step before gave.
    fn stale_beyond_horizon(&self) -> Stale {
        let horizon = self.horizon();
        let mut stale = Stale::default();
        // None of the new frame's commands are in the guess.
        stale.touched.extend(self.log.bodies_at(horizon.next()));
        let gravity_changes = [horizon, horizon.next()].iter().any(|f| self.log.changes_gravity_at(*f));
        if self.recompute_all || gravity_changes || horizon == self.oldest() {
            stale.everyone = true;
            return stale;
        }
        let before = horizon.minus(1);
        stale.basis = Some(Arc::clone(self.table(before)));
        // Those of the last frame changed what the step before gave.
        for body in self.log.bodies_at(horizon) {
            stale.bodies.insert(body, self.definitions.body(body, before).cloned());
            stale.touched.insert(body);
        }
        for effect in self.effects.get(&horizon).into_iter().flat_map(|effects| effects.iter()) {
            stale.touched.extend(&effect.1.woken);
        }
        stale
    }

    /// Does the step that leaves `frame` for the bodies that follow from the out-of-date ones, and stores what it gives.
    fn compute(
        &mut self,
        frame: Frame,
        stale: &Stale,
        out_of_date: &[BodyId],
        observer: &mut dyn Observer,
    ) -> Advance {
        let arrival = frame.next();
        let table = Arc::clone(self.table(frame));
        let extended = frame == self.horizon();
        let stored = Arc::clone(if extended { &table } else { self.table(arrival) });
        let definitions = Arc::clone(&self.definitions);
        let inputs = Inputs {
            frame,
            table: &table,
            stale,
            definitions: &definitions,
            areas: &self.areas,
            effects: self.effects.get(&arrival).map(AsRef::as_ref),
            mutation: self.mutation,
        };
        let group = affected(&inputs, out_of_date, &mut self.scratch);
        observer.after(Stage::Collisions);

        let environment = definitions.environment(frame);
        let mut scratch = std::mem::take(&mut self.step_scratch);
        let (next, report, touches) = self.step((frame, &group), &environment, observer, &mut scratch);
        let is_last = arrival >= self.horizon();
        let arrived = Arrival {
            frame: arrival,
            log: &self.log,
            definitions: &definitions,
            stored: &stored,
            until: if is_last { Until::FurtherNotice } else { Until::NextFrame },
            ask_everybody: self.recompute_all,
        };
        let entries = entries(&group, next, out_of_date);
        self.step_scratch = scratch;
        let outdated = (stale.everyone || stale.all_touched).then(|| stored.touches());
        let told = touches.map(|touches| Told::new(&entries, &group, &touches, table.touches(), outdated));
        let mut effects = taken(&mut self.effects, arrival);
        self.stats.ignored -= ignored(&effects);
        let mut entries = arrived.apply_commands(entries, stale, &mut self.areas, &mut effects);
        self.stats.ignored += ignored(&effects);
        if let Mutation::Tolerance(tolerance) = self.mutation {
            entries.retain(|(body, state)| !nearly(stored.get(*body), state.as_ref(), tolerance));
        }
        arrived.visit(&entries, &mut self.areas);
        if !effects.is_empty() {
            Arc::make_mut(&mut self.effects).insert(arrival, Arc::new(effects));
        }

        let (mut new, changed) = stored.with_entries(&entries, &table);
        if let Some(told) = told {
            new = new.with_touches(&told, &table);
        }
        if extended {
            self.tables.push(new);
        } else {
            if !changed.is_empty() && !is_last {
                self.stale.entry(arrival).or_default().basis.get_or_insert(stored);
            }
            self.tables.set(arrival, new);
        }
        let due = group.members.iter().zip(&group.due).filter(|(_, due)| **due);
        let recomputed = due.filter(|(member, _)| member.body.kind != BodyKind::Fixed).count();
        let done = Advance {
            frame: arrival,
            recomputed: recomputed as u32,
            affected: changed.len() as u32,
            slices_max: report.slices_max,
            extended,
        };
        self.count(&done, report.quarantined);
        done
    }

    /// The next states of a group, and where that is recorded, who touched whom.
    fn step<'s>(
        &self,
        (frame, group): (Frame, &Affected),
        environment: &Environment,
        observer: &mut dyn Observer,
        scratch: &'s mut StepScratch,
    ) -> (&'s [BodyState], StepReport, Option<Touches>) {
        let step = Group { members: &group.members, pairs: &group.pairs, contacts: &group.contacts };
        if self.settings.record_contacts {
            let mut touches = Touches::default();
            let (next, report) = advance_touching(&step, environment, observer, &mut touches, scratch);
            if frame == self.oldest() && touches.resting.contains(&true) {
                touches = touches_of_all(&step, environment);
            }
            return (next, report, Some(touches));
        }
        let (next, report) = advance(&step, environment, observer, scratch);
        (next, report, None)
    }
}

/// What a step tells about touches when nothing counts as a fixpoint: the frame before may be none that tells.
fn touches_of_all(step: &Group, environment: &Environment) -> Touches {
    let mut members = step.members.to_vec();
    for member in &mut members {
        // The last frame of rest that is solved; nothing else reads the counter.
        member.state.rest = member.state.rest.min(environment.settings.rest_frames());
    }
    let mut touches = Touches::default();
    let step = Group { members: &members, ..*step };
    let _ = advance_touching(&step, environment, &mut Unobserved, &mut touches, &mut StepScratch::default());
    touches
}

/// The next states of the due members, and `None` for the out-of-date bodies that do not exist. Sorted.
fn entries(group: &Affected, next: &[BodyState], out_of_date: &[BodyId]) -> Vec<Entry> {
    let due = group.members.iter().zip(&group.due).zip(next).filter(|((_, due), _)| **due);
    let mut entries: Vec<Entry> = due.map(|((member, _), state)| (member.id, Some(*state))).collect();
    let missing: Vec<Entry> = out_of_date
        .iter()
        .filter(|body| entries.binary_search_by_key(*body, |(id, _)| *id).is_err())
        .map(|body| (*body, None))
        .collect();
    if !missing.is_empty() {
        entries.extend(missing);
        entries.sort_unstable_by_key(|(id, _)| *id);
    }
    entries
}

fn nearly(stored: Option<&BodyState>, new: Option<&BodyState>, tolerance: f32) -> bool {
    let (Some(a), Some(b)) = (stored, new) else { return stored.is_none() && new.is_none() };
    (a.position - b.position).length() < tolerance && (a.velocity - b.velocity).length() < tolerance
}

/// The effects of the commands of a frame, taken out. Forks and later edits share them: to touch them is to copy.
fn taken(effects: &mut Arc<BTreeMap<Frame, Arc<FrameEffects>>>, frame: Frame) -> FrameEffects {
    if !effects.contains_key(&frame) {
        return FrameEffects::default();
    }
    Arc::make_mut(effects).remove(&frame).map(Arc::unwrap_or_clone).unwrap_or_default()
}
