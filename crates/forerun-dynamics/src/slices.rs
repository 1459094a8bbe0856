//! Slices: islands, packed into batches, through their frame in one or more parts, each with contacts of its own.

use std::ops::Range;

use forerun_geometry::{Aabb, Vec3};
use rayon::prelude::*;

use crate::bounds::swept_bound;
use crate::narrow_phase::{Contact, find_contacts};
use crate::plan::{Plan, half_thickness, pack};
use crate::solver::{Batch, Ends, rest_after_slices};
use crate::step::{Group, Member};
use crate::touch::Ledger;
use crate::{Body, BodyState, Environment, Observer, Stage};

/// An overlap that grows by less than this is never too deep. Metres.
const DEEP_M: f32 = 0.001;

/// Memory for batches.
#[derive(Debug, Default)]
pub(crate) struct SliceScratch {
    batches: Vec<Batch<'static>>,
    packed: Vec<Range<usize>>,
}

/// Does the frame of some islands in `count` slices, each with contacts of its own.
pub(crate) struct Slicer<'a> {
    pub(crate) group: &'a Group<'a>,
    pub(crate) environment: &'a Environment,
    pub(crate) plan: &'a Plan,
    pub(crate) count: u32,
}

/// Where the states of a run go, and what it did.
pub(crate) struct Run<'a> {
    pub(crate) observer: &'a mut dyn Observer,
    /// By member of the group.
    pub(crate) next: &'a mut [BodyState],
    /// Where somebody asks for touches.
    pub(crate) notes: Option<Ledger>,
    /// Islands that ended too deep and may still be cut finer.
    pub(crate) too_deep: Vec<u32>,
}

/// What a batch is made from, slice after slice.
struct Part<'a> {
    /// At the start of the slice.
    members: Vec<Member<'a>>,
    sources: Vec<u32>,
    /// How many of the members yield; they come first.
    dynamic: usize,
    /// Indices into the members, in the order of the bodies.
    pairs: Vec<(u32, u32)>,
    /// Where each member may be in this frame: nobody looked for contacts elsewhere.
    reach: Vec<Aabb>,
}

impl<'a> Slicer<'a> {
    /// Writes the next states of the chosen islands.
    pub(crate) fn run(&self, chosen: &mut [u32], run: &mut Run, scratch: &mut SliceScratch) {
        pack(self.plan, chosen, &mut scratch.packed);
        let mut batches: Vec<Batch> = std::mem::take(&mut scratch.batches);
        batches.resize_with(scratch.packed.len().max(batches.len()), Batch::default);
        if self.count == 1 {
            batches = self.whole(chosen, &scratch.packed, batches, run);
        } else {
            let wanted: &[u32] = chosen;
            let mut pairs = self.plan.pairs_of(wanted, self.group);
            // As the chosen islands are sorted: meshes last.
            let is_mesh = |island: u32| self.plan.islands[island as usize].mesh;
            pairs.sort_by_key(|(island, _)| is_mesh(*island));
            let mut rest = pairs.as_slice();
            let mut parts: Vec<Part> = Vec::with_capacity(scratch.packed.len());
            for range in &scratch.packed {
                let last = wanted[range.end - 1];
                let sorts_behind = |island: u32| (is_mesh(island), island) > (is_mesh(last), last);
                let (here, after) = rest.split_at(rest.partition_point(|(island, _)| !sorts_behind(*island)));
                parts.push(self.part(&wanted[range.clone()], here));
                rest = after;
            }
            for slice in 0..self.count {
                batches = self.slice(&mut parts, slice + 1 == self.count, batches, run);
            }
            run.too_deep.sort_unstable();
            run.too_deep.dedup();
        }
        scratch.batches = batches.into_iter().map(Batch::emptied).collect();
    }

    /// The whole frame at once, with the contacts of the group.
    fn whole<'b>(
        &self,
        chosen: &[u32],
        packed: &[Range<usize>],
        mut batches: Vec<Batch<'b>>,
        run: &mut Run,
    ) -> Vec<Batch<'b>>
    where
        'a: 'b,
    {
        let notes = run.notes.is_some();
        let used = &mut batches[..packed.len()];
        used.par_iter_mut().zip(packed).for_each(|(batch, range)| {
            self.gather(&chosen[range.clone()], batch);
            batch.start(self.environment, self.group.contacts);
            if notes {
                batch.record_impulses();
            }
        });
        solve(used, run.observer);
        for batch in used {
            self.note(batch, run);
            self.keep(batch, run);
            self.find_too_deep(batch, run);
        }
        batches
    }

    /// Gives a batch the members, contacts and islands of the plan.
    fn gather<'b>(&self, islands: &[u32], batch: &mut Batch<'b>)
    where
        'a: 'b,
    {
        let (group, plan) = (self.group, self.plan);
        batch.sources.clear();
        for &island in islands {
            batch.sources.extend(plan.members(island));
        }
        let dynamic = batch.sources.len();
        let unyielding = |i: u32| plan.place[i as usize] == Plan::NONE;
        for ends in islands.iter().flat_map(|&island| plan.contacts(island)) {
            for i in [ends.first, ends.second] {
                if unyielding(i) && batch.sources[dynamic..].last() != Some(&i) {
                    batch.sources.push(i);
                }
            }
        }
        sort_tail(&mut batch.sources, dynamic);
        batch.members.clear();
        batch.members.extend(batch.sources.iter().map(|&i| group.members[i as usize]));
        let others = &batch.sources[dynamic..];
        batch.ends.clear();
        let mut at = 0;
        for &island in islands {
            let range = plan.member_range(island);
            let local = |i: u32| {
                if unyielding(i) {
                    (dynamic + others.partition_point(|&other| other < i)) as u32
                } else {
                    plan.place[i as usize] - range.start as u32 + at
                }
            };
            batch.ends.extend(plan.contacts(island).iter().map(|ends| Ends {
                first: local(ends.first),
                second: local(ends.second),
                contact: ends.contact,
            }));
            at += range.len() as u32;
        }
        let sizes = islands.iter().map(|&island| plan.member_range(island).len());
        batch.islands.in_rows(sizes, batch.members.len() - dynamic);
    }

    /// The members of some islands and all whom they may meet, at the start of the frame.
    fn part(&self, islands: &[u32], pairs: &[(u32, (u32, u32))]) -> Part<'a> {
        let plan = self.plan;
        let mut sources: Vec<u32> = Vec::new();
        for &island in islands {
            sources.extend(plan.members(island));
        }
        let dynamic = sources.len();
        let unyielding = |i: &u32| plan.place[*i as usize] == Plan::NONE;
        sources.extend(pairs.iter().flat_map(|(_, (i, j))| [*i, *j]).filter(unyielding));
        sort_tail(&mut sources, dynamic);
        let (inside, others) = sources.split_at(dynamic);
        let mut at = 0;
        let mut starts = islands.iter().map(|&island| {
            at += plan.members(island).len();
            (island, at - plan.members(island).len())
        });
        let mut here = starts.next();
        let mut local_pairs = Vec::with_capacity(pairs.len());
        for &(island, (i, j)) in pairs {
            while here.is_some_and(|(other, _)| other != island) {
                here = starts.next();
            }
            let start = here.map_or(0, |(_, start)| start);
            let local = |i: u32| {
                let place = if unyielding(&i) {
                    dynamic + others.partition_point(|&other| other < i)
                } else {
                    start + plan.place[i as usize] as usize - plan.member_range(island).start
                };
                place as u32
            };
            local_pairs.push((local(i), local(j)));
        }
        debug_assert!(inside.iter().all(|i| !unyielding(i)));
        let members: Vec<Member> = sources.iter().map(|&i| self.group.members[i as usize]).collect();
        let reach = members.iter().map(|m| swept_bound(m.body, &m.state, self.environment)).collect();
        Part { members, sources, dynamic, pairs: local_pairs, reach }
    }

    /// One slice of all parts.
    fn slice<'b>(
        &self,
        parts: &mut [Part<'a>],
        last: bool,
        batches: Vec<Batch<'b>>,
        run: &mut Run,
    ) -> Vec<Batch<'b>> {
        let mut environment = *self.environment;
        environment.settings.frame_seconds /= self.count as f32;
        let found: Vec<Vec<Contact>> =
            parts.iter().map(|part| find_contacts(&part.members, &part.pairs, &environment)).collect();
        let mut batches: Vec<Batch> = batches.into_iter().map(Batch::emptied).collect();
        let used = &mut batches[..parts.len()];
        for ((batch, part), found) in used.iter_mut().zip(parts.iter()).zip(&found) {
            batch.members.clone_from(&part.members);
            batch.sources.clone_from(&part.sources);
            batch.ends.clear();
            let ends =
                |(k, c): (usize, &Contact)| Ends { first: c.first, second: c.second, contact: k as u32 };
            batch.ends.extend(found.iter().enumerate().map(ends));
            let others = part.members.len() - part.dynamic;
            batch.islands.find(part.dynamic, others, found.iter().map(|c| (c.first, c.second)));
            batch.start(&environment, found);
            if run.notes.is_some() {
                batch.record_impulses();
            }
        }
        run.observer.after(Stage::Collisions);
        solve(used, run.observer);
        for (part, batch) in parts.iter_mut().zip(used) {
            self.note(batch, run);
            for ((member, state), reach) in part.members.iter_mut().zip(&mut batch.next).zip(&part.reach) {
                // Rest is counted in whole frames: at the end.
                *state = within(member.body, BodyState { rest: 0, ..*state }, reach);
                member.state = *state;
            }
            if last {
                self.keep(batch, run);
            }
            self.find_too_deep(batch, run);
        }
        batches.into_iter().map(Batch::emptied).collect()
    }

    /// Stores the states of the dynamic members.
    fn keep(&self, batch: &Batch, run: &mut Run) {
        for ((member, &source), state) in batch.members.iter().zip(&batch.sources).zip(&batch.next) {
            if !member.body.is_dynamic() {
                break;
            }
            let next = &mut run.next[source as usize];
            *next = *state;
            if self.count > 1 {
                next.rest = rest_after_slices(&self.group.members[source as usize], state, self.environment);
            }
        }
    }

    /// The island of a contact of a batch.
    fn island_of(&self, batch: &Batch, ends: &Ends) -> u32 {
        let of = |i: u32| self.plan.island_of[batch.sources[i as usize] as usize];
        let of_first = of(ends.first);
        if of_first == Plan::NONE { of(ends.second) } else { of_first }
    }

    /// Notes what the contacts of a solved batch did, where that is asked for.
    fn note(&self, batch: &Batch, run: &mut Run) {
        if let Some(notes) = &mut run.notes {
            notes.note(batch, |ends| self.island_of(batch, ends));
        }
    }

    fn find_too_deep(&self, batch: &Batch, run: &mut Run) {
        if self.environment.settings.slices_max <= self.count {
            return;
        }
        let part = self.environment.settings.deep_overlap_part;
        for (ends, growth) in batch.ends.iter().zip(batch.overlap_growth()) {
            if growth > DEEP_M {
                let (a, b) = (&batch.members[ends.first as usize], &batch.members[ends.second as usize]);
                if growth > part * half_thickness(a, b) {
                    run.too_deep.push(self.island_of(batch, ends));
                }
            }
        }
        run.too_deep.sort_unstable();
        run.too_deep.dedup();
    }
}

/// The stages of one frame or slice for some batches; batches side by side, stages one after the other.
fn solve<'b>(batches: &mut [Batch<'b>], observer: &mut dyn Observer) {
    let mut all = |stage: Stage, f: fn(&mut Batch<'b>)| {
        match &mut *batches {
            [] => {}
            // Nothing to share out: no other thread need wake.
            [one] => f(one),
            _ => batches.par_iter_mut().for_each(f),
        }
        observer.after(stage);
    };
    all(Stage::Velocities, Batch::integrate_velocities);
    all(Stage::ContactGraph, Batch::build_contact_graph);
    all(Stage::Contacts, Batch::resolve_contacts);
    all(Stage::ShockPropagation, Batch::propagate_shock);
    all(Stage::Positions, Batch::integrate_positions);
}

/// Sorts what comes after the first `kept`, each once.
fn sort_tail(list: &mut Vec<u32>, kept: usize) {
    list[kept..].sort_unstable();
    let mut end = kept;
    for k in kept..list.len() {
        if end == kept || list[end - 1] != list[k] {
            list[end] = list[k];
            end += 1;
        }
    }
    list.truncate(end);
}

/// The state of a body that a hit has thrown where nobody looked for contacts, held at the border until the frame ends.
fn within(body: &Body, state: BodyState, reach: &Aabb) -> BodyState {
    if !body.is_dynamic() {
        return state;
    }
    let now = body.shape.aabb(&body.own_pose(&state));
    let shift = (reach.min - now.min).max(Vec3::ZERO) + (reach.max - now.max).min(Vec3::ZERO);
    if shift.is_finite() { BodyState { position: state.position + shift, ..state } } else { state }
}
