//! Warm start: the guessed impulses are applied before the sweeps, and two guards keep guess and sweeps from adding kinetic energy.

use super::blocks::{Block, Contacts, NO_CONTACT};
use super::islands::Islands;
use super::sweep::Sides;
use crate::lanes::{LANES, Lanes, Portable, Row, dispatched, recast};

/// Below this optimal step the guess would add energy as it stands (it would be neutral at one half).
const STEP_MIN: f64 = 0.52;
/// Relative gain of energy that counts as rounding.
const GAIN_ALLOWED: f64 = 1e-7;

dispatched! {
    /// Applies all impulses of all blocks to the velocities.
    pub(crate) fn apply_impulses(blocks: &mut [Block<Portable>], velocities: &mut [Row]) => apply_lanes
}

#[inline(always)]
fn apply_lanes<F: Lanes>(blocks: &mut [Block<Portable>], velocities: &mut [Row]) {
    let blocks = recast::<F, Contacts>(blocks);
    for block in blocks {
        let mut v = Sides::gather(block, velocities);
        for point in &block.points {
            v.apply(block, &point.jacobian(), point.impulse);
        }
        for i in 0..2 {
            v.apply(block, &block.tangent_jacobian(i), block.friction.impulses[i]);
        }
        v.apply(block, &block.twist_jacobian(), block.friction.twist_impulse);
        v.scatter(block, velocities);
    }
}

/// Adds the momentum to impulses that had none.
pub(crate) fn add_momentum(blocks: &mut [Block<Portable>]) {
    for block in blocks {
        for (point, momentum) in block.points.iter_mut().zip(block.momentum.points) {
            point.impulse = (point.impulse + momentum).max(Portable::zero());
        }
        for i in 0..2 {
            block.friction.impulses[i] += block.momentum.tangents[i];
        }
        block.friction.twist_impulse += block.momentum.twist;
    }
}

/// Takes the momentum out of the impulses: it has been passed on and must not be passed on again.
pub(crate) fn remove_momentum(blocks: &mut [Block<Portable>]) {
    for block in blocks {
        for (point, momentum) in block.points.iter_mut().zip(block.momentum.points) {
            point.impulse = (point.impulse - momentum).max(Portable::zero());
        }
        for i in 0..2 {
            block.friction.impulses[i] -= block.momentum.tangents[i];
        }
        block.friction.twist_impulse -= block.momentum.twist;
    }
}

/// Keeps impulses from adding kinetic energy, island by island.
///
/// With `u` the velocities before, `p` the change by the impulses, the energy along `u + s p` is least at `s = -(p·u)/(p·p)`. Sums are in
/// double precision and in the order of the bodies. Islands on moving kinematic bodies are left alone: these do add energy.
pub(crate) struct EnergyGuard<'a> {
    pub(crate) islands: &'a Islands,
    pub(crate) dynamic: &'a [bool],
    /// Per island root: whether a moving kinematic body touches it.
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

impl EnergyGuard<'_> {
    /// Scales back what `before -> velocities` added, where it added energy.
    pub(crate) fn check(
        &self,
        blocks: &mut [Block<Portable>],
        before: &[Row],
        velocities: &mut [Row],
        what: Guarded,
    ) {
        let n = self.dynamic.len();
        let (mut work, mut square) = (vec![0.0f64; n], vec![0.0f64; n]);
        for i in (0..n).filter(|&i| self.dynamic[i]) {
            let (mut pu, mut pp) = (0.0f32, 0.0f32);
            for k in 0..6 {
                let p = velocities[i].0[k] - before[i].0[k];
                pu += p * before[i].0[k];
                pp += p * p;
            }
            let root = self.islands.root(i);
            work[root] += f64::from(pu);
            square[root] += f64::from(pp);
        }
        let mut scale = vec![1.0f32; n];
        let mut any = false;
        for root in 0..n {
            let (pu, pp) = (work[root], square[root]);
            let gains = match what {
                Guarded::FirstGuess | Guarded::Guess => pp > 0.0 && -pu < STEP_MIN * pp,
                Guarded::Result => 0.5 * pp + pu > GAIN_ALLOWED * pp,
            };
            if gains && !self.driven[root] {
                scale[root] = (-pu / pp).clamp(0.0, 1.0) as f32;
                any = true;
            }
        }
        if any {
            self.scale_back(&scale, before, velocities);
            self.scale_impulses(&scale, blocks, what);
        }
    }

    fn scale_back(&self, scale: &[f32], before: &[Row], velocities: &mut [Row]) {
        for i in (0..self.dynamic.len()).filter(|&i| self.dynamic[i]) {
            let s = scale[self.islands.root(i)];
            if s < 1.0 {
                for k in 0..6 {
                    let u = before[i].0[k];
                    velocities[i].0[k] = u + s * (velocities[i].0[k] - u);
                }
            }
        }
    }

    /// What holds for the islands (by root) of a block's contacts; 1 in lanes without one.
    pub(crate) fn per_lane(&self, block: &Block<Portable>, of_root: &[f32]) -> Portable {
        let mut factor = [1.0; LANES];
        for lane in (0..LANES).filter(|&lane| block.source[lane] != NO_CONTACT) {
            let (a, b) = (block.first[lane] as usize, block.second[lane] as usize);
            factor[lane] = of_root[self.islands.root(if self.dynamic[a] { a } else { b })];
        }
        Portable::from_array(factor)
    }

    fn scale_impulses(&self, scale: &[f32], blocks: &mut [Block<Portable>], what: Guarded) {
        for block in blocks {
            let factor = self.per_lane(block, scale);
            for point in &mut block.points {
                point.impulse = point.impulse * factor;
            }
            block.friction.impulses = block.friction.impulses.map(|x| x * factor);
            block.friction.twist_impulse = block.friction.twist_impulse * factor;
            if what == Guarded::FirstGuess {
                block.momentum.points = block.momentum.points.map(|x| x * factor);
                block.momentum.tangents = block.momentum.tangents.map(|x| x * factor);
                block.momentum.twist = block.momentum.twist * factor;
            }
        }
    }
}
