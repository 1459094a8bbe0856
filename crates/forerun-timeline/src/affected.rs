//! Affected: the closed group of bodies that the out-of-date ones reach in a step, found without asking the others.
//!
//! A body that is not out of date has to be advanced again when it touches, or touched, one that has to. So the group is the
//! closure, over real contacts, of
//! - the out-of-date bodies;
//! - those that an out-of-date body touched as it was before: its old island. The rest of that island follows: what did not
//!   change touches still what it touched;
//! - those that were woken by the commands of a body in the group.
//!
//! Whoever is not in the group neither touches nor touched a body in it, so its next state is the stored one. Both questions are
//! answered from states at the frame alone: absence of others is checked before anything is solved.
//!
//! Fixed and kinematic bodies are in the group where a dynamic member may reach them; they join nobody to it. But one that is out of
//! date concerns all that its old or new bound reaches, as the step may look at it more often than once.

use std::sync::Arc;

use forerun_dynamics::bounds::Prospect;
use forerun_dynamics::broad_phase::{Bound, BroadPhase};
use forerun_dynamics::narrow_phase::{Contact, NarrowPhase, Outlook};
use forerun_dynamics::{BodyId, Environment, Member};
use forerun_geometry::Aabb;

use crate::Frame;
use crate::areas::Areas;
use crate::commanding::FrameEffects;
use crate::definitions::Definitions;
use crate::frame_table::{FrameTable, same_entry};
use crate::stale::{Stale, same_body};

/// What is known when a step is to be done (again).
#[derive(Clone, Copy)]
pub(crate) struct Inputs<'a, 'b> {
    /// The frame that the step leaves.
    pub(crate) frame: Frame,
    /// The states there.
    pub(crate) table: &'a Arc<FrameTable>,
    /// What is out of date.
    pub(crate) stale: &'a Stale,
    /// What the bodies are.
    pub(crate) definitions: &'a Definitions,
    /// Who is near.
    pub(crate) areas: &'b Areas,
    /// What the commands at the end of the step did as it was before, if there are any.
    pub(crate) effects: Option<&'b FrameEffects>,
    /// A rule left out, to show that the tests miss it.
    pub(crate) mutation: Mutation,
}

/// A rule that is left out on purpose, to show that tests notice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[doc(hidden)]
pub enum Mutation {
    /// All rules hold.
    #[default]
    None,
    /// Those that an out-of-date body used to touch are left alone.
    NoOldIsland,
    /// Those that an out-of-date body newly touches are left alone.
    NoNewcomers,
    /// A body that a command woke before it was changed sleeps or wakes on as it did.
    NoWaking,
    /// Pairs and contacts reach the step in the order in which they were found.
    Unsorted,
    /// States that differ less than this (m, m/s) are taken to be equal.
    Tolerance(f32),
}

/// A closed group, ready to be advanced.
#[derive(Debug)]
pub(crate) struct Affected<'a> {
    /// Sorted by id. Those that are only in reach come out as they went in.
    pub(crate) members: Vec<Member<'a>>,
    /// By member: whether it has to be advanced, and is not only in reach of those that have.
    pub(crate) due: Vec<bool>,
    /// Pairs of members whose bounds overlap, sorted.
    pub(crate) pairs: Vec<(u32, u32)>,
    /// Contacts between members.
    pub(crate) contacts: Vec<Contact>,
}

/// A body that the search has met.
#[derive(Clone, Copy, Debug)]
struct Met<'a> {
    member: Member<'a>,
    prospect: Prospect,
    /// Has to be advanced.
    due: bool,
    /// Fixed or kinematic, and a due body may reach it.
    in_reach: bool,
    /// All its pairs are known.
    looked: bool,
}

impl Met<'_> {
    fn is_dynamic(&self) -> bool {
        self.member.body.is_dynamic()
    }

    fn bound(&self) -> Bound {
        Bound { aabb: self.prospect.bound, dynamic: self.is_dynamic() }
    }
}

/// Index by body into what was met. Kept between steps, so that a small step costs nothing for the others.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    /// Index plus 1; 0 is not met.
    met_index: Vec<u32>,
    broad_phase: BroadPhase,
    narrow_phase: NarrowPhase,
}

impl Clone for Scratch {
    /// An empty one: between steps there is nothing in it, and a fork is not to pay for its size.
    fn clone(&self) -> Scratch {
        Scratch::default()
    }
}

/// Finds the group that follows from `out_of_date` (sorted).
pub(crate) fn affected<'a>(
    inputs: &Inputs<'a, '_>,
    out_of_date: &[BodyId],
    scratch: &mut Scratch,
) -> Affected<'a> {
    scratch.met_index.resize(inputs.definitions.names().max(scratch.met_index.len()), 0);
    let mut search = Search {
        inputs,
        environment: inputs.definitions.environment(inputs.frame),
        scratch,
        met: Vec::new(),
        pairs: Vec::new(),
        contacts: Vec::new(),
    };
    let mut frontier: Vec<u32> = Vec::new();
    for body in out_of_date {
        search.join(*body, &mut frontier);
    }
    for body in out_of_date {
        search.join_woken(*body, &mut frontier);
    }
    let mut next = Vec::new();
    search.look_around(&frontier, &mut next);
    if inputs.mutation == Mutation::NoNewcomers {
        for index in next.drain(..) {
            search.met[index as usize].due = false;
        }
    }
    if !inputs.stale.everyone && inputs.mutation != Mutation::NoOldIsland {
        search.join_old_partners(out_of_date, &mut next);
    }
    while !next.is_empty() {
        frontier = std::mem::take(&mut next);
        let mut asked = 0;
        while asked < frontier.len() {
            let id = search.met[frontier[asked] as usize].member.id;
            search.join_woken(id, &mut frontier);
            asked += 1;
        }
        search.look_around(&frontier, &mut next);
    }
    search.finish()
}

struct Search<'a, 'b> {
    inputs: &'b Inputs<'a, 'b>,
    environment: Environment,
    scratch: &'b mut Scratch,
    met: Vec<Met<'a>>,
    /// Pairs of indices into `met`, lower id first, each found once.
    pairs: Vec<(u32, u32)>,
    /// As `pairs`: `first` and `second` are indices into `met`.
    contacts: Vec<Contact>,
}

impl<'a> Search<'a, '_> {
    /// The index of a body among those met; `None` if it does not exist at the frame.
    fn meet(&mut self, id: BodyId) -> Option<u32> {
        let slot = id.0 as usize;
        if self.scratch.met_index[slot] != 0 {
            return Some(self.scratch.met_index[slot] - 1);
        }
        let state = *self.inputs.table.get(id)?;
        let body = self.inputs.definitions.body(id, self.inputs.frame)?;
        let prospect = Prospect::new(body, &state, &self.environment);
        let member = Member { id, body, state };
        self.met.push(Met { member, prospect, due: false, in_reach: false, looked: false });
        self.scratch.met_index[slot] = self.met.len() as u32;
        Some(self.met.len() as u32 - 1)
    }

    /// A body has to be advanced: `frontier` gets it if that is news.
    fn join(&mut self, id: BodyId, frontier: &mut Vec<u32>) {
        if let Some(index) = self.meet(id) {
            self.join_met(index, frontier);
        }
    }

    fn join_met(&mut self, index: u32, frontier: &mut Vec<u32>) {
        let met = &mut self.met[index as usize];
        if !met.due {
            met.due = true;
            frontier.push(index);
        }
    }

    /// Whom the commands to a member woke, its new state may not wake: their next states are open again.
    fn join_woken(&mut self, id: BodyId, frontier: &mut Vec<u32>) {
        let inputs = *self.inputs;
        if inputs.mutation == Mutation::NoWaking {
            return;
        }
        if let Some(effect) = inputs.effects.and_then(|effects| effects.get(&id)) {
            for woken in &effect.woken {
                self.join(*woken, frontier);
            }
        }
    }

    /// Meets everybody near the given bounds (or just everybody, where that is as cheap) and the bodies themselves that `ids` starts
    /// with; their indices, sorted by id.
    fn meet_near(&mut self, bounds: &[Aabb], mut ids: Vec<BodyId>) -> Vec<u32> {
        let others = self.inputs.table.population().saturating_sub(self.met.len());
        let listed = others > bounds.len() && self.inputs.areas.near(self.inputs.frame, bounds, &mut ids);
        if listed {
            ids.sort_unstable();
            ids.dedup();
        } else {
            ids = self.inputs.table.iter().map(|(id, _)| id).collect();
        }
        ids.into_iter().filter_map(|id| self.meet(id)).collect()
    }

    /// Finds what the frontier touches; those that join by it go to `next`. Each pair is looked at once: when the first of its
    /// bodies is in the frontier.
    fn look_around(&mut self, frontier: &[u32], next: &mut Vec<u32>) {
        let reach: Vec<Aabb> =
            frontier.iter().map(|index| self.met[*index as usize].prospect.bound).collect();
        let ids = frontier.iter().map(|index| self.met[*index as usize].member.id).collect();
        let mut around = self.meet_near(&reach, ids);
        around.retain(|index| !self.met[*index as usize].looked);
        for index in frontier {
            self.met[*index as usize].looked = true;
        }
        let met = |index: &u32| &self.met[*index as usize];
        let bounds: Vec<Bound> = around.iter().map(|index| met(index).bound()).collect();
        let members: Vec<Member> = around.iter().map(|index| met(index).member).collect();
        let prospects: Vec<Prospect> = around.iter().map(|index| met(index).prospect).collect();
        // Those that were looked at before are not around: who is looked at is in the frontier.
        let in_frontier: Vec<bool> = around.iter().map(|index| met(index).looked).collect();
        let mut pairs = Vec::new();
        self.scratch.broad_phase.overlapping_pairs(&bounds, &mut pairs);
        pairs.retain(|(a, b)| in_frontier[*a as usize] || in_frontier[*b as usize]);
        let outlook = Outlook { members: &members, prospects: &prospects, environment: &self.environment };
        let mut contacts = Vec::new();
        self.scratch.narrow_phase.find_contacts(&outlook, &pairs, &mut contacts);

        let met_of = |local: u32| around[local as usize];
        for (a, b) in &mut pairs {
            let ends = (*a as usize, *b as usize);
            (*a, *b) = (met_of(*a), met_of(*b));
            if bounds[ends.0].dynamic != bounds[ends.1].dynamic {
                let (moved, other) = if bounds[ends.0].dynamic { (*a, *b) } else { (*b, *a) };
                self.reach(moved, other, next);
            }
        }
        for contact in &mut contacts {
            let ends = (contact.first as usize, contact.second as usize);
            (contact.first, contact.second) = (met_of(contact.first), met_of(contact.second));
            if bounds[ends.0].dynamic && bounds[ends.1].dynamic && in_frontier[ends.0] != in_frontier[ends.1]
            {
                self.join_met(contact.first, next);
                self.join_met(contact.second, next);
            }
        }
        keep(&mut self.pairs, pairs);
        keep(&mut self.contacts, contacts);
    }

    /// The bounds of a dynamic body and one that is not overlap, and at least one of them is due: what follows for the other.
    fn reach(&mut self, dynamic: u32, other: u32, next: &mut Vec<u32>) {
        if self.met[dynamic as usize].due {
            self.met[other as usize].in_reach = true;
        }
        if self.met[other as usize].due {
            self.join_met(dynamic, next);
        }
    }

    /// Those that the out-of-date bodies, as they were before, touched; of fixed and kinematic ones, reached.
    fn join_old_partners(&mut self, out_of_date: &[BodyId], next: &mut Vec<u32>) {
        if self.met.len() == self.inputs.table.population()
            && self.met.iter().all(|met| met.due || !met.is_dynamic())
        {
            return;
        }
        let mut list: Vec<Met> = out_of_date.iter().filter_map(|id| self.old_inputs(*id)).collect();
        let reach: Vec<Aabb> = list.iter().map(|old| old.prospect.bound).collect();
        for index in self.meet_near(&reach, Vec::new()) {
            let met = self.met[index as usize];
            if met.is_dynamic() && !met.due {
                list.push(met);
            }
        }
        if list.len() == reach.len() {
            return;
        }
        // The old ones are due, the others are not.
        list.sort_unstable_by_key(|met| met.member.id);
        let bounds: Vec<Bound> = list.iter().map(Met::bound).collect();
        let members: Vec<Member> = list.iter().map(|met| met.member).collect();
        let prospects: Vec<Prospect> = list.iter().map(|met| met.prospect).collect();
        let mut pairs = Vec::new();
        self.scratch.broad_phase.overlapping_pairs(&bounds, &mut pairs);
        pairs.retain(|(a, b)| list[*a as usize].due != list[*b as usize].due);
        let (touching, reached): (Vec<_>, Vec<_>) =
            pairs.iter().partition(|(a, b)| bounds[*a as usize].dynamic && bounds[*b as usize].dynamic);
        let outlook = Outlook { members: &members, prospects: &prospects, environment: &self.environment };
        let mut contacts = Vec::new();
        self.scratch.narrow_phase.find_contacts(&outlook, &touching, &mut contacts);
        let touched = contacts.iter().map(|contact| (contact.first, contact.second));
        for (a, b) in reached.into_iter().chain(touched) {
            let partner = if list[a as usize].due { b } else { a };
            self.join(list[partner as usize].member.id, next);
        }
    }

    /// An out-of-date body as it was when the next frame was computed, if it was there and not as it is now.
    fn old_inputs(&self, id: BodyId) -> Option<Met<'a>> {
        let Inputs { frame, table, stale, definitions, .. } = *self.inputs;
        let state = stale.old_table(table).get(id)?;
        let now = definitions.body(id, frame);
        let body = stale.bodies.get(&id).map_or(now, Option::as_ref)?;
        if same_entry(Some(state), table.get(id)) && same_body(Some(body), now) {
            return None;
        }
        let prospect = Prospect::new(body, state, &self.environment);
        let member = Member { id, body, state: *state };
        Some(Met { member, prospect, due: true, in_reach: false, looked: false })
    }

    /// The members in the order of their ids, and what is between them.
    fn finish(mut self) -> Affected<'a> {
        let is_member = |met: &Met| met.due || met.in_reach;
        let mut order: Vec<u32> =
            (0..self.met.len() as u32).filter(|i| is_member(&self.met[*i as usize])).collect();
        // Stable sorts: what is in order already, as mostly, costs one look.
        order.sort_by_key(|index| self.met[*index as usize].member.id);
        let mut place = vec![u32::MAX; self.met.len()];
        for (member, index) in order.iter().enumerate() {
            place[*index as usize] = member as u32;
        }
        let placed = |index: u32| place[index as usize];
        self.pairs.retain_mut(|(a, b)| {
            (*a, *b) = (placed(*a), placed(*b));
            *a != u32::MAX && *b != u32::MAX
        });
        let sorted = self.inputs.mutation != Mutation::Unsorted;
        if sorted {
            self.pairs.sort();
        }
        self.contacts.retain_mut(|contact| {
            (contact.first, contact.second) = (placed(contact.first), placed(contact.second));
            contact.first != u32::MAX && contact.second != u32::MAX
        });
        // Several manifolds of a pair stay in their order.
        if sorted {
            self.contacts.sort_by_key(|contact| (contact.first, contact.second));
        }
        for met in &self.met {
            self.scratch.met_index[met.member.id.0 as usize] = 0;
        }
        Affected {
            members: order.iter().map(|index| self.met[*index as usize].member).collect(),
            due: order.iter().map(|index| self.met[*index as usize].due).collect(),
            pairs: self.pairs,
            contacts: self.contacts,
        }
    }
}

/// Adds to what is kept; mostly there is only one round, and then nothing is moved.
fn keep<T>(kept: &mut Vec<T>, mut found: Vec<T>) {
    if kept.is_empty() {
        *kept = found;
    } else {
        kept.append(&mut found);
    }
}
