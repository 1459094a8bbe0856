//! Shadow: what the sun sees, as heights towards it.

use forerun::{Aabb, Vec3};

use super::raster::cover;
use super::shade::Item;

/// Texels along each side of the map.
const SIDE: usize = 2048;
/// How far a point is lifted off its own surface, so that this does not shade itself. Texels.
const LIFT: f32 = 1.6;

/// A map of how high, towards the sun, the highest thing is.
pub(crate) struct Shadow {
    right: Vec3,
    up: Vec3,
    to_sun: Vec3,
    /// Where the map begins along `right` and `up`. Metres.
    corner: [f32; 2],
    /// Size of a texel. Metres.
    texel: f32,
    heights: Vec<f32>,
}

impl Shadow {
    /// The shadows in and around a box.
    pub(crate) fn of(items: &[Item], seen: &Aabb, to_sun: Vec3) -> Shadow {
        let to_sun = to_sun.normalize();
        let (right, up) = to_sun.any_orthonormal_pair();
        let centre = 0.5 * (seen.min + seen.max);
        // The shadows lie beside the bodies.
        let radius = 0.75 * (seen.max - seen.min).length().max(1e-3);
        let corner = [centre.dot(right) - radius, centre.dot(up) - radius];
        let texel = 2.0 * radius / SIDE as f32;
        let mut shadow =
            Shadow { right, up, to_sun, corner, texel, heights: vec![f32::NEG_INFINITY; SIDE * SIDE] };
        for item in items {
            for facet in item.facets.iter() {
                let at = facet.corners.map(|corner| shadow.place(item.pose.transform_point(corner)));
                cover(at, [SIDE, SIDE], |index, parts| {
                    let height = parts[0] * at[0].z + parts[1] * at[1].z + parts[2] * at[2].z;
                    shadow.heights[index] = shadow.heights[index].max(height);
                });
            }
        }
        shadow
    }

    /// A point in texels, and its height.
    fn place(&self, point: Vec3) -> Vec3 {
        Vec3::new(
            (point.dot(self.right) - self.corner[0]) / self.texel,
            (point.dot(self.up) - self.corner[1]) / self.texel,
            point.dot(self.to_sun),
        )
    }

    /// How much of the sun a point of a surface sees: 0 to 1.
    pub(crate) fn light_at(&self, point: Vec3, normal: Vec3) -> f32 {
        let at = self.place(point + normal * (LIFT * self.texel));
        let mut lit = 0;
        for dy in -1..=1 {
            for dx in -1..=1 {
                let (x, y) = (at.x as i64 + dx, at.y as i64 + dy);
                let inside = (0..SIDE as i64).contains(&x) && (0..SIDE as i64).contains(&y);
                let covered = inside && self.heights[y as usize * SIDE + x as usize] > at.z + self.texel;
                lit += i32::from(!covered);
            }
        }
        lit as f32 / 9.0
    }
}
