//! Rows: the blocks of both kinds, and the passes over them.
//!
//! An island is wholly of one kind, so that it does not matter which kind goes first.

use super::blocks::Arranged;
use super::collisions::{Moving, resolve_collisions};
use super::energy_guard::{EnergyGuard, Guarded};
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

    pub(crate) fn sweep(&mut self, velocities: &mut [Row]) {
        sweep(&mut self.flat.blocks, velocities);
        sweep(&mut self.uneven.blocks, velocities);
    }

    pub(crate) fn relax(&mut self, moving: &mut Moving, bounces: bool) {
        relax(&mut self.flat.blocks, &self.flat.details, moving, bounces);
        relax(&mut self.uneven.blocks, &self.uneven.details, moving, bounces);
    }

    pub(crate) fn add_impulses(&self, sums: &mut [[f32; 4]]) {
        add_substep(sums, &self.flat);
        add_substep(sums, &self.uneven);
    }

    /// One pass over the blocks of hard islands, or over all; see [`propagate_shock`].
    pub(crate) fn propagate_shock(
        &self,
        only_hard: OnlyHard,
        displacements: &mut [Row],
        settings: &StepSettings,
    ) {
        let push_max = settings.recovery_speed_max * settings.frame_seconds;
        let skipped = |easy: usize| if only_hard == OnlyHard::Yes { easy } else { 0 };
        let from = skipped(self.flat.easy);
        let Arranged { blocks, details, .. } = &self.flat;
        propagate_shock(&blocks[from..], &details[from..], displacements, settings, push_max);
        let from = skipped(self.uneven.easy);
        let Arranged { blocks, details, .. } = &self.uneven;
        propagate_shock(&blocks[from..], &details[from..], displacements, settings, push_max);
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

/// Which islands a pass is for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum OnlyHard {
    No,
    Yes,
}
