//! Half-space: the ground against every convex shape, exactly.

use super::capsule::Rod;
use super::cylinder::Drum;
use super::reduce::Reducer;
use super::{ContactPoint, Manifold, any_perpendicular};
use crate::shape::{Cuboid, Hull};
use crate::{Pose, Shape, Vec3};

/// The surface of a half-space.
struct Ground {
    point: Vec3,
    normal: Vec3,
}

/// A half-space against a convex shape at a pose. The normal points out of the ground.
pub(super) fn half_space_any(ground: &Pose, shape: &Shape, pose: &Pose, margin: f32) -> Option<Manifold> {
    let ground = Ground { point: ground.position, normal: ground.rotation * Vec3::Y };
    let centre = pose.position;
    match shape {
        Shape::Sphere(sphere) => ground.under_points(&[centre - ground.normal * sphere.radius], margin),
        Shape::Capsule(capsule) => {
            let rod =
                Rod::new(centre, pose.rotation * Vec3::new(0.0, capsule.half_height, 0.0), capsule.radius);
            let [low, high] = rod.ends.map(|end| end - ground.normal * rod.radius);
            // Without a length both ends are one point.
            let count = if capsule.half_height > 0.0 { 2 } else { 1 };
            ground.under_points(&[low, high][..count], margin)
        }
        Shape::Cuboid(cuboid) => ground.under_cuboid(cuboid, pose, margin),
        Shape::Cylinder(cylinder) => {
            let drum = Drum::new(cylinder, centre, pose.axes());
            let lowest = drum.lowest(-ground.normal, any_perpendicular(ground.normal));
            ground.under_points(lowest.as_slice(), margin)
        }
        Shape::Hull(hull) => ground.under_hull(hull, pose, margin),
        // The ground does not move; compounds and meshes come here by their parts, if at all.
        Shape::HalfSpace | Shape::Compound(_) | Shape::Mesh(_) => None,
    }
}

impl Ground {
    /// The contact under one point of a surface.
    fn under(&self, point: Vec3) -> ContactPoint {
        let separation = (point - self.point).dot(self.normal);
        let position = point - self.normal * (separation * 0.5);
        ContactPoint { position, normal: self.normal, separation }
    }

    /// Up to four points, as they are.
    fn under_points(&self, points: &[Vec3], margin: f32) -> Option<Manifold> {
        let mut kept = [ContactPoint::FAR_APART; 4];
        let mut count = 0;
        for contact in points.iter().map(|&point| self.under(point)) {
            if contact.separation < margin {
                kept[count] = contact;
                count += 1;
            }
        }
        Manifold::from_points(&kept[..count])
    }

    /// The corners of the face that looks most against the normal. No other corner is nearer than the one of these below it.
    fn under_cuboid(&self, cuboid: &Cuboid, pose: &Pose, margin: f32) -> Option<Manifold> {
        let axes = pose.axes();
        let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis];
        let cosine = [x, y, z].map(|axis| axis.dot(self.normal));
        let steep = cosine.map(f32::abs);
        let down = if steep[0] >= steep[1] && steep[0] >= steep[2] {
            0
        } else if steep[1] >= steep[2] {
            1
        } else {
            2
        };
        let h = cuboid.half_extents;
        let mut side = [0.0; 3];
        side[down] = if cosine[down] > 0.0 { -1.0 } else { 1.0 };
        let mut manifold = Manifold { normal: self.normal, points: [ContactPoint::FAR_APART; 4], count: 0 };
        for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            (side[(down + 1) % 3], side[(down + 2) % 3]) = (u, v);
            let corner = pose.position + x * (h.x * side[0]) + y * (h.y * side[1]) + z * (h.z * side[2]);
            let contact = self.under(corner);
            if contact.separation < margin {
                manifold.points[manifold.count as usize] = contact;
                manifold.count += 1;
            }
        }
        (manifold.count > 0).then_some(manifold)
    }

    fn under_hull(&self, hull: &Hull, pose: &Pose, margin: f32) -> Option<Manifold> {
        let u = any_perpendicular(self.normal);
        let mut reducer = Reducer::new(pose.position, u, self.normal.cross(u));
        let axes = pose.axes();
        for &vertex in &hull.vertices {
            let contact = self.under(axes * vertex + pose.position);
            if contact.separation < margin {
                reducer.offer(contact);
            }
        }
        reducer.finish()
    }
}
