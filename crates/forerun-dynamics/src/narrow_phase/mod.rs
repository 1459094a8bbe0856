//! Narrow phase: where the bodies of a pair touch, or will within the frame.
//!
//! Promise: the manifolds of a pair depend on its two bodies, their states and the environment alone.
#![allow(
    clippy::needless_range_loop,
    reason = "kernels walk several short arrays side by side; the index is the point"
)]

mod cuboid_faces;
mod cuboids;
#[cfg(test)]
mod tests;

use forerun_geometry::{Manifold, Motion, Placed, Pose, Shape};
use rayon::prelude::*;

use self::cuboids::{BoxPair, Boxes, cuboid_manifolds};
use crate::{Environment, Member, bounds};

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
    let placed: Vec<(Motion, Pose)> = members
        .iter()
        .map(|m| (bounds::motion(m.body, &m.state, environment), m.body.own_pose(&m.state)))
        .collect();
    let mut boxes = Boxes::default();
    let box_of: Vec<u32> = (members.iter().zip(&placed))
        .map(|(m, (_, pose))| match &m.body.shape {
            Shape::Cuboid(cuboid) => boxes.push(cuboid.half_extents, pose),
            _ => u32::MAX,
        })
        .collect();
    let found = Finder { members, placed: &placed, boxes: &boxes, box_of: &box_of, environment };
    if pairs.len() <= PAIRS_PER_TASK {
        return found.contacts(pairs);
    }
    // Collected in the order of the chunks, whoever finishes first.
    let chunks: Vec<Vec<Contact>> =
        pairs.par_chunks(PAIRS_PER_TASK).map(|chunk| found.contacts(chunk)).collect();
    chunks.concat()
}

struct Finder<'a> {
    members: &'a [Member<'a>],
    placed: &'a [(Motion, Pose)],
    boxes: &'a Boxes,
    /// Index among the boxes, or `u32::MAX`.
    box_of: &'a [u32],
    environment: &'a Environment,
}

impl Finder<'_> {
    fn contacts(&self, pairs: &[(u32, u32)]) -> Vec<Contact> {
        let mut box_pairs = Vec::new();
        let mut others = Vec::new();
        let mut manifolds = Vec::new();
        for (slot, &(first, second)) in pairs.iter().enumerate() {
            let (i, j) = (first as usize, second as usize);
            let margin = self.margin(i, j);
            if self.spheres_apart(i, j, margin) {
                continue;
            }
            let boxes = self.box_of[i] != u32::MAX && self.box_of[j] != u32::MAX;
            // Fast boxes may meet in a corner, or pass each other: the lanes know only faces and edges.
            if boxes && margin <= FAST * self.environment.settings.contact_margin_m {
                box_pairs.push(BoxPair {
                    slot: slot as u32,
                    first: self.box_of[i],
                    second: self.box_of[j],
                    margin,
                });
            } else {
                forerun_geometry::contact::contact_manifolds(
                    &self.placed(i),
                    &self.placed(j),
                    margin,
                    &mut manifolds,
                );
                others.extend(manifolds.drain(..).map(|m| (slot as u32, m)));
            }
        }
        let mut found = Vec::with_capacity(box_pairs.len());
        cuboid_manifolds(self.boxes, &box_pairs, &mut found);
        if !others.is_empty() {
            // Every pair is in one of the two lists; a stable sort by slot restores the order of the pairs.
            found.append(&mut others);
            found.sort_by_key(|(slot, _)| *slot);
        }
        (found.into_iter())
            .map(|(slot, manifold)| {
                let (first, second) = pairs[slot as usize];
                Contact { first, second, manifold }
            })
            .collect()
    }

    fn placed(&self, i: usize) -> Placed<'_> {
        let (motion, pose) = self.placed[i];
        Placed { shape: &self.members[i].body.shape, pose, motion }
    }

    /// Whether even the spheres around the two are farther apart than the margin: bounds of round things overlap in their corners.
    fn spheres_apart(&self, i: usize, j: usize, margin: f32) -> bool {
        let (a, b) = (&self.members[i], &self.members[j]);
        let reach = (a.body.radius + b.body.radius + margin) * ROUNDING;
        (a.state.position - b.state.position).length_squared() > reach * reach
    }

    fn margin(&self, i: usize, j: usize) -> f32 {
        let of = |i: usize| (self.placed[i].0, self.members[i].body.radius);
        bounds::pair_margin(&of(i), &of(j), self.environment)
    }
}
