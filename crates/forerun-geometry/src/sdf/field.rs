//! Field: the signed distance to a closed surface on a dense grid, negative inside.
//!
//! Promise: a look-up is a pure function of the field and the point, with the same bits on every target, and never
//! panics, whatever the point (not-a-number gives not-a-number).
#![allow(clippy::needless_range_loop, reason = "counted loops over fixed arrays are what vectorises")]

use super::lanes::{Lanes, Lanes3, WIDTH};
use crate::{Aabb, Vec3};

/// Signed distances in 16 bits at the nodes of a dense grid, read by trilinear interpolation.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Position of the first node. Metres.
    origin: Vec3,
    /// Distance between neighbouring nodes. Metres.
    cell: f32,
    /// Number of nodes along x, y and z, 3 or more each; fewer than 2^23 in all.
    size: [usize; 3],
    /// Number of cells along x, y and z, ready to compute with.
    cells: Vec3,
    /// Metres per unit of `nodes`.
    scale: f32,
    /// Distances at the nodes, x fastest, then y, then z.
    nodes: Vec<i16>,
}

/// Where eight points are in the grid.
struct Place {
    /// Index of the lowest node of the cell.
    base: [u32; WIDTH],
    /// Position in the cell, 0 to 1.
    fraction: Lanes3,
    /// From the point of the grid's box nearest to the point, to the point: zero inside. Metres.
    offset: Lanes3,
}

impl Field {
    /// A field from distances (metres) at the nodes of a grid, x fastest.
    ///
    /// The distances are stored in steps of the largest one over 32767. Before that a twelfth of the sum of second
    /// differences is taken off: between nodes trilinear interpolation lies above a convex function by that much on
    /// average, which would make round shapes too small.
    pub(crate) fn from_distances(origin: Vec3, cell: f32, size: [usize; 3], distances: &[f32]) -> Field {
        let corrected = without_interpolation_bias(size, distances);
        let largest = corrected.iter().fold(0.0_f32, |m, d| m.max(d.abs()));
        let scale = if largest > 0.0 { largest / f32::from(i16::MAX) } else { 1.0 };
        let nodes = corrected.iter().map(|d| (d / scale).round() as i16).collect();
        Field { origin, cell, size, cells: Vec3::from_array(size.map(|n| (n - 1) as f32)), scale, nodes }
    }

    /// Distance between neighbouring nodes. Metres.
    #[must_use]
    pub fn cell(&self) -> f32 {
        self.cell
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
    /// Beyond the grid's box this is the distance to the surface point that the nearest point of the box points at,
    /// never less than the true distance by more than the error of the grid.
    #[must_use]
    pub fn distance_and_gradient(&self, point: Vec3) -> (f32, Vec3) {
        let (distance, gradient) = self.look_up(Lanes3::splat(point));
        (distance.0[0], gradient.lane(0))
    }

    /// Gradient by central differences over a cell: smooth where the trilinear one jumps from cell to cell.
    #[must_use]
    pub fn smooth_gradient(&self, point: Vec3) -> Vec3 {
        let step = 0.5 * self.cell;
        let mut taps = Lanes3::splat(point);
        for (axis, lanes) in [&mut taps.x, &mut taps.y, &mut taps.z].into_iter().enumerate() {
            lanes.0[2 * axis] += step;
            lanes.0[2 * axis + 1] -= step;
        }
        let (d, _) = self.look_up(taps);
        Vec3::new(d.0[0] - d.0[1], d.0[2] - d.0[3], d.0[4] - d.0[5]) / self.cell
    }

    /// [`Field::distance_and_gradient`] at eight points.
    #[inline]
    pub(crate) fn look_up(&self, points: Lanes3) -> (Lanes, Lanes3) {
        let place = self.place(points);
        let [a, b, c, d, e, f, g, h] = self.corners(&place.base);
        let (fx, fy, fz) = (place.fraction.x, place.fraction.y, place.fraction.z);
        let (ab, cd, ef, gh) = (b - a, d - c, f - e, h - g);
        let (y0, y1, y2, y3) = (a + fx * ab, c + fx * cd, e + fx * ef, g + fx * gh);
        let (z0, z1) = (y0 + fy * (y1 - y0), y2 + fy * (y3 - y2));
        let distance = (z0 + fz * (z1 - z0)) * self.scale;
        let (x0, x1) = (ab + fy * (cd - ab), ef + fy * (gh - ef));
        let (s0, s1) = (y1 - y0, y3 - y2);
        let slope = self.scale / self.cell;
        let gradient = Lanes3 {
            x: (x0 + fz * (x1 - x0)) * slope,
            y: (s0 + fz * (s1 - s0)) * slope,
            z: (z1 - z0) * slope,
        };
        let outside = Lanes::ZERO.below(place.offset.dot(place.offset));
        if outside.bits() == 0 {
            return (distance, gradient);
        }
        // The surface point that q, the nearest point of the box, sees: p - y = offset + phi(q) grad phi(q).
        let away = place.offset.plus(gradient.scaled(distance.max(Lanes::ZERO)));
        let length = away.length();
        (outside.select(length, distance), outside.select3(away.normalized(), gradient))
    }

    /// Lower bounds of the signed distance at eight points, exact (but for the grid) inside the grid's box.
    ///
    /// Beyond the box, with o the offset from its nearest point q: the surface lies inside the box, which is convex,
    /// so no point of it is nearer than the square root of o² + phi(q)².
    #[inline]
    pub(crate) fn lower_bound(&self, points: Lanes3) -> Lanes {
        let place = self.place(points);
        let [a, b, c, d, e, f, g, h] = self.corners(&place.base);
        let (fx, fy, fz) = (place.fraction.x, place.fraction.y, place.fraction.z);
        let (y0, y1, y2, y3) = (a + fx * (b - a), c + fx * (d - c), e + fx * (f - e), g + fx * (h - g));
        let (z0, z1) = (y0 + fy * (y1 - y0), y2 + fy * (y3 - y2));
        let distance = (z0 + fz * (z1 - z0)) * self.scale;
        let offset_squared = place.offset.dot(place.offset);
        let outside = Lanes::ZERO.below(offset_squared);
        let positive = distance.max(Lanes::ZERO);
        outside.select((offset_squared + positive * positive).sqrt(), distance)
    }

    #[inline(always)]
    fn place(&self, points: Lanes3) -> Place {
        let inverse_cell = 1.0 / self.cell;
        let (x, fx, ox) = self.place_along(0, points.x, inverse_cell);
        let (y, fy, oy) = self.place_along(1, points.y, inverse_cell);
        let (z, fz, oz) = self.place_along(2, points.z, inverse_cell);
        // Whole numbers below 2^23 are exact, and adding 2^23 puts them into the lowest bits.
        let base = (z * (self.cells.y + 1.0) + y) * (self.cells.x + 1.0) + x + Lanes::splat(8_388_608.0);
        let mut bits = [0; WIDTH];
        for i in 0..WIDTH {
            bits[i] = base.0[i].to_bits() & 0x007f_ffff;
        }
        Place { base: bits, fraction: Lanes3 { x: fx, y: fy, z: fz }, offset: Lanes3 { x: ox, y: oy, z: oz } }
    }

    /// Index of the cell along an axis, position in the cell, and offset from the grid's box.
    #[inline(always)]
    fn place_along(&self, axis: usize, p: Lanes, inverse_cell: f32) -> (Lanes, Lanes, Lanes) {
        /// Adding and subtracting 1.5 times 2^23 rounds to the nearest whole number.
        const ROUND: f32 = 12_582_912.0;
        let cells = self.cells[axis];
        let u = (p - Lanes::splat(self.origin[axis])) * inverse_cell;
        let inside = u.max(Lanes::ZERO).min(Lanes::splat(cells));
        // A node may end up at fraction 1 of the cell below as well as at fraction 0 of its own: the value is the same.
        let index = inside.map(|u| (u - 0.5 + ROUND) - ROUND).min(Lanes::splat(cells - 1.0));
        (index, inside - index, (u - inside) * self.cell)
    }

    /// Values at the corners of eight cells: x changes fastest, then y, then z.
    #[inline(always)]
    fn corners(&self, base: &[u32; WIDTH]) -> [Lanes; 8] {
        let (row, layer) = (self.size[0], self.size[0] * self.size[1]);
        let mut values = [[0_i32; WIDTH]; 8];
        for i in 0..WIDTH {
            let cell = &self.nodes[base[i] as usize..][..layer + row + 2];
            let corners = [0, 1, row, row + 1, layer, layer + 1, layer + row, layer + row + 1];
            for k in 0..8 {
                values[k][i] = i32::from(cell[corners[k]]);
            }
        }
        let mut corners = [Lanes::ZERO; 8];
        for k in 0..8 {
            for i in 0..WIDTH {
                corners[k].0[i] = values[k][i] as f32;
            }
        }
        corners
    }
}

/// The distances less (sum of the 6 neighbours - 6 times the node) / 12; nodes on the faces of the grid stay.
fn without_interpolation_bias(size: [usize; 3], distances: &[f32]) -> Vec<f32> {
    let [nx, ny, nz] = size;
    let (row, layer) = (nx, nx * ny);
    let mut corrected = distances.to_vec();
    for z in 1..nz - 1 {
        for y in 1..ny - 1 {
            for i in z * layer + y * row + 1..z * layer + y * row + nx - 1 {
                let d = |k: usize| distances[k];
                let neighbours =
                    (d(i - 1) + d(i + 1)) + (d(i - row) + d(i + row)) + (d(i - layer) + d(i + layer));
                corrected[i] = d(i) - (neighbours - 6.0 * d(i)) * (1.0 / 12.0);
            }
        }
    }
    corrected
}
