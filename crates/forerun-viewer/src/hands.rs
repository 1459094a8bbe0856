//! Hands: what the mouse does to the camera and to bodies.

mod camera_hand;
mod drag;
mod missile;
mod sight;
mod throw;

use forerun::{BodyId, Change, Shape};
use three_d::{Event, Modifiers, MouseButton};

use crate::camera::Camera;
use crate::draw::Extras;
use crate::input::Input;
use crate::session::Play;
use crate::view::{Grip, Tool, View};
pub(crate) use camera_hand::take_flight;
use drag::Drag;
use missile::Missiles;
use sight::Sight;

/// What the left button is held down for.
#[derive(Debug, Default)]
enum Doing {
    #[default]
    Nothing,
    /// A body is dragged. A click with Shift or Ctrl, which is no drag, picks it too, or no longer.
    Dragging(Drag, OnClick),
    /// A throw is aimed.
    Aiming,
    /// It was let go here (pixels), and what is thrown is still being made.
    LetGo([f32; 2]),
}

/// What a click on a body that can be dragged does when the button is let go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OnClick {
    /// It has picked the body already.
    Nothing,
    /// Picks it besides others, or no longer.
    Toggle,
}

/// The user's hands.
#[derive(Debug, Default)]
pub struct Hands {
    /// What is shown of what the hands do.
    pub extras: Extras,
    doing: Doing,
    /// Where the mouse is. Pixels from the left and the bottom.
    pointer: Option<[f32; 2]>,
    /// Whether it moved since the last picture.
    moved: bool,
    /// The body under it when it moved last.
    pointed: Option<BodyId>,
    modifiers: Modifiers,
    missiles: Missiles,
    /// Whether a body is to be added that is still being made.
    adding: bool,
    /// The scene that the hands are in.
    opened: u64,
}

impl Hands {
    /// Takes what the mouse did since the last picture. `opened` is the number of the scene.
    pub fn take(
        &mut self,
        input: &mut Input,
        (play, opened): (&mut Play, u64),
        camera: &mut Camera,
        view: &View,
    ) {
        if self.opened != opened {
            (self.doing, self.pointed, self.adding, self.opened) = (Doing::Nothing, None, false, opened);
        }
        self.extras = Extras::default();
        let size = [input.viewport.width.max(1) as f32, input.viewport.height.max(1) as f32];
        for event in &mut input.events {
            if matches!(event, Event::MouseLeave) && self.let_go(play) {
                // What began in the window does not go on as something else when the mouse comes back.
                camera.motion.turning = false;
            }
            self.take_event(event, play, &Sight::new(camera, size), view);
        }
        camera_hand::take(input, camera);
        self.go_on(play, &Sight::new(camera, size), view);
    }

    fn take_event(&mut self, event: &mut Event, play: &mut Play, sight: &Sight<'_>, view: &View) {
        match event {
            Event::MousePress {
                button: MouseButton::Left,
                position,
                modifiers,
                handled: handled @ false,
            } => {
                self.pointer = Some([position.x, position.y]);
                self.modifiers = *modifiers;
                self.press(play, sight, view);
                *handled = true;
            }
            Event::MouseMotion { position, modifiers, handled, .. } => {
                self.moved |= !*handled;
                self.pointer = Some([position.x, position.y]);
                self.modifiers = *modifiers;
                *handled |= self.is_busy();
            }
            // Also over a panel: what began in the picture ends with the button.
            Event::MouseRelease { button: MouseButton::Left, position, .. } if self.is_busy() => {
                self.pointer = Some([position.x, position.y]);
                self.release(play, sight, view);
            }
            Event::ModifiersChange { modifiers } => self.modifiers = *modifiers,
            Event::MouseLeave => self.pointer = None,
            _ => {}
        }
    }

    fn press(&mut self, play: &mut Play, sight: &Sight<'_>, view: &View) {
        let Some(pointer) = self.pointer else { return };
        match view.grip.tool {
            Tool::Select => self.pick(play, sight, pointer),
            Tool::Throw => self.doing = Doing::Aiming,
            Tool::Push => push(play, sight, pointer, &view.grip),
        }
    }

    /// Picks what is under the mouse, and takes hold of it. What has no end counts as nothing, but with Shift or Ctrl.
    fn pick(&mut self, play: &mut Play, sight: &Sight<'_>, pointer: [f32; 2]) {
        let more = self.modifiers.shift || self.modifiers.ctrl || self.modifiers.command;
        let hit = sight.hit(play, pointer);
        let endless = |id| play.body(id).is_some_and(|body| matches!(body.shape, Shape::HalfSpace));
        let Some(hit) = hit.filter(|hit| more || !endless(hit.body)) else {
            if !more {
                play.selection.clear();
            }
            return;
        };
        if !more {
            play.selection.pick(hit.body);
        }
        match Drag::of(play, &hit, pointer) {
            // With Shift a body may be dragged along the ground, which is no click.
            Some(drag) => {
                self.doing = Doing::Dragging(drag, if more { OnClick::Toggle } else { OnClick::Nothing });
            }
            None if more => play.selection.toggle(hit.body),
            None => {}
        }
    }

    /// What goes on as long as the button is held down.
    fn go_on(&mut self, play: &mut Play, sight: &Sight<'_>, view: &View) {
        if self.adding {
            self.add(play, sight.camera, &view.grip);
        }
        if let Doing::LetGo(pointer) = self.doing {
            self.throw(play, (sight, pointer), view);
        }
        let Some(pointer) = self.pointer else { return };
        match &mut self.doing {
            Doing::Dragging(drag, _) => {
                if drag.go_on(play, sight, (pointer, self.modifiers.shift), &view.grip) {
                    self.extras.grab = drag.line(play);
                } else {
                    self.doing = Doing::Nothing;
                }
            }
            Doing::Aiming => throw::aim(&mut self.extras, play, (&mut self.missiles, view), (sight, pointer)),
            Doing::Nothing if view.grip.tool == Tool::Throw => {
                // Before it is asked for; not while the mouse is on a panel, where its size is being chosen.
                if std::mem::take(&mut self.moved) {
                    self.missiles.prepare(&view.grip);
                }
            }
            Doing::LetGo(_) => {}
            Doing::Nothing => {
                // A look at all bodies: not for a mouse that lies still.
                if std::mem::take(&mut self.moved) {
                    self.pointed = sight.hit(play, pointer).map(|hit| hit.body);
                }
                self.extras.pointed = self.pointed;
            }
        }
    }

    fn release(&mut self, play: &mut Play, sight: &Sight<'_>, view: &View) {
        let pointer = self.pointer.unwrap_or_default();
        match std::mem::take(&mut self.doing) {
            Doing::Dragging(mut drag, on_click) => {
                // To where the mouse was let go, although no picture has shown it there.
                drag.go_on(play, sight, (pointer, self.modifiers.shift), &view.grip);
                if on_click == OnClick::Toggle && !drag.moves() {
                    play.selection.toggle(drag.body());
                }
                drag.end(play);
            }
            Doing::Aiming => self.throw(play, (sight, pointer), view),
            Doing::LetGo(_) | Doing::Nothing => {}
        }
    }

    /// Throws, as soon as there is what to throw.
    fn throw(&mut self, play: &mut Play, (sight, pointer): (&Sight<'_>, [f32; 2]), view: &View) {
        let thrown = throw::release(play, (&mut self.missiles, view), sight, pointer);
        self.doing = if thrown { Doing::Nothing } else { Doing::LetGo(pointer) };
    }

    /// Leaves off what the button is held down for, as if it had not begun; whether there was something.
    pub fn cancel(&mut self, play: &mut Play) -> bool {
        self.adding = false;
        match std::mem::take(&mut self.doing) {
            Doing::Dragging(drag, _) => drag.cancel(play),
            Doing::Aiming | Doing::LetGo(_) => play.forget_preview(),
            Doing::Nothing => return false,
        }
        true
    }

    /// The mouse is lost, or something else is done: a drag ends where it is, and what is aimed is not thrown. Whether there was something.
    pub fn let_go(&mut self, play: &mut Play) -> bool {
        match std::mem::take(&mut self.doing) {
            Doing::Dragging(drag, _) => drag.end(play),
            Doing::Aiming => play.forget_preview(),
            doing @ (Doing::LetGo(_) | Doing::Nothing) => {
                self.doing = doing;
                return false;
            }
        }
        true
    }

    /// Brings a body in, at the point that the camera looks at.
    pub fn add(&mut self, play: &mut Play, camera: &Camera, grip: &Grip) {
        match self.missiles.def(play, grip) {
            Ok(None) => self.adding = true,
            Ok(Some(mut def)) => {
                self.adding = false;
                let radius = missile::radius_of(&def);
                def.pose.position = match Sight::new(camera, [1.0, 1.0]).hit_ahead(play) {
                    Some(hit) => hit.point + hit.normal * radius,
                    None => camera.target,
                };
                let added = play.add_all("add", vec![def]);
                play.selection.pick_coming(added);
            }
            Err(message) => {
                self.adding = false;
                play.notice.tell(message);
            }
        }
    }

    /// The body that is dragged.
    #[must_use]
    pub fn dragged(&self) -> Option<BodyId> {
        match &self.doing {
            Doing::Dragging(drag, _) => drag.moves().then(|| drag.body()),
            _ => None,
        }
    }

    /// Whether a throw is aimed.
    #[must_use]
    pub fn is_aiming(&self) -> bool {
        matches!(self.doing, Doing::Aiming)
    }

    fn is_busy(&self) -> bool {
        matches!(self.doing, Doing::Dragging(..) | Doing::Aiming)
    }
}

/// Pushes the body under the mouse, away from the eye.
fn push(play: &mut Play, sight: &Sight<'_>, pointer: [f32; 2], grip: &Grip) {
    let Some(hit) = sight.hit(play, pointer) else { return };
    let Some(body) = play.body(hit.body).filter(|body| body.is_dynamic()) else { return };
    let impulse = sight.ray(pointer).direction * (grip.push / body.inverse_mass);
    play.change(Change::Push { body: hit.body, impulse, at_point: Some(hit.point) });
}
