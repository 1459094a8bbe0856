//! Fork: two futures of one past, for the price of what differs.

use forerun_dynamics::BodyId;

use crate::{Frame, Stats, Timeline, TimelineSettings};

/// Where two timelines first part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The first frame at which a body differs.
    pub frame: Frame,
    /// The bodies that differ there, or that are only in one of the two, in the order of their ids.
    pub bodies: Vec<BodyId>,
}

impl Timeline {
    /// A timeline that goes its own way from here on. It shares all states with this one until they differ: a fork costs a few
    /// thousand reference counts whatever has been computed, and then what it changes. Dropping it gives that back.
    ///
    /// Commands to one of the two do not reach the other; both may use the same names for bodies that they add.
    #[must_use]
    pub fn fork(&self) -> Timeline {
        self.clone()
    }

    /// Where another timeline first differs from this one, among the frames that both have and know to be true; `None` when they
    /// agree. Costs a look at the memory that is not shared.
    #[must_use]
    pub fn diff(&self, other: &Timeline) -> Option<Difference> {
        let from = self.oldest().max(other.oldest());
        let to = self.valid_to().min(other.valid_to());
        if from > to {
            return None;
        }
        // Between two frames at which one of the two changes, both stay as they are.
        let begins = |timeline: &Timeline| -> Vec<Frame> {
            timeline
                .tables
                .runs()
                .map(|(frame, _)| frame)
                .filter(|frame| (from..=to).contains(frame))
                .collect()
        };
        let mut frames = [vec![from], begins(self), begins(other)].concat();
        frames.sort_unstable();
        frames.dedup();
        frames.into_iter().find_map(|frame| {
            let bodies = self.table(frame).differences(other.table(frame));
            (!bodies.is_empty()).then_some(Difference { frame, bodies })
        })
    }

    /// A fork takes this timeline's place: its commands, states and names. The settings stay, but for what the states depend on (whether
    /// contacts are recorded), and the display, if the fork still keeps its frame: else it is at the oldest that the fork does. What
    /// this timeline did since the fork is gone; its counters, and the sequence numbers that were used, are not.
    pub fn adopt(&mut self, fork: Timeline) {
        let record_contacts = fork.settings.record_contacts;
        let settings = TimelineSettings { record_contacts, ..self.settings };
        let display = self.display.max(fork.oldest());
        let stats = Stats { ignored: fork.stats.ignored, ..self.stats };
        let next_sequence = self.next_sequence.max(fork.next_sequence);
        *self = Timeline { settings, stats, next_sequence, ..fork };
        self.set_display(display);
    }
}
