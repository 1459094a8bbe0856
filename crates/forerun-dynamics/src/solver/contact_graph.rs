//! Contact graph: who rests on whom.
//!
//! Promise: levels rise from the bodies that do not yield, one a contact; bodies that touch nothing supported come last. Inside an island levels
//! and order depend on the island alone, so that islands can be solved together or apart with the same bits.

use crate::Member;
use crate::narrow_phase::Contact;

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
    links: Vec<Link>,
    level: Vec<u32>,
    /// Per contact: how near its points count as touching. Metres.
    touch: Vec<f32>,
    /// Bodies by rising level; bodies that nothing supports are not in it.
    pub(crate) order: Vec<u32>,
}

impl ContactGraph {
    /// The graph over the bodies of a batch; those that do not yield are the ground.
    pub(crate) fn build(members: &[Member], contacts: &[Contact]) -> ContactGraph {
        let mut graph = ContactGraph::adjacency(members, contacts);
        graph.assign_levels(members.len(), |i| members[i].body.is_dynamic());
        graph
    }

    fn adjacency(members: &[Member], contacts: &[Contact]) -> ContactGraph {
        let count = members.len();
        let half = |i: u32| members[i as usize].body.half_thickness;
        let touch: Vec<f32> =
            contacts.iter().map(|c| TOUCH_M.min(TOUCH_PART * half(c.first).min(half(c.second)))).collect();
        let mut starts = vec![0u32; count + 1];
        for c in contacts {
            starts[c.first as usize + 1] += 1;
            starts[c.second as usize + 1] += 1;
        }
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut links = vec![Link { body: 0, contact: 0, touches: false }; 2 * contacts.len()];
        for (k, c) in contacts.iter().enumerate() {
            let points = &c.manifold.points[..c.manifold.count as usize];
            let touches = points.iter().any(|p| p.separation < touch[k]);
            for (here, there) in [(c.first, c.second), (c.second, c.first)] {
                links[next[here as usize] as usize] = Link { body: there, contact: k as u32, touches };
                next[here as usize] += 1;
            }
        }
        ContactGraph { starts, links, touch, level: Vec::new(), order: Vec::new() }
    }

    /// Breadth first from the ground over touching contacts: bodies of a cycle share a level or differ by one, whoever is first reached.
    fn assign_levels(&mut self, count: usize, yields: impl Fn(usize) -> bool) {
        const UNREACHED: u32 = u32::MAX;
        let mut level = vec![UNREACHED; count];
        let mut order: Vec<u32> = (0..count as u32).filter(|&i| !yields(i as usize)).collect();
        for &i in &order {
            level[i as usize] = 0;
        }
        let mut head = 0;
        while head < order.len() {
            let i = order[head] as usize;
            head += 1;
            for link in self.links(i) {
                let j = link.body as usize;
                if link.touches && level[j] == UNREACHED {
                    level[j] = level[i] + 1;
                    order.push(link.body);
                }
            }
        }
        let top = order.last().map_or(0, |&i| level[i as usize]);
        for l in &mut level {
            if *l == UNREACHED {
                *l = top + 1;
            }
        }
        self.level = level;
        self.order = order;
    }

    /// The contacts of a body, in canonical order.
    pub(crate) fn links(&self, body: usize) -> &[Link] {
        &self.links[self.starts[body] as usize..self.starts[body + 1] as usize]
    }

    /// How near the points of a contact count as touching. Metres, above 0.
    pub(crate) fn touch(&self, contact: usize) -> f32 {
        self.touch[contact]
    }

    /// The level of a body: 0 for the ground.
    pub(crate) fn level(&self, body: usize) -> u32 {
        self.level[body]
    }

    /// The level of a contact: that of its upper body.
    pub(crate) fn contact_level(&self, contact: &Contact) -> u32 {
        self.level[contact.first as usize].max(self.level[contact.second as usize])
    }
}
