//! Field: the signed distance to a closed surface on a dense grid, negative inside.
//!
//! Promise: a look-up is a pure function of the field and the point, with the same bits on every target, and never
//! panics, whatever the point (not-a-number gives not-a-number).

use forerun_lanes::{LANES, LaneMask, Lanes, Portable, V8};

use super::eight::{lane, normalized, splat};
use super::kept::Reader;
use crate::{Aabb, Vec3};

/// Signed distances in 16 bits at the nodes of a dense grid, read by trilinear interpolation.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Position of the first node. Metres.
    origin: Vec3,
    /// Distance between neighbouring nodes along x, y and z, about the same. Metres.
    cell: Vec3,
    /// Number of nodes along x, y and z, 3 or more each; fewer than 2^23 in all.
    size: [usize; 3],
    /// Number of cells along x, y and z, ready to compute with.
    cells: Vec3,
    /// Metres per unit of `nodes`.
    scale: f32,
    /// Distances at the nodes, x fastest, then y, then z.
    nodes: Vec<i16>,
}

/// More nodes than a grid may have: whole numbers below this are exact in the arithmetic of look-ups.
const NODES_END: usize = 1 << 23;
/// The bits of a mask that is set in all lanes.
const ALL: u32 = (1 << LANES) - 1;

/// Where eight points are in the grid.
struct Place<F> {
    /// Index of the lowest node of the cell.
    base: [u32; LANES],
    /// Position in the cell, 0 to 1.
    fraction: V8<F>,
    /// From the point of the grid's box nearest to the point, to the point: zero inside. Metres.
    offset: V8<F>,
}

impl Field {
    /// A field from distances (metres) at the nodes of a grid, x fastest.
    ///
    /// The distances are stored in steps of the largest one over 32767. Before that a twelfth of the sum of second
    /// differences is taken off: between nodes trilinear interpolation lies above a convex function by that much on
    /// average, which would make round shapes too small. Not so at sharp edges, where it would make them too large.
    pub(crate) fn from_distances(origin: Vec3, cell: Vec3, size: [usize; 3], distances: &[f32]) -> Field {
        let corrected = without_interpolation_bias(size, distances, cell.min_element());
        let largest = corrected.iter().fold(0.0_f32, |m, d| m.max(d.abs()));
        let scale = if largest > 0.0 { largest / f32::from(i16::MAX) } else { 1.0 };
        let nodes = corrected.iter().map(|d| (d / scale).round() as i16).collect();
        Field { origin, cell, size, cells: Vec3::from_array(size.map(|n| (n - 1) as f32)), scale, nodes }
    }

    /// Appends what [`Field::read`] reads.
    pub(super) fn write(&self, out: &mut Vec<u8>) {
        let numbers = self.origin.to_array().into_iter().chain(self.cell.to_array()).chain([self.scale]);
        numbers.for_each(|x| out.extend(x.to_le_bytes()));
        self.size.iter().for_each(|n| out.extend((*n as u32).to_le_bytes()));
        self.nodes.iter().for_each(|d| out.extend(d.to_le_bytes()));
    }

    /// A field that was written; none where it cannot be one.
    pub(super) fn read(reader: &mut Reader<'_>) -> Option<Field> {
        let (origin, cell, scale) = (reader.vec3()?, reader.vec3()?, reader.f32()?);
        let size = [reader.u32()?, reader.u32()?, reader.u32()?].map(|n| n as usize);
        let count = size.iter().try_fold(1_usize, |all, n| all.checked_mul(*n))?;
        let lengths = [cell.x, cell.y, cell.z, scale];
        let possible = origin.is_finite()
            && lengths.iter().all(|x| *x > 0.0 && x.is_finite())
            && size.iter().all(|n| *n >= 3)
            && count < NODES_END;
        if !possible {
            return None;
        }
        let nodes = reader.i16s(count)?;
        Some(Field {
            origin,
            cell,
            size,
            cells: Vec3::from_array(size.map(|n| (n - 1) as f32)),
            scale,
            nodes,
        })
    }

    /// Largest distance between neighbouring nodes. Metres.
    #[must_use]
    pub fn cell(&self) -> f32 {
        self.cell.max_element()
    }

    /// Distances between neighbouring nodes along x, y and z. Metres.
    pub(super) fn cell_size(&self) -> Vec3 {
        self.cell
    }

    /// Calls `visit` with the lowest corner of each cell and the distances at its corners: x changes fastest, then y, then z.
    pub(super) fn each_cell(&self, mut visit: impl FnMut(Vec3, [f32; 8])) {
        let [nx, ny, nz] = self.size;
        let (row, layer) = (nx, nx * ny);
        for z in 0..nz - 1 {
            for y in 0..ny - 1 {
                for x in 0..nx - 1 {
                    let base = z * layer + y * row + x;
                    let corners = [0, 1, row, row + 1, layer, layer + 1, layer + row, layer + row + 1];
                    let distances = corners.map(|k| f32::from(self.nodes[base + k]) * self.scale);
                    visit(self.origin + Vec3::new(x as f32, y as f32, z as f32) * self.cell, distances);
                }
            }
        }
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

    /// Memory that the nodes take.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<i16>()
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
        let taps = self.taps(point);
        let (distances, _) = self.look_up::<Portable>(V8::from_arrays(taps.map(|[a, b, c, d, e, f]| {
            // A look-up is of eight: the last two are not wanted.
            [a, b, c, d, e, f, f, f]
        })));
        let [a, b, c, d, e, f, ..] = distances.to_array();
        self.difference([a, b, c, d, e, f])
    }

    /// Where the distances are asked that central differences at a point are made of, by component: half a cell to either side along x, y and z.
    #[inline(always)]
    pub(crate) fn taps(&self, p: Vec3) -> [[f32; 6]; 3] {
        let h = self.cell * 0.5;
        [
            [p.x + h.x, p.x - h.x, p.x, p.x, p.x, p.x],
            [p.y, p.y, p.y + h.y, p.y - h.y, p.y, p.y],
            [p.z, p.z, p.z, p.z, p.z + h.z, p.z - h.z],
        ]
    }

    /// The gradient, from the distances at [`Field::taps`].
    #[inline(always)]
    pub(crate) fn difference(&self, d: [f32; 6]) -> Vec3 {
        Vec3::new(d[0] - d[1], d[2] - d[3], d[4] - d[5]) / self.cell
    }

    /// [`Field::distance_and_gradient`] at eight points.
    #[inline(always)]
    pub(crate) fn look_up<F: Lanes>(&self, points: V8<F>) -> (F, V8<F>) {
        let place = self.place(points);
        let [[a, b], [c, d], [e, f], [g, h]] = F::gather_pairs(&self.nodes, &place.base, &self.rows());
        let (fx, fy, fz) = (place.fraction.x, place.fraction.y, place.fraction.z);
        let (ab, cd, ef, gh) = (b - a, d - c, f - e, h - g);
        let (y0, y1, y2, y3) = (a + fx * ab, c + fx * cd, e + fx * ef, g + fx * gh);
        let (z0, z1) = (y0 + fy * (y1 - y0), y2 + fy * (y3 - y2));
        let distance = (z0 + fz * (z1 - z0)) * F::splat(self.scale);
        let (x0, x1) = (ab + fy * (cd - ab), ef + fy * (gh - ef));
        let (s0, s1) = (y1 - y0, y3 - y2);
        let slope = splat::<F>(Vec3::splat(self.scale) / self.cell);
        let gradient = V8 { x: x0 + fz * (x1 - x0), y: s0 + fz * (s1 - s0), z: z1 - z0 }.times(slope);
        // Not "outside where above 0": points that are not numbers are not inside.
        let inside = place.offset.dot(place.offset).lt(F::splat(f32::MIN_POSITIVE));
        if inside.bits() == ALL {
            return (distance, gradient);
        }
        // The surface point y that q, the nearest point of the box, sees: p - y = offset + phi(q) grad phi(q).
        let away = place.offset + normalized(gradient) * distance.max(F::zero());
        (inside.select(distance, away.length()), inside.select_v(gradient, normalized(away)))
    }

    /// Lower bounds of the signed distance at eight points, exact (but for the grid) inside the grid's box.
    ///
    /// Beyond the box, with o the offset from its nearest point q: the surface lies inside the box, which is convex,
    /// so no point of it is nearer than the square root of o² + phi(q)².
    #[inline(always)]
    pub(crate) fn lower_bound<F: Lanes>(&self, points: V8<F>) -> F {
        let place = self.place(points);
        let [[a, b], [c, d], [e, f], [g, h]] = F::gather_pairs(&self.nodes, &place.base, &self.rows());
        let (fx, fy, fz) = (place.fraction.x, place.fraction.y, place.fraction.z);
        let (y0, y1, y2, y3) = (a + fx * (b - a), c + fx * (d - c), e + fx * (f - e), g + fx * (h - g));
        let (z0, z1) = (y0 + fy * (y1 - y0), y2 + fy * (y3 - y2));
        let distance = (z0 + fz * (z1 - z0)) * F::splat(self.scale);
        let offset_squared = place.offset.dot(place.offset);
        let inside = offset_squared.lt(F::splat(f32::MIN_POSITIVE));
        let positive = distance.max(F::zero());
        inside.select(distance, (offset_squared + positive * positive).sqrt())
    }

    /// From the lowest node of a cell to the rows of nodes along its four edges in the direction of x.
    #[inline(always)]
    fn rows(&self) -> [u32; 4] {
        let (row, layer) = (self.size[0] as u32, (self.size[0] * self.size[1]) as u32);
        [0, row, layer, layer + row]
    }

    #[inline(always)]
    fn place<F: Lanes>(&self, points: V8<F>) -> Place<F> {
        let inverse_cell = self.cell.recip();
        let (x, fx, ox) = self.place_along(0, points.x, inverse_cell.x);
        let (y, fy, oy) = self.place_along(1, points.y, inverse_cell.y);
        let (z, fz, oz) = self.place_along(2, points.z, inverse_cell.z);
        let base = (z * F::splat(self.cells.y + 1.0) + y) * F::splat(self.cells.x + 1.0) + x;
        let (fraction, offset) = (V8 { x: fx, y: fy, z: fz }, V8 { x: ox, y: oy, z: oz });
        Place { base: base.to_whole(), fraction, offset }
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

/// Second differences that would take off more than this part of a cell come from sharp edges: the smallest radius
/// that the cells are made for takes off a twenty-fourth.
const ROUND_PART: f32 = 1.0 / 16.0;

/// The distances less (sum of the 6 neighbours - 6 times the node) / 12; nodes on the faces of the grid and at sharp
/// edges stay.
#[allow(clippy::needless_range_loop, reason = "the index is that of the neighbours too")]
fn without_interpolation_bias(size: [usize; 3], distances: &[f32], cell: f32) -> Vec<f32> {
    let [nx, ny, nz] = size;
    let (row, layer) = (nx, nx * ny);
    let mut corrected = distances.to_vec();
    for z in 1..nz - 1 {
        for y in 1..ny - 1 {
            for i in z * layer + y * row + 1..z * layer + y * row + nx - 1 {
                let d = |k: usize| distances[k];
                let neighbours =
                    (d(i - 1) + d(i + 1)) + (d(i - row) + d(i + row)) + (d(i - layer) + d(i + layer));
                let bias = (neighbours - 6.0 * d(i)) * (1.0 / 12.0);
                if bias.abs() < ROUND_PART * cell {
                    corrected[i] = d(i) - bias;
                }
            }
        }
    }
    corrected
}

#[cfg(test)]
mod tests {
    use super::*;

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
        Field::from_distances(origin, cell, size, &distances)
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
