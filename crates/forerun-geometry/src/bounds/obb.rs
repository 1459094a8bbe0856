//! Oriented bounding boxes (dissertation, section 2.3.1).

use glam::Mat3;

use super::Aabb;
use crate::{Pose, Vec3};

/// A box turned in any way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obb {
    /// Centre. Metres.
    pub centre: Vec3,
    /// Its columns are the unit directions of the box's sides, right-handed.
    pub axes: Mat3,
    /// Half the size along each of its axes. Metres, 0 or more; may be infinite.
    pub half_extents: Vec3,
}

impl Obb {
    /// The box seen from the outer frame of `pose`.
    #[must_use]
    pub fn at(&self, pose: &Pose) -> Obb {
        Obb {
            centre: pose.transform_point(self.centre),
            axes: pose.axes() * self.axes,
            half_extents: self.half_extents,
        }
    }

    /// Volume. m³.
    #[must_use]
    pub fn volume(&self) -> f32 {
        8.0 * self.half_extents.x * self.half_extents.y * self.half_extents.z
    }

    /// The smallest axis-aligned box around this one.
    #[must_use]
    pub fn aabb(&self) -> Aabb {
        let (m, h) = (self.axes, self.half_extents);
        Aabb::from_centre(self.centre, m.x_axis.abs() * h.x + m.y_axis.abs() * h.y + m.z_axis.abs() * h.z)
    }

    /// The point of the box closest to `point`: itself when inside. Metres.
    #[must_use]
    pub fn closest_point(&self, point: Vec3) -> Vec3 {
        let local = self.axes.transpose() * (point - self.centre);
        let h = self.half_extents;
        self.centre + self.axes * local.max(-h).min(h)
    }

    /// Whether the two boxes share a point.
    ///
    /// They do not when their shadows on one of 15 directions are apart: the 3 axes of each and the 9 cross products (Gottschalk,
    /// Lin, Manocha, *OBBTree*, 1996).
    #[must_use]
    pub fn overlaps(&self, other: &Obb) -> bool {
        let (a, b) = (self.half_extents.to_array(), other.half_extents.to_array());
        // The other box seen from this one.
        let r = self.axes.transpose() * other.axes;
        let t = self.axes.transpose() * (other.centre - self.centre);
        // Of parallel axes the cross product is nothing but rounding: a little more reach keeps it from telling boxes apart.
        let reach =
            [r.x_axis, r.y_axis, r.z_axis].map(|column| (column.abs() + Vec3::splat(1e-6)).to_array());
        let r = [r.x_axis, r.y_axis, r.z_axis].map(|column| column.to_array());
        for i in 0..3 {
            if t[i].abs() > a[i] + b[0] * reach[0][i] + b[1] * reach[1][i] + b[2] * reach[2][i] {
                return false;
            }
        }
        for j in 0..3 {
            let along = t.dot(Vec3::from(r[j]));
            if along.abs() > b[j] + a[0] * reach[j][0] + a[1] * reach[j][1] + a[2] * reach[j][2] {
                return false;
            }
        }
        for i in 0..3 {
            let (i1, i2) = ((i + 1) % 3, (i + 2) % 3);
            for j in 0..3 {
                let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
                let along = t[i2] * r[j][i1] - t[i1] * r[j][i2];
                let own = a[i1] * reach[j][i2] + a[i2] * reach[j][i1];
                let others = b[j1] * reach[j2][i] + b[j2] * reach[j1][i];
                if along.abs() > own + others {
                    return false;
                }
            }
        }
        true
    }

    /// Whether the box shares a point with an axis-aligned one.
    #[must_use]
    pub fn overlaps_aabb(&self, aabb: &Aabb) -> bool {
        self.overlaps(&Obb::from(*aabb))
    }
}

impl From<Aabb> for Obb {
    fn from(aabb: Aabb) -> Obb {
        Obb { centre: aabb.centre(), axes: Mat3::IDENTITY, half_extents: aabb.half_extents() }
    }
}
