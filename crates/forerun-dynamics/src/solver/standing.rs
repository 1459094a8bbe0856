//! Standing: what the contacts of hard islands carry while nothing moves.
//!
//! The load pass cannot place the weight of heaps, arches and wedged bodies; sweeps find it, over the gravity and forces of one substep alone, as if
//! every body stood still. No velocity gets into the impulses that the substeps start from: what a sweep does against a velocity, and the next substep
//! does once more, throws the body back. Heaps that were swept in motion only rattled for ever: fallen dominoes at 20 mm/s in the median, now 3.
//!
//! After each sweep the solution goes on along the way that it came, as far as that lowers the kinetic energy: conjugate gradients, with a sweep in
//! place of the gradient. Impulses that this makes pull are put right by the next sweep; the last sweep is a plain one.

use super::blocks::{Block, Detail, Impulses};
use super::energy_guard::{EnergyGuard, Guarded, Guarding, per_lane};
use super::points::Kind;
use super::sweep::sweep;
use super::warm_start::{add_momentum, apply_impulses, take_off_momentum};
use crate::lanes::{Portable, Row, cells};

/// The longest way on, in lengths of the way that the solution came.
const FURTHEST: f64 = 20.0;

/// Finds what the contacts of hard islands carry.
pub(crate) struct StandingPass<'a> {
    pub(crate) guard: &'a mut EnergyGuard,
    pub(crate) at: Guarding<'a>,
    /// Mass-scaled change of velocity that gravity and forces make in a substep, and the dummy's.
    pub(crate) kicks: &'a [Row],
    pub(crate) sweeps: u32,
}

/// Velocities and impulses that belong together.
#[derive(Clone)]
struct Solution {
    velocities: Vec<Row>,
    impulses: Vec<Impulses<Portable>>,
}

impl StandingPass<'_> {
    /// Betters the weight in the first guess of the blocks; the momentum in it stays.
    pub(crate) fn run<K: Kind>(
        &mut self,
        blocks: &mut [Block<Portable, K>],
        details: &mut [Detail<Portable>],
    ) {
        if blocks.is_empty() {
            return;
        }
        take_off_momentum(blocks, details);
        let mut velocities = self.kicks.to_vec();
        apply_impulses(blocks, cells(&mut velocities));
        let islands = self.at.islands;
        if self.guard.gains(self.at, self.kicks, &velocities, Guarded::Guess) {
            self.guard.scale_back(islands, self.kicks, &mut velocities);
            self.guard.scale_impulses(islands, (blocks, details), Guarded::Guess);
        }
        let mut last = Solution::of(blocks, &velocities);
        let mut way = last.clone();
        for k in 0..self.sweeps {
            sweep(blocks, cells(&mut velocities));
            if k + 1 == self.sweeps {
                break;
            }
            if k > 0 {
                let lengths = self.lengths(&velocities, &last, &way);
                self.go_on(&lengths, &way, &mut velocities, (&mut *blocks, &*details));
            }
            way.lead(&mut last, &velocities, blocks);
        }
        add_momentum(blocks, details);
    }

    /// How far each island goes on: to the least kinetic energy on the way, and nowhere if the sweep has raised it.
    fn lengths(&self, velocities: &[Row], last: &Solution, way: &Solution) -> Vec<f32> {
        let n = self.at.islands.count() + 1;
        let (mut along, mut square, mut rise) = (vec![0.0f64; n], vec![0.0f64; n], vec![0.0f64; n]);
        for (i, &island) in self.at.islands.numbers().iter().enumerate() {
            let island = island as usize;
            let (u, d, before) = (&velocities[i].0, &way.velocities[i].0, &last.velocities[i].0);
            let (mut ud, mut dd, mut gain) = (0.0f32, 0.0f32, 0.0f32);
            for k in 0..6 {
                ud += u[k] * d[k];
                dd += d[k] * d[k];
                gain += u[k] * u[k] - before[k] * before[k];
            }
            along[island] += f64::from(ud);
            square[island] += f64::from(dd);
            rise[island] += f64::from(gain);
        }
        let length = |island: usize| {
            let moves = square[island] > 0.0 && rise[island] <= 0.0;
            if moves { (-along[island] / square[island]).clamp(0.0, FURTHEST) as f32 } else { 0.0 }
        };
        (0..n).map(length).collect()
    }

    fn go_on<K: Kind>(
        &self,
        lengths: &[f32],
        way: &Solution,
        velocities: &mut [Row],
        (blocks, details): (&mut [Block<Portable, K>], &[Detail<Portable>]),
    ) {
        for (i, &island) in self.at.islands.numbers().iter().enumerate() {
            let island = island as usize;
            for k in 0..6 {
                velocities[i].0[k] += lengths[island] * way.velocities[i].0[k];
            }
        }
        for ((block, detail), way) in blocks.iter_mut().zip(details).zip(&way.impulses) {
            let factor = per_lane(self.at.islands, block, detail, lengths);
            for q in 0..4 {
                block.impulses[q] += way.points[q] * factor;
            }
            for k in 0..3 {
                block.friction.impulses[k] += way.friction[k] * factor;
            }
        }
    }
}

impl Solution {
    fn of<K: Kind>(blocks: &[Block<Portable, K>], velocities: &[Row]) -> Solution {
        Solution { velocities: velocities.to_vec(), impulses: blocks.iter().map(impulses_of).collect() }
    }

    /// Makes this the way from `last` to where the solution is now, which becomes the last.
    fn lead<K: Kind>(&mut self, last: &mut Solution, velocities: &[Row], blocks: &[Block<Portable, K>]) {
        for ((way, last), here) in self.velocities.iter_mut().zip(&mut last.velocities).zip(velocities) {
            *way = Row(std::array::from_fn(|k| here.0[k] - last.0[k]));
            *last = *here;
        }
        for ((way, last), block) in self.impulses.iter_mut().zip(&mut last.impulses).zip(blocks) {
            let here = impulses_of(block);
            *way = Impulses {
                points: std::array::from_fn(|q| here.points[q] - last.points[q]),
                friction: std::array::from_fn(|k| here.friction[k] - last.friction[k]),
            };
            *last = here;
        }
    }
}

fn impulses_of<K: Kind>(block: &Block<Portable, K>) -> Impulses<Portable> {
    Impulses { points: block.impulses, friction: block.friction.impulses }
}
