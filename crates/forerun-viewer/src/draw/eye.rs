//! Eye: what the camera means for the graphics card.

use forerun::Vec3;
use three_d::{Mat4, SquareMatrix, Viewport};

use super::convert::vector;
use crate::camera::Camera;

/// What is nearer to the eye than this part of the distance to the target is not drawn.
const NEAR: f32 = 0.01;
/// What is farther than so many times all that there is, is not drawn.
const FAR: f32 = 30.0;

/// From where, whereto and how far one sees.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eye {
    pub(super) viewport: Viewport,
    pub(super) position: Vec3,
    /// To the middle of the picture, which need not be where the target is. Its depth is 1.
    pub(super) forward: Vec3,
    /// Half the picture's width and height at distance 1.
    pub(super) across: Vec3,
    pub(super) upwards: Vec3,
    pub(super) view_projection: Mat4,
    pub(super) near: f32,
    pub(super) far: f32,
}

impl Eye {
    /// `reach`: how far from the target there is something to see. Metres.
    pub(super) fn new(camera: &Camera, viewport: Viewport, reach: f32) -> Eye {
        let aspect = viewport.width.max(1) as f32 / viewport.height.max(1) as f32;
        let position = camera.eye();
        let near = NEAR * camera.distance;
        let far = FAR * (camera.distance + reach);
        let half = camera.half_height();
        let view = Mat4::look_at_rh(
            three_d::Point3::new(position.x, position.y, position.z),
            three_d::Point3::new(camera.target.x, camera.target.y, camera.target.z),
            vector(camera.up()),
        );
        let projection = three_d::perspective(three_d::radians(camera.angle()), aspect, near, far);
        let ([x, y], across, upwards) = (camera.centre, camera.right() * (half * aspect), camera.up() * half);
        let shift = Mat4::from_translation(three_d::vec3(x, y, 0.0));
        Eye {
            viewport,
            position,
            forward: camera.forward() - across * x - upwards * y,
            across,
            upwards,
            view_projection: shift * projection * view,
            near,
            far,
        }
    }

    /// How wide a line of one point is, so that it is seen on large screens too. Pixels.
    pub(super) fn pixels_per_point(&self) -> f32 {
        (self.viewport.height as f32 / 1000.0).clamp(1.0, 3.0)
    }
}

/// The identity, where a matrix is not known.
pub(super) fn identity() -> Mat4 {
    Mat4::identity()
}
