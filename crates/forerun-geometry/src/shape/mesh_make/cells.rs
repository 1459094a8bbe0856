//! Unions of boxes: the filled cells of a grid.

use super::surface::Surface;
use super::{Mesh, ShapeError, below};
use crate::Vec3;
use crate::shape::{TriangleList, positive};

/// A box as 12 triangles.
///
/// # Errors
/// When a half extent is not above 0.
pub fn cuboid(half_extents: Vec3) -> Result<Mesh, ShapeError> {
    for half_extent in half_extents.to_array() {
        positive("half_extents", half_extent)?;
    }
    let h = half_extents;
    Ok(blocks([&[-h.x, h.x], &[-h.y, h.y], &[-h.z, h.z]], |_| true).mesh()?)
}

/// A rectangular frame with a hole along y: a box of the given half extents whose bars are `width` wide in x and z (metres).
///
/// # Errors
/// When a half extent or the width is not above 0, or the bars leave no hole.
pub fn frame(half_extents: Vec3, width: f32) -> Result<Mesh, ShapeError> {
    for half_extent in half_extents.to_array() {
        positive("half_extents", half_extent)?;
    }
    positive("width", width)?;
    let h = half_extents;
    if width >= h.x.min(h.z) {
        return Err(ShapeError::new(
            "width",
            format!(
                "must be below the half extents in x and z ({} and {}) to leave a hole, is {width}",
                h.x, h.z
            ),
        ));
    }
    let across = |h: f32| [-h, -h + width, h - width, h];
    Ok(blocks([&across(h.x), &[-h.y, h.y], &across(h.z)], |[x, _, z]| x != 1 || z != 1).mesh()?)
}

/// An angle (L-shape): arms of `length` along +x and +y from the origin's corner, each `width` wide, from -half_depth to half_depth
/// in z (metres).
///
/// # Errors
/// When not 0 < `width` < `length`, or the half depth is not above 0.
pub fn angle(length: f32, width: f32, half_depth: f32) -> Result<Mesh, ShapeError> {
    positive("length", length)?;
    positive("half_depth", half_depth)?;
    if !(width > 0.0 && width < length) {
        return Err(ShapeError::new(
            "width",
            format!("must be above 0 and below the length of the arms ({length}), is {width}"),
        ));
    }
    let arms = [0.0, width, length];
    Ok(blocks([&arms, &arms, &[-half_depth, half_depth]], |[x, y, _]| x == 0 || y == 0).mesh()?)
}

/// A chair without arms: four legs, a seat, and a back of two posts and a rail. It stands on y = 0, its middle above the origin, and faces +z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chair {
    /// Of seat and back, along x. Metres, above 3 `bar`.
    pub width: f32,
    /// Of the seat, along z. Metres, above 3 `bar`.
    pub depth: f32,
    /// From the floor to the top of the seat. Metres, above 2 `bar`.
    pub seat_height: f32,
    /// From the floor to the top of the back. Metres, above `seat_height` by more than 3 `bar`.
    pub height: f32,
    /// Thickness of legs, seat and posts. The rail is twice as high. Metres, above 0.
    pub bar: f32,
}

impl Chair {
    /// Whether it can be made.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        for (field, value) in [
            ("width", self.width),
            ("depth", self.depth),
            ("seat_height", self.seat_height),
            ("height", self.height),
        ] {
            positive(field, value)?;
        }
        let room = (self.width.min(self.depth) / 3.0)
            .min(0.5 * self.seat_height)
            .min((self.height - self.seat_height) / 3.0);
        below("bar", self.bar, room, "what width, depth, seat_height and height leave")
    }

    /// Its surface.
    ///
    /// # Errors
    /// As [`Chair::check`].
    pub fn triangles(&self) -> Result<TriangleList, ShapeError> {
        self.check()?;
        let across = |size: f32| [-0.5 * size, self.bar - 0.5 * size, 0.5 * size - self.bar, 0.5 * size];
        let rail = self.height - 2.0 * self.bar;
        let heights = [0.0, self.seat_height - self.bar, self.seat_height, rail, self.height];
        Ok(blocks([&across(self.width), &heights, &across(self.depth)], |[x, y, z]| match y {
            0 => x != 1 && z != 1,
            1 => true,
            2 => x != 1 && z == 0,
            _ => z == 0,
        }))
    }
}

/// The surface of the filled cells of a grid with planes at the given places along x, y and z.
fn blocks(planes: [&[f32]; 3], filled: impl Fn([usize; 3]) -> bool) -> TriangleList {
    let cells = planes.map(|p| p.len() - 1);
    let corner = |at: [usize; 3]| Vec3::new(planes[0][at[0]], planes[1][at[1]], planes[2][at[2]]);
    let mut surface = Surface::default();
    for cell in (0..cells[0] * cells[1] * cells[2])
        .map(|i| [i % cells[0], i / cells[0] % cells[1], i / cells[0] / cells[1]])
        .filter(|cell| filled(*cell))
    {
        for axis in 0..3 {
            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
            for high in [0, 1] {
                let mut beyond = cell;
                beyond[axis] = beyond[axis].wrapping_add(high * 2).wrapping_sub(1);
                if beyond[axis] < cells[axis] && filled(beyond) {
                    continue;
                }
                let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| {
                    let mut at = cell;
                    at[axis] += high;
                    at[u] += i;
                    at[v] += j;
                    surface.vertex(corner(at))
                });
                // Counter-clockwise in u, v is outwards on the high side.
                let order = if high == 1 { [0, 1, 2, 3] } else { [0, 3, 2, 1] };
                surface.quad(order.map(|i: usize| corners[i]));
            }
        }
    }
    surface.finish()
}
