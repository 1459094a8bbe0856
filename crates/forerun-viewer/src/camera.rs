//! Camera: an eye that goes round a point, flies, and travels to what it is to look at.
#![allow(
    clippy::disallowed_methods,
    reason = "where a picture is taken from need not be the same on all platforms"
)]

mod framing;
mod motion;

pub use framing::Framed;
pub(crate) use motion::{Motion, Push};

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
    /// Where in the picture the target is: `x` and `y` from -1 (left, bottom) to 1. The middle of what panels leave free.
    pub centre: [f32; 2],
    /// How much is seen from bottom to top, against a window without panels: above 0.
    pub lens: f32,
    /// What moves it from picture to picture.
    pub(crate) motion: Motion,
}

impl Default for Camera {
    fn default() -> Self {
        Camera {
            target: Vec3::ZERO,
            yaw: 0.6,
            pitch: 0.45,
            distance: 10.0,
            centre: [0.0; 2],
            lens: 1.0,
            motion: Motion::default(),
        }
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
        2.0 * self.half_height().atan()
    }

    /// Half the height of what is seen at distance 1.
    #[must_use]
    pub fn half_height(&self) -> f32 {
        HALF_ANGLE.tan() * self.lens
    }

    /// From the eye through a place of the picture: `x` and `y` from -1 (left, bottom) to 1, `aspect` is width over height.
    #[must_use]
    pub fn ray(&self, x: f32, y: f32, aspect: f32) -> Ray {
        let (half, [centre_x, centre_y]) = (self.half_height(), self.centre);
        let direction = self.forward()
            + self.right() * ((x - centre_x) * half * aspect)
            + self.up() * ((y - centre_y) * half);
        Ray { origin: self.eye(), direction: direction.normalize() }
    }

    /// The place in the picture of a point: `x` and `y` from -1 (left, bottom) to 1 where it is seen. None behind the eye.
    #[must_use]
    pub fn project(&self, point: Vec3, aspect: f32) -> Option<[f32; 2]> {
        let (at, half) = (point - self.eye(), self.half_height());
        let depth = at.dot(self.forward());
        let [x, y] = [at.dot(self.right()) / (half * aspect * depth), at.dot(self.up()) / (half * depth)];
        (depth > 0.0).then_some([x + self.centre[0], y + self.centre[1]])
    }

    /// Goes round the target. Radians.
    pub fn orbit(&mut self, yaw: f32, pitch: f32) {
        self.yaw = (self.yaw + yaw).rem_euclid(std::f32::consts::TAU);
        self.pitch = (self.pitch + pitch).clamp(-PITCH_MAX, PITCH_MAX);
    }

    /// Turns where it is. Radians.
    pub fn look_round(&mut self, yaw: f32, pitch: f32) {
        let eye = self.eye();
        self.orbit(yaw, pitch);
        self.target = eye + self.forward() * self.distance;
    }

    /// Moves the target with the picture, by parts of its height.
    pub fn pan(&mut self, right: f32, up: f32) {
        self.motion.stop();
        let height = 2.0 * self.distance * self.half_height();
        self.target += (self.right() * right + self.up() * up) * height;
    }

    /// Comes nearer by a factor above 0.
    pub fn zoom(&mut self, factor: f32) {
        self.motion.stop();
        self.distance = (self.distance * factor).clamp(1e-3, 1e5);
    }

    /// Comes nearer by a factor above 0 to what lies under a ray as far away as the target: it stays where it is in the picture.
    pub fn zoom_to(&mut self, factor: f32, ray: &Ray) {
        let facing = ray.direction.dot(self.forward()).max(0.1);
        let point = ray.origin + ray.direction * (self.distance / facing);
        let before = self.distance;
        self.zoom(factor);
        self.target = point + (self.target - point) * (self.distance / before);
    }

    /// Where it is now.
    pub(crate) fn framed(&self) -> Framed {
        Framed { target: self.target, distance: self.distance, yaw: self.yaw, pitch: self.pitch }
    }

    /// Is there.
    pub fn jump(&mut self, framed: Framed) {
        self.motion.stop();
        self.place(framed);
    }

    /// Travels there.
    pub fn travel(&mut self, framed: Framed) {
        self.motion.travel(framed);
    }

    /// Says what of the picture is free of panels: width and height, in heights of the picture, and where the middle of it is, as in [`Camera::centre`].
    pub fn set_free(&mut self, size: [f32; 2], middle: [f32; 2]) {
        self.motion.free = size;
        self.centre = middle;
    }

    /// What is seen between the panels, in a picture of its own; `aspect` is width over height.
    #[must_use]
    pub fn without_panels(&self, aspect: f32) -> Camera {
        let [width, height] = self.motion.free;
        Camera { centre: [0.0; 2], lens: self.lens * height.max(width / aspect).clamp(0.1, 1.0), ..*self }
    }

    /// Whether it moves by itself.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.motion.is_under_way()
    }

    /// Ends a journey at once.
    pub fn arrive(&mut self) {
        if let Some(framed) = self.motion.journey(f32::INFINITY, &self.framed()) {
            self.place(framed);
        }
    }

    fn place(&mut self, Framed { target, distance, yaw, pitch }: Framed) {
        (self.target, self.distance, self.yaw, self.pitch) = (target, distance, yaw, pitch);
    }

    /// Goes on by a time (seconds): flies while keys are held, and travels.
    pub fn go_on(&mut self, elapsed_s: f32) {
        let mut motion = self.motion;
        let pushed = motion.flight(elapsed_s, self.distance);
        self.target += self.right() * pushed.x + Vec3::Y * pushed.y + self.forward() * pushed.z;
        if let Some(framed) = motion.journey(elapsed_s, &self.framed()) {
            self.place(framed);
        }
        self.motion = motion;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_the_picture_is_the_target() {
        let camera = Camera {
            target: Vec3::new(1.0, 2.0, 3.0),
            yaw: 2.1,
            pitch: -0.7,
            distance: 4.0,
            ..Camera::default()
        };
        let ray = camera.ray(0.0, 0.0, 1.7);
        assert!((ray.origin + ray.direction * 4.0 - camera.target).length() < 1e-5);
        assert!(camera.up().y > 0.0 && camera.right().dot(camera.up()).abs() < 1e-6);
    }

    #[test]
    fn beside_panels_the_target_is_in_the_middle_of_what_is_free() {
        let mut camera = Camera { target: Vec3::new(1.0, 2.0, 3.0), ..Camera::default() };
        camera.set_free([1.0, 0.6], [-0.1, 0.4]);
        let near = |place: Option<[f32; 2]>, [x, y]: [f32; 2]| {
            place.is_some_and(|at| (at[0] - x).abs() + (at[1] - y).abs() < 1e-4)
        };
        assert!(near(camera.project(camera.target, 1.6), [-0.1, 0.4]));
        let ray = camera.ray(0.5, -0.7, 1.6);
        assert!(near(camera.project(ray.origin + ray.direction * 5.0, 1.6), [0.5, -0.7]));
        // What a wheel brings nearer stays under it.
        let depth = camera.distance / ray.direction.dot(camera.forward());
        let point = ray.origin + ray.direction * depth;
        camera.zoom_to(0.5, &ray);
        assert!(near(camera.project(point, 1.6), [0.5, -0.7]));
        // A picture of its own shows what is free, and that fills it.
        let aspect = 1.0 / 0.6;
        let alone = camera.without_panels(aspect);
        assert!(near(alone.project(camera.target, aspect), [0.0, 0.0]));
        let corner = camera.ray(-0.1 + 1.0 / 1.6, 0.4 + 0.6, 1.6);
        assert!(near(alone.project(corner.origin + corner.direction, aspect), [1.0, 1.0]));
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

    #[test]
    fn what_is_projected_lies_on_its_ray_and_stays_there_in_a_zoom() {
        let mut camera = Camera { target: Vec3::new(0.0, 1.0, -2.0), ..Camera::default() };
        let ray = camera.ray(0.4, -0.6, 1.6);
        let depth = camera.distance / ray.direction.dot(camera.forward());
        let point = ray.origin + ray.direction * depth;
        let near =
            |place: Option<[f32; 2]>| place.is_some_and(|[x, y]| (x - 0.4).abs() + (y + 0.6).abs() < 1e-3);
        assert!(near(camera.project(point, 1.6)));
        camera.zoom_to(0.5, &ray);
        assert!((camera.distance - 5.0).abs() < 1e-4 && near(camera.project(point, 1.6)));
        assert_eq!(camera.project(camera.eye() - camera.forward(), 1.6), None);
    }

    #[test]
    fn looking_round_leaves_the_eye_where_it_is() {
        let mut camera = Camera::default();
        let eye = camera.eye();
        camera.look_round(0.3, -0.2);
        assert!((camera.eye() - eye).length() < 1e-5);
    }
}
