//! Impulses: what each contact point pushed with over the substeps, for those who ask.
//!
//! A contact's sums follow from its island alone, whatever lane and block it is in: each adds up in the order of the substeps.

use forerun_geometry::Vec3;

use super::batch::Batch;
use super::blocks::{Arranged, Block, NO_CONTACT};
use super::points::Kind;
use crate::lanes::{LANES, Lanes};
use crate::scratch::fill;

/// Normal impulses of the points of each contact of a batch, summed over a frame or slice. N s. Empty where nobody asks.
pub(crate) type ImpulseSums = Vec<[f32; 4]>;

/// Impulses of friction on the second body of each contact of a batch, in the world, summed over a frame or slice. N s. Empty where nobody asks.
pub(crate) type FrictionSums = Vec<Vec3>;

/// Where impulses are added up.
#[derive(Debug)]
pub(crate) struct Sums<'a> {
    pub(crate) normal: &'a mut [[f32; 4]],
    pub(crate) friction: &'a mut [Vec3],
}

impl Batch<'_> {
    /// Has what contacts push with added up. The classic shock propagation's impulses, which act on velocities, are not among it.
    pub(crate) fn record_impulses(&mut self) {
        fill(&mut self.impulses, self.ends.len(), [0.0; 4]);
    }

    /// Has what contacts rub with added up too. Asks for [`Batch::record_impulses`].
    pub(crate) fn record_friction(&mut self) {
        fill(&mut self.frictions, self.ends.len(), Vec3::ZERO);
    }
}

/// Adds the impulses of a substep, once it is over.
pub(crate) fn add_substep<K: Kind>(sums: &mut Sums, arranged: &Arranged<K>) {
    if sums.normal.is_empty() {
        return;
    }
    for (block, detail) in arranged.blocks.iter().zip(&arranged.details) {
        add(sums.normal, &detail.source, &block.impulses);
    }
    if sums.friction.is_empty() {
        return;
    }
    for (block, detail) in arranged.blocks.iter().zip(&arranged.details) {
        add_friction(sums.friction, (block, &detail.source), &block.friction.impulses);
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

/// Adds the friction of eight contacts: impulses along their two tangents; the twist moves no mass.
#[inline(always)]
pub(crate) fn add_friction<F: Lanes, K: Kind>(
    sums: &mut [Vec3],
    (block, source): (&Block<F, K>, &[u32; LANES]),
    impulses: &[F; 3],
) {
    let [t1, t2, _] = block.axes();
    let force = t1 * impulses[0] + t2 * impulses[1];
    let (x, y, z) = (force.x.to_array(), force.y.to_array(), force.z.to_array());
    for lane in 0..LANES {
        if source[lane] != NO_CONTACT {
            sums[source[lane] as usize] += Vec3::new(x[lane], y[lane], z[lane]);
        }
    }
}
