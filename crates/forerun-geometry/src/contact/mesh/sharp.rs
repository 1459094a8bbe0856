//! Sharp: distances at edges and corners, where a grid blurs them.
//!
//! Between its nodes a grid takes the mean of the sides of an edge, which cuts the edge off: by a third of a cell where
//! the edge is askew to the grid. Corners of two stones that touch would not. Round surfaces, and edges along the sides
//! of the grid, are met exactly; the fields of others are asked only who is near, and their triangles how near.

use forerun_lanes::{LANES, LaneMask, Lanes, V8};

use super::directions::Direction;
use crate::Vec3;
use crate::sdf::eight::of_vectors;

impl Direction<'_> {
    /// Distances and gradients at eight points of the field's frame, good where they are `asked` and, but for `more`
    /// metres, near.
    #[inline(always)]
    pub(super) fn answer<F: Lanes>(&self, points: V8<F>, asked: u32, more: f32) -> (F, V8<F>) {
        let (distance, gradient) = self.surface.look_up(points);
        if self.blur == 0.0 {
            return (distance, gradient);
        }
        let reach = self.reach(points, F::zero()) + F::splat(self.blur + more);
        let asked = asked & distance.lt(reach).bits();
        let mut exact = Exact { distances: distance.to_array(), gradients: vectors(gradient) };
        self.sharpen(&vectors(points), asked, &mut exact);
        (F::from_array(exact.distances), of_vectors(&exact.gradients).form())
    }

    /// Puts the exact answers in the place of some.
    #[inline(never)]
    fn sharpen(&self, points: &[Vec3; LANES], mut asked: u32, exact: &mut Exact) {
        let mut guess = None;
        while asked != 0 {
            let i = asked.trailing_zeros() as usize;
            asked &= asked - 1;
            let (distance, gradient) = self.surface.exact(points[i], self.skin.as_ref(), &mut guess);
            (exact.distances[i], exact.gradients[i]) = (distance, gradient);
        }
    }
}

/// Eight answers, one by one.
struct Exact {
    distances: [f32; LANES],
    gradients: [Vec3; LANES],
}

#[inline(always)]
fn vectors<F: Lanes>(v: V8<F>) -> [Vec3; LANES] {
    let (x, y, z) = (v.x.to_array(), v.y.to_array(), v.z.to_array());
    let mut out = [Vec3::ZERO; LANES];
    for i in 0..LANES {
        out[i] = Vec3::new(x[i], y[i], z[i]);
    }
    out
}
