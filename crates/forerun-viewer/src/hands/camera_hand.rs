//! The camera's hand: the right button goes round, the middle one (or Shift and the right one) moves, the wheel comes nearer to what is
//! under the mouse, and W, A, S, D, Q and E fly while the right button is held. What is dragged with the left button where no body is goes
//! round too: on a touch screen one finger does, and two come nearer.

use three_d::{Event, Key, MouseButton};

use crate::camera::{Camera, Push};
use crate::input::Input;

/// A turn of the picture for a drag across its height. Radians.
const TURN: f32 = 3.5;
/// Nearer by this factor for one notch of a wheel.
const NOTCH: f32 = 0.88;
/// Points of a notch.
const NOTCH_POINTS: f32 = 24.0;

/// Takes the keys that fly, before they mean anything else.
pub(crate) fn take_flight(input: &mut Input, camera: &mut Camera) {
    for event in &mut input.events {
        match event {
            Event::MousePress { button, handled, .. } => {
                // What begins on a panel is not meant for the camera.
                camera.motion.turning = !*handled;
                camera.motion.flying |= !*handled && *button == MouseButton::Right;
            }
            Event::MouseRelease { button: MouseButton::Right, .. } | Event::MouseLeave => {
                camera.motion.release();
            }
            Event::ModifiersChange { modifiers } => camera.motion.fast = modifiers.shift,
            Event::KeyPress { kind, handled: handled @ false, .. } if camera.motion.flying => {
                if let Some(push) = push_of(*kind) {
                    camera.motion.hold(push, true);
                    *handled = true;
                }
            }
            Event::KeyRelease { kind, .. } => {
                if let Some(push) = push_of(*kind) {
                    camera.motion.hold(push, false);
                }
            }
            _ => {}
        }
    }
    camera.go_on(input.elapsed_s as f32);
}

/// As in games.
fn push_of(key: Key) -> Option<Push> {
    Some(match key {
        Key::W => Push::Forward,
        Key::S => Push::Back,
        Key::A => Push::Left,
        Key::D => Push::Right,
        Key::E => Push::Up,
        Key::Q => Push::Down,
        _ => return None,
    })
}

/// Moves the camera by what the tools left. `height` of the window in pixels.
pub(super) fn take(input: &mut Input, camera: &mut Camera) {
    let height = input.viewport.height.max(1) as f32;
    let width = input.viewport.width.max(1) as f32;
    for event in &mut input.events {
        match event {
            Event::MouseMotion { button, position, modifiers, handled, .. } => {
                let at = [position.x, position.y];
                let from = camera.motion.pointer.replace(at).unwrap_or(at);
                let Some(button) = button.filter(|_| !*handled && camera.motion.turning) else { continue };
                let [right, up] = [0, 1].map(|k| (at[k] - from[k]) / height);
                match button {
                    MouseButton::Right if camera.motion.is_pushed() => {
                        camera.look_round(-TURN * right, -TURN * up);
                    }
                    MouseButton::Right if modifiers.shift => camera.pan(-right, -up),
                    MouseButton::Right | MouseButton::Left => camera.orbit(-TURN * right, -TURN * up),
                    MouseButton::Middle => camera.pan(-right, -up),
                }
                *handled = true;
            }
            Event::MousePress { position, .. } => {
                // A finger that comes down has not come from where the last one was.
                camera.motion.pointer = Some([position.x, position.y]);
            }
            Event::MouseWheel { delta, position, handled: handled @ false, .. } => {
                // Two fingers may move apart sideways.
                let notches = if delta.1.abs() < delta.0.abs() { delta.0 } else { delta.1 } / NOTCH_POINTS;
                let place = [position.x / width * 2.0 - 1.0, position.y / height * 2.0 - 1.0];
                let ray = camera.ray(place[0], place[1], width / height);
                camera.zoom_to(factor_of(notches), &ray);
                *handled = true;
            }
            Event::PinchGesture { delta, handled: handled @ false, .. } => {
                camera.zoom(factor_of(*delta / -NOTCH.log2()));
                *handled = true;
            }
            _ => {}
        }
    }
}

/// How much nearer so many notches bring.
fn factor_of(notches: f32) -> f32 {
    (NOTCH.log2() * notches.clamp(-20.0, 20.0)).exp2()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_notch_is_a_notch_and_back_again() {
        assert!((factor_of(1.0) - NOTCH).abs() < 1e-6);
        assert!((factor_of(3.0) * factor_of(-3.0) - 1.0).abs() < 1e-5);
        assert!(factor_of(1e9) > 0.0);
    }
}
