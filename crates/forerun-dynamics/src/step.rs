//! The step of a closed group of bodies: contacts in, next states out.

use forerun_geometry::{Aabb, Vec3};
use rayon::prelude::*;

use crate::bounds::swept_bound;
use crate::narrow_phase::{Contact, find_contacts};
use crate::plan::{Island, Plan, half_thickness, pack};
use crate::solver::{Batch, fly, rest_after_slices};
use crate::touch::Ledger;
use crate::{Body, BodyId, BodyKind, BodyState, Environment, Observer, Stage, Touches};

/// An overlap that grows by less than this is never too deep. Metres.
const DEEP_M: f32 = 0.001;

/// A body of a group, at the frame that is to be advanced.
#[derive(Clone, Copy, Debug)]
pub struct Member<'a> {
    /// Its name; members are sorted by it.
    pub id: BodyId,
    /// What it is.
    pub body: &'a Body,
    /// How it is.
    pub state: BodyState,
}

impl Member<'_> {
    /// Whether it is a kinematic body in motion: what it touches is pushed, and not at rest.
    pub(crate) fn drives(&self) -> bool {
        let zero = Vec3::ZERO;
        self.body.kind == BodyKind::Kinematic
            && (self.state.velocity != zero || self.state.angular_velocity != zero)
    }
}

/// Bodies that touch nobody outside the group.
///
/// Whoever builds it promises: `members` are sorted by id; `pairs` are all pairs of members with overlapping swept bounds, one of them
/// dynamic, lower index first, sorted; `contacts` are what [`find_contacts`] gives for these pairs; and every
/// body with a contact to a dynamic member is a member.
#[derive(Clone, Copy, Debug)]
pub struct Group<'a> {
    /// The bodies.
    pub members: &'a [Member<'a>],
    /// Pairs of members that may meet in this frame.
    pub pairs: &'a [(u32, u32)],
    /// Where members touch.
    pub contacts: &'a [Contact],
}

/// What a step did. Degraded results are counted, not hidden.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepReport {
    /// Islands with at least one contact that were solved.
    pub islands: u32,
    /// Contacts (manifolds) found.
    pub contacts: u32,
    /// Most slices that an island's frame was cut into; 1 when none was.
    pub slices_max: u32,
    /// Bodies whose next state was not finite: they were stopped where they were.
    pub quarantined: u32,
}

/// The states of the members one frame later, in the members' order.
///
/// Stage 1, collisions, is what made the group: swept bounds, pairs, contacts. The other five follow for each batch of islands.
#[must_use]
pub fn advance(
    group: &Group,
    environment: &Environment,
    observer: &mut dyn Observer,
) -> (Vec<BodyState>, StepReport) {
    advance_islands(group, environment, observer, None)
}

/// As [`advance`], with the same bits, and tells who touched whom. Replaces what `touches` held.
pub fn advance_touching(
    group: &Group,
    environment: &Environment,
    observer: &mut dyn Observer,
    touches: &mut Touches,
) -> (Vec<BodyState>, StepReport) {
    advance_islands(group, environment, observer, Some(touches))
}

/// As [`advance`]; tells who touched whom where somebody asks.
pub(crate) fn advance_islands(
    group: &Group,
    environment: &Environment,
    observer: &mut dyn Observer,
    touches: Option<&mut Touches>,
) -> (Vec<BodyState>, StepReport) {
    let plan = Plan::new(group, environment);
    let mut ledger = touches.is_some().then(Ledger::default);
    let mut next: Vec<BodyState> = group.members.iter().map(|m| m.state).collect();
    let dt = environment.settings.frame_seconds;
    for (i, member) in group.members.iter().enumerate() {
        if plan.island_of[i] == Plan::NONE && !plan.resting[i] {
            next[i] = fly(member.body, &member.state, environment, dt);
        }
    }
    let mut report = StepReport {
        islands: plan.islands.len() as u32,
        contacts: group.contacts.len() as u32,
        slices_max: 1,
        quarantined: 0,
    };
    let mut slices: Vec<u32> = plan.islands.iter().map(|island| island.slices).collect();
    let mut count = 1;
    while count <= environment.settings.slices_max.max(1) {
        let chosen: Vec<u32> = (0..slices.len() as u32).filter(|&i| slices[i as usize] == count).collect();
        if !chosen.is_empty() {
            report.slices_max = count;
            let mut notes = ledger.is_some().then(Ledger::default);
            let slicer = Slicer { group, environment, plan: &plan, count };
            let too_deep = slicer.run(&chosen, &mut next, observer, &mut notes);
            if let (Some(ledger), Some(notes)) = (&mut ledger, notes) {
                ledger.keep(notes, &too_deep);
            }
            // The return in time: the frame of these islands is thrown away and done again in smaller parts.
            for i in too_deep {
                slices[i as usize] = count * 2;
            }
        }
        count *= 2;
    }
    report.quarantined = quarantine(group, &mut next);
    if let (Some(touches), Some(ledger)) = (touches, ledger) {
        *touches = Touches { list: ledger.touches(), resting: plan.resting };
    }
    (next, report)
}

/// The stages of one frame or slice for some batches; batches side by side, stages one after the other.
fn solve(batches: &mut [Batch], observer: &mut dyn Observer) -> Vec<Vec<BodyState>> {
    batches.par_iter_mut().for_each(Batch::integrate_velocities);
    observer.after(Stage::Velocities);

    batches.par_iter_mut().for_each(Batch::build_contact_graph);
    observer.after(Stage::ContactGraph);

    batches.par_iter_mut().for_each(Batch::resolve_contacts);
    observer.after(Stage::Contacts);

    batches.par_iter_mut().for_each(Batch::propagate_shock);
    observer.after(Stage::ShockPropagation);

    let next = batches.par_iter().map(Batch::integrate_positions).collect();
    observer.after(Stage::Positions);
    next
}

/// Does the frame of some islands in `count` slices, each with contacts of its own.
struct Slicer<'a> {
    group: &'a Group<'a>,
    environment: &'a Environment,
    plan: &'a Plan,
    count: u32,
}

impl<'a> Slicer<'a> {
    /// Writes the next states of the chosen islands, and names those that ended too deep and may still be cut finer.
    fn run(
        &self,
        chosen: &[u32],
        next: &mut [BodyState],
        observer: &mut dyn Observer,
        notes: &mut Option<Ledger>,
    ) -> Vec<u32> {
        let mut environment = *self.environment;
        environment.settings.frame_seconds /= self.count as f32;
        let packed = pack(&self.plan.islands, chosen);
        let mut too_deep = Vec::new();
        if self.count == 1 {
            let mut batches: Vec<Batch> = packed.iter().map(|b| self.batch(b, environment)).collect();
            if notes.is_some() {
                batches.iter_mut().for_each(Batch::record_impulses);
            }
            let solved = solve(&mut batches, observer);
            for ((batch, islands), states) in batches.iter().zip(&packed).zip(solved) {
                self.note(batch, notes);
                self.keep(batch, &states, next);
                self.find_too_deep(batch, islands, &mut too_deep);
            }
            return too_deep;
        }
        let mut wanted = vec![false; self.plan.islands.len()];
        for &i in chosen {
            wanted[i as usize] = true;
        }
        let pairs = self.plan.pairs_of(&wanted, self.group);
        let mut members: Vec<Vec<Member>> =
            packed.iter().map(|b| self.members_with_pairs(b, &pairs)).collect();
        let reach: Vec<Vec<Aabb>> = members.iter().map(|m| self.reach(m)).collect();
        for slice in 0..self.count {
            let mut batches: Vec<Batch> = (members.iter().zip(&packed))
                .map(|(m, islands)| self.detect(m, islands, &pairs, environment))
                .collect();
            if notes.is_some() {
                batches.iter_mut().for_each(Batch::record_impulses);
            }
            observer.after(Stage::Collisions);
            let solved = solve(&mut batches, observer);
            for (((members, islands), reach), (batch, states)) in
                members.iter_mut().zip(&packed).zip(&reach).zip(batches.iter().zip(solved))
            {
                self.note(batch, notes);
                for ((member, state), reach) in members.iter_mut().zip(&states).zip(reach) {
                    // Rest is counted in whole frames: at the end.
                    member.state = within(member.body, BodyState { rest: 0, ..*state }, reach);
                }
                if slice + 1 == self.count {
                    let states: Vec<BodyState> = members.iter().map(|m| m.state).collect();
                    self.keep(batch, &states, next);
                }
                if self.count < self.environment.settings.slices_max {
                    self.find_too_deep(batch, islands, &mut too_deep);
                }
            }
        }
        too_deep.sort_unstable();
        too_deep.dedup();
        too_deep
    }

    /// Where each member may be in this frame: nobody looked for contacts elsewhere.
    fn reach(&self, members: &[Member]) -> Vec<Aabb> {
        members.iter().map(|m| swept_bound(m.body, &m.state, self.environment)).collect()
    }

    /// The islands as one batch, with the contacts of the group.
    fn batch(&self, islands: &[u32], environment: Environment) -> Batch<'a> {
        let mut indices: Vec<u32> = Vec::new();
        let mut contacts: Vec<u32> = Vec::new();
        for island in self.islands(islands) {
            indices.extend(&island.members);
            contacts.extend(&island.contacts);
        }
        indices.sort_unstable();
        indices.dedup();
        contacts.sort_unstable();
        let members: Vec<Member> = indices.iter().map(|&i| self.group.members[i as usize]).collect();
        let local = Local::new(&indices, self.group.members.len());
        let contacts = (contacts.iter().map(|&k| self.group.contacts[k as usize]))
            .map(|c| Contact { first: local.of(c.first), second: local.of(c.second), ..c })
            .collect();
        Batch::new(members, contacts, environment)
    }

    /// The members of some islands and all whom they may meet.
    fn members_with_pairs(&self, islands: &[u32], pairs: &[Vec<(u32, u32)>]) -> Vec<Member<'a>> {
        let mut indices: Vec<u32> = self.islands(islands).flat_map(|i| i.members.iter().copied()).collect();
        indices.extend(islands.iter().flat_map(|&i| pairs[i as usize].iter().flat_map(|&(a, b)| [a, b])));
        indices.sort_unstable();
        indices.dedup();
        indices.iter().map(|&i| self.group.members[i as usize]).collect()
    }

    /// A batch with contacts found anew.
    fn detect(
        &self,
        members: &[Member<'a>],
        islands: &[u32],
        pairs: &[Vec<(u32, u32)>],
        environment: Environment,
    ) -> Batch<'a> {
        let ids: Vec<BodyId> = members.iter().map(|m| m.id).collect();
        let local = |i: u32| {
            let id = self.group.members[i as usize].id;
            ids.partition_point(|&other| other < id) as u32
        };
        let mut found: Vec<(u32, u32)> = islands
            .iter()
            .flat_map(|&i| pairs[i as usize].iter().map(|&(a, b)| (local(a), local(b))))
            .collect();
        found.sort_unstable();
        let contacts = find_contacts(members, &found, &environment);
        Batch::new(members.to_vec(), contacts, environment)
    }

    fn islands(&self, indices: &[u32]) -> impl Iterator<Item = &'a Island> {
        let plan = self.plan;
        indices.iter().map(move |&i| &plan.islands[i as usize]).collect::<Vec<_>>().into_iter()
    }

    /// Stores the states of the dynamic members.
    fn keep(&self, batch: &Batch, states: &[BodyState], next: &mut [BodyState]) {
        let mut at = 0;
        for (member, state) in batch.members.iter().zip(states) {
            at += self.group.members[at..].partition_point(|m| m.id < member.id);
            if member.body.is_dynamic() {
                next[at] = *state;
                if self.count > 1 {
                    next[at].rest = rest_after_slices(&self.group.members[at], state, self.environment);
                }
            }
        }
    }

    /// The island of a contact between two bodies of a batch.
    fn island_of(&self, a: &Member, b: &Member) -> u32 {
        let dynamic = if a.body.is_dynamic() { a.id } else { b.id };
        let at = self.group.members.partition_point(|m| m.id < dynamic);
        self.plan.island_of[at]
    }

    /// Notes what the contacts of a solved batch did, where that is asked for.
    fn note(&self, batch: &Batch, notes: &mut Option<Ledger>) {
        if let Some(notes) = notes {
            let member = |i: u32| &batch.members[i as usize];
            notes.note(batch, |contact| self.island_of(member(contact.first), member(contact.second)));
        }
    }

    fn find_too_deep(&self, batch: &Batch, islands: &[u32], too_deep: &mut Vec<u32>) {
        if self.environment.settings.slices_max <= self.count {
            return;
        }
        let part = self.environment.settings.deep_overlap_part;
        for (contact, growth) in batch.contacts.iter().zip(batch.overlap_growth()) {
            let (a, b) = (&batch.members[contact.first as usize], &batch.members[contact.second as usize]);
            if growth > (part * half_thickness(a, b)).max(DEEP_M) {
                let island = self.island_of(a, b);
                debug_assert!(islands.contains(&island));
                too_deep.push(island);
            }
        }
        too_deep.sort_unstable();
        too_deep.dedup();
    }
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

/// From indices of a group to indices of a batch.
struct Local {
    of: Vec<u32>,
}

impl Local {
    fn new(indices: &[u32], count: usize) -> Local {
        let mut of = vec![0; count];
        for (k, &i) in indices.iter().enumerate() {
            of[i as usize] = k as u32;
        }
        Local { of }
    }

    fn of(&self, i: u32) -> u32 {
        self.of[i as usize]
    }
}

/// Stops bodies whose next state is not finite. Returns how many.
fn quarantine(group: &Group, next: &mut [BodyState]) -> u32 {
    let mut count = 0;
    for (state, member) in next.iter_mut().zip(group.members) {
        if !state.is_finite() {
            let zero = Vec3::ZERO;
            *state = BodyState { velocity: zero, angular_velocity: zero, rest: 0, ..member.state };
            count += 1;
        }
    }
    count
}
