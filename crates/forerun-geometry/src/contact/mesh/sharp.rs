//! Sharp: distances at edges and corners, where a grid blurs them.
//!
//! Between its nodes a grid takes the mean of the sides of an edge, which cuts the edge off: by a third of a cell where
//! the edge is askew to the grid. Corners of two stones that touch would not. Round surfaces, and edges along the sides
//! of the grid, are met exactly; the fields of others are asked only who is near, and their triangles how near.

use super::directions::Direction;
use crate::sdf::lanes::{Lanes, Lanes3};

impl Direction<'_> {
    /// Distances and gradients at eight points of the field's frame, good where they are `asked` and, but for `more`
    /// metres, near.
    #[inline(always)]
    pub(super) fn answer(&self, points: Lanes3, asked: u32, more: f32) -> (Lanes, Lanes3) {
        let (mut distance, mut gradient) = self.surface.look_up(points);
        if self.blur > 0.0 {
            let reach = self.reach(points, Lanes::ZERO) + Lanes::splat(self.blur + more);
            self.sharpen(points, asked & distance.below(reach).bits(), (&mut distance, &mut gradient));
        }
        (distance, gradient)
    }

    /// Puts the exact answers in the place of some.
    #[inline(never)]
    fn sharpen(&self, points: Lanes3, mut asked: u32, (distance, gradient): (&mut Lanes, &mut Lanes3)) {
        let mut guess = None;
        while asked != 0 {
            let i = asked.trailing_zeros() as usize;
            asked &= asked - 1;
            let (d, g) = self.surface.exact(points.lane(i), self.skin.as_ref(), &mut guess);
            distance.0[i] = d;
            gradient.set_lane(i, g);
        }
    }
}
