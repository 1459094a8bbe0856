//! Hands: what the mouse does to the camera and to bodies.

mod camera_hand;

use three_d::Event;

use crate::camera::Camera;
use crate::draw::Extras;
use crate::input::Input;
use crate::session::Play;
use crate::view::View;

/// What a press of the left button does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Picks a body, and drags it by a spring.
    #[default]
    Select,
    /// Throws something.
    Throw,
    /// Pushes a body.
    Push,
}

/// The user's hands.
#[derive(Debug, Default)]
pub struct Hands {
    /// What a press of the left button does.
    pub tool: Tool,
    /// What is shown of what the hands do.
    pub extras: Extras,
}

impl Hands {
    /// Takes what the mouse did since the last picture.
    pub fn take(&mut self, input: &mut Input, play: &mut Play, camera: &mut Camera, _view: &View) {
        let height = input.viewport.height.max(1) as f32;
        let aspect = input.viewport.width as f32 / height;
        for event in &mut input.events {
            if let Event::MousePress {
                button: three_d::MouseButton::Left,
                position,
                handled: handled @ false,
                ..
            } = event
                && self.tool == Tool::Select
            {
                let at = [position.x / (height * aspect) * 2.0 - 1.0, position.y / height * 2.0 - 1.0];
                let ray = camera.ray(at[0], at[1], aspect);
                match play.picture.snapshot.cast_ray(play.picture.time_s, &ray, 1e4) {
                    Some(hit) => play.selection.pick(hit.body),
                    None => play.selection.clear(),
                }
                *handled = true;
            }
        }
        camera_hand::take(&mut input.events, camera, height);
    }
}
