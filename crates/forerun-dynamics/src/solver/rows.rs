//! Rows: the blocks of both kinds, and the passes over them.
//!
//! An island is wholly of one kind, so that it does not matter which kind goes first.

use std::cell::Cell;

use rayon::prelude::*;

use super::blocks::{Arranged, Block, Class, Detail};
use super::bodies::Bodies;
use super::collisions::{Ahead, Moving, resolve_collisions};
use super::descent::{Descent, Hard, Sweeps};
use super::energy_guard::{EnergyGuard, Guarded, Guarding};
use super::impulses::{Sums, add_substep};
use super::islands::Islands;
use super::manifolds::Source;
use super::overlap::overlap_growth;
use super::points::{Flat, Kind, Uneven};
use super::prepare::{Common, prepare};
use super::shared::{Least, Shared};
use super::shock::{propagate_classic, propagate_shock};
use super::standing::StandingPass;
use super::sweep::{relax, sweep};
use super::team::Lead;
use super::warm_start::{apply_impulses, remove_momentum};
use crate::StepSettings;
use crate::lanes::{Portable, Row, cells};

/// A share of fewer blocks is not worth a thread.
const BLOCKS_PER_SHARE: usize = 128;

/// All blocks of a batch.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    /// Of islands in which every manifold is flat.
    pub(crate) flat: Arranged<Flat>,
    /// Of the others.
    pub(crate) uneven: Arranged<Uneven>,
}

impl Rows {
    /// Fills the blocks in; those that are shared out, by all threads.
    pub(crate) fn prepare(&mut self, bodies: &Bodies, source: &Source, common: &Common) {
        self.flat.prepare(bodies, source, common);
        self.uneven.prepare(bodies, source, common);
    }

    /// Into how many shares the blocks are cut, at least of one kind; 1 where one thread does them all.
    pub(crate) fn share_count(&self) -> usize {
        self.flat.shares.len().max(self.uneven.shares.len()).max(1)
    }

    pub(crate) fn resolve_collisions(&self, moving: &mut Moving) {
        resolve_collisions(&self.flat.blocks, &self.flat.details, moving);
        resolve_collisions(&self.uneven.blocks, &self.uneven.details, moving);
    }

    pub(crate) fn apply_impulses(&mut self, velocities: &mut [Row], team: &mut Lead) {
        self.flat.pass(team, velocities, |blocks, _, rows| apply_impulses(blocks, rows));
        self.uneven.pass(team, velocities, |blocks, _, rows| apply_impulses(blocks, rows));
    }

    pub(crate) fn remove_momentum(&mut self, pushes: &mut [Row]) {
        let pushes = cells(pushes);
        remove_momentum(&mut self.flat.blocks, &self.flat.details, pushes);
        remove_momentum(&mut self.uneven.blocks, &self.uneven.details, pushes);
    }

    pub(crate) fn scale_impulses(&mut self, guard: &EnergyGuard, islands: &Islands, what: Guarded) {
        let Rows { flat, uneven } = self;
        guard.scale_impulses(islands, (&mut flat.blocks, &mut flat.details), what);
        guard.scale_impulses(islands, (&mut uneven.blocks, &mut uneven.details), what);
    }

    pub(crate) fn sweep(&mut self, velocities: &mut [Row], team: &mut Lead) {
        self.flat.pass(team, velocities, |blocks, _, rows| sweep(blocks, rows));
        self.uneven.pass(team, velocities, |blocks, _, rows| sweep(blocks, rows));
    }

    /// Finds what the contacts of a class carry.
    pub(crate) fn stand(&mut self, class: Class, standing: &mut StandingPass, sweeps: u32) {
        let chosen = self.flat.of(class);
        let Arranged { blocks, details, .. } = &mut self.flat;
        standing.run(&mut blocks[chosen.clone()], &mut details[chosen], sweeps);
        let chosen = self.uneven.of(class);
        let Arranged { blocks, details, .. } = &mut self.uneven;
        standing.run(&mut blocks[chosen.clone()], &mut details[chosen], sweeps);
    }

    /// Sweeps delicate islands some more.
    pub(crate) fn descend(
        &mut self,
        descent: &mut Descent,
        at: Guarding,
        velocities: &mut [Row],
        sweeps: Sweeps,
    ) {
        let chosen = self.flat.of(Class::Delicate);
        let Arranged { blocks, details, .. } = &mut self.flat;
        let hard = Hard { at, blocks: &mut blocks[chosen.clone()], details: &details[chosen] };
        descent.run(hard, velocities, sweeps);
        let chosen = self.uneven.of(Class::Delicate);
        let Arranged { blocks, details, .. } = &mut self.uneven;
        let hard = Hard { at, blocks: &mut blocks[chosen.clone()], details: &details[chosen] };
        descent.run(hard, velocities, sweeps);
    }

    /// Returns the least separation that was met. Metres.
    pub(crate) fn relax(&mut self, velocities: &mut [Row], ahead: &Ahead, team: &mut Lead) -> f32 {
        let least = Least::default();
        self.flat.pass(team, velocities, |blocks, details, rows| {
            least.note(|gap| relax(blocks, details, rows, ahead, gap));
        });
        self.uneven.pass(team, velocities, |blocks, details, rows| {
            least.note(|gap| relax(blocks, details, rows, ahead, gap));
        });
        least.get()
    }

    pub(crate) fn add_impulses(&self, sums: &mut Sums) {
        add_substep(sums, &self.flat);
        add_substep(sums, &self.uneven);
    }

    /// One pass over all blocks; see [`propagate_shock`].
    pub(crate) fn propagate_shock(
        &mut self,
        displacements: &mut [Row],
        settings: &StepSettings,
        team: &mut Lead,
    ) {
        self.flat.pass(team, displacements, |blocks, details, rows| {
            propagate_shock(blocks, details, rows, settings);
        });
        self.uneven.pass(team, displacements, |blocks, details, rows| {
            propagate_shock(blocks, details, rows, settings);
        });
    }

    /// One pass over the blocks of islands that are not easy.
    pub(crate) fn propagate_more_shock(&self, displacements: &mut [Row], settings: &StepSettings) {
        let displacements = cells(displacements);
        let Arranged { blocks, details, .. } = &self.flat;
        let start = self.flat.of(Class::Overlapping).start;
        propagate_shock(&blocks[start..], &details[start..], displacements, settings);
        let Arranged { blocks, details, .. } = &self.uneven;
        let start = self.uneven.of(Class::Overlapping).start;
        propagate_shock(&blocks[start..], &details[start..], displacements, settings);
    }

    pub(crate) fn propagate_classic(
        &self,
        velocities: &mut [Row],
        displacements: &[Row],
        substep_seconds: f32,
    ) {
        let velocities = cells(velocities);
        let Arranged { blocks, details, .. } = &self.flat;
        propagate_classic(blocks, details, velocities, displacements, substep_seconds);
        let Arranged { blocks, details, .. } = &self.uneven;
        propagate_classic(blocks, details, velocities, displacements, substep_seconds);
    }

    pub(crate) fn overlap_growth(&self, displacements: &[Row], growth: &mut [f32]) {
        overlap_growth(&self.flat.blocks, &self.flat.details, displacements, growth);
        overlap_growth(&self.uneven.blocks, &self.uneven.details, displacements, growth);
    }
}

impl<K: Kind> Arranged<K> {
    fn prepare(&mut self, bodies: &Bodies, source: &Source, common: &Common) {
        // Every block is filled in for itself.
        if self.shares.len() < 2 {
            prepare(&mut self.blocks, &mut self.details, bodies, source, common);
        } else {
            let parts = self.blocks.par_chunks_mut(BLOCKS_PER_SHARE);
            parts.zip(self.details.par_chunks_mut(BLOCKS_PER_SHARE)).for_each(|(blocks, details)| {
                prepare(blocks, details, bodies, source, common);
            });
        }
    }

    /// Has `kernel` go over all blocks in their order: at once, or, where the island has been shared out, over parts of it side by side.
    #[allow(unsafe_code, reason = "hands out parts of the blocks to several threads")]
    fn pass(
        &mut self,
        team: &mut Lead,
        rows: &mut [Row],
        kernel: impl Fn(&mut [Block<Portable, K>], &[Detail<Portable>], &[Cell<Row>]) + Sync,
    ) {
        if self.shares.len() < 2 {
            kernel(&mut self.blocks, &self.details, cells(rows));
            return;
        }
        let (blocks, details, rows) = (Shared::of(&mut self.blocks), &self.details, Shared::of(rows));
        team.run(&self.shares, &|part| {
            // SAFETY: the team hands every part to one thread. Rows are those of bodies: blocks that move a common body come one after the other, a
            // body that nobody moves is not written, and what no one reads is written to a row of the share's own.
            let (blocks, rows) = unsafe { (blocks.part(part.clone()), rows.cells()) };
            kernel(blocks, &details[part], rows);
        });
    }

    /// Shares the blocks out among `count` threads, if they are worth it. The rows of the batch are `count - 1` more than those of its bodies, the
    /// dummy's and the one that nobody reads.
    pub(crate) fn share_out(&mut self, count: usize, bodies: usize) {
        if count < 2 || self.blocks.len() < BLOCKS_PER_SHARE * count {
            self.shares.clear();
            return;
        }
        let ends = self.runs.iter().skip(1).map(|&run| run as usize).chain([self.blocks.len()]);
        let runs = self.runs.iter().zip(ends).map(|(&start, end)| start as usize..end);
        let unread = bodies as u32 + 1;
        let blocks = &self.blocks;
        let moved = |block: usize| {
            let Block { first_out, second_out, .. } = &blocks[block];
            first_out.iter().chain(second_out).copied().filter(move |&row| row < unread)
        };
        self.shares.make(count, runs, bodies, moved);
        for share in 0..count {
            for part in self.shares.parts(share) {
                for block in &mut self.blocks[part.start as usize..part.end as usize] {
                    for out in block.first_out.iter_mut().chain(&mut block.second_out) {
                        *out += if *out == unread { share as u32 } else { 0 };
                    }
                }
            }
        }
    }
}
