//! Overlap: what the solver expects the deepest overlap of a contact to be at the end of its frame.

use super::blocks::{Block, BlocksOf, Detail, DetailsOf, NO_CONTACT};
use super::points::{Kind, Point};
use super::sides::Sides;
use crate::lanes::{LANES, LaneMask, Lanes, Portable, Row, dispatched, recast};

dispatched! {
    /// By how much the deepest point of each contact will lie deeper than at the start (and than touching), into the contact's place. Metres, 0 or more.
    pub(crate) fn overlap_growth<K: Kind>(
        blocks: &[Block<Portable, K>],
        details: &[Detail<Portable>],
        displacements: &[Row],
        growth: &mut [f32],
    ) => growth_lanes
}

#[inline(always)]
fn growth_lanes<F: Lanes, K: Kind>(
    blocks: &[Block<Portable, K>],
    details: &[Detail<Portable>],
    displacements: &[Row],
    growth: &mut [f32],
) {
    let blocks = recast::<F, BlocksOf<K>>(blocks);
    for (block, detail) in blocks.iter().zip(recast::<F, DetailsOf>(details)) {
        let moved = Sides::gather_still(block, displacements).relative(block);
        let mut deepest = F::zero();
        for q in 0..4 {
            let start = detail.separation[q].min(F::zero());
            let deeper = start - (detail.separation[q] + block.points[q].speed(&moved));
            deepest = block.is_point(q).select(deepest.max(deeper), deepest);
        }
        let deepest = deepest.to_array();
        for lane in 0..LANES {
            if detail.source[lane] != NO_CONTACT {
                growth[detail.source[lane] as usize] = deepest[lane];
            }
        }
    }
}
