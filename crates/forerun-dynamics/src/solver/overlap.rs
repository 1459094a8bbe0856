//! Overlap: what the solver expects the deepest overlap of a contact to be at the end of its frame.

use super::blocks::{Block, NO_CONTACT};
use super::sweep::Sides;
use crate::lanes::{LANES, LaneMask, Lanes, Row};

impl<F: Lanes> Block<F> {
    /// For each lane with a contact: the contact's index, and by how much its deepest point will lie deeper than at the start (and than touching).
    /// Metres, 0 or more.
    pub(crate) fn overlap_growth(&self, displacements: &[Row]) -> impl Iterator<Item = (usize, f32)> {
        let d: Sides<F> = Sides::gather(self, displacements);
        let mut growth = F::zero();
        for point in &self.points {
            let is_point = point.inverse_k.gt(F::zero());
            let moved = d.along(self, &point.jacobian());
            let start = point.separation.min(F::zero());
            let deeper = start - (point.separation + moved);
            growth = is_point.select(growth.max(deeper), growth);
        }
        let (source, growth) = (self.source, growth.to_array());
        (0..LANES)
            .filter(move |&lane| source[lane] != NO_CONTACT)
            .map(move |lane| (source[lane] as usize, growth[lane]))
    }
}
