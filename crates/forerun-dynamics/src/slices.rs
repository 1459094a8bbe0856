//! Slices: islands, packed into batches, through their frame in one or more parts, each with contacts of its own.

use std::ops::Range;

use forerun_geometry::{Aabb, Vec3};
use rayon::prelude::*;

use crate::bounds::swept_bound;
use crate::carried::Carried;
use crate::narrow_phase::Contact;
use crate::plan::{Plan, half_thickness, pack};
use crate::run::Run;
use crate::solver::{Batch, Ends, rest_after_slices};
use crate::step::{Group, Member};
use crate::{Body, BodyState, Environment, Observer, Stage};

/// An overlap that grows by less than this is never too deep. Metres.
const DEEP_M: f32 = 0.001;

/// Batches that go through the stages together, for each of several threads.
const BATCHES_PER_THREAD: usize = 4;

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

/// What a batch is made from, slice after slice.
struct Part<'a> {
    /// At the start of the slice. Sorted by id.
    members: Vec<Member<'a>>,
    /// Indices of the members in the group.
    sources: Vec<u32>,
    /// Indices of the members, those that yield first: the batch's order.
    order: Vec<u32>,
    /// How many of the members yield.
    dynamic: usize,
    /// By member: its place in that order.
    place: Vec<u32>,
    /// Between members.
    carried: Carried,
    /// Where each member may be in this frame: nobody looked for contacts elsewhere.
    reach: Vec<Aabb>,
}

impl<'a> Slicer<'a> {
    /// Writes the next states of the chosen islands.
    pub(crate) fn run(&self, chosen: &mut [u32], run: &mut Run, scratch: &mut SliceScratch) {
        pack(self.plan, chosen, &mut scratch.packed);
        let mut batches: Vec<Batch> = std::mem::take(&mut scratch.batches);
        let count = scratch.packed.len();
        if self.count == 1 {
            batches.resize_with(batches.len().max(count.min(wave())), Batch::default);
            batches = self.whole(chosen, &scratch.packed, batches, run);
        } else {
            batches.resize_with(batches.len().max(count), Batch::default);
            let mut parts = self.parts(chosen, &scratch.packed);
            for slice in 0..self.count {
                if let Some(close_up) = &mut run.close_up {
                    close_up.slice = slice;
                }
                batches = self.slice(&mut parts, slice + 1 == self.count, batches, run);
            }
        }
        run.too_deep.sort_unstable();
        run.too_deep.dedup();
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
        let recorded = run.recorded();
        for packed in packed.chunks(wave()) {
            let used = &mut batches[..packed.len()];
            each(used, |(k, batch)| {
                self.gather(&chosen[packed[k].clone()], batch);
                batch.start(self.environment, self.group.contacts);
                recorded.by(batch);
            });
            solve(used, run.observer);
            for batch in used {
                self.note(batch, run);
                self.keep(batch, run);
                self.find_too_deep(batch, run);
            }
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

    /// The members of each batch and all whom they may meet, at the start of the frame.
    fn parts(&self, chosen: &[u32], packed: &[Range<usize>]) -> Vec<Part<'a>> {
        let mut batch_of = vec![Plan::NONE; self.plan.islands.len()];
        for (batch, range) in packed.iter().enumerate() {
            for &island in &chosen[range.clone()] {
                batch_of[island as usize] = batch as u32;
            }
        }
        let mut pairs = vec![Vec::new(); packed.len()];
        for &(i, j) in self.group.pairs {
            let island = self.plan.island_between(i, j);
            if island != Plan::NONE && batch_of[island as usize] != Plan::NONE {
                pairs[batch_of[island as usize] as usize].push((i, j));
            }
        }
        let parts = packed.iter().zip(pairs);
        parts.map(|(range, pairs)| self.part(&chosen[range.clone()], pairs)).collect()
    }

    /// `pairs`: of members of the group, sorted.
    fn part(&self, islands: &[u32], mut pairs: Vec<(u32, u32)>) -> Part<'a> {
        let mut sources: Vec<u32> =
            islands.iter().flat_map(|&island| self.plan.members(island)).copied().collect();
        sources.extend(pairs.iter().flat_map(|(i, j)| [*i, *j]));
        sort_tail(&mut sources, 0);
        // Both rise: pairs stay sorted.
        let local = |i: u32| sources.partition_point(|&source| source < i) as u32;
        pairs.iter_mut().for_each(|(i, j)| (*i, *j) = (local(*i), local(*j)));
        let members: Vec<Member> = sources.iter().map(|&i| self.group.members[i as usize]).collect();
        let contacts = islands.iter().flat_map(|&island| self.plan.contacts(island));
        let mut contacts: Vec<u32> = contacts.map(|ends| ends.contact).collect();
        contacts.sort_unstable();
        let contacts = contacts.iter().map(|&k| {
            let contact = self.group.contacts[k as usize];
            Contact { first: local(contact.first), second: local(contact.second), ..contact }
        });
        let carried = Carried::new(pairs, contacts.collect(), &members, self.environment);
        let reach = members.iter().map(|m| swept_bound(m.body, &m.state, self.environment)).collect();
        let (mut order, others): (Vec<u32>, Vec<u32>) =
            (0..members.len() as u32).partition(|&i| members[i as usize].body.is_dynamic());
        let dynamic = order.len();
        order.extend(others);
        let mut place = vec![0; order.len()];
        for (k, &i) in order.iter().enumerate() {
            place[i as usize] = k as u32;
        }
        Part { members, sources, order, dynamic, place, carried, reach }
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
        parts.par_iter_mut().for_each(|part| part.carried.look(&part.members, &environment));
        let found: Vec<Vec<Contact>> =
            parts.iter_mut().map(|part| std::mem::take(&mut part.carried.contacts)).collect();
        let mut batches: Vec<Batch> = batches.into_iter().map(Batch::emptied).collect();
        let used = &mut batches[..parts.len()];
        let recorded = run.recorded();
        each(used, |(k, batch)| {
            parts[k].fill(batch, &found[k]);
            batch.start(&environment, &found[k]);
            recorded.by(batch);
        });
        run.observer.after(Stage::Collisions);
        solve(used, run.observer);
        for (k, (part, batch)) in parts.iter_mut().zip(used).enumerate() {
            self.note(batch, run);
            part.carried.contacts.clone_from(&found[k]);
            let mut next: Vec<BodyState> = part.members.iter().map(|m| m.state).collect();
            for (state, &i) in batch.next.iter_mut().zip(&part.order) {
                let member = &part.members[i as usize];
                // Rest is counted in whole frames: at the end.
                *state = within(member.body, BodyState { rest: 0, ..*state }, &part.reach[i as usize]);
                next[i as usize] = *state;
            }
            part.carried.follow(&part.members, &next);
            part.members.iter_mut().zip(&next).for_each(|(member, next)| member.state = *next);
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
        if let Some(close_up) = &mut run.close_up {
            let island_of = |i: u32| self.plan.island_of[batch.sources[i as usize] as usize];
            close_up.note(batch, island_of, |ends| self.island_of(batch, ends));
        }
    }

    fn find_too_deep(&self, batch: &Batch, run: &mut Run) {
        if self.environment.settings.slices_max <= self.count {
            return;
        }
        let part = self.environment.settings.deep_overlap_part;
        for (ends, &growth) in batch.ends.iter().zip(&batch.overlap_growth) {
            if growth > DEEP_M {
                let (a, b) = (&batch.members[ends.first as usize], &batch.members[ends.second as usize]);
                if growth > part * half_thickness(a, b) {
                    run.too_deep.push(self.island_of(batch, ends));
                }
            }
        }
    }
}

impl<'a> Part<'a> {
    /// Gives a batch the members, and contacts that were found between them.
    fn fill<'b>(&self, batch: &mut Batch<'b>, found: &[Contact])
    where
        'a: 'b,
    {
        batch.members.clear();
        batch.members.extend(self.order.iter().map(|&i| self.members[i as usize]));
        batch.sources.clear();
        batch.sources.extend(self.order.iter().map(|&i| self.sources[i as usize]));
        let place = |i: u32| self.place[i as usize];
        batch.ends.clear();
        batch.ends.extend(found.iter().enumerate().map(|(k, c)| Ends {
            first: place(c.first),
            second: place(c.second),
            contact: k as u32,
        }));
        let others = self.members.len() - self.dynamic;
        batch.islands.find(self.dynamic, others, batch.ends.iter().map(|e| (e.first, e.second)));
    }
}

/// The stages of one frame or slice for some batches; batches side by side, stages one after the other.
fn solve(batches: &mut [Batch], observer: &mut dyn Observer) {
    each(batches, |(_, batch)| batch.integrate_velocities());
    observer.after(Stage::Velocities);

    each(batches, |(_, batch)| batch.build_contact_graph());
    observer.after(Stage::ContactGraph);

    each(batches, |(_, batch)| batch.resolve_contacts());
    observer.after(Stage::Contacts);

    each(batches, |(_, batch)| batch.propagate_shock());
    observer.after(Stage::ShockPropagation);

    each(batches, |(_, batch)| batch.integrate_positions());
    observer.after(Stage::Positions);
}

/// How many batches go through the stages together: few, so that what one stage writes is still near when the next reads it; enough to share out.
/// Batches do not notice each other, so this changes no bits.
fn wave() -> usize {
    match rayon::current_num_threads() {
        1 => 1,
        threads => BATCHES_PER_THREAD * threads,
    }
}

/// Does something to each batch, side by side; to a single one without waking another thread.
fn each<'b>(batches: &mut [Batch<'b>], act: impl Fn((usize, &mut Batch<'b>)) + Send + Sync) {
    match batches {
        [one] => act((0, one)),
        _ => batches.par_iter_mut().enumerate().for_each(act),
    }
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
