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
        let Detection { prospects, bounds, broad_phase, narrow_phase, pairs, contacts } = self;
        prospects.clear();
        bounds.clear();
        for member in members {
            let prospect = Prospect::new(member.body, &member.state, environment);
            prospects.push(prospect);
            bounds.push(Bound { aabb: prospect.bound, dynamic: member.body.is_dynamic() });
        }
        broad_phase.overlapping_pairs(bounds, pairs);
        narrow_phase.find_contacts(&Outlook { members, prospects, environment }, pairs, contacts);
    }
}
