//! Bounding spheres (dissertation, section 2.3.1).

use super::{Aabb, Obb};
use crate::{Pose, Vec3};

/// How often a sphere around points is moved towards the farthest of them.
const SHIFTS: usize = 64;

/// A sphere around something. Turning does not change it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingSphere {
    /// Centre. Metres.
    pub centre: Vec3,
    /// Radius. Metres, 0 or more; may be infinite.
    pub radius: f32,
}

impl BoundingSphere {
    /// A sphere around points, a few percent larger at most than the smallest. Of no points: radius 0 at the origin.
    ///
    /// The centre moves towards the farthest point by 1/2, 1/3, 1/4, ... of the way (Bădoiu and Clarkson, *Smaller core-sets for
    /// balls*, 2003).
    #[must_use]
    pub fn around(points: &[Vec3]) -> Self {
        let farthest = |centre: Vec3| {
            points
                .iter()
                .copied()
                .max_by(|a, b| a.distance_squared(centre).total_cmp(&b.distance_squared(centre)))
        };
        let mut centre = Aabb::around(points.iter().copied()).centre();
        let mut best: Option<BoundingSphere> = None;
        for shift in 2..SHIFTS + 2 {
            let Some(point) = farthest(centre) else {
                return BoundingSphere { centre: Vec3::ZERO, radius: 0.0 };
            };
            let radius = point.distance(centre);
            if best.is_none_or(|b| radius < b.radius) {
                best = Some(BoundingSphere { centre, radius });
            }
            centre += (point - centre) / shift as f32;
        }
        // A little more than was computed, so that rounding leaves no point outside.
        best.map_or(BoundingSphere { centre, radius: 0.0 }, |b| BoundingSphere {
            radius: b.radius * 1.000_001,
            ..b
        })
    }

    /// The sphere seen from the outer frame of `pose`.
    #[must_use]
    pub fn at(&self, pose: &Pose) -> BoundingSphere {
        BoundingSphere { centre: pose.transform_point(self.centre), radius: self.radius }
    }

    /// Whether the two spheres share a point: |c_A - c_B| <= r_A + r_B.
    #[must_use]
    pub fn overlaps(&self, other: &BoundingSphere) -> bool {
        let reach = self.radius + other.radius;
        let apart = self.centre.distance_squared(other.centre) > reach * reach;
        !apart
    }

    /// How far the two spheres are in each other, max(r_A + r_B - |c_A - c_B|, 0). Metres.
    #[must_use]
    pub fn penetration(&self, other: &BoundingSphere) -> f32 {
        (self.radius + other.radius - self.centre.distance(other.centre)).max(0.0)
    }

    /// Whether the sphere shares a point with an axis-aligned box.
    #[must_use]
    pub fn overlaps_aabb(&self, aabb: &Aabb) -> bool {
        let apart = aabb.closest_point(self.centre).distance_squared(self.centre) > self.radius * self.radius;
        !apart
    }

    /// Whether the sphere shares a point with an oriented box.
    #[must_use]
    pub fn overlaps_obb(&self, obb: &Obb) -> bool {
        let apart = obb.closest_point(self.centre).distance_squared(self.centre) > self.radius * self.radius;
        !apart
    }
}
