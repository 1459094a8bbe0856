//! Close-up: what one step found out about its contacts and levels, for who looks into it. Nothing of it is read by the step.

use crate::inspect::{InspectedContact, InspectedPoint};
use crate::solver::{Batch, Ends};
use crate::{BodyId, Member};

/// Notes of contacts and levels, islands and slices apart.
#[derive(Debug, Default)]
pub(crate) struct CloseUp {
    /// The slice that is being done.
    pub(crate) slice: u32,
    /// With the island of each.
    contacts: Vec<(u32, InspectedContact)>,
    /// Of dynamic bodies, in the first slice, with the island of each.
    levels: Vec<(u32, BodyId, u32)>,
}

impl CloseUp {
    /// Notes a solved batch. `island_of_member` and `island_of` say which island a dynamic member and a contact belong to.
    pub(crate) fn note(
        &mut self,
        batch: &Batch,
        island_of_member: impl Fn(u32) -> u32,
        island_of: impl Fn(&Ends) -> u32,
    ) {
        let member = |i: u32| -> &Member { &batch.members[i as usize] };
        if self.slice == 0 {
            let graph = batch.graph();
            let risen = graph.order.iter().filter(|&&i| member(i).body.is_dynamic());
            self.levels
                .extend(risen.map(|&i| (island_of_member(i), member(i).id, graph.levels()[i as usize])));
        }
        for (k, ends) in batch.ends.iter().enumerate() {
            let manifold = batch.contacts().manifold(k);
            let mut contact = InspectedContact {
                first: member(ends.first).id,
                second: member(ends.second).id,
                slice: self.slice,
                normal: manifold.normal,
                friction: batch.frictions[k],
                points: [InspectedPoint::NONE; 4],
                count: manifold.count,
            };
            for ((told, point), impulse) in
                contact.points.iter_mut().zip(manifold.points()).zip(batch.impulses[k])
            {
                *told = InspectedPoint {
                    position: point.position,
                    normal: point.normal,
                    separation: point.separation,
                    impulse,
                };
            }
            self.contacts.push((island_of(ends), contact));
        }
    }

    /// Takes over the notes of a run, but for the islands that are done again (sorted).
    pub(crate) fn keep(&mut self, run: CloseUp, done_again: &[u32]) {
        let stands = |island: u32| done_again.binary_search(&island).is_err();
        self.contacts.extend(run.contacts.into_iter().filter(|(island, _)| stands(*island)));
        self.levels.extend(run.levels.into_iter().filter(|(island, ..)| stands(*island)));
    }

    /// The contacts, sorted by pair, then slice.
    pub(crate) fn take_contacts(&mut self) -> Vec<InspectedContact> {
        let mut contacts: Vec<InspectedContact> =
            std::mem::take(&mut self.contacts).into_iter().map(|(_, contact)| contact).collect();
        contacts.sort_by_key(|contact| (contact.first, contact.second, contact.slice));
        contacts
    }

    /// The levels of the dynamic bodies that something supports, sorted by body.
    pub(crate) fn take_levels(&mut self) -> Vec<(BodyId, u32)> {
        let mut levels: Vec<(BodyId, u32)> =
            std::mem::take(&mut self.levels).into_iter().map(|(_, body, level)| (body, level)).collect();
        levels.sort_unstable();
        levels
    }
}
