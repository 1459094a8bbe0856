//! Contact graph: who rests on whom.
//!
//! Promise: levels rise from the bodies that do not yield, one a contact; bodies that touch nothing supported come last. Inside an island levels
//! and order depend on the island alone, so that islands can be solved together or apart with the same bits.

use super::batch::{ContactList, Ends};
use crate::Member;
use crate::scratch::{add_up, fill};

/// Contacts nearer than this carry load and levels. Metres; well above the allowed overlap, so that rest does not flip it.
const TOUCH_M: f32 = 0.01;
/// Or than this part of the thinner body's half thickness, if that is less: what lies on a sheet does not rest on what is under the sheet.
const TOUCH_PART: f32 = 0.25;

/// A contact, seen from one of its bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    /// The other body.
    pub(crate) body: u32,
    /// Index of the contact.
    pub(crate) contact: u32,
    /// Whether it touches: see [`ContactGraph::touch`].
    pub(crate) touches: bool,
}

/// Adjacency, levels and the breadth-first order.
#[derive(Debug, Default)]
pub(crate) struct ContactGraph {
    starts: Vec<u32>,
    next: Vec<u32>,
    links: Vec<Link>,
    level: Vec<u32>,
    touch: Vec<f32>,
    deepest: Vec<f32>,
    /// Bodies by rising level; bodies that nothing supports are not in it.
    pub(crate) order: Vec<u32>,
}

impl ContactGraph {
    /// Makes this the graph over the bodies of a batch; those that do not yield are the ground.
    pub(crate) fn build(&mut self, members: &[Member], contacts: &ContactList) {
        self.measure(members, contacts);
        self.link(members.len(), contacts.ends);
        self.assign_levels(members);
    }

    /// How near each contact is, and has to be to touch.
    fn measure(&mut self, members: &[Member], contacts: &ContactList) {
        let half = |i: u32| members[i as usize].body.half_thickness;
        self.touch.clear();
        self.touch.extend(
            contacts.ends.iter().map(|e| TOUCH_M.min(TOUCH_PART * half(e.first).min(half(e.second)))),
        );
        self.deepest.clear();
        self.deepest.extend((0..contacts.ends.len()).map(|k| contacts.manifold(k).deepest()));
    }

    fn link(&mut self, count: usize, ends: &[Ends]) {
        fill(&mut self.starts, count + 1, 0);
        for e in ends {
            self.starts[e.first as usize + 1] += 1;
            self.starts[e.second as usize + 1] += 1;
        }
        add_up(&mut self.starts);
        self.next.clone_from(&self.starts);
        fill(&mut self.links, 2 * ends.len(), Link { body: 0, contact: 0, touches: false });
        for (k, e) in ends.iter().enumerate() {
            let touches = self.deepest[k] < self.touch[k];
            for (here, body) in [(e.first, e.second), (e.second, e.first)] {
                let at = &mut self.next[here as usize];
                self.links[*at as usize] = Link { body, contact: k as u32, touches };
                *at += 1;
            }
        }
    }

    /// Breadth first from the ground over touching contacts: bodies of a cycle share a level or differ by one, whoever is first reached.
    fn assign_levels(&mut self, members: &[Member]) {
        const UNREACHED: u32 = u32::MAX;
        let (level, order) = (&mut self.level, &mut self.order);
        level.clear();
        order.clear();
        for (i, member) in members.iter().enumerate() {
            let yields = member.body.is_dynamic();
            level.push(if yields { UNREACHED } else { 0 });
            if !yields {
                order.push(i as u32);
            }
        }
        let mut head = 0;
        while head < order.len() {
            let i = order[head] as usize;
            head += 1;
            for link in &self.links[self.starts[i] as usize..self.starts[i + 1] as usize] {
                let j = link.body as usize;
                if link.touches && level[j] == UNREACHED {
                    level[j] = level[i] + 1;
                    order.push(link.body);
                }
            }
        }
        let top = order.last().map_or(0, |&i| level[i as usize]);
        for l in level {
            if *l == UNREACHED {
                *l = top + 1;
            }
        }
    }

    /// The contacts of a body, in canonical order.
    pub(crate) fn links(&self, body: usize) -> &[Link] {
        &self.links[self.starts[body] as usize..self.starts[body + 1] as usize]
    }

    /// How near the points of a contact count as touching. Metres, above 0.
    pub(crate) fn touch(&self, contact: usize) -> f32 {
        self.touch[contact]
    }

    /// By contact: the smallest separation of its points at the start of the frame. Metres.
    pub(crate) fn deepest(&self) -> &[f32] {
        &self.deepest
    }

    /// The level of each body: 0 for the ground. What nothing supports has one more than the highest of the batch, not of its island: to be compared,
    /// never to be reckoned with.
    pub(crate) fn levels(&self) -> &[u32] {
        &self.level
    }

    /// The level of a contact: that of its upper body.
    pub(crate) fn contact_level(&self, contact: &Ends) -> u32 {
        self.level[contact.first as usize].max(self.level[contact.second as usize])
    }
}
