//! Motion: what moves the camera from picture to picture: keys that are held, and a journey to what it is to look at.

use forerun::Vec3;

use super::Framed;

/// How long a journey takes. Seconds.
const JOURNEY_S: f32 = 0.35;
/// Flying, in distances of the target a second.
const FLIGHT: f32 = 0.9;
/// So much faster with Shift.
const FAST: f32 = 4.0;
/// A slow picture moves the camera no farther than one of this length. Seconds.
const ELAPSED_MAX_S: f32 = 0.1;

/// A key that flies while it is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Push {
    Forward,
    Back,
    Left,
    Right,
    Up,
    Down,
}

/// What moves the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion {
    /// Width and height of what is free of panels, in heights of the picture.
    pub(crate) free: [f32; 2],
    /// Whether a button is held that was pressed beside all panels.
    pub(crate) turning: bool,
    /// Whether the button is held with which keys fly.
    pub(crate) flying: bool,
    /// Whether it goes fast.
    pub(crate) fast: bool,
    /// Where the mouse was last. Pixels.
    pub(crate) pointer: Option<[f32; 2]>,
    /// By [`Push`], whether its key is held.
    held: [bool; 6],
    journey: Option<Journey>,
}

impl Default for Motion {
    fn default() -> Self {
        Motion {
            free: [1.6, 1.0],
            turning: false,
            flying: false,
            fast: false,
            pointer: None,
            held: [false; 6],
            journey: None,
        }
    }
}

/// On the way.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Journey {
    to: Framed,
    left_s: f32,
}

impl Motion {
    /// Stays where it is.
    pub(crate) fn stop(&mut self) {
        self.journey = None;
    }

    pub(crate) fn travel(&mut self, to: Framed) {
        self.journey = Some(Journey { to, left_s: JOURNEY_S });
    }

    /// A key is held or let go.
    pub(crate) fn hold(&mut self, push: Push, held: bool) {
        self.held[push as usize] = held;
    }

    /// Whether a key flies now.
    pub(crate) fn is_pushed(&self) -> bool {
        self.flying && self.held.contains(&true)
    }

    /// Whether the next picture is taken from elsewhere.
    pub(super) fn is_under_way(&self) -> bool {
        self.journey.is_some() || self.is_pushed()
    }

    /// Lets go of everything.
    pub(crate) fn release(&mut self) {
        self.held = [false; 6];
        self.flying = false;
    }

    /// How far keys move the camera in a time (seconds): to the right, up and forward. Metres.
    pub(super) fn flight(&mut self, elapsed_s: f32, distance: f32) -> Vec3 {
        if !self.is_pushed() {
            return Vec3::ZERO;
        }
        self.stop();
        let along = |more: Push, less: Push| {
            f32::from(u8::from(self.held[more as usize])) - f32::from(u8::from(self.held[less as usize]))
        };
        let direction = Vec3::new(
            along(Push::Right, Push::Left),
            along(Push::Up, Push::Down),
            along(Push::Forward, Push::Back),
        );
        let fast = if self.fast { FAST } else { 1.0 };
        direction.normalize_or_zero() * (FLIGHT * fast * distance * elapsed_s.min(ELAPSED_MAX_S))
    }

    /// Where a journey is after a time (seconds), from where it was.
    pub(super) fn journey(&mut self, elapsed_s: f32, from: &Framed) -> Option<Framed> {
        let journey = self.journey.as_mut()?;
        let part = elapsed_s / journey.left_s;
        journey.left_s -= elapsed_s;
        let to = journey.to;
        if part >= 1.0 || !part.is_finite() {
            self.journey = None;
            return Some(to);
        }
        // Of what is left, a part that begins large and ends small: it slows down on arrival.
        let part = 1.0 - (1.0 - part) * (1.0 - part);
        // The short way round.
        let turn = std::f32::consts::TAU;
        let yaw = (to.yaw - from.yaw + 0.5 * turn).rem_euclid(turn) - 0.5 * turn;
        Some(Framed {
            target: from.target.lerp(to.target, part),
            distance: from.distance * (to.distance / from.distance).powf(part),
            yaw: from.yaw + yaw * part,
            pitch: from.pitch + (to.pitch - from.pitch) * part,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;

    #[test]
    fn a_journey_arrives_in_time_and_gets_nearer_in_every_picture() {
        let mut camera = Camera::default();
        let goal = Vec3::new(5.0, 1.0, 0.0);
        camera.travel(Framed { target: goal, distance: 2.0, ..camera.framed() });
        let mut away = (camera.target - goal).length();
        for _ in 0..20 {
            camera.go_on(0.02);
            let now = (camera.target - goal).length();
            assert!(now < away || now < 1e-6);
            away = now;
        }
        assert!(away < 1e-6);
        // And stays there.
        let there = camera;
        camera.go_on(0.02);
        assert_eq!(camera, there);
    }

    #[test]
    fn keys_fly_while_the_button_is_held() {
        let mut camera = Camera::default();
        camera.motion.hold(Push::Forward, true);
        let eye = camera.eye();
        camera.go_on(0.05);
        assert_eq!(camera.eye(), eye);
        camera.motion.flying = true;
        camera.go_on(0.05);
        let moved = camera.eye() - eye;
        assert!(moved.normalize().dot(camera.forward()) > 0.999 && moved.length() > 0.1);
        camera.motion.release();
        let eye = camera.eye();
        camera.go_on(0.05);
        assert_eq!(camera.eye(), eye);
    }
}
