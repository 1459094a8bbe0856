//! Overlap: what the solver expects the deepest overlap of a contact to be at the end of its frame.

use super::blocks::{Block, NO_CONTACT};
use super::sweep::Sides;
use crate::lanes::{F8, LANES, Row};

impl Block {
    /// For each lane with a contact: the contact's index, and by how much its deepest point will lie deeper than at the start (and than touching).
    /// Metres, 0 or more.
    pub(crate) fn overlap_growth(&self, displacements: &[Row]) -> impl Iterator<Item = (usize, f32)> + '_ {
        let d = Sides::gather(self, displacements);
        let mut growth = F8::ZERO;
        for point in &self.points {
            let is_point = point.inverse_k.gt(F8::ZERO);
            let moved = d.along(self, &point.jacobian());
            let start = point.separation.min(F8::ZERO);
            let deeper = start - (point.separation + moved);
            growth = is_point.select(growth.max(deeper), growth);
        }
        (0..LANES)
            .filter(|&lane| self.source[lane] != NO_CONTACT)
            .map(move |lane| (self.source[lane] as usize, growth.0[lane]))
    }
}
