//! Sight: what is where in the picture.

use forerun::{BodyHit, Ray, Vec3};

use crate::camera::Camera;
use crate::session::Play;

/// How far it is looked for bodies. Metres.
const FAR_M: f32 = 1e5;

/// A camera and the size of its picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight<'a> {
    pub(super) camera: &'a Camera,
    /// Width and height. Pixels.
    size: [f32; 2],
}

impl Sight<'_> {
    pub(super) fn new(camera: &Camera, size: [f32; 2]) -> Sight<'_> {
        Sight { camera, size }
    }

    /// From the eye through a place of the picture (pixels from the left and the bottom).
    pub(super) fn ray(&self, pointer: [f32; 2]) -> Ray {
        let [width, height] = self.size;
        let at = [pointer[0] / width * 2.0 - 1.0, pointer[1] / height * 2.0 - 1.0];
        self.camera.ray(at[0], at[1], width / height)
    }

    /// The first body there.
    pub(super) fn hit(&self, play: &Play, pointer: [f32; 2]) -> Option<BodyHit> {
        play.picture.snapshot.cast_ray(play.picture.time_s, &self.ray(pointer), FAR_M)
    }

    /// The first body before the target, or at it, or behind it.
    pub(super) fn hit_ahead(&self, play: &Play) -> Option<BodyHit> {
        let ray = Ray { origin: self.camera.eye(), direction: self.camera.forward() };
        play.picture.snapshot.cast_ray(play.picture.time_s, &ray, FAR_M)
    }

    /// Where the ray through a place of the picture meets a plane.
    pub(super) fn on_plane(&self, pointer: [f32; 2], point: Vec3, normal: Vec3) -> Option<Vec3> {
        /// A plane that is seen so flat (sine of the angle) has no place under the mouse to speak of.
        const FLAT: f32 = 0.02;
        let ray = self.ray(pointer);
        let slope = ray.direction.dot(normal);
        let distance = (point - ray.origin).dot(normal) / slope;
        (slope.abs() > FLAT && distance > 0.0 && distance < FAR_M)
            .then(|| ray.origin + ray.direction * distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_on_a_plane_is_under_the_mouse_and_on_the_plane() {
        let camera = Camera { target: Vec3::new(1.0, 2.0, 3.0), ..Camera::default() };
        let sight = Sight::new(&camera, [800.0, 600.0]);
        for pointer in [[400.0, 300.0], [100.0, 50.0], [700.0, 420.0]] {
            let point = sight.on_plane(pointer, Vec3::Y * 0.5, Vec3::Y).expect("the ground is below");
            assert!((point.y - 0.5).abs() < 1e-4, "{point}");
            let ray = sight.ray(pointer);
            let beside = (point - ray.origin).cross(ray.direction).length();
            assert!(beside < 1e-4, "{beside} m beside the ray");
        }
        let level = Camera { pitch: 0.0, ..camera };
        let sight = Sight::new(&level, [800.0, 600.0]);
        assert_eq!(sight.on_plane([400.0, 300.0], Vec3::ZERO, Vec3::Y), None, "seen edge on");
    }
}
