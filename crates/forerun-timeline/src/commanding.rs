//! Commanding: the commands of one frame act on the states that the step gave, and wake whoever is near.
//!
//! Rest is part of a body's state, and a resting island is not computed again while its members stay as they are. A command can take
//! away what such an island stands on without changing a member. So the rule, on states alone: every dynamic body whose swept
//! bound, before the commands, overlaps that of a commanded body before or after them, is not at rest at that frame.

use std::collections::BTreeMap;

use forerun_dynamics::{Body, BodyId, BodyState, bounds};
use forerun_geometry::Aabb;

use crate::Frame;
use crate::areas::{Areas, Until};
use crate::command::Change;
use crate::command_log::CommandLog;
use crate::definitions::Definitions;
use crate::effect::{body_after, state_after};
use crate::frame_table::{Entry, FrameTable};
use crate::stale::Stale;

/// What the commands to one body at one frame did.
#[derive(Clone, Debug, Default)]
pub(crate) struct Effect {
    /// The state before the commands, as the step left it, if the body was there: what is shown up to the frame.
    pub(crate) arrived: Option<BodyState>,
    /// Swept bound before the commands, if the body was there.
    before: Option<Aabb>,
    /// Swept bound after the commands, if the body is there.
    after: Option<Aabb>,
    /// Whether any of the commands was obeyed.
    obeyed: bool,
    /// Who is not at rest because of that. Sorted.
    pub(crate) woken: Vec<BodyId>,
    /// How many of the commands did nothing.
    pub(crate) ignored: u32,
}

impl Effect {
    /// As far as a display needs to know it.
    pub(crate) fn shown(arrived: Option<BodyState>) -> Effect {
        Effect { arrived, ..Effect::default() }
    }
}

/// By commanded body.
pub(crate) type FrameEffects = BTreeMap<BodyId, Effect>;

/// How many commands did nothing.
pub(crate) fn ignored(effects: &FrameEffects) -> u64 {
    effects.values().map(|effect| u64::from(effect.ignored)).sum()
}

/// A frame whose states come out of the step.
pub(crate) struct Arrival<'a> {
    /// The frame.
    pub(crate) frame: Frame,
    /// All commands.
    pub(crate) log: &'a CommandLog,
    /// What the bodies are.
    pub(crate) definitions: &'a Definitions,
    /// What is stored, for the bodies that were not advanced.
    pub(crate) stored: &'a FrameTable,
    /// Until when visits at the frame hold.
    pub(crate) until: Until,
    /// Whether the areas are not trusted to name who is near.
    pub(crate) ask_everybody: bool,
}

impl Arrival<'_> {
    /// Applies the commands of the frame to `entries`: the states of the advanced bodies, sorted, `None` where a body was expected
    /// and is not there. `effects` is what the commands did when the frame was last computed, and is brought up to date.
    pub(crate) fn apply_commands(
        &self,
        mut entries: Vec<Entry>,
        stale: &Stale,
        areas: &mut Areas,
        effects: &mut FrameEffects,
    ) -> Vec<Entry> {
        if self.log.changes_gravity_at(self.frame) {
            self.wake_everyone(&mut entries);
        }
        let commanded = self.log.bodies_at(self.frame);
        effects.retain(|body, _| commanded.contains(body));
        if commanded.is_empty() {
            return entries;
        }
        for (body, state) in &entries {
            areas.visit(*body, self.frame, self.bound(*body, state.as_ref()).as_ref(), self.until);
        }
        let mut entries = Entries { stepped: entries, commanded: BTreeMap::new() };
        for body in commanded {
            if stale.touched.contains(&body) || entries.get(body).is_some() {
                let state = entries.get(body).copied().flatten();
                let (state, effect) = self.act(body, state);
                entries.commanded.insert(body, state);
                effects.insert(body, effect);
            }
        }
        self.wake(&mut entries, areas, effects);
        entries.into_sorted()
    }

    /// The commands to one body act on its state.
    fn act(&self, id: BodyId, before: Option<BodyState>) -> (Option<BodyState>, Effect) {
        let mut effect = Effect { arrived: before, ..Effect::default() };
        let mut body = self.definitions.body(id, self.frame.minus(1)).cloned();
        let mut state = before;
        let environment = self.definitions.environment(self.frame);
        let bound = |body: &Body, state: &BodyState| bounds::swept_bound(body, state, &environment);
        effect.before = body.as_ref().zip(state.as_ref()).map(|(body, state)| bound(body, state));
        let def = self.definitions.def(id).map(AsRef::as_ref);
        for change in self.log.of_body_at(id, self.frame) {
            let Ok(next) = body_after(body.as_ref(), change, def) else {
                effect.ignored += 1;
                continue;
            };
            let next_state = match (&next, change, &state) {
                (None, ..) => Ok(None),
                (Some(_), Change::Add { def, .. }, _) => Ok(Body::new(def).ok().map(|(_, state)| state)),
                (Some(body), _, Some(state)) => state_after(body, state, change).map(Some),
                // A body that exists has a state.
                (Some(_), _, None) => Ok(None),
            };
            match next_state {
                Ok(next_state) => (body, state, effect.obeyed) = (next, next_state, true),
                Err(_) => effect.ignored += 1,
            }
        }
        effect.after = body.as_ref().zip(state.as_ref()).map(|(body, state)| bound(body, state));
        (state, effect)
    }

    /// Ends the rest of whoever is near a commanded body, and notes whom.
    fn wake(&self, entries: &mut Entries, areas: &Areas, effects: &mut FrameEffects) {
        let obeyed: Vec<BodyId> =
            effects.iter().filter(|(_, effect)| effect.obeyed).map(|(body, _)| *body).collect();
        for effect in effects.values_mut().filter(|effect| effect.obeyed) {
            let bounds: Vec<Aabb> = effect.before.into_iter().chain(effect.after).collect();
            let mut near = Vec::new();
            if self.ask_everybody || !areas.near(self.frame, &bounds, &mut near) {
                near = (0..self.definitions.names() as u32).map(BodyId).collect();
            }
            near.sort_unstable();
            near.dedup();
            near.retain(|id| {
                let state = entries.get(*id).map_or_else(|| self.stored.get(*id).copied(), |entry| *entry);
                let dynamic = self.definitions.body(*id, self.frame).is_some_and(|body| body.is_dynamic());
                let bound = self.bound(*id, state.as_ref());
                let meets = bound.is_some_and(|bound| bounds.iter().any(|other| other.overlaps(&bound)));
                // The commanded bodies themselves are not at rest in any case.
                dynamic && meets && obeyed.binary_search(id).is_err()
            });
            effect.woken = near;
        }
        for id in effects.values().flat_map(|effect| &effect.woken) {
            let state = entries.get(*id).map_or_else(|| self.stored.get(*id).copied(), |entry| *entry);
            if let Some(state) = state.filter(|state| state.rest != 0) {
                entries.commanded.insert(*id, Some(BodyState { rest: 0, ..state }));
            }
        }
    }

    fn wake_everyone(&self, entries: &mut [Entry]) {
        for (id, state) in entries {
            let dynamic = self.definitions.body(*id, self.frame).is_some_and(|body| body.is_dynamic());
            if let Some(state) = state.as_mut().filter(|_| dynamic) {
                state.rest = 0;
            }
        }
    }

    /// The swept bound of a body that has a state at the frame; the same however long it has been at rest.
    fn bound(&self, id: BodyId, state: Option<&BodyState>) -> Option<Aabb> {
        let body = self.definitions.body(id, self.frame)?;
        let state = BodyState { rest: 0, ..*state? };
        Some(bounds::swept_bound(body, &state, &self.definitions.environment(self.frame)))
    }

    /// Tells the areas where the bodies are now.
    pub(crate) fn visit(&self, entries: &[Entry], areas: &mut Areas) {
        let environment = self.definitions.environment(self.frame);
        for (id, state) in entries {
            let bound = self.definitions.body(*id, self.frame).zip(state.as_ref());
            let bound = bound.map(|(body, state)| bounds::swept_bound(body, state, &environment));
            areas.visit(*id, self.frame, bound.as_ref(), self.until);
        }
    }
}

/// States at the frame: as the step left them, and as the commands changed them.
struct Entries {
    /// Sorted by body.
    stepped: Vec<Entry>,
    /// In place of the stepped ones.
    commanded: BTreeMap<BodyId, Option<BodyState>>,
}

impl Entries {
    /// The state of a body; `None` if it was neither advanced nor commanded.
    fn get(&self, body: BodyId) -> Option<&Option<BodyState>> {
        self.commanded.get(&body).or_else(|| {
            let index = self.stepped.binary_search_by_key(&body, |(id, _)| *id).ok()?;
            Some(&self.stepped[index].1)
        })
    }

    fn into_sorted(mut self) -> Vec<Entry> {
        let mut others = Vec::new();
        for (body, state) in self.commanded {
            match self.stepped.binary_search_by_key(&body, |(id, _)| *id) {
                Ok(index) => self.stepped[index].1 = state,
                Err(_) => others.push((body, state)),
            }
        }
        if !others.is_empty() {
            self.stepped.extend(others);
            self.stepped.sort_unstable_by_key(|(id, _)| *id);
        }
        self.stepped
    }
}
