//! Blur: the cells of a field whose interpolation cuts sharp edges off.
//!
//! Between its nodes a grid takes the mean of the sides of an edge: the surface seems to be up to a third of a cell
//! farther away than it is. Contact asks the triangles in these cells.

use super::Field;
use crate::Vec3;

/// The cells around the sharp edges of a mesh; none where all is smooth.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Blur {
    /// One bit a cell; nothing where no edge is sharp.
    cells: Vec<u64>,
    /// How far off its surface the field sees points of sharp edges. Metres.
    pub(crate) depth: f32,
}

/// Points along an edge in a cell.
const PER_CELL: f32 = 2.0;
/// Most points along an edge.
const POINTS_MAX: f32 = 65_536.0;
/// Edges may be worse between the points than at them.
const SPARE: f32 = 1.25;

impl Blur {
    /// Marks the cells that edges pass through, and those next to them.
    pub(crate) fn new(field: &Field, edges: &[[Vec3; 2]]) -> Blur {
        let mut blur = Blur::default();
        if edges.is_empty() {
            return blur;
        }
        let [nx, ny, nz] = field.cells();
        blur.cells = vec![0; (nx * ny * nz).div_ceil(64)];
        for [a, b] in edges {
            let parts = (PER_CELL * a.distance(*b) / field.cell()).ceil().clamp(1.0, POINTS_MAX);
            for k in 0..=parts as u32 {
                let point = *a + (*b - *a) * (k as f32 / parts);
                blur.depth = blur.depth.max(SPARE * field.distance_and_gradient(point).0);
                blur.mark_around(field, point);
            }
        }
        blur
    }

    fn mark_around(&mut self, field: &Field, point: Vec3) {
        let (cells, at) = (field.cells(), field.cell_of(point));
        let [x, y, z] = [0, 1, 2].map(|k| at[k].saturating_sub(1)..=(at[k] + 1).min(cells[k] - 1));
        for z in z {
            for y in y.clone() {
                for x in x.clone() {
                    let index = (z * cells[1] + y) * cells[0] + x;
                    self.cells[index / 64] |= 1 << (index % 64);
                }
            }
        }
    }

    /// Whether the field is blurred at a point of its frame.
    pub(crate) fn is_at(&self, field: &Field, point: Vec3) -> bool {
        if !field.contains(point) {
            return false;
        }
        let ([nx, ny, _], [x, y, z]) = (field.cells(), field.cell_of(point));
        let index = (z * ny + y) * nx + x;
        self.cells[index / 64] >> (index % 64) & 1 == 1
    }

    /// Memory that the cells take.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.cells)
    }
}
