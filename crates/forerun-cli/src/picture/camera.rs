//! Camera: where the picture is taken from, so that what matters fills it.

use forerun::Vec3;

/// How much is seen above and below the middle: the tangent of half the angle (32 degrees in all).
const HALF_HEIGHT: f32 = 0.287;
/// Room around what has to be seen.
const MARGIN: f32 = 1.06;
/// Between the eye and what has to be seen. Metres.
const SMALLEST_DISTANCE: f32 = 1e-3;

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
    /// A camera in the direction `from` (not straight above or below), as near as it can be with all points in view. `aspect`: width over height.
    ///
    /// A point is left of the right edge where `right - eye <= half_size (depth - eye depth)`, and so for all four edges: what bounds the eye
    /// are the largest of `right - half_size depth` and the smallest of `right + half_size depth`.
    pub(crate) fn fitting(points: impl Iterator<Item = Vec3>, from: Vec3, aspect: f32) -> Camera {
        let forward = -from.normalize();
        let right = forward.cross(Vec3::Y).normalize();
        let up = right.cross(forward);
        let half_size = [HALF_HEIGHT * aspect, HALF_HEIGHT];
        let slopes = half_size.map(|half| half / MARGIN);
        let (mut low, mut high, mut nearest) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2], f32::INFINITY);
        for point in points {
            let (across, depth) = ([point.dot(right), point.dot(up)], point.dot(forward));
            for axis in 0..2 {
                high[axis] = high[axis].max(across[axis] - slopes[axis] * depth);
                low[axis] = low[axis].min(across[axis] + slopes[axis] * depth);
            }
            nearest = nearest.min(depth);
        }
        let depths = [0, 1].map(|axis| (low[axis] - high[axis]) / (2.0 * slopes[axis]));
        // A little farther, so that a single point has a distance too.
        let depth = depths[0].min(depths[1]) - SMALLEST_DISTANCE;
        let [across, above] = [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]));
        let eye = right * across + up * above + forward * depth;
        Camera { eye, right, up, forward, half_size, near: 0.01 * (nearest - depth) }
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
        let (min, max) = (Vec3::new(-3.0, 0.0, -1.0), Vec3::new(5.0, 2.0, 1.0));
        let corners = || {
            (0..8).map(|k| {
                let pick = |axis: usize| if k >> axis & 1 == 0 { min[axis] } else { max[axis] };
                Vec3::new(pick(0), pick(1), pick(2))
            })
        };
        let from = Vec3::new(0.5, 0.4, 0.9);
        for aspect in [0.5, 1.0, 1.8] {
            let camera = Camera::fitting(corners(), from, aspect);
            let farthest = corners()
                .map(|corner| {
                    let at = camera.project(corner);
                    assert!(at.z > camera.near);
                    (at.x.abs() / at.z).max(at.y.abs() / at.z)
                })
                .fold(0.0, f32::max);
            assert!((0.93..=1.0).contains(&farthest), "{aspect}: {farthest}");
        }
        let point = Camera::fitting(std::iter::once(max), from, 1.0);
        assert!(point.near > 0.0 && point.project(max).truncate().length() < 1e-4);
        let camera = Camera::fitting(corners(), from, 1.5);
        let there = camera.eye + camera.ray(0.3, -0.6) * 7.0;
        let back = camera.project(there);
        assert!((back / back.z - Vec3::new(0.3, -0.6, 1.0)).length() < 1e-4);
    }
}
