//! Camera: where the picture is taken from, so that what matters fills it.

use forerun::{Aabb, Vec3};

/// How much is seen above and below the middle: the tangent of half the angle (32 degrees in all).
const HALF_HEIGHT: f32 = 0.287;
/// Room around what has to be seen.
const MARGIN: f32 = 1.08;

/// A camera that looks at a point, upright.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    pub(crate) eye: Vec3,
    /// Unit vectors to the right, up, and into the picture.
    pub(crate) right: Vec3,
    pub(crate) up: Vec3,
    pub(crate) forward: Vec3,
    /// Half the width and height of what is seen at distance 1.
    pub(crate) half_size: [f32; 2],
    /// What is nearer is not drawn. Metres.
    pub(crate) near: f32,
}

impl Camera {
    /// A camera in the direction `from` of the box (not straight above or below), as near as it can be with all of it in view.
    /// `aspect`: width over height.
    pub(crate) fn fitting(seen: &Aabb, from: Vec3, aspect: f32) -> Camera {
        let forward = -from.normalize();
        let right = forward.cross(Vec3::Y).normalize();
        let up = right.cross(forward);
        let half_size = [HALF_HEIGHT * aspect, HALF_HEIGHT];
        let centre = 0.5 * (seen.min + seen.max);
        let half = (0.5 * (seen.max - seen.min)).max(Vec3::splat(1e-4));
        let mut distance = 0.0_f32;
        for corner in 0..8 {
            let side = |axis: u32| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
            let at = half * Vec3::new(side(0), side(1), side(2));
            let (x, y, depth) = (at.dot(right).abs(), at.dot(up).abs(), at.dot(forward));
            distance = distance.max(MARGIN * (x / half_size[0]).max(y / half_size[1]) - depth);
        }
        Camera { eye: centre - forward * distance, right, up, forward, half_size, near: 1e-3 * distance }
    }

    /// A point as (right, up, depth), its first two in half widths and heights of the picture times depth.
    pub(crate) fn project(&self, point: Vec3) -> Vec3 {
        let at = point - self.eye;
        Vec3::new(
            at.dot(self.right) / self.half_size[0],
            at.dot(self.up) / self.half_size[1],
            at.dot(self.forward),
        )
    }

    /// From the eye to a place in the picture (-1 to 1 each), 1 deep.
    pub(crate) fn ray(&self, x: f32, y: f32) -> Vec3 {
        self.forward + self.right * (x * self.half_size[0]) + self.up * (y * self.half_size[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_of_the_box_is_in_view_and_fills_it() {
        let seen = Aabb { min: Vec3::new(-3.0, 0.0, -1.0), max: Vec3::new(5.0, 2.0, 1.0) };
        for aspect in [0.5, 1.0, 1.8] {
            let camera = Camera::fitting(&seen, Vec3::new(0.5, 0.4, 0.9), aspect);
            let corners = (0..8).map(|k| {
                let pick = |axis: u32, a: f32, b: f32| if k >> axis & 1 == 0 { a } else { b };
                camera.project(Vec3::new(
                    pick(0, seen.min.x, seen.max.x),
                    pick(1, seen.min.y, seen.max.y),
                    pick(2, seen.min.z, seen.max.z),
                ))
            });
            let farthest = corners
                .map(|c| {
                    assert!(c.z > camera.near);
                    (c.x.abs() / c.z).max(c.y.abs() / c.z)
                })
                .fold(0.0, f32::max);
            assert!((0.85..=1.0).contains(&farthest), "{aspect}: {farthest}");
        }
        let camera = Camera::fitting(&seen, Vec3::new(0.5, 0.4, 0.9), 1.5);
        let there = camera.eye + camera.ray(0.3, -0.6) * 7.0;
        let back = camera.project(there);
        assert!((back / back.z - Vec3::new(0.3, -0.6, 1.0)).length() < 1e-4);
    }
}
