//! Impulses: what each contact point pushed with over the substeps, for those who ask.
//!
//! A contact's sums follow from its island alone, whatever lane and block it is in: each adds up in the order of the substeps.

use super::blocks::{Block, NO_CONTACT};
use crate::lanes::{LANES, Lanes, Portable};

/// Normal impulses of the points of each contact of a batch, summed over a frame or slice. N s. Empty where nobody asks.
pub(crate) type ImpulseSums = Vec<[f32; 4]>;

/// Adds the impulses of a substep, once it is over.
pub(crate) fn add_substep(sums: &mut [[f32; 4]], blocks: &[Block<Portable>]) {
    if sums.is_empty() {
        return;
    }
    for block in blocks {
        add(sums, &block.source, &[0, 1, 2, 3].map(|q| block.points[q].impulse));
    }
}

/// Adds the impulses of eight contacts.
#[inline(always)]
pub(crate) fn add<F: Lanes>(sums: &mut [[f32; 4]], source: &[u32; LANES], impulses: &[F; 4]) {
    let impulses = impulses.map(F::to_array);
    for lane in (0..LANES).filter(|&lane| source[lane] != NO_CONTACT) {
        let sum = &mut sums[source[lane] as usize];
        for q in 0..4 {
            sum[q] += impulses[q][lane];
        }
    }
}
