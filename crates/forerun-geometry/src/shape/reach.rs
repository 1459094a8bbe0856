//! Reach: how far a set of points extends in 26 directions, from which a box around it at any rotation follows without looking at the
//! points again.

use crate::{Aabb, BoundingSphere, Pose, Vec3};

/// Farthest extent of points from a centre along every direction with components -1, 0 and 1, and in general.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Reach {
    centre: Vec3,
    radius: f32,
    /// Largest p . d for d = (x, y, z), at 9 (x + 1) + 3 (y + 1) + z + 1.
    along: [f32; 27],
}

impl Reach {
    pub(super) fn of(points: &[Vec3]) -> Reach {
        let centre = Aabb::around(points.iter().copied()).centre();
        let radius = points.iter().map(|p| p.distance(centre)).fold(0.0, f32::max);
        let mut along = [0.0; 27];
        for (i, farthest) in along.iter_mut().enumerate() {
            let d = Vec3::new((i / 9) as f32, (i / 3 % 3) as f32, (i % 3) as f32) - Vec3::ONE;
            *farthest = points.iter().map(|p| d.dot(*p - centre)).fold(f32::NEG_INFINITY, f32::max);
        }
        Reach { centre, radius, along }
    }

    /// A bound from above of the largest (p - centre) . u, for a unit vector u.
    ///
    /// With |u_i| >= |u_j| >= |u_k| and signs s, u = (|u_i| - |u_j|) s_i e_i + (|u_j| - |u_k|) (s_i e_i + s_j e_j) + |u_k| (s_i e_i + s_j e_j + s_k e_k), and the
    /// largest of a sum is at most the sum of the largest.
    fn towards(&self, u: Vec3) -> f32 {
        let size = u.abs();
        let mut axes = [0, 1, 2];
        axes.sort_by(|&a, &b| size[b].total_cmp(&size[a]));
        let places = [9, 3, 1];
        let mut direction = 13;
        let mut sum = 0.0;
        for (rank, &axis) in axes.iter().enumerate() {
            direction = if u[axis] < 0.0 { direction - places[axis] } else { direction + places[axis] };
            let next = if rank < 2 { size[axes[rank + 1]] } else { 0.0 };
            sum += (size[axis] - next) * self.along[direction];
        }
        sum.min(self.radius)
    }

    /// A ball around the points: its middle is that of their box.
    pub(super) fn ball(&self) -> BoundingSphere {
        BoundingSphere { centre: self.centre, radius: self.radius }
    }

    /// A box around the points at `pose`; the smallest one where the pose does not turn them.
    pub(super) fn aabb(&self, pose: &Pose) -> Aabb {
        let centre = pose.transform_point(self.centre);
        let rows = pose.axes().transpose();
        let (x, y, z) = (rows.x_axis, rows.y_axis, rows.z_axis);
        Aabb {
            min: centre - Vec3::new(self.towards(-x), self.towards(-y), self.towards(-z)),
            max: centre + Vec3::new(self.towards(x), self.towards(y), self.towards(z)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Quat;

    #[test]
    fn unturned_boxes_are_exact_and_turned_ones_close() {
        let rod = [Vec3::new(-1.0, -1.0, 0.5), Vec3::new(1.0, 1.0, 0.5)];
        let reach = Reach::of(&rod);
        let upright = reach.aabb(&Pose::from_position(Vec3::X));
        assert_eq!((upright.min, upright.max), (Vec3::new(0.0, -1.0, 0.5), Vec3::new(2.0, 1.0, 0.5)));
        for i in 0..40 {
            let (s, c) = libm::sincosf(i as f32 * 0.1);
            let pose = Pose::new(Vec3::ZERO, Quat::from_xyzw(0.3 * s, 0.9 * s, s, c).normalize());
            let exact = Aabb::around(rod.iter().map(|p| pose.transform_point(*p)));
            let found = reach.aabb(&pose);
            let slack = (exact.min - found.min).min(found.max - exact.max).min_element();
            let loose = (exact.min - found.min).max(found.max - exact.max).max_element();
            assert!(slack > -1e-6 && loose < 0.3, "{slack} {loose}");
        }
    }
}
