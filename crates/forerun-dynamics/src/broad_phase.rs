//! Broad phase: which pairs of bounds overlap. Areas (a spatial grid for each size of bounds), swept eight bounds at a time, in place
//! of the sort and sweep of chapter 4 of the dissertation.
//!
//! Promise: the pairs are exactly the overlapping ones, sorted; areas and lanes only make it fast.

mod areas;
mod order;
#[cfg(test)]
mod tests;

use forerun_geometry::Aabb;

use self::areas::{Areas, Sizes};
use self::order::PairOrder;

/// So many bounds, and fewer, are compared each with each.
const FEW: usize = 40;

/// What the broad phase knows of a body.
#[derive(Clone, Copy, Debug)]
pub struct Bound {
    /// Swept bound.
    pub aabb: Aabb,
    /// Whether the body is dynamic: pairs of two others are left out.
    pub dynamic: bool,
}

/// All pairs (lower index first) of overlapping bounds of which at least one is dynamic, sorted.
#[must_use]
pub fn overlapping_pairs(bounds: &[Bound]) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    BroadPhase::default().overlapping_pairs(bounds, &mut pairs);
    pairs
}

/// The reference that tests compare with: every bound against every other.
#[must_use]
pub fn overlapping_pairs_by_force(bounds: &[Bound]) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    for (i, a) in bounds.iter().enumerate() {
        for (j, b) in bounds.iter().enumerate().skip(i + 1) {
            if (a.dynamic || b.dynamic) && a.aabb.overlaps(&b.aabb) {
                pairs.push((i as u32, j as u32));
            }
        }
    }
    pairs
}

/// The memory that the search needs, to be used again from step to step. It remembers nothing.
#[derive(Clone, Debug, Default)]
pub struct BroadPhase {
    /// Bounds that are not yet compared with each other.
    left: Vec<u32>,
    large: Vec<u32>,
    areas: Areas,
    found: Vec<(u32, u32)>,
    order: PairOrder,
}

impl BroadPhase {
    /// As [`overlapping_pairs`]; replaces what `pairs` held.
    ///
    /// The smallest bounds are compared in areas of about their size, all larger ones then look into these areas. The same is done with
    /// the larger ones, and so on until few are left.
    pub fn overlapping_pairs(&mut self, bounds: &[Bound], pairs: &mut Vec<(u32, u32)>) {
        let BroadPhase { left, large, areas, found, order } = self;
        found.clear();
        left.clear();
        left.extend(0..bounds.len() as u32);
        while left.len() > FEW {
            let Some(sizes) = Sizes::smallest(bounds, left) else { break };
            areas.fill(bounds, left, &sizes, large);
            if large.len() == left.len() {
                break;
            }
            areas.sweep(found);
            areas.look_up(bounds, large, found);
            std::mem::swap(left, large);
        }
        areas.compare_all(bounds, left, found);
        order.sort(found, bounds.len(), pairs);
    }
}
