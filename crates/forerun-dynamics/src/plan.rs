//! Plan: which islands a group falls into, what each needs, and how they are packed into batches.

use forerun_geometry::Vec3;

use crate::Environment;
use crate::narrow_phase::Contact;
use crate::solver::{Islands, is_mesh};
use crate::step::{Group, Member};

/// Contacts that a batch holds at least, if there are so many: enough to fill the lanes, few enough to share out.
const CONTACTS_PER_BATCH: usize = 1024;
/// An approach of this many half thicknesses of the thinner body in one slice might pass through.
const APPROACH_MAX: f32 = 2.0;

/// An island with at least one contact.
#[derive(Clone, Debug, Default)]
pub(crate) struct Island {
    /// Its dynamic members, and the others that they touch; indices into the group, sorted.
    pub(crate) members: Vec<u32>,
    /// Its contacts; indices into the group's, in their order.
    pub(crate) contacts: Vec<u32>,
    /// Whether a mesh moves in it.
    pub(crate) mesh: bool,
    /// Slices into which its frame is to be cut.
    pub(crate) slices: u32,
}

/// The islands of a group, by their lowest dynamic member; resting ones and bodies without contacts are left out.
pub(crate) struct Plan {
    pub(crate) islands: Vec<Island>,
    /// Per member: its index in `islands`, or [`Plan::NONE`].
    pub(crate) island_of: Vec<u32>,
    /// Members whose state stays as it is.
    pub(crate) resting: Vec<bool>,
}

impl Plan {
    pub(crate) const NONE: u32 = u32::MAX;

    pub(crate) fn new(group: &Group, environment: &Environment) -> Plan {
        let members = group.members;
        let dynamic = |i: usize| members[i].body.is_dynamic();
        let ends = group.contacts.iter().map(|c| (c.first, c.second));
        let roots = Islands::find(members.len(), dynamic, ends);
        let mut plan = Plan {
            islands: Vec::new(),
            island_of: vec![Plan::NONE; members.len()],
            resting: resting(group, &roots, environment),
        };
        plan.sort_contacts(group, &roots);
        for island in &mut plan.islands {
            island.members.sort_unstable();
            island.members.dedup();
            island.slices = slices_wanted(island, group, environment);
        }
        plan
    }

    fn sort_contacts(&mut self, group: &Group, roots: &Islands) {
        let members = group.members;
        // Islands are numbered by their lowest member, so that their order does not depend on the contacts.
        let mut touched = vec![false; members.len()];
        for c in group.contacts {
            for i in [c.first as usize, c.second as usize] {
                touched[i] = true;
            }
        }
        for i in 0..members.len() {
            if !touched[i] || !members[i].body.is_dynamic() || self.resting[i] {
                continue;
            }
            let root = roots.root(i);
            if root == i {
                self.island_of[i] = self.islands.len() as u32;
                self.islands.push(Island { slices: 1, ..Island::default() });
            }
            self.island_of[i] = self.island_of[root];
            let island = &mut self.islands[self.island_of[i] as usize];
            island.members.push(i as u32);
            island.mesh |= is_mesh(&members[i].body.shape);
        }
        for (k, c) in group.contacts.iter().enumerate() {
            let (a, b) = (self.island_of[c.first as usize], self.island_of[c.second as usize]);
            let index = if a == Plan::NONE { b } else { a };
            if index == Plan::NONE {
                continue;
            }
            let island = &mut self.islands[index as usize];
            island.contacts.push(k as u32);
            if a == Plan::NONE {
                island.members.push(c.first);
            }
            if b == Plan::NONE {
                island.members.push(c.second);
            }
        }
    }

    /// The pairs inside an island, or between it and bodies that do not yield: where a slice looks for contacts.
    pub(crate) fn pairs_of(&self, wanted: &[bool], group: &Group) -> Vec<Vec<(u32, u32)>> {
        let mut pairs = vec![Vec::new(); self.islands.len()];
        for &(i, j) in group.pairs {
            let (a, b) = (self.island_of[i as usize], self.island_of[j as usize]);
            let dynamic = |k: u32| group.members[k as usize].body.is_dynamic();
            let island = match (dynamic(i), dynamic(j)) {
                (true, true) if a == b => a,
                (true, false) => a,
                (false, true) => b,
                _ => Plan::NONE,
            };
            if island != Plan::NONE && wanted[island as usize] {
                pairs[island as usize].push((i, j));
            }
        }
        pairs
    }
}

/// Members of islands that are at a fixpoint: every dynamic one has been at rest with all of its island for a frame, and nothing moves into it.
fn resting(group: &Group, roots: &Islands, environment: &Environment) -> Vec<bool> {
    let members = group.members;
    let full = environment.settings.rest_frames();
    let mut awake = vec![full == 0; members.len()];
    for (i, m) in members.iter().enumerate() {
        // Velocities are asked too: whoever changes the length of a frame changes how many of them rest takes.
        let still = m.state.velocity == Vec3::ZERO && m.state.angular_velocity == Vec3::ZERO;
        if m.body.is_dynamic() && (m.state.rest <= full || !still) {
            awake[roots.root(i)] = true;
        }
    }
    let mut held = vec![false; members.len()];
    for c in group.contacts {
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
    (members.iter().enumerate()).map(|(i, m)| m.body.is_dynamic() && !awake[roots.root(i)]).collect()
}

/// Enough slices that nothing approaches by more than it is thick; a power of two.
fn slices_wanted(island: &Island, group: &Group, environment: &Environment) -> u32 {
    let most = environment.settings.slices_max;
    let mut slices = 1;
    for &k in &island.contacts {
        let c = &group.contacts[k as usize];
        let (a, b) = (&group.members[c.first as usize], &group.members[c.second as usize]);
        let limit = APPROACH_MAX * half_thickness(a, b);
        let approach = approach(c, a, b, environment);
        while slices < most && approach > limit * slices as f32 {
            slices *= 2;
        }
    }
    slices
}

/// Half the thickness of the thinner of two bodies that can be passed through. Metres.
pub(crate) fn half_thickness(a: &Member, b: &Member) -> f32 {
    a.body.half_thickness.min(b.body.half_thickness)
}

/// How far the contact closes in the frame at the speed of its start. Metres.
fn approach(contact: &Contact, a: &Member, b: &Member, environment: &Environment) -> f32 {
    let m = &contact.manifold;
    // Without gravity: what lies still is not to be cut, however thin it is.
    m.points[..m.count as usize].iter().fold(0.0, |most, p| {
        let speed = (a.state.velocity_at(p.position) - b.state.velocity_at(p.position)).dot(p.normal);
        f32::max(most, speed * environment.settings.frame_seconds)
    })
}

/// Islands (indices) packed into batches, in order; meshes apart.
pub(crate) fn pack(islands: &[Island], chosen: &[u32]) -> Vec<Vec<u32>> {
    let mut batches = Vec::new();
    for mesh in [false, true] {
        let mut batch = Vec::new();
        let mut contacts = 0;
        for &i in chosen.iter().filter(|&&i| islands[i as usize].mesh == mesh) {
            batch.push(i);
            contacts += islands[i as usize].contacts.len();
            if contacts >= CONTACTS_PER_BATCH {
                batches.push(std::mem::take(&mut batch));
                contacts = 0;
            }
        }
        if !batch.is_empty() {
            batches.push(batch);
        }
    }
    batches
}
