//! The camera's hand: the right button goes round, the middle one (or Shift and the right one) moves, the wheel comes nearer.

use three_d::{Event, MouseButton};

use crate::camera::Camera;

/// A turn of the picture for a drag across its height. Radians.
const TURN: f32 = 3.5;
/// Nearer by this factor for one notch of a wheel.
const NOTCH: f32 = 0.88;
/// Points of a notch.
const NOTCH_POINTS: f32 = 24.0;

/// Moves the camera. `height` of the window in pixels.
pub(super) fn take(events: &mut [Event], camera: &mut Camera, height: f32) {
    for event in events {
        match event {
            Event::MouseMotion {
                button: Some(button), delta, modifiers, handled: handled @ false, ..
            } => {
                let (right, up) = (delta.0 / height, -delta.1 / height);
                match button {
                    MouseButton::Right if !modifiers.shift => camera.orbit(-TURN * right, -TURN * up),
                    MouseButton::Right | MouseButton::Middle => camera.pan(-right, -up),
                    MouseButton::Left => continue,
                }
                *handled = true;
            }
            Event::MouseWheel { delta, handled: handled @ false, .. } => {
                camera.zoom(NOTCH.powf(delta.1 / NOTCH_POINTS));
                *handled = true;
            }
            Event::PinchGesture { delta, handled: handled @ false, .. } => {
                camera.zoom((-*delta).exp());
                *handled = true;
            }
            _ => {}
        }
    }
}
