//! Standing: what the contacts of hard islands carry while nothing moves.
//!
//! The load pass cannot place the weight of heaps, arches and wedged bodies; sweeps find it, over the gravity and forces of one substep alone, as if
//! every body stood still. No velocity gets into the impulses that the substeps start from: what a sweep does against a velocity, and the next substep
//! does once more, throws the body back. Heaps that were swept in motion only rattled for ever: fallen dominoes at 20 mm/s in the median, now 3.
//!
//! These sweeps are by the law of the [`Law::Cone`], which finds forces that keep an island in place if there are any; the last one is by Coulomb's.

use super::blocks::{Block, Detail};
use super::descent::{Descent, Hard, Sweeps};
use super::energy_guard::{EnergyGuard, Guarded, Guarding};
use super::points::Kind;
use super::sweep::Law;
use super::warm_start::{add_momentum, apply_impulses, take_off_momentum};
use crate::lanes::{Portable, Row, cells};

/// Finds what the contacts of hard islands carry.
pub(crate) struct StandingPass<'a> {
    pub(crate) guard: &'a mut EnergyGuard,
    pub(crate) descent: &'a mut Descent,
    pub(crate) at: Guarding<'a>,
    /// Mass-scaled change of velocity that gravity and forces make in a substep, and the dummy's.
    pub(crate) kicks: &'a [Row],
}

impl StandingPass<'_> {
    /// Betters the weight in the first guess of the blocks; the momentum in it stays.
    pub(crate) fn run<K: Kind>(
        &mut self,
        blocks: &mut [Block<Portable, K>],
        details: &mut [Detail<Portable>],
        sweeps: u32,
    ) {
        if blocks.is_empty() {
            return;
        }
        take_off_momentum(blocks, details);
        let mut velocities = std::mem::take(&mut self.descent.standing);
        velocities.clear();
        velocities.extend_from_slice(self.kicks);
        apply_impulses(blocks, cells(&mut velocities));
        let islands = self.at.islands;
        if self.guard.gains(self.at, self.kicks, &velocities, Guarded::Guess) {
            self.guard.scale_back(islands, self.kicks, &mut velocities);
            self.guard.scale_impulses(islands, (blocks, details), Guarded::Guess);
        }
        let sweeps = Sweeps { count: sweeps, law: Law::Cone };
        self.descent.run(Hard { at: self.at, blocks, details }, &mut velocities, sweeps);
        self.descent.standing = velocities;
        add_momentum(blocks, details);
    }
}
