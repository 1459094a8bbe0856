//! Detection: who may meet whom in the next frame, and where; the first stage of the step.

use crate::bounds::Prospect;
use crate::broad_phase::{Bound, BroadPhase};
use crate::narrow_phase::{Contact, NarrowPhase, Outlook};
use crate::{Environment, Member};

/// Finds pairs and contacts of bodies, in memory that is used again from step to step. It remembers nothing.
#[derive(Clone, Debug, Default)]
pub struct Detection {
    prospects: Vec<Prospect>,
    bounds: Vec<Bound>,
    broad_phase: BroadPhase,
    narrow_phase: NarrowPhase,
    /// All pairs of members with overlapping swept bounds, one of them dynamic; lower index first, sorted.
    pub pairs: Vec<(u32, u32)>,
    /// The contacts of the pairs, in their order.
    pub contacts: Vec<Contact>,
}

impl Detection {
    /// Replaces pairs and contacts by those of `members`.
    pub fn run(&mut self, members: &[Member], environment: &Environment) {
        self.find_pairs(members, environment);
        self.find_contacts(members, environment);
    }

    /// Replaces the pairs by those of `members`.
    pub(crate) fn find_pairs(&mut self, members: &[Member], environment: &Environment) {
        self.prospects.clear();
        self.bounds.clear();
        for member in members {
            let prospect = Prospect::new(member.body, &member.state, environment);
            self.prospects.push(prospect);
            self.bounds.push(Bound { aabb: prospect.bound, dynamic: member.body.is_dynamic() });
        }
        self.broad_phase.overlapping_pairs(&self.bounds, &mut self.pairs);
    }

    /// Replaces the contacts by those of the pairs.
    pub(crate) fn find_contacts(&mut self, members: &[Member], environment: &Environment) {
        let outlook = Outlook { members, prospects: &self.prospects, environment };
        self.narrow_phase.find_contacts(&outlook, &self.pairs, &mut self.contacts);
    }
}
