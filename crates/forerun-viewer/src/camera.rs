//! Camera: an eye that goes round a point.

use forerun::{Ray, Vec3};

/// Half of what is seen from bottom to top. Radians.
const HALF_ANGLE: f32 = 0.4;
/// The eye never goes straight above or below: there it has no upright. Radians.
const PITCH_MAX: f32 = 1.55;

/// Where the picture is taken from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point that it looks at and goes round. Metres.
    pub target: Vec3,
    /// About the vertical, 0 looks along -z. Radians.
    pub yaw: f32,
    /// Above the horizontal. Radians, -1.55 to 1.55.
    pub pitch: f32,
    /// From the target. Metres, above 0.
    pub distance: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Camera { target: Vec3::ZERO, yaw: 0.6, pitch: 0.45, distance: 10.0 }
    }
}

impl Camera {
    /// Unit vector from the eye to the target.
    #[must_use]
    pub fn forward(&self) -> Vec3 {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.sin_cos();
        Vec3::new(-sin_yaw * cos_pitch, -sin_pitch, -cos_yaw * cos_pitch)
    }

    /// Unit vector to the right of the picture.
    #[must_use]
    pub fn right(&self) -> Vec3 {
        let (sin, cos) = self.yaw.sin_cos();
        Vec3::new(cos, 0.0, -sin)
    }

    /// Unit vector up in the picture.
    #[must_use]
    pub fn up(&self) -> Vec3 {
        self.right().cross(self.forward())
    }

    /// Where the picture is taken from. Metres.
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        self.target - self.forward() * self.distance
    }

    /// The whole angle of what is seen from bottom to top. Radians.
    #[must_use]
    pub fn angle(&self) -> f32 {
        2.0 * HALF_ANGLE
    }

    /// From the eye through a place of the picture: `x` and `y` from -1 (left, bottom) to 1, `aspect` is width over height.
    #[must_use]
    pub fn ray(&self, x: f32, y: f32, aspect: f32) -> Ray {
        let half = HALF_ANGLE.tan();
        let direction = self.forward() + self.right() * (x * half * aspect) + self.up() * (y * half);
        Ray { origin: self.eye(), direction: direction.normalize() }
    }

    /// Goes round the target. Radians.
    pub fn orbit(&mut self, yaw: f32, pitch: f32) {
        self.yaw = (self.yaw + yaw).rem_euclid(std::f32::consts::TAU);
        self.pitch = (self.pitch + pitch).clamp(-PITCH_MAX, PITCH_MAX);
    }

    /// Moves the target with the picture, by parts of its height.
    pub fn pan(&mut self, right: f32, up: f32) {
        let height = 2.0 * self.distance * HALF_ANGLE.tan();
        self.target += (self.right() * right + self.up() * up) * height;
    }

    /// Comes nearer by a factor above 0.
    pub fn zoom(&mut self, factor: f32) {
        self.distance = (self.distance * factor).clamp(1e-3, 1e5);
    }

    /// Looks at a ball from where it is, so that all of it is seen.
    pub fn look_at(&mut self, centre: Vec3, radius: f32) {
        self.target = centre;
        self.distance = (radius.max(1e-3) / HALF_ANGLE.sin()).clamp(1e-3, 1e5);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_the_picture_is_the_target() {
        let camera = Camera { target: Vec3::new(1.0, 2.0, 3.0), yaw: 2.1, pitch: -0.7, distance: 4.0 };
        let ray = camera.ray(0.0, 0.0, 1.7);
        assert!((ray.origin + ray.direction * 4.0 - camera.target).length() < 1e-5);
        assert!(camera.up().y > 0.0 && camera.right().dot(camera.up()).abs() < 1e-6);
    }

    #[test]
    fn what_is_panned_stays_under_the_mouse() {
        let mut camera = Camera::default();
        let before = camera.ray(0.0, 1.0, 1.5);
        // The point at the upper edge, as far away as the target, comes to the middle when the picture goes half a height down.
        let depth = camera.distance / before.direction.dot(camera.forward());
        let point = before.origin + before.direction * depth;
        camera.pan(0.0, 0.5);
        assert!((camera.target - point).length() < 1e-4);
    }
}
