//! Descent: sweeps that take hard islands to the least kinetic energy that their contacts allow, in far fewer rounds than sweeps alone.
//!
//! After each sweep, down and up, the solution goes on along the sweep's own change and along the whole of the last round, to where the energy is
//! least on the plane of the two: conjugate gradients, with a symmetric sweep in place of the gradient (as in Silcowitz-Hansen, Niebe, Erleben:
//! *A nonsmooth nonlinear conjugate gradient method for interactive contact force problems*, 2010). Impulses that this makes pull are put right by the
//! next sweep; the last sweep is a plain one. The number of sweeps is fixed: to stop at a tolerance makes noise of its own (measured).

use super::blocks::{Block, Detail, Impulses, NO_CONTACT};
use super::energy_guard::{Guarding, per_lane};
use super::islands::Islands;
use super::points::Kind;
use super::sweep::{Law, sweep_both_ways};
use crate::lanes::{LANES, Lanes, Portable, Row, cells};
use crate::scratch::fill;

/// The longest way on, in lengths of the last round.
const FURTHEST: f64 = 20.0;
/// How much of a sweep may be taken back, and how far beyond it the solution may go.
const SWEEP_PART: (f64, f64) = (-0.5, 2.0);

/// How much is done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sweeps {
    /// Sweeps, each down and up.
    pub(crate) count: u32,
    /// Of all sweeps but the last, which is by Coulomb's.
    pub(crate) law: Law,
}

/// Whole islands that are solved together.
pub(crate) struct Hard<'a, K: Kind> {
    pub(crate) at: Guarding<'a>,
    pub(crate) blocks: &'a mut [Block<Portable, K>],
    pub(crate) details: &'a [Detail<Portable>],
}

/// Memory for the descent.
#[derive(Debug, Default)]
pub(crate) struct Descent {
    /// Velocities for the standing pass.
    pub(crate) standing: Vec<Row>,
    /// Bodies that the blocks move, rising.
    bodies: Vec<u32>,
    /// Before the sweep.
    last: Solution,
    /// The last round: sweep and way on.
    way: Solution,
    /// By island.
    sums: Vec<Sums>,
    /// By island: how far to go on along the sweep, and along the last round.
    along_sweep: Vec<f32>,
    along_way: Vec<f32>,
}

/// Velocities (by body of the descent) and impulses (by block) that belong together.
#[derive(Debug, Default)]
struct Solution {
    velocities: Vec<Row>,
    impulses: Vec<Impulses<Portable>>,
}

/// Products of velocities `u`, of the sweep's change `z` and of the last round `d`; with what open gaps add to the energy.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    zz: f64,
    zd: f64,
    dd: f64,
    /// Slopes of the energy along both.
    along_z: f64,
    along_d: f64,
    /// Twice what the sweep took off the energy.
    gain: f64,
}

impl Descent {
    /// Sweeps the islands.
    pub(crate) fn run<K: Kind>(&mut self, islands: Hard<K>, velocities: &mut [Row], sweeps: Sweeps) {
        if islands.blocks.is_empty() {
            return;
        }
        let Hard { at, blocks, details } = islands;
        self.begin(at.islands, blocks, velocities);
        for k in 1..sweeps.count {
            sweep_both_ways(blocks, cells(velocities), sweeps.law);
            if k > 1 {
                self.find_lengths(at, blocks, details, velocities);
                self.go_on(at.islands, blocks, details, velocities);
            }
            self.note(blocks, velocities);
        }
        sweep_both_ways(blocks, cells(velocities), Law::Coulomb);
    }

    fn begin<K: Kind>(&mut self, islands: &Islands, blocks: &[Block<Portable, K>], velocities: &[Row]) {
        self.bodies.clear();
        for block in blocks {
            let moved = block.first_out.iter().chain(&block.second_out);
            self.bodies.extend(moved.filter(|&&i| (i as usize) < islands.numbers().len()));
        }
        self.bodies.sort_unstable();
        self.bodies.dedup();
        self.last.velocities.clear();
        self.last.velocities.extend(self.bodies.iter().map(|&i| velocities[i as usize]));
        self.last.impulses.clear();
        self.last.impulses.extend(blocks.iter().map(impulses_of));
        self.way.velocities.clear();
        self.way.velocities.resize(self.bodies.len(), Row::default());
        self.way.impulses.clone_from(&self.last.impulses);
    }

    /// Makes what was done since the last note the way, and what there is now the last solution.
    fn note<K: Kind>(&mut self, blocks: &[Block<Portable, K>], velocities: &[Row]) {
        let (last, way) = (&mut self.last, &mut self.way);
        for ((&body, last), way) in self.bodies.iter().zip(&mut last.velocities).zip(&mut way.velocities) {
            let here = velocities[body as usize];
            *way = Row(std::array::from_fn(|k| here.0[k] - last.0[k]));
            *last = here;
        }
        for ((block, last), way) in blocks.iter().zip(&mut last.impulses).zip(&mut way.impulses) {
            let here = impulses_of(block);
            *way = change(&here, last);
            *last = here;
        }
    }

    /// How far each island goes on: to the least energy on the plane, and nowhere if the sweep has raised it.
    fn find_lengths<K: Kind>(
        &mut self,
        at: Guarding,
        blocks: &[Block<Portable, K>],
        details: &[Detail<Portable>],
        velocities: &[Row],
    ) {
        fill(&mut self.sums, at.islands.count() + 1, Sums::default());
        for (k, &body) in self.bodies.iter().enumerate() {
            let (u, d) = (&velocities[body as usize], &self.way.velocities[k]);
            self.sums[at.islands.root(body as usize)].add_body(u, d, &self.last.velocities[k]);
        }
        for (k, (block, detail)) in blocks.iter().zip(details).enumerate() {
            let swept = change(&impulses_of(block), &self.last.impulses[k]);
            let (along_z, along_d) = (opened(block, &swept), opened(block, &self.way.impulses[k]));
            let (along_z, along_d) = (along_z.to_array(), along_d.to_array());
            for lane in (0..LANES).filter(|&lane| detail.source[lane] != NO_CONTACT) {
                let (first, second) = (block.first_row[lane] as usize, block.second_row[lane] as usize);
                let island = at.islands.root(first).min(at.islands.root(second));
                self.sums[island].add_gaps(along_z[lane], along_d[lane]);
            }
        }
        self.along_sweep.clear();
        self.along_way.clear();
        for (island, sums) in self.sums.iter().enumerate() {
            // Moving kinematic bodies do work: what is least there is not the energy.
            let (along_sweep, along_way) = if at.driven[island] { (0.0, 0.0) } else { sums.lengths() };
            self.along_sweep.push(along_sweep);
            self.along_way.push(along_way);
        }
    }

    fn go_on<K: Kind>(
        &self,
        islands: &Islands,
        blocks: &mut [Block<Portable, K>],
        details: &[Detail<Portable>],
        velocities: &mut [Row],
    ) {
        for (k, &body) in self.bodies.iter().enumerate() {
            let island = islands.root(body as usize);
            let (a, b) = (self.along_sweep[island], self.along_way[island]);
            let (last, way) = (&self.last.velocities[k].0, &self.way.velocities[k].0);
            let u = &mut velocities[body as usize].0;
            for axis in 0..6 {
                u[axis] += a * (u[axis] - last[axis]) + b * way[axis];
            }
        }
        for (k, (block, detail)) in blocks.iter_mut().zip(details).enumerate() {
            let a = per_lane(islands, block, detail, &self.along_sweep);
            let b = per_lane(islands, block, detail, &self.along_way);
            let (last, way) = (&self.last.impulses[k], &self.way.impulses[k]);
            for q in 0..4 {
                let here = block.impulses[q];
                block.impulses[q] = here + a * (here - last.points[q]) + b * way.points[q];
            }
            for q in 0..3 {
                let here = block.friction.impulses[q];
                block.friction.impulses[q] = here + a * (here - last.friction[q]) + b * way.friction[q];
            }
        }
    }
}

impl Sums {
    fn add_body(&mut self, u: &Row, d: &Row, before: &Row) {
        let mut sums = [0.0f32; 6];
        for k in 0..6 {
            let (u, d, before) = (u.0[k], d.0[k], before.0[k]);
            let z = u - before;
            sums[0] += z * z;
            sums[1] += z * d;
            sums[2] += d * d;
            sums[3] += u * z;
            sums[4] += u * d;
            sums[5] += before * before - u * u;
        }
        let [zz, zd, dd, uz, ud, gain] = sums.map(f64::from);
        self.zz += zz;
        self.zd += zd;
        self.dd += dd;
        self.along_z += uz;
        self.along_d += ud;
        self.gain += gain;
    }

    /// Impulses at open gaps do no work until these are closed.
    fn add_gaps(&mut self, along_z: f32, along_d: f32) {
        self.along_z += f64::from(along_z);
        self.along_d += f64::from(along_d);
        self.gain -= 2.0 * f64::from(along_z);
    }

    fn lengths(&self) -> (f32, f32) {
        let Sums { zz, zd, dd, along_z, along_d, gain } = *self;
        if dd <= 0.0 || gain < 0.0 {
            return (0.0, 0.0);
        }
        let determinant = zz * dd - zd * zd;
        let a = if determinant > 1e-9 * zz * dd { (along_d * zd - along_z * dd) / determinant } else { 0.0 };
        let a = a.clamp(SWEEP_PART.0, SWEEP_PART.1);
        let b = (-(along_d + a * zd) / dd).clamp(0.0, FURTHEST);
        (a as f32, b as f32)
    }
}

fn impulses_of<K: Kind>(block: &Block<Portable, K>) -> Impulses<Portable> {
    Impulses { points: block.impulses, friction: block.friction.impulses }
}

fn change(here: &Impulses<Portable>, last: &Impulses<Portable>) -> Impulses<Portable> {
    Impulses {
        points: std::array::from_fn(|q| here.points[q] - last.points[q]),
        friction: std::array::from_fn(|k| here.friction[k] - last.friction[k]),
    }
}

/// What impulses at the open gaps of a block add to the energy.
fn opened<K: Kind>(block: &Block<Portable, K>, impulses: &Impulses<Portable>) -> Portable {
    let mut sum = Portable::zero();
    for q in 0..4 {
        sum += impulses.points[q] * block.allowed[q];
    }
    sum
}
