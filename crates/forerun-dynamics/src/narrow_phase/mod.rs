//! Narrow phase: where the bodies of a pair touch, or will within the frame.
//!
//! Promise: the manifolds of a pair depend on its two bodies, their states and the environment alone.
#![allow(
    clippy::needless_range_loop,
    reason = "kernels walk several short arrays side by side; the index is the point"
)]

mod cuboid_faces;
mod cuboids;
mod ground;
mod merge;
#[cfg(test)]
mod tests;

use forerun_geometry::contact::ContactScratch;
use forerun_geometry::{Manifold, Placed};
use rayon::prelude::*;

use self::cuboids::{Boxes, Kind, cuboid_contacts};
use self::ground::ground_contacts;
use crate::bounds::{Prospect, pair_margin};
use crate::{Environment, Member};

/// A pair is fast when its contacts are looked for this many contact margins ahead.
const FAST: f32 = 2.0;
/// Spheres are taken to be larger by this factor, so that no contact is lost to rounding.
const ROUNDING: f32 = 1.001;
/// Pairs that one task looks at; small enough to share out, large enough to fill the lanes.
const PAIRS_PER_TASK: usize = 512;

/// A manifold between two members of a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Index of the first member.
    pub first: u32,
    /// Index of the second member, above `first`.
    pub second: u32,
    /// Where they touch.
    pub manifold: Manifold,
}

/// The contacts of all pairs (indices into `members`, lower first), in the order of the pairs. Pairs that stay apart give none.
#[must_use]
pub fn find_contacts(members: &[Member], pairs: &[(u32, u32)], environment: &Environment) -> Vec<Contact> {
    if pairs.is_empty() {
        return Vec::new();
    }
    let prospects: Vec<Prospect> =
        members.iter().map(|m| Prospect::new(m.body, &m.state, environment)).collect();
    let bodies = Outlook { members, prospects: &prospects, environment };
    let mut contacts = Vec::new();
    NarrowPhase::default().find_contacts(&bodies, pairs, &mut contacts);
    contacts
}

/// Bodies, and how each is expected to go through the frame.
#[derive(Clone, Copy, Debug)]
pub struct Outlook<'a> {
    /// The bodies.
    pub members: &'a [Member<'a>],
    /// The prospect of each member in `environment`.
    pub prospects: &'a [Prospect],
    /// Gravity and settings.
    pub environment: &'a Environment,
}

/// The memory that the search needs, to be used again from step to step. It remembers nothing.
#[derive(Clone, Debug, Default)]
pub struct NarrowPhase {
    boxes: Boxes,
    search: Search,
}

impl NarrowPhase {
    /// As [`find_contacts`]; replaces what `contacts` held.
    pub fn find_contacts(&mut self, bodies: &Outlook, pairs: &[(u32, u32)], contacts: &mut Vec<Contact>) {
        contacts.clear();
        if pairs.is_empty() {
            return;
        }
        self.boxes.fill(bodies);
        let boxes = &self.boxes;
        if pairs.len() <= PAIRS_PER_TASK || rayon::current_num_threads() == 1 {
            self.search.run(bodies, boxes, pairs, contacts);
            bring_back(bodies, contacts);
            return;
        }
        // Joined in the order of the chunks, whoever finishes first.
        let chunks: Vec<Vec<Contact>> = (pairs.par_chunks(PAIRS_PER_TASK))
            .map(|chunk| {
                let mut contacts = Vec::with_capacity(chunk.len());
                Search::default().run(bodies, boxes, chunk, &mut contacts);
                contacts
            })
            .collect();
        contacts.reserve(chunks.iter().map(Vec::len).sum());
        chunks.iter().for_each(|chunk| contacts.extend_from_slice(chunk));
        bring_back(bodies, contacts);
    }
}

/// Makes the separations of bodies that were looked at halfway those of the frame's start.
fn bring_back(bodies: &Outlook, contacts: &mut [Contact]) {
    for contact in contacts {
        let (first, second) = (contact.first as usize, contact.second as usize);
        let (a, b) = (&bodies.prospects[first].halfway, &bodies.prospects[second].halfway);
        if a.is_none() && b.is_none() {
            continue;
        }
        let start = |i: usize| bodies.members[i].state.position;
        let manifold = &mut contact.manifold;
        for point in &mut manifold.points[..manifold.count as usize] {
            let way = b.way(start(second), point.position) - a.way(start(first), point.position);
            point.separation -= point.normal.dot(way);
        }
    }
}

/// The memory of one task.
#[derive(Clone, Debug, Default)]
struct Search {
    box_pairs: Vec<(u32, u32)>,
    /// A box and a half-space.
    ground_pairs: Vec<(u32, u32)>,
    other_pairs: Vec<(u32, u32)>,
    /// Pairs of boxes that are fast: they may meet in a corner, or pass each other, and the lanes know only faces and edges.
    fast: Vec<(u32, u32)>,
    contact: ContactScratch,
    manifolds: Vec<Manifold>,
    others: Vec<Contact>,
}

impl Search {
    fn run(&mut self, bodies: &Outlook, boxes: &Boxes, pairs: &[(u32, u32)], contacts: &mut Vec<Contact>) {
        let Search { box_pairs, ground_pairs, other_pairs, fast, others, .. } = self;
        for list in [&mut *box_pairs, &mut *ground_pairs, &mut *other_pairs, &mut *fast] {
            list.clear();
        }
        others.clear();
        for &(first, second) in pairs {
            let list = match (boxes.kind(first), boxes.kind(second)) {
                (Kind::Cuboid, Kind::Cuboid) => &mut *box_pairs,
                (Kind::HalfSpace, Kind::Cuboid) | (Kind::Cuboid, Kind::HalfSpace) => &mut *ground_pairs,
                _ => &mut *other_pairs,
            };
            list.push((first, second));
        }
        ground_contacts(boxes, ground_pairs, contacts);
        if ground_pairs.last() < box_pairs.first() {
            // As mostly: the ground is the first of all bodies.
            cuboid_contacts(boxes, box_pairs, contacts, fast);
        } else {
            cuboid_contacts(boxes, box_pairs, others, fast);
            merge::insert(contacts, others);
            others.clear();
        }
        if !self.fast.is_empty() {
            self.other_pairs.append(&mut self.fast);
            self.other_pairs.sort_unstable();
        }
        for &(first, second) in &self.other_pairs {
            let (a, b) = (first as usize, second as usize);
            let placed = |i: usize| Placed {
                shape: &bodies.members[i].body.shape,
                pose: bodies.prospects[i].pose,
                motion: bodies.prospects[i].motion,
            };
            let margin = pair_margin(&bodies.prospects[a], &bodies.prospects[b], bodies.environment);
            if spheres_apart(&bodies.members[a], &bodies.members[b], margin) {
                continue;
            }
            self.contact.contact_manifolds(&placed(a), &placed(b), margin, &mut self.manifolds);
            self.others.extend(self.manifolds.drain(..).map(|manifold| Contact { first, second, manifold }));
        }
        merge::insert(contacts, &self.others);
    }
}

/// Whether even the spheres around the two are farther apart than the margin: bounds of round things overlap in their corners.
fn spheres_apart(a: &Member, b: &Member, margin: f32) -> bool {
    let reach = (a.body.radius + b.body.radius + margin) * ROUNDING;
    (a.state.position - b.state.position).length_squared() > reach * reach
}
