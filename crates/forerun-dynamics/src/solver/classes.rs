//! Classes: how an island is to be solved, by what it is like alone.

use super::batch::ContactList;
use super::blocks::Class;
use super::contact_graph::ContactGraph;
use super::islands::Islands;
use super::load::Strain;
use crate::Member;
use crate::scratch::fill;
use crate::solver::is_mesh;

/// An island is hard when the load pass leaves more than this part of its weight to the sweeps: stacks and pyramids leave none, a heap most of it.
const HARD_PART: f64 = 0.1;

/// Root mean square of the speeds in an island; what moves faster does not stand. m/s
const SLOW: f64 = 0.5;
/// Hard islands that are so high and have so few contacts are delicate: arches, card houses. It takes many sweeps to find what keeps them up, and
/// as they are small that costs little: 0.1 ms for an arch of 17 stones.
const DELICATE_LEVELS: u32 = 4;
const DELICATE_CONTACTS: u32 = 192;
/// An island overlaps when some contact does by so many times what is allowed.
const OVERLAPPING: f32 = 2.0;
/// What the classes of islands follow from.
#[derive(Clone, Copy, Debug, Default)]
struct IslandSums {
    weight: f64,
    /// The part of the weight that the load pass does not place.
    lost: f64,
    mass: f64,
    /// Twice the energy of the centres of mass.
    motion: f64,
    contacts: u32,
    /// The highest level of a body that something supports.
    top: u32,
    /// The deepest overlap. Metres.
    overlap: f32,
}

impl IslandSums {
    fn add(&mut self, strain: &Strain, member: &Member) {
        let mass = 1.0 / f64::from(member.body.inverse_mass);
        self.weight += f64::from(strain.weight);
        self.lost += f64::from(strain.lost);
        self.mass += mass;
        self.motion += mass * f64::from(member.state.velocity.length_squared());
    }

    /// What the island needs; it overlaps where some contact is deeper than `deep`.
    fn class(&self, deep: f32) -> Class {
        if self.lost <= HARD_PART * self.weight {
            if self.overlap > deep { Class::Overlapping } else { Class::Easy }
        } else if self.motion > SLOW * SLOW * self.mass {
            Class::Rushing
        } else if self.contacts <= DELICATE_CONTACTS && self.top >= DELICATE_LEVELS {
            Class::Delicate
        } else {
            Class::Heap
        }
    }
}

/// Whether all points of every manifold of an island push the same way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Evenness {
    Flat,
    Uneven,
}

/// The islands of a batch, and what is known of them.
pub(crate) struct Islanders<'a> {
    pub(crate) members: &'a [Member<'a>],
    pub(crate) contacts: ContactList<'a>,
    pub(crate) islands: &'a Islands,
    pub(crate) graph: &'a ContactGraph,
    /// By member.
    pub(crate) strain: &'a [Strain],
    pub(crate) overlap_allowed_m: f32,
}

/// By island: its class.
#[derive(Debug, Default)]
pub(crate) struct Classes {
    sums: Vec<IslandSums>,
    of_island: Vec<(Class, Evenness)>,
}

impl Classes {
    /// The class of an island, by its number.
    pub(crate) fn of(&self, island: usize) -> (Class, Evenness) {
        self.of_island[island]
    }

    /// Finds the class of each island, and whether points of a mesh's manifold push different ways. (So may those of two capsules that lie alongside
    /// each other, by a few degrees: their mean serves.)
    pub(crate) fn find(&mut self, at: &Islanders) {
        let Classes { sums, of_island } = self;
        fill(sums, at.islands.count() + 1, IslandSums::default());
        for (i, (strain, member)) in at.strain.iter().zip(at.members).enumerate() {
            if member.body.is_dynamic() {
                sums[at.islands.root(i)].add(strain, member);
            }
        }
        for &i in &at.graph.order {
            let top = &mut sums[at.islands.root(i as usize)].top;
            *top = (*top).max(at.graph.levels()[i as usize]);
        }
        for (ends, separation) in at.contacts.ends.iter().zip(at.graph.deepest()) {
            let sums = &mut sums[at.islands.of(ends)];
            sums.contacts += 1;
            sums.overlap = sums.overlap.max(-separation);
        }
        let deep = OVERLAPPING * at.overlap_allowed_m;
        of_island.clear();
        of_island.extend(sums.iter().map(|sums| (sums.class(deep), Evenness::Flat)));
        if !at.members.iter().any(|m| is_mesh(&m.body.shape)) {
            return;
        }
        for (k, ends) in at.contacts.ends.iter().enumerate() {
            let points = at.contacts.manifold(k).points();
            let of_mesh = |i: u32| is_mesh(&at.members[i as usize].body.shape);
            let differ = points.iter().any(|p| p.normal != points[0].normal);
            if differ && (of_mesh(ends.first) || of_mesh(ends.second)) {
                of_island[at.islands.of(ends)].1 = Evenness::Uneven;
            }
        }
    }
}
