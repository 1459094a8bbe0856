//! Energy guard: keeps guess and sweeps from adding kinetic energy, island by island.
//!
//! With `u` the velocities before, `p` the change by the impulses, the energy along `u + s p` is least at `s = -(p·u)/(p·p)`. Sums are in
//! double precision and in the order of the bodies. Islands on moving kinematic bodies are left alone: these do add energy.

use super::blocks::{Arranged, Block, Detail, NO_CONTACT};
use super::islands::Islands;
use super::points::Kind;
use crate::lanes::{LANES, Lanes, Portable, Row, dispatched};

/// Below this optimal step the guess would add energy as it stands (it would be neutral at one half).
const STEP_MIN: f64 = 0.52;
/// Relative gain of energy that counts as rounding.
const GAIN_ALLOWED: f64 = 1e-7;

/// The islands of a batch by number, and memory for their sums.
#[derive(Debug, Default)]
pub(crate) struct EnergyGuard {
    /// By body; [`EnergyGuard::NONE`] for those that impulses do not move.
    island: Vec<u32>,
    /// By island: whether a moving kinematic body touches it.
    driven: Vec<bool>,
    /// By body: `p·u` and `p·p`.
    products: Vec<[f32; 2]>,
    /// By island.
    sums: Vec<[f64; 2]>,
    scale: Vec<f32>,
}

/// What is scaled besides velocities and impulses.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Guarded {
    /// The guess of the first substep: its momentum part shrinks with it.
    FirstGuess,
    /// The impulses of a later substep, carried over from the one before.
    Guess,
    /// The impulses after the sweeps.
    Result,
}

dispatched! {
    /// By body: `p·u` and `p·p`.
    fn work_and_square(before: &[Row], velocities: &[Row], products: &mut [[f32; 2]]) => work_lanes
}

#[inline(always)]
fn work_lanes<F: Lanes>(before: &[Row], velocities: &[Row], products: &mut [[f32; 2]]) {
    let last = before.len() - 1;
    for (k, products) in products.chunks_mut(LANES).enumerate() {
        let mut index = [0; LANES];
        for lane in 0..LANES {
            index[lane] = (k * LANES + lane).min(last) as u32;
        }
        let (u, v) = (F::gather(before, &index), F::gather(velocities, &index));
        let p = v[0] - u[0];
        let (mut work, mut square) = (p * u[0], p * p);
        for axis in 1..6 {
            let p = v[axis] - u[axis];
            work += p * u[axis];
            square += p * p;
        }
        let (work, square) = (work.to_array(), square.to_array());
        for (lane, product) in products.iter_mut().enumerate() {
            *product = [work[lane], square[lane]];
        }
    }
}

impl EnergyGuard {
    const NONE: u32 = u32::MAX;

    /// Numbers the islands. `driven` is by root.
    pub(crate) fn begin(&mut self, islands: &Islands, dynamic: &[bool], driven: &[bool]) {
        self.island.clear();
        self.driven.clear();
        for i in 0..dynamic.len() {
            let root = islands.root(i);
            let number = if !dynamic[i] {
                EnergyGuard::NONE
            } else if root == i {
                self.driven.push(driven[i]);
                self.driven.len() as u32 - 1
            } else {
                // The root is the lowest body of its island: it has its number.
                self.island[root]
            };
            self.island.push(number);
        }
    }

    /// How many islands there are.
    pub(crate) fn islands(&self) -> usize {
        self.driven.len()
    }

    /// The number of the island that each body is in, if impulses move it.
    pub(crate) fn island_of(&self, body: usize) -> Option<usize> {
        let island = self.island[body];
        (island != EnergyGuard::NONE).then_some(island as usize)
    }

    /// Finds the islands where what `before -> velocities` added is energy. Returns whether there are any.
    pub(crate) fn gains(&mut self, before: &[Row], velocities: &[Row], what: Guarded) -> bool {
        self.products.resize(self.island.len(), [0.0; 2]);
        work_and_square(before, velocities, &mut self.products);
        self.sum_products();
        self.scale.clear();
        let mut any = false;
        for (&[work, square], &driven) in self.sums.iter().zip(&self.driven) {
            let gains = match what {
                Guarded::FirstGuess | Guarded::Guess => square > 0.0 && -work < STEP_MIN * square,
                Guarded::Result => 0.5 * square + work > GAIN_ALLOWED * square,
            };
            let scaled = gains && !driven;
            any |= scaled;
            self.scale.push(if scaled { (-work / square).clamp(0.0, 1.0) as f32 } else { 1.0 });
        }
        any
    }

    fn sum_products(&mut self) {
        self.sums.clear();
        self.sums.resize(self.driven.len(), [0.0; 2]);
        // Neighbours are mostly of one island: its sums stay at hand.
        let (mut here, mut sums) = (EnergyGuard::NONE, [0.0; 2]);
        for (&island, &[work, square]) in self.island.iter().zip(&self.products) {
            if island == EnergyGuard::NONE {
                continue;
            }
            if island != here {
                if here != EnergyGuard::NONE {
                    self.sums[here as usize] = sums;
                }
                (here, sums) = (island, self.sums[island as usize]);
            }
            sums = [sums[0] + f64::from(work), sums[1] + f64::from(square)];
        }
        if here != EnergyGuard::NONE {
            self.sums[here as usize] = sums;
        }
    }

    /// Scales back what `before -> velocities` added to the islands that [`EnergyGuard::gains`] found.
    pub(crate) fn scale_back(&self, before: &[Row], velocities: &mut [Row]) {
        for (i, &island) in self.island.iter().enumerate() {
            if island == EnergyGuard::NONE || self.scale[island as usize] >= 1.0 {
                continue;
            }
            let s = self.scale[island as usize];
            for k in 0..6 {
                let u = before[i].0[k];
                velocities[i].0[k] = u + s * (velocities[i].0[k] - u);
            }
        }
    }

    /// Scales the impulses of the same islands.
    pub(crate) fn scale_impulses<K: Kind>(&self, arranged: &mut Arranged<K>, what: Guarded) {
        let Arranged { blocks, details, .. } = arranged;
        self.scale_blocks(blocks, details, what);
    }

    /// As [`EnergyGuard::scale_impulses`], for some of the blocks.
    pub(crate) fn scale_blocks<K: Kind>(
        &self,
        blocks: &mut [Block<Portable, K>],
        details: &mut [Detail<Portable>],
        what: Guarded,
    ) {
        for (block, detail) in blocks.iter_mut().zip(details) {
            let factor = self.per_lane(block, detail, &self.scale);
            block.impulses = block.impulses.map(|x| x * factor);
            block.friction.impulses = block.friction.impulses.map(|x| x * factor);
            if what == Guarded::FirstGuess {
                detail.momentum.points = detail.momentum.points.map(|x| x * factor);
                detail.momentum.friction = detail.momentum.friction.map(|x| x * factor);
            }
        }
    }

    /// What holds for the islands (by number) of a block's contacts; 1 in lanes without one.
    pub(crate) fn per_lane<K: Kind>(
        &self,
        block: &Block<Portable, K>,
        detail: &Detail<Portable>,
        of_island: &[f32],
    ) -> Portable {
        let mut factor = [1.0; LANES];
        for lane in (0..LANES).filter(|&lane| detail.source[lane] != NO_CONTACT) {
            let (first, second) = (block.first_row[lane] as usize, block.second_row[lane] as usize);
            if let Some(island) = self.island_of(first).or(self.island_of(second)) {
                factor[lane] = of_island[island];
            }
        }
        Portable::from_array(factor)
    }
}
