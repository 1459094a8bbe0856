//! Energy guard: keeps guess and sweeps from adding kinetic energy, island by island.
//!
//! With `u` the velocities before, `p` the change by the impulses, the energy along `u + s p` is least at `s = -(p·u)/(p·p)`. Sums are in
//! double precision and in the order of the bodies. Islands on moving kinematic bodies are left alone: these do add energy.

use super::blocks::{Block, Detail, NO_CONTACT};
use super::islands::Islands;
use super::points::Kind;
use crate::lanes::{LANES, Lanes, Portable, Row, dispatched};
use crate::scratch::fill;

/// Below this optimal step the guess would add energy as it stands (it would be neutral at one half).
const STEP_MIN: f64 = 0.52;
/// Relative gain of energy that counts as rounding.
const GAIN_ALLOWED: f64 = 1e-7;

/// What the islands of a batch gain in energy.
#[derive(Debug, Default)]
pub(crate) struct EnergyGuard {
    /// By body: `p·u` and `p·p`.
    products: Vec<[f32; 2]>,
    /// By island.
    sums: Vec<[f64; 2]>,
    /// By island, and 1 for those who belong to none.
    scale: Vec<f32>,
}

/// The islands of a batch.
#[derive(Clone, Copy)]
pub(crate) struct Guarding<'a> {
    pub(crate) islands: &'a Islands,
    /// By island: whether a moving kinematic body touches it.
    pub(crate) driven: &'a [bool],
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
    /// Finds the islands where what `before -> velocities` added is energy. Returns whether there are any.
    pub(crate) fn gains(&mut self, at: Guarding, before: &[Row], velocities: &[Row], what: Guarded) -> bool {
        let numbers = at.islands.numbers();
        self.products.resize(numbers.len(), [0.0; 2]);
        work_and_square(before, velocities, &mut self.products);
        fill(&mut self.sums, at.islands.count() + 1, [0.0; 2]);
        // Neighbours are of one island: its sums stay at hand.
        let (mut here, mut sums) = (0, [0.0; 2]);
        for (&island, &[work, square]) in numbers.iter().zip(&self.products) {
            if island as usize != here {
                self.sums[here] = sums;
                here = island as usize;
                sums = self.sums[here];
            }
            sums = [sums[0] + f64::from(work), sums[1] + f64::from(square)];
        }
        self.sums[here] = sums;
        self.scale.clear();
        let mut any = false;
        for (&[work, square], &driven) in self.sums[..at.islands.count()].iter().zip(at.driven) {
            let gains = match what {
                Guarded::FirstGuess | Guarded::Guess => square > 0.0 && -work < STEP_MIN * square,
                Guarded::Result => 0.5 * square + work > GAIN_ALLOWED * square,
            };
            let scaled = gains && !driven;
            any |= scaled;
            self.scale.push(if scaled { (-work / square).clamp(0.0, 1.0) as f32 } else { 1.0 });
        }
        self.scale.push(1.0);
        any
    }

    /// Scales back what `before -> velocities` added to the islands that [`EnergyGuard::gains`] found.
    pub(crate) fn scale_back(&self, islands: &Islands, before: &[Row], velocities: &mut [Row]) {
        for (i, &island) in islands.numbers().iter().enumerate() {
            let s = self.scale[island as usize];
            if s < 1.0 {
                for k in 0..6 {
                    let u = before[i].0[k];
                    velocities[i].0[k] = u + s * (velocities[i].0[k] - u);
                }
            }
        }
    }

    /// Scales the impulses of the same islands.
    pub(crate) fn scale_impulses<K: Kind>(
        &self,
        islands: &Islands,
        (blocks, details): (&mut [Block<Portable, K>], &mut [Detail<Portable>]),
        what: Guarded,
    ) {
        for (block, detail) in blocks.iter_mut().zip(details) {
            let factor = per_lane(islands, block, detail, &self.scale);
            block.impulses = block.impulses.map(|x| x * factor);
            block.friction.impulses = block.friction.impulses.map(|x| x * factor);
            if what == Guarded::FirstGuess {
                detail.momentum.points = detail.momentum.points.map(|x| x * factor);
                detail.momentum.friction = detail.momentum.friction.map(|x| x * factor);
            }
        }
    }
}

/// What holds for the islands (by number) of a block's contacts; 1 in lanes without one.
pub(crate) fn per_lane<K: Kind>(
    islands: &Islands,
    block: &Block<Portable, K>,
    detail: &Detail<Portable>,
    of_island: &[f32],
) -> Portable {
    let mut factor = [1.0; LANES];
    for lane in (0..LANES).filter(|&lane| detail.source[lane] != NO_CONTACT) {
        let (first, second) = (block.first_row[lane] as usize, block.second_row[lane] as usize);
        // Bodies that do not yield have the highest number.
        factor[lane] = of_island[islands.root(first).min(islands.root(second))];
    }
    Portable::from_array(factor)
}
