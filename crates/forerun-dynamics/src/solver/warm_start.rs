//! Warm start: the guessed impulses are applied before the sweeps of the first substep. Later substeps start from what the last one did to each body.

use std::cell::Cell;

use super::blocks::{Block, BlocksOf, Detail, DetailsOf};
use super::points::{Kind, Point};
use super::sides::Sides;
use crate::lanes::{Lanes, Portable, Row, dispatched, recast, recast_mut};

dispatched! {
    /// Applies all impulses of all blocks to the velocities.
    pub(crate) fn apply_impulses<K: Kind>(blocks: &[Block<Portable, K>], velocities: &[Cell<Row>]) => apply_lanes
}

dispatched! {
    /// Takes the momentum out of the impulses, and what it did out of the pushes of the bodies: it has been passed on and must not be passed on again.
    pub(crate) fn remove_momentum<K: Kind>(
        blocks: &mut [Block<Portable, K>],
        details: &[Detail<Portable>],
        pushes: &[Cell<Row>],
    ) => remove_lanes
}

#[inline(always)]
fn apply_lanes<F: Lanes, K: Kind>(blocks: &[Block<Portable, K>], velocities: &[Cell<Row>]) {
    for block in recast::<F, BlocksOf<K>>(blocks) {
        push_sides(block, &block.impulses, &block.friction.impulses, velocities);
    }
}

#[inline(always)]
fn remove_lanes<F: Lanes, K: Kind>(
    blocks: &mut [Block<Portable, K>],
    details: &[Detail<Portable>],
    pushes: &[Cell<Row>],
) {
    let blocks = recast_mut::<F, BlocksOf<K>>(blocks);
    for (block, detail) in blocks.iter_mut().zip(recast::<F, DetailsOf>(details)) {
        if !detail.has_momentum() {
            continue;
        }
        let (points, friction) = (block.impulses, block.friction.impulses);
        take_off(block, detail);
        let mut changes = ([F::zero(); 4], [F::zero(); 3]);
        for q in 0..4 {
            changes.0[q] = block.impulses[q] - points[q];
        }
        for k in 0..3 {
            changes.1[k] = block.friction.impulses[k] - friction[k];
        }
        // Contacts without momentum change by 0, and so their bodies.
        push_sides(block, &changes.0, &changes.1, pushes);
    }
}

#[inline(always)]
fn push_sides<F: Lanes, K: Kind>(
    block: &Block<F, K>,
    points: &[F; 4],
    friction: &[F; 3],
    rows: &[Cell<Row>],
) {
    let mut push = Point::push(&block.points, points);
    push.rub([friction[0], friction[1]], friction[2]);
    let mut sides = Sides::gather(block, rows);
    sides.push(block, &push);
    sides.scatter(block, rows);
}

#[inline(always)]
fn take_off<F: Lanes, K: Kind>(block: &mut Block<F, K>, detail: &Detail<F>) {
    for q in 0..4 {
        block.impulses[q] = (block.impulses[q] - detail.momentum.points[q]).max(F::zero());
    }
    for k in 0..3 {
        block.friction.impulses[k] -= detail.momentum.friction[k];
    }
}

/// Takes the momentum out of the impulses.
pub(crate) fn take_off_momentum<K: Kind>(blocks: &mut [Block<Portable, K>], details: &[Detail<Portable>]) {
    for (block, detail) in blocks.iter_mut().zip(details) {
        take_off(block, detail);
    }
}

/// Adds the momentum to impulses that had none.
pub(crate) fn add_momentum<K: Kind>(blocks: &mut [Block<Portable, K>], details: &[Detail<Portable>]) {
    for (block, detail) in blocks.iter_mut().zip(details) {
        for q in 0..4 {
            block.impulses[q] = (block.impulses[q] + detail.momentum.points[q]).max(Portable::zero());
        }
        for k in 0..3 {
            block.friction.impulses[k] += detail.momentum.friction[k];
        }
    }
}
