//! Standing: what the contacts of hard islands carry while nothing moves.
//!
//! The load pass cannot place the weight of heaps, arches and wedged bodies; sweeps find it, over the gravity and forces of one substep alone, as if
//! every body stood still. No velocity gets into the impulses that the substeps start from: what a sweep does against a velocity, and the next substep
//! does once more, throws the body back. Heaps that were swept in motion only rattled for ever.
//!
//! After each sweep the solution goes on along the way that it came, as far as that lowers the kinetic energy: conjugate gradients, with a sweep in
//! place of the gradient. Impulses that this makes pull are put right by the next sweep; the last sweep is a plain one.

use super::blocks::{Block, Impulses};
use super::sweep::sweep;
use super::warm_start::{EnergyGuard, Guarded, add_momentum, apply_impulses, remove_momentum};
use crate::lanes::{Portable, Row};

/// The longest way on, in lengths of the way that the solution came.
const FURTHEST: f64 = 20.0;

/// Finds what the contacts of hard islands carry.
pub(crate) struct StandingPass<'a> {
    pub(crate) guard: &'a EnergyGuard<'a>,
    /// Mass-scaled change of velocity that gravity and forces make in a substep, and the dummy's.
    pub(crate) kicks: &'a [Row],
    /// None yet: the frame begins.
    pub(crate) displacements: &'a [Row],
    pub(crate) substep_seconds: f32,
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
    pub(crate) fn run(&self, blocks: &mut [Block<Portable>]) {
        if blocks.is_empty() {
            return;
        }
        remove_momentum(blocks);
        let mut velocities = self.kicks.to_vec();
        velocities.push(Row::default());
        apply_impulses(blocks, &mut velocities);
        self.guard.check(blocks, self.kicks, &mut velocities, Guarded::Guess);
        let mut last = Solution::of(blocks, &velocities);
        let mut way = last.clone();
        for k in 0..self.sweeps {
            sweep(blocks, &mut velocities, self.displacements, self.substep_seconds);
            if k + 1 == self.sweeps {
                break;
            }
            if k > 0 {
                let lengths = self.lengths(&velocities, &last, &way);
                self.go_on(&lengths, &way, &mut velocities, blocks);
            }
            way.lead(&mut last, &velocities, blocks);
        }
        add_momentum(blocks);
    }

    /// How far each island (by root) goes on: to the least kinetic energy on the way, and nowhere if the sweep has raised it.
    fn lengths(&self, velocities: &[Row], last: &Solution, way: &Solution) -> Vec<f32> {
        let n = self.guard.dynamic.len();
        let (mut along, mut square, mut rise) = (vec![0.0f64; n], vec![0.0f64; n], vec![0.0f64; n]);
        for i in (0..n).filter(|&i| self.guard.dynamic[i]) {
            let (u, d, before) = (&velocities[i].0, &way.velocities[i].0, &last.velocities[i].0);
            let (mut ud, mut dd, mut gain) = (0.0f32, 0.0f32, 0.0f32);
            for k in 0..6 {
                ud += u[k] * d[k];
                dd += d[k] * d[k];
                gain += u[k] * u[k] - before[k] * before[k];
            }
            let root = self.guard.islands.root(i);
            along[root] += f64::from(ud);
            square[root] += f64::from(dd);
            rise[root] += f64::from(gain);
        }
        let length = |root: usize| {
            let moves = square[root] > 0.0 && rise[root] <= 0.0;
            if moves { (-along[root] / square[root]).clamp(0.0, FURTHEST) as f32 } else { 0.0 }
        };
        (0..n).map(length).collect()
    }

    fn go_on(&self, lengths: &[f32], way: &Solution, velocities: &mut [Row], blocks: &mut [Block<Portable>]) {
        for i in (0..self.guard.dynamic.len()).filter(|&i| self.guard.dynamic[i]) {
            let length = lengths[self.guard.islands.root(i)];
            for k in 0..6 {
                velocities[i].0[k] += length * way.velocities[i].0[k];
            }
        }
        for (block, way) in blocks.iter_mut().zip(&way.impulses) {
            let factor = self.guard.per_lane(block, lengths);
            for (point, way) in block.points.iter_mut().zip(way.points) {
                point.impulse += way * factor;
            }
            for (impulse, way) in block.friction.impulses.iter_mut().zip(way.tangents) {
                *impulse += way * factor;
            }
            block.friction.twist_impulse += way.twist * factor;
        }
    }
}

impl Solution {
    fn of(blocks: &[Block<Portable>], velocities: &[Row]) -> Solution {
        Solution { velocities: velocities.to_vec(), impulses: blocks.iter().map(impulses_of).collect() }
    }

    /// Makes this the way from `last` to where the solution is now, which becomes the last.
    fn lead(&mut self, last: &mut Solution, velocities: &[Row], blocks: &[Block<Portable>]) {
        for ((way, last), here) in self.velocities.iter_mut().zip(&mut last.velocities).zip(velocities) {
            *way = Row(std::array::from_fn(|k| here.0[k] - last.0[k]));
            *last = *here;
        }
        for ((way, last), block) in self.impulses.iter_mut().zip(&mut last.impulses).zip(blocks) {
            let here = impulses_of(block);
            *way = Impulses {
                points: std::array::from_fn(|q| here.points[q] - last.points[q]),
                tangents: std::array::from_fn(|i| here.tangents[i] - last.tangents[i]),
                twist: here.twist - last.twist,
            };
            *last = here;
        }
    }
}

fn impulses_of(block: &Block<Portable>) -> Impulses<Portable> {
    Impulses {
        points: std::array::from_fn(|q| block.points[q].impulse),
        tangents: block.friction.impulses,
        twist: block.friction.twist_impulse,
    }
}
