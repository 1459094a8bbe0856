//! Plan: which islands a group falls into, what each needs, and how they are packed into batches.

use std::ops::Range;

use forerun_geometry::{Shape, Vec3};

use crate::narrow_phase::Contact;
use crate::scratch::{add_up, fill};
use crate::solver::{Ends, Roots, is_mesh};
use crate::step::{Group, Member};
use crate::{BodyKind, Environment};

/// Contacts that a batch holds at least, if there are so many: enough to fill the lanes, few enough to share out.
const CONTACTS_PER_BATCH: usize = 1024;
/// An approach of more than this many half thicknesses of the thinner body in one slice might pass through.
const APPROACH_MAX: f32 = 2.0;
/// The same for meshes, but on level ground: their contacts are flat, and they are not. 200 falling tori overlap by 0.12 m with 2, 0.05 m with 1, and
/// 0.03 m with 0.75 or less.
const MESH_APPROACH_MAX: f32 = 0.75;

/// An island with at least one contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Island {
    /// Whether a mesh moves in it.
    pub(crate) mesh: bool,
    /// Slices into which its frame is to be cut.
    pub(crate) slices: u32,
}

/// The islands of a group, by their lowest dynamic member; resting ones and bodies without contacts are left out.
#[derive(Debug, Default)]
pub(crate) struct Plan {
    pub(crate) islands: Vec<Island>,
    /// Per member: its index in `islands`, or [`Plan::NONE`].
    pub(crate) island_of: Vec<u32>,
    /// Per member with an island: its place in the list of all members of islands.
    pub(crate) place: Vec<u32>,
    /// Members whose state stays as it is.
    pub(crate) resting: Vec<bool>,
    /// Dynamic members (indices into the group), island by island, rising.
    members: Vec<u32>,
    member_starts: Vec<u32>,
    /// Contacts between members of the group, island by island, in their order.
    contacts: Vec<Ends>,
    contact_starts: Vec<u32>,
    roots: Roots,
    traits: Vec<Trait>,
    /// By contact of the group.
    touches: Vec<Touching>,
    next: Vec<u32>,
    /// By member that is the root of its component: whether that moves, and whether something holds it.
    awake: Vec<bool>,
    held: Vec<bool>,
}

/// What the plan asks of a contact.
#[derive(Clone, Copy, Debug)]
struct Touching {
    first: u32,
    second: u32,
    /// Slices that its island needs at least.
    slices: u32,
}

/// What the plan asks of a member again and again.
#[derive(Clone, Copy, Debug, Default)]
struct Trait {
    dynamic: bool,
    touched: bool,
    /// Speed of its centre, and of its surface by its spin beyond that. m/s
    speed: f32,
    /// rad/s
    spin: f32,
    radius: f32,
    half_thickness: f32,
    mesh: bool,
    half_space: bool,
}

impl Plan {
    pub(crate) const NONE: u32 = u32::MAX;

    /// Makes this the plan of a group. `still` says, by member, who is known to rest; it may be empty.
    pub(crate) fn make(&mut self, group: &Group, environment: &Environment, still: &[bool]) {
        self.traits.clear();
        self.traits.extend(group.members.iter().map(Trait::of));
        self.join(group, environment);
        self.find_resting(group, environment);
        for (resting, still) in self.resting.iter_mut().zip(still) {
            *resting |= still;
        }
        self.sort_members(group);
        self.sort_contacts();
    }

    /// Who belongs to one island, and all else that is asked of contacts: they are large, and read once.
    fn join(&mut self, group: &Group, environment: &Environment) {
        let settings = &environment.settings;
        let traits = &mut self.traits;
        self.roots.separate(group.members.len());
        self.touches.clear();
        for c in group.contacts {
            let (a, b) = (c.first as usize, c.second as usize);
            traits[a].touched = true;
            traits[b].touched = true;
            if traits[a].dynamic && traits[b].dynamic {
                self.roots.join(c.first, c.second);
            }
            let limit = approach_max(&traits[a], &traits[b]);
            let slices = if fastest(c, &traits[a], &traits[b]) * settings.frame_seconds <= limit {
                1
            } else {
                slices_wanted(approach(c, group.members, environment), limit, settings.slices_max)
            };
            self.touches.push(Touching { first: c.first, second: c.second, slices });
        }
        self.roots.settle();
    }

    /// The dynamic members of an island (indices into the group), rising.
    pub(crate) fn members(&self, island: u32) -> &[u32] {
        &self.members[self.member_range(island)]
    }

    /// Where the members of an island are in the list of all members of islands.
    pub(crate) fn member_range(&self, island: u32) -> Range<usize> {
        self.member_starts[island as usize] as usize..self.member_starts[island as usize + 1] as usize
    }

    /// The contacts of an island, between members of the group, in their order.
    pub(crate) fn contacts(&self, island: u32) -> &[Ends] {
        let from = self.contact_starts[island as usize] as usize;
        &self.contacts[from..self.contact_starts[island as usize + 1] as usize]
    }

    /// Islands are numbered by their lowest member, so that their order does not depend on the contacts.
    fn sort_members(&mut self, group: &Group) {
        let count = group.members.len();
        fill(&mut self.island_of, count, Plan::NONE);
        fill(&mut self.place, count, Plan::NONE);
        self.islands.clear();
        self.member_starts.clear();
        self.member_starts.push(0);
        let joins =
            |plan: &Plan, i: usize| plan.traits[i].touched && plan.traits[i].dynamic && !plan.resting[i];
        for i in 0..count {
            if joins(self, i) {
                let root = self.roots.root(i);
                if root == i {
                    self.island_of[i] = self.islands.len() as u32;
                    self.islands.push(Island { mesh: false, slices: 1 });
                    self.member_starts.push(0);
                }
                let island = self.island_of[root];
                self.island_of[i] = island;
                self.member_starts[island as usize + 1] += 1;
                self.islands[island as usize].mesh |= is_mesh(&group.members[i].body.shape);
            }
        }
        add_up(&mut self.member_starts);
        self.next.clone_from(&self.member_starts);
        fill(&mut self.members, self.member_starts[self.islands.len()] as usize, 0);
        for (i, &island) in self.island_of.iter().enumerate() {
            if island != Plan::NONE {
                let at = &mut self.next[island as usize];
                self.members[*at as usize] = i as u32;
                self.place[i] = *at;
                *at += 1;
            }
        }
    }

    fn sort_contacts(&mut self) {
        fill(&mut self.contact_starts, self.islands.len() + 1, 0);
        for touching in &self.touches {
            let island = island_of_pair(&self.island_of, touching);
            if island != Plan::NONE {
                self.contact_starts[island as usize + 1] += 1;
                let slices = &mut self.islands[island as usize].slices;
                *slices = touching.slices.max(*slices);
            }
        }
        add_up(&mut self.contact_starts);
        self.next.clone_from(&self.contact_starts);
        let count = self.contact_starts[self.islands.len()] as usize;
        fill(&mut self.contacts, count, Ends { first: 0, second: 0, contact: 0 });
        for (k, touching) in self.touches.iter().enumerate() {
            let island = island_of_pair(&self.island_of, touching);
            if island != Plan::NONE {
                let at = &mut self.next[island as usize];
                let Touching { first, second, .. } = *touching;
                self.contacts[*at as usize] = Ends { first, second, contact: k as u32 };
                *at += 1;
            }
        }
    }

    /// The island that a pair of members is inside of, or between and bodies that do not yield: it is where a slice of it looks for contacts.
    pub(crate) fn island_between(&self, i: u32, j: u32) -> u32 {
        let (a, b) = (self.island_of[i as usize], self.island_of[j as usize]);
        match (self.traits[i as usize].dynamic, self.traits[j as usize].dynamic) {
            (true, true) if a == b => a,
            (true, false) => a,
            (false, true) => b,
            _ => Plan::NONE,
        }
    }

    /// Members of islands that are at a fixpoint: every dynamic one has been at rest with all of its island for a frame, and nothing moves into it.
    fn find_resting(&mut self, group: &Group, environment: &Environment) {
        let members = group.members;
        fill(&mut self.resting, members.len(), false);
        let full = environment.settings.rest_frames();
        let rests = |(m, t): (&Member, &Trait)| {
            // Velocities are asked too: whoever changes the length of a frame changes how many of them rest takes.
            let still = m.state.velocity == Vec3::ZERO && m.state.angular_velocity == Vec3::ZERO;
            t.dynamic && m.state.rest > full && still
        };
        if full == 0 || !members.iter().zip(&self.traits).any(rests) {
            return;
        }
        let Plan { roots, awake, held, .. } = self;
        fill(awake, members.len(), false);
        fill(held, members.len(), false);
        for (i, (member, traits)) in members.iter().zip(&self.traits).enumerate() {
            if traits.dynamic && !rests((member, traits)) {
                awake[roots.root(i)] = true;
            }
        }
        for c in &self.touches {
            for (support, carried) in [(c.first, c.second), (c.second, c.first)] {
                let support = &members[support as usize];
                held[roots.root(carried as usize)] |= !support.body.is_dynamic();
                awake[roots.root(carried as usize)] |= support.drives();
            }
        }
        for (i, m) in members.iter().enumerate() {
            // Nothing rests on nothing, whatever its state says.
            awake[roots.root(i)] |= !held[roots.root(i)] && m.body.acceleration(environment) != Vec3::ZERO;
        }
        for (i, resting) in self.resting.iter_mut().enumerate() {
            *resting = self.traits[i].dynamic && !awake[roots.root(i)];
        }
    }
}

impl Trait {
    fn of(member: &Member) -> Trait {
        let (body, state) = (member.body, &member.state);
        Trait {
            dynamic: body.kind == BodyKind::Dynamic,
            touched: false,
            speed: state.velocity.length(),
            spin: state.angular_velocity.length(),
            radius: body.radius,
            half_thickness: body.half_thickness,
            mesh: is_mesh(&body.shape),
            half_space: matches!(body.shape, Shape::HalfSpace),
        }
    }
}

/// How far two bodies may come nearer to each other in one slice. Metres.
fn approach_max(a: &Trait, b: &Trait) -> f32 {
    let bent = (a.mesh || b.mesh) && !a.half_space && !b.half_space;
    let most = if bent { MESH_APPROACH_MAX } else { APPROACH_MAX };
    most * a.half_thickness.min(b.half_thickness)
}

/// No point of the contact closes faster than this; cheap, and mostly enough to know. m/s
fn fastest(contact: &Contact, a: &Trait, b: &Trait) -> f32 {
    /// For rounding, and points a little outside of a shape.
    const SLACK: f32 = 1.5;
    let mut apart = 0.0;
    for point in contact.manifold.points() {
        if point.separation > apart {
            apart = point.separation;
        }
    }
    let of = |t: &Trait| t.speed + if t.spin > 0.0 { t.spin * (t.radius + apart) } else { 0.0 };
    SLACK * (of(a) + of(b))
}

/// Half the thickness of the thinner of two bodies that can be passed through. Metres.
pub(crate) fn half_thickness(a: &Member, b: &Member) -> f32 {
    a.body.half_thickness.min(b.body.half_thickness)
}

/// How far the contact closes in the frame at the speed of its start. Metres.
fn approach(contact: &Contact, members: &[Member], environment: &Environment) -> f32 {
    let (a, b) = (&members[contact.first as usize].state, &members[contact.second as usize].state);
    // Without gravity: what lies still is not to be cut, however thin it is.
    // What goes along a bent surface goes into it, or into what comes after it.
    let bent = is_mesh(&members[contact.first as usize].body.shape)
        && is_mesh(&members[contact.second as usize].body.shape);
    contact.manifold.points().iter().fold(0.0, |most, p| {
        let relative = a.velocity_at(p.position) - b.velocity_at(p.position);
        let speed = if bent { relative.length() } else { relative.dot(p.normal) };
        f32::max(most, speed * environment.settings.frame_seconds)
    })
}

/// Enough slices that nothing approaches by more than `limit` in one; a power of two.
fn slices_wanted(approach: f32, limit: f32, most: u32) -> u32 {
    let mut slices = 1;
    while slices < most && approach > limit * slices as f32 {
        slices *= 2;
    }
    slices
}

/// The island that a contact between two members belongs to.
fn island_of_pair(island_of: &[u32], touching: &Touching) -> u32 {
    let of_first = island_of[touching.first as usize];
    if of_first == Plan::NONE { island_of[touching.second as usize] } else { of_first }
}

/// Sorts the chosen islands, meshes last, else in order, and packs them into batches: ranges of what is sorted.
pub(crate) fn pack(plan: &Plan, chosen: &mut [u32], batches: &mut Vec<Range<usize>>) {
    let is_mesh = |island: u32| plan.islands[island as usize].mesh;
    if chosen.iter().any(|&island| is_mesh(island)) {
        chosen.sort_by_key(|&island| is_mesh(island));
    }
    batches.clear();
    let (mut start, mut contacts) = (0, 0);
    for k in 0..chosen.len() {
        contacts += plan.contacts(chosen[k]).len();
        let last = chosen.get(k + 1).is_none_or(|&next| is_mesh(next) != is_mesh(chosen[k]));
        if contacts >= CONTACTS_PER_BATCH || last {
            batches.push(start..k + 1);
            (start, contacts) = (k + 1, 0);
        }
    }
}
