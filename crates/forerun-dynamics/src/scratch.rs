//! Scratch: memory that one step after the other works in, so that a steady step asks the system for none.
//!
//! *Architecture invariant:* nothing that a step left in it is read by the next: every list is cleared or filled before it is read.

use crate::plan::Plan;
use crate::slices::SliceScratch;
use crate::{BodyState, Member};

/// Memory for [`advance`](crate::step::advance), kept from step to step by whoever takes them. What is in it has no meaning: any scratch gives the same
/// bits as a new one.
#[derive(Debug, Default)]
pub struct StepScratch {
    pub(crate) plan: Plan,
    pub(crate) slices: SliceScratch,
    /// Empty.
    pub(crate) members: Vec<Member<'static>>,
    /// The states that the last step gave.
    pub(crate) next: Vec<BodyState>,
    /// By island: how many slices its frame is cut into.
    pub(crate) slice_counts: Vec<u32>,
    /// The islands whose frame is cut into the slices that are being done.
    pub(crate) chosen: Vec<u32>,
}

impl Clone for StepScratch {
    /// An empty one: there is nothing to be had from the contents.
    fn clone(&self) -> StepScratch {
        StepScratch::default()
    }
}

/// Makes `list` hold `count` times `value`.
pub(crate) fn fill<T: Clone>(list: &mut Vec<T>, count: usize, value: T) {
    list.clear();
    list.resize(count, value);
}

/// Turns counts, each one place up, into the starts of a table of rows: row `i` is `starts[i]..starts[i + 1]`.
pub(crate) fn add_up(starts: &mut [u32]) {
    let mut sum = 0;
    for start in starts {
        sum += *start;
        *start = sum;
    }
}

/// The memory of a list of members of one step, for those of another.
pub(crate) fn emptied<'b>(mut members: Vec<Member<'_>>) -> Vec<Member<'b>> {
    members.clear();
    // Collected in place: nothing is moved and nothing allocated.
    members.into_iter().map(|_| unreachable!("the list is empty")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_memory_of_a_list_of_members_is_used_again() {
        let list: Vec<Member> = Vec::with_capacity(100);
        let place = list.as_ptr() as usize;
        let again = emptied(list);
        assert_eq!((again.capacity(), again.as_ptr() as usize), (100, place));
    }
}
