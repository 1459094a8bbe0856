//! Impulses: what each contact point pushed with over the substeps, for those who ask.
//!
//! A contact's sums follow from its island alone, whatever lane and block it is in: each adds up in the order of the substeps.

use super::blocks::{Arranged, NO_CONTACT};
use super::points::Kind;
use crate::lanes::{LANES, Lanes};

/// Normal impulses of the points of each contact of a batch, summed over a frame or slice. N s. Empty where nobody asks.
pub(crate) type ImpulseSums = Vec<[f32; 4]>;

/// Adds the impulses of a substep, once it is over.
pub(crate) fn add_substep<K: Kind>(sums: &mut [[f32; 4]], arranged: &Arranged<K>) {
    if sums.is_empty() {
        return;
    }
    for (block, detail) in arranged.blocks.iter().zip(&arranged.details) {
        add(sums, &detail.source, &block.impulses);
    }
}

/// Adds the impulses of eight contacts.
#[inline(always)]
pub(crate) fn add<F: Lanes>(sums: &mut [[f32; 4]], source: &[u32; LANES], impulses: &[F; 4]) {
    let [a, b, c, d] = impulses;
    let impulses = [a.to_array(), b.to_array(), c.to_array(), d.to_array()];
    for lane in 0..LANES {
        if source[lane] != NO_CONTACT {
            let sum = &mut sums[source[lane] as usize];
            for q in 0..4 {
                sum[q] += impulses[q][lane];
            }
        }
    }
}
