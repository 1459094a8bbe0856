//! Field: the signed distance to a closed surface on a grid, negative inside.
//!
//! Promise: a look-up is a pure function of the field and the point, with the same bits on every target, and never
//! panics, whatever the point (not-a-number gives not-a-number).

use forerun_lanes::{LANES, LaneMask, Lanes, Portable, V8};

use super::accuracy::FieldError;
use super::blocks::{self, Blocks};
use super::eight::{lane, normalized, splat};
use super::primitive::LookUp;
use crate::{Aabb, Vec3};

/// Signed distances in 16 bits at the nodes of a grid, read by trilinear interpolation.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Position of the first node. Metres.
    pub(super) origin: Vec3,
    /// Distance between neighbouring nodes along x, y and z, about the same. Metres.
    pub(super) cell: Vec3,
    /// Number of nodes along x, y and z, 3 or more each; of a dense grid fewer than 2^23 in all.
    pub(super) size: [usize; 3],
    /// Number of cells along x, y and z, ready to compute with.
    pub(super) cells: Vec3,
    /// Metres per unit of `nodes`.
    pub(super) scale: f32,
    /// What it is off by on the surface.
    pub(super) error: FieldError,
    /// Which parts of the grid are fine; none for a dense grid, which is fine everywhere.
    pub(super) blocks: Option<Blocks>,
    /// Distances at the nodes: of a dense grid x fastest, then y, then z; else in the order of the blocks.
    pub(super) nodes: Vec<i16>,
}

/// The bits of a mask that is set in all lanes.
const ALL: u32 = (1 << LANES) - 1;

/// Neighbours of a point in a grid: two along each axis.
const SIDES: usize = 6;

/// Where eight points are in the grid.
struct Place<F> {
    /// Index of the lowest node of the cell.
    base: [u32; LANES],
    /// Position in the cell, 0 to 1.
    fraction: V8<F>,
    /// From the point of the grid's box nearest to the point, to the point: zero inside. Metres.
    offset: V8<F>,
    /// Size of a fine cell as a part of that of the cell.
    step: F,
}

impl Field {
    /// How far it is off at points of the surface.
    #[must_use]
    pub fn error(&self) -> FieldError {
        self.error
    }

    /// Largest distance between neighbouring nodes. Metres.
    #[must_use]
    pub fn cell(&self) -> f32 {
        self.cell.max_element()
    }

    /// The box that the grid covers.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb { min: self.origin, max: self.origin + self.cells * self.cell }
    }

    /// Whether a point is inside the box that the grid covers.
    #[must_use]
    pub fn contains(&self, point: Vec3) -> bool {
        let bounds = self.bounds();
        point.cmpge(bounds.min).all() && point.cmple(bounds.max).all()
    }

    /// Number of cells along x, y and z.
    pub(crate) fn cells(&self) -> [usize; 3] {
        self.size.map(|n| n - 1)
    }

    /// The cell that a point is in; the nearest one for a point beyond the grid.
    pub(crate) fn cell_of(&self, point: Vec3) -> [usize; 3] {
        let place = (point - self.origin) / self.cell;
        // Casts saturate, and what is not a number becomes 0.
        [0, 1, 2].map(|k| (place[k] as usize).min(self.size[k] - 2))
    }

    /// Memory that the nodes take.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + self.blocks.as_ref().map_or(0, Blocks::bytes)
    }

    /// Signed distance (metres) and its gradient (about 1 long) at a point of the field's frame.
    ///
    /// Beyond the grid's box this is the distance to a point of the surface, that nearest to the nearest point of the
    /// box: the true distance or more.
    #[must_use]
    pub fn distance_and_gradient(&self, point: Vec3) -> (f32, Vec3) {
        let (distance, gradient) = self.look_up::<Portable>(splat(point));
        (distance.to_array()[0], lane(&gradient, 0))
    }

    /// Gradient by central differences over a cell: smooth where the trilinear one jumps from cell to cell.
    #[must_use]
    pub fn smooth_gradient(&self, point: Vec3) -> Vec3 {
        lane(&self.differences::<Portable>(splat(point), 1), 0)
    }

    /// [`Field::smooth_gradient`] at the first `count` of eight points; what it is at others says nothing.
    #[allow(clippy::needless_range_loop, reason = "several short arrays are walked side by side")]
    #[inline(always)]
    pub(crate) fn differences<F: Lanes>(&self, points: V8<F>, count: usize) -> V8<F> {
        // The neighbours of all points on one side, then on the next, without gaps: few points take few look-ups.
        let numbers = [points.x.to_array(), points.y.to_array(), points.z.to_array()];
        let mut around = [[[0.0; LANES]; 3]; SIDES];
        for side in 0..SIDES {
            let axis = side / 2;
            let step = self.cell[axis] * if side % 2 == 0 { 0.5 } else { -0.5 };
            for i in 0..count {
                let at = side * count + i;
                let neighbour = &mut around[at / LANES];
                for k in 0..3 {
                    neighbour[k][at % LANES] = if k == axis { numbers[k][i] + step } else { numbers[k][i] };
                }
            }
        }
        let mut distances = [[0.0; LANES]; SIDES];
        for k in 0..(SIDES * count).div_ceil(LANES) {
            distances[k] = self.look_up::<F>(V8::from_arrays(around[k])).0.to_array();
        }
        let mut along = [[0.0; LANES]; 3];
        for axis in 0..3 {
            for i in 0..count {
                let (more, less) = (2 * axis * count + i, (2 * axis + 1) * count + i);
                along[axis][i] =
                    distances[more / LANES][more % LANES] - distances[less / LANES][less % LANES];
            }
        }
        let cell = splat::<F>(self.cell);
        let along = V8::<F>::from_arrays(along);
        V8 { x: along.x / cell.x, y: along.y / cell.y, z: along.z / cell.z }
    }

    /// From the lowest node of a cell to the rows of nodes along its four edges in the direction of x.
    #[inline(always)]
    pub(super) fn rows(&self) -> [u32; 4] {
        let (row, layer) = (self.size[0] as u32, (self.size[0] * self.size[1]) as u32);
        if self.blocks.is_some() { blocks::ROWS } else { [0, row, layer, layer + row] }
    }

    #[inline(always)]
    fn cell_at<F: Lanes>(&self, place: &Place<F>) -> Cells<F> {
        let [[a, b], [c, d], [e, f], [g, h]] = F::gather_pairs(&self.nodes, &place.base, &self.rows());
        let (fx, fy, fz) = (place.fraction.x, place.fraction.y, place.fraction.z);
        let (ab, cd, ef, gh) = (b - a, d - c, f - e, h - g);
        let (y0, y1, y2, y3) = (a + fx * ab, c + fx * cd, e + fx * ef, g + fx * gh);
        let (z0, z1) = (y0 + fy * (y1 - y0), y2 + fy * (y3 - y2));
        Cells {
            distance: (z0 + fz * (z1 - z0)) * F::splat(self.scale),
            fraction: place.fraction,
            along_x: [ab, cd, ef, gh],
            on_x: [y0, y1, y2, y3],
            on_faces: [z0, z1],
        }
    }

    #[inline(always)]
    fn place<F: Lanes>(&self, points: V8<F>) -> Place<F> {
        let inverse_cell = self.cell.recip();
        let (x, fx, ox) = self.place_along(0, points.x, inverse_cell.x);
        let (y, fy, oy) = self.place_along(1, points.y, inverse_cell.y);
        let (z, fz, oz) = self.place_along(2, points.z, inverse_cell.z);
        let offset = V8 { x: ox, y: oy, z: oz };
        if let Some(blocks) = &self.blocks {
            let place = blocks.place([x + fx, y + fy, z + fz].map(F::to_array));
            let fraction = V8::from_arrays(place.fraction);
            return Place { base: place.base, fraction, offset, step: F::from_array(place.step) };
        }
        let base = (z * F::splat(self.cells.y + 1.0) + y) * F::splat(self.cells.x + 1.0) + x;
        let fraction = V8 { x: fx, y: fy, z: fz };
        Place { base: base.to_whole(), fraction, offset, step: F::one() }
    }

    /// Index of the cell along an axis, position in the cell, and offset from the grid's box.
    #[inline(always)]
    fn place_along<F: Lanes>(&self, axis: usize, p: F, inverse_cell: f32) -> (F, F, F) {
        /// Adding and subtracting 1.5 times 2^23 rounds to the nearest whole number.
        const ROUND: f32 = 12_582_912.0;
        let cells = self.cells[axis];
        let u = (p - F::splat(self.origin[axis])) * F::splat(inverse_cell);
        let inside = u.max(F::zero()).min(F::splat(cells));
        // A node may end up at fraction 1 of the cell below as well as at fraction 0 of its own: the value is the same.
        let below = (inside - F::splat(0.5) + F::splat(ROUND)) - F::splat(ROUND);
        let index = below.min(F::splat(cells - 1.0));
        (index, inside - index, (u - inside) * F::splat(self.cell[axis]))
    }
}

impl LookUp for Field {
    #[inline(always)]
    fn look_up<F: Lanes>(&self, points: V8<F>) -> (F, V8<F>) {
        let place = self.place(points);
        let cell = self.cell_at(&place);
        cell.answer(&place, cell.gradient(self, &place))
    }

    /// Far from the surface, as most points are, the gradient is not worked out.
    #[inline(always)]
    fn look_up_near<F: Lanes>(&self, points: V8<F>, asked: u32, limit: f32) -> Option<(F, V8<F>)> {
        let place = self.place(points);
        let cell = self.cell_at(&place);
        if cell.lower_bound(&place).lt(F::splat(limit)).bits() & asked == 0 {
            return None;
        }
        Some(cell.answer(&place, cell.gradient(self, &place)))
    }

    #[inline(always)]
    fn lower_bound<F: Lanes>(&self, points: V8<F>) -> F {
        let place = self.place(points);
        self.cell_at(&place).lower_bound(&place)
    }
}

impl<F: Lanes> Place<F> {
    /// Which points are inside the grid's box. Not "outside where above 0": points that are not numbers are not inside.
    #[inline(always)]
    fn inside(&self) -> F::Mask {
        self.offset.dot(self.offset).lt(F::splat(f32::MIN_POSITIVE))
    }
}

/// What the corners of eight cells say of points in them.
struct Cells<F> {
    /// By trilinear interpolation. Metres.
    distance: F,
    /// Position in the cell, 0 to 1.
    fraction: V8<F>,
    /// Differences along the four edges in the direction of x.
    along_x: [F; 4],
    /// Values on these edges.
    on_x: [F; 4],
    /// Values in the middle of the two faces across z.
    on_faces: [F; 2],
}

impl<F: Lanes> Cells<F> {
    #[inline(always)]
    fn gradient(&self, field: &Field, place: &Place<F>) -> V8<F> {
        let ([ab, cd, ef, gh], [y0, y1, y2, y3], [z0, z1]) = (self.along_x, self.on_x, self.on_faces);
        let (fy, fz) = (self.fraction.y, self.fraction.z);
        let (x0, x1) = (ab + fy * (cd - ab), ef + fy * (gh - ef));
        let (s0, s1) = (y1 - y0, y3 - y2);
        let slope = splat::<F>(Vec3::splat(field.scale) / field.cell);
        let gradient = V8 { x: x0 + fz * (x1 - x0), y: s0 + fz * (s1 - s0), z: z1 - z0 }.times(slope);
        if field.blocks.is_some() { gradient * place.step } else { gradient }
    }

    /// Beyond the grid's box, with o the offset from its nearest point q: the surface lies inside the box, which is
    /// convex, so no point of it is nearer than the square root of o² + phi(q)².
    #[inline(always)]
    fn lower_bound(&self, place: &Place<F>) -> F {
        let positive = self.distance.max(F::zero());
        let beyond = (place.offset.dot(place.offset) + positive * positive).sqrt();
        place.inside().select(self.distance, beyond)
    }

    /// Distance and gradient, beyond the grid's box too.
    #[inline(always)]
    fn answer(&self, place: &Place<F>, gradient: V8<F>) -> (F, V8<F>) {
        let inside = place.inside();
        if inside.bits() == ALL {
            return (self.distance, gradient);
        }
        // The surface point y that q, the nearest point of the box, sees: p - y = offset + phi(q) grad phi(q).
        let away = place.offset + normalized(gradient) * self.distance.max(F::zero());
        (inside.select(self.distance, away.length()), inside.select_v(gradient, normalized(away)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sdf::bake::Grid;

    const RADIUS: f32 = 0.4;

    /// A ball on a grid of 0.1 m, distances exact at the nodes.
    fn ball() -> Field {
        let (origin, cell, size) = (Vec3::new(-0.65, -0.6, -0.7), Vec3::splat(0.1), [14, 13, 15]);
        let mut distances = Vec::new();
        for z in 0..size[2] {
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let node = origin + Vec3::new(x as f32, y as f32, z as f32) * cell;
                    distances.push(node.length() - RADIUS);
                }
            }
        }
        Field::from_distances(&Grid { origin, cell, size }, &distances)
    }

    fn points() -> impl Iterator<Item = Vec3> {
        (0..5000_u32).map(|i| {
            let part = |k: u32| ((i * 7919 + i * i % 613 * k * 104_729) % 2003) as f32 / 2003.0 * 2.0 - 1.0;
            Vec3::new(part(1), part(2), part(3))
        })
    }

    #[test]
    fn a_round_surface_is_as_large_as_it_should_be_on_average() {
        let field = ball();
        let near: Vec<f32> = points()
            .map(|p| p * 0.5)
            .filter(|p| (p.length() - RADIUS).abs() < 0.03)
            .map(|p| field.distance_and_gradient(p).0 - (p.length() - RADIUS))
            .collect();
        let mean = near.iter().sum::<f32>() / near.len() as f32;
        // Without the correction it would be cell² / 12 times 2 / radius = 4.2 mm.
        assert!(near.len() > 200 && mean.abs() < 1e-3, "{mean} m too far on average");
    }

    #[test]
    fn lower_bounds_are_below_and_answers_beyond_the_grid_are_surface_points() {
        let field = ball();
        // In the middle of the ball the grid is too coarse to say much.
        for p in points().map(|p| p * 3.0).filter(|p| p.length() > 0.3) {
            let truth = p.length() - RADIUS;
            let bound = field.lower_bound::<Portable>(splat(p)).to_array()[0];
            assert!(bound < truth + 0.006, "{bound} at {p}, truth {truth}");
            let (distance, gradient) = field.distance_and_gradient(p);
            assert!(distance > truth - 0.005 - 0.01 * p.length(), "{distance} at {p}, truth {truth}");
            if !field.contains(p) {
                let foot = p - gradient * distance;
                assert!((foot.length() - RADIUS).abs() < 0.02, "from {p} to {foot}");
            }
        }
    }

    #[test]
    fn nodes_and_corners_of_the_grid_are_read_without_a_panic() {
        let field = ball();
        let bounds = field.bounds();
        for x in 0..14 {
            let p = Vec3::new(bounds.min.x + 0.1 * x as f32, bounds.max.y, bounds.max.z);
            let (d, _) = field.distance_and_gradient(p);
            assert!((d - (p.length() - RADIUS)).abs() < 0.01, "{d} at {p}");
        }
        for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN_POSITIVE] {
            let (d, _) = field.distance_and_gradient(Vec3::new(odd, 0.0, 0.0));
            assert!(!odd.is_nan() || d.is_nan());
            let _ = field.smooth_gradient(Vec3::splat(odd));
        }
    }
}
