//! Rows: the blocks of both kinds, and the passes over them.
//!
//! An island is wholly of one kind, so that it does not matter which kind goes first.

use std::ops::RangeInclusive;

use super::blocks::{Arranged, Class};
use super::collisions::{Moving, resolve_collisions};
use super::descent::{Descent, Hard, Sweeps};
use super::energy_guard::{EnergyGuard, Guarded, Guarding};
use super::impulses::add_substep;
use super::islands::Islands;
use super::overlap::overlap_growth;
use super::points::{Flat, Uneven};
use super::shock::{propagate_classic, propagate_shock};
use super::sweep::{relax, sweep};
use super::warm_start::{apply_impulses, remove_momentum};
use crate::StepSettings;
use crate::lanes::Row;

/// All blocks of a batch.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    /// Of islands in which every manifold is flat.
    pub(crate) flat: Arranged<Flat>,
    /// Of the others.
    pub(crate) uneven: Arranged<Uneven>,
}

impl Rows {
    pub(crate) fn resolve_collisions(&self, moving: &mut Moving) {
        resolve_collisions(&self.flat.blocks, &self.flat.details, moving);
        resolve_collisions(&self.uneven.blocks, &self.uneven.details, moving);
    }

    pub(crate) fn apply_impulses(&self, velocities: &mut [Row]) {
        apply_impulses(&self.flat.blocks, velocities);
        apply_impulses(&self.uneven.blocks, velocities);
    }

    pub(crate) fn remove_momentum(&mut self, pushes: &mut [Row]) {
        remove_momentum(&mut self.flat.blocks, &self.flat.details, pushes);
        remove_momentum(&mut self.uneven.blocks, &self.uneven.details, pushes);
    }

    pub(crate) fn scale_impulses(&mut self, guard: &EnergyGuard, islands: &Islands, what: Guarded) {
        let Rows { flat, uneven } = self;
        guard.scale_impulses(islands, (&mut flat.blocks, &mut flat.details), what);
        guard.scale_impulses(islands, (&mut uneven.blocks, &mut uneven.details), what);
    }

    /// Delicate islands are left to [`Rows::descend`].
    pub(crate) fn sweep(&mut self, velocities: &mut [Row]) {
        let end = self.flat.of(Class::Delicate).start;
        sweep(&mut self.flat.blocks[..end], velocities);
        let end = self.uneven.of(Class::Delicate).start;
        sweep(&mut self.uneven.blocks[..end], velocities);
    }

    /// Solves delicate islands.
    pub(crate) fn descend(
        &mut self,
        descent: &mut Descent,
        at: Guarding,
        velocities: &mut [Row],
        sweeps: Sweeps,
    ) {
        let delicate = self.flat.of(Class::Delicate);
        let Arranged { blocks, details, .. } = &mut self.flat;
        let hard = Hard { at, blocks: &mut blocks[delicate.clone()], details: &details[delicate] };
        descent.run(hard, velocities, sweeps);
        let delicate = self.uneven.of(Class::Delicate);
        let Arranged { blocks, details, .. } = &mut self.uneven;
        let hard = Hard { at, blocks: &mut blocks[delicate.clone()], details: &details[delicate] };
        descent.run(hard, velocities, sweeps);
    }

    pub(crate) fn relax(&mut self, moving: &mut Moving, bounces: bool) {
        relax(&mut self.flat.blocks, &self.flat.details, moving, bounces);
        relax(&mut self.uneven.blocks, &self.uneven.details, moving, bounces);
    }

    pub(crate) fn add_impulses(&self, sums: &mut [[f32; 4]]) {
        add_substep(sums, &self.flat);
        add_substep(sums, &self.uneven);
    }

    /// One pass over the blocks of islands of these classes; see [`propagate_shock`].
    pub(crate) fn propagate_shock(
        &self,
        classes: RangeInclusive<Class>,
        displacements: &mut [Row],
        settings: &StepSettings,
        push_max: f32,
    ) {
        let Arranged { blocks, details, .. } = &self.flat;
        let chosen = self.flat.of(*classes.start()).start..self.flat.of(*classes.end()).end;
        let (blocks, details) = (&blocks[chosen.clone()], &details[chosen]);
        propagate_shock(blocks, details, displacements, settings, push_max);
        let Arranged { blocks, details, .. } = &self.uneven;
        let chosen = self.uneven.of(*classes.start()).start..self.uneven.of(*classes.end()).end;
        let (blocks, details) = (&blocks[chosen.clone()], &details[chosen]);
        propagate_shock(blocks, details, displacements, settings, push_max);
    }

    pub(crate) fn propagate_classic(
        &self,
        velocities: &mut [Row],
        displacements: &[Row],
        substep_seconds: f32,
    ) {
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
