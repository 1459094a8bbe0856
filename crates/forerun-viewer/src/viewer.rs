//! Viewer: one picture after another, as a short story: take what happened, show, do what was asked, draw.

use three_d::{Context, Event, FrameInput, FrameOutput, GUI};

use crate::actions::{Action, action_of};
use crate::camera::Camera;
use crate::draw::{Painter, Scenery};
use crate::hands::{Hands, Tool};
use crate::host::{Host, SceneSource};
use crate::input::Input;
use crate::panels::{self, Wish};
use crate::report::{Report, Reported, Window};
use crate::session::{Play, Session};
use crate::view::View;

/// Half and double speed.
const SPEED_FACTOR: f64 = 2.0;

/// The whole viewer, but the window that it is in.
pub struct Viewer {
    /// The scene that is open.
    pub session: Session,
    /// What is shown and how.
    pub view: View,
    /// Where it is seen from.
    pub camera: Camera,
    hands: Hands,
    painter: Painter,
    gui: GUI,
    /// The scene that the camera has looked at as a whole.
    framed: u64,
    pictures: u64,
    window: Window,
}

impl Viewer {
    /// A viewer that begins with this scene and draws into windows of this context.
    #[must_use]
    pub fn new(context: &Context, host: Host, source: SceneSource, view: View) -> Viewer {
        Viewer {
            session: Session::new(host, source),
            view,
            camera: Camera::default(),
            hands: Hands::default(),
            painter: Painter::new(context),
            gui: GUI::new(context),
            framed: 0,
            pictures: 0,
            window: Window::default(),
        }
    }

    /// One picture.
    pub fn picture(&mut self, mut frame: FrameInput) -> FrameOutput {
        let mut input = Input::of(&mut frame);
        self.session.show(input.real_s);
        self.frame_new_scene();
        let wishes = self.show_panels(&mut input);
        for wish in wishes {
            match wish {
                Wish::Do(action) => self.perform(action),
                Wish::Open(source) => self.session.open(source),
            }
        }
        self.take_keys(&mut input);
        let opened = self.session.opened;
        self.window = Window { viewport: input.viewport, pixels_per_point: input.pixels_per_point };
        if let Some(play) = self.session.play_mut() {
            self.hands.take(&mut input, (play, opened), &mut self.camera, &self.view);
        }
        self.draw(&frame);
        self.pictures += 1;
        FrameOutput::default()
    }

    /// The state as plain values, for scripts.
    #[must_use]
    pub fn report(&self) -> Report {
        Report::of(&Reported {
            session: &self.session,
            view: &self.view,
            hands: &self.hands,
            camera: &self.camera,
            window: self.window,
            pictures: self.pictures,
        })
    }

    /// Does what a key, a menu or a button asks for.
    pub fn perform(&mut self, action: Action) {
        match action {
            Action::Reload => self.session.reload(),
            Action::Help => self.view.open.help ^= true,
            Action::Plots => self.view.open.plots ^= true,
            Action::Inspector => self.view.open.inspector ^= true,
            Action::Ghosts => self.view.ghosts.shown ^= true,
            Action::Contacts => self.view.overlays.contacts ^= true,
            Action::NextColour => self.view.colour_by = self.view.colour_by.next(),
            Action::SelectTool => self.hands.tool = Tool::Select,
            Action::ThrowTool => self.hands.tool = Tool::Throw,
            Action::PushTool => self.hands.tool = Tool::Push,
            Action::Focus => self.focus(false),
            Action::FrameAll => self.focus(true),
            Action::Coupled => self.session.switch_driver(),
            action => {
                if let Some(play) = self.session.play_mut() {
                    match action {
                        Action::Add => self.hands.add(play, &self.camera, &self.view.grip),
                        Action::Deselect if self.hands.cancel(play) => {}
                        action => perform_in(play, action),
                    }
                }
            }
        }
    }

    fn show_panels(&mut self, input: &mut Input) -> Vec<Wish> {
        let Viewer { gui, session, view, .. } = self;
        let mut wishes = Vec::new();
        let scale = input.pixels_per_point * view.scale;
        gui.update(&mut input.events, input.real_s * 1e3, input.viewport, scale, |ui| {
            wishes = panels::show(ui, session, view);
        });
        // What is pressed on a panel, beside its buttons, is not meant for the picture behind it.
        if gui.context().is_pointer_over_egui() {
            for event in &mut input.events {
                if let Event::MousePress { handled, .. } | Event::MouseWheel { handled, .. } = event {
                    *handled = true;
                }
            }
        }
        wishes
    }

    fn take_keys(&mut self, input: &mut Input) {
        for event in &mut input.events {
            if let Event::KeyPress { kind, modifiers, handled: handled @ false } = event
                && let Some(action) = action_of(*kind, *modifiers)
            {
                *handled = true;
                self.perform(action);
            }
        }
    }

    /// A scene that has just begun is looked at as a whole.
    fn frame_new_scene(&mut self) {
        let opened = self.session.opened;
        if self.framed != opened && self.session.play().is_some_and(|play| !play.samples.is_empty()) {
            self.focus(true);
            self.framed = opened;
        }
    }

    fn focus(&mut self, everything: bool) {
        let Some(play) = self.session.play() else { return };
        let bodies = if everything { &[] } else { play.selection.bodies() };
        if let Some((min, max)) = play.bounds(bodies) {
            self.camera.look_at(0.5 * (min + max), 0.5 * (max - min).length());
        }
    }

    fn draw(&mut self, frame: &FrameInput) {
        let target = frame.screen();
        if let Some(play) = self.session.play() {
            let scenery = Scenery {
                play,
                scene_number: self.session.opened,
                camera: &self.camera,
                view: &self.view,
                extras: &self.hands.extras,
            };
            self.painter.draw(&target, frame.viewport, &scenery);
        } else {
            target.clear(three_d::ClearState::color_and_depth(0.2, 0.22, 0.25, 1.0, 1.0));
        }
        // Only a panic in the library could make this fail.
        let _ = target.write(|| self.gui.render());
    }
}

/// Actions that need a scene.
fn perform_in(play: &mut Play, action: Action) {
    let snapshot = play.picture.snapshot.clone();
    let seconds = snapshot.frame_seconds();
    match action {
        Action::PlayPause => play.set_paused(!play.paused),
        Action::StepForward => play.step(1),
        Action::StepBack => play.step(-1),
        Action::JumpForward => play.seek(play.picture.time_s + 1.0),
        Action::JumpBack => play.seek(play.picture.time_s - 1.0),
        Action::GoToStart => play.seek(snapshot.oldest().seconds(seconds)),
        Action::GoToHorizon => play.seek(snapshot.horizon().seconds(seconds)),
        Action::Slower => play.set_speed(play.speed / SPEED_FACTOR),
        Action::Faster => play.set_speed(play.speed * SPEED_FACTOR),
        Action::Rewind => play.set_rewinding(!play.rewinding),
        Action::Undo => play.undo(),
        Action::Redo => play.redo(),
        Action::Deselect => play.selection.clear(),
        Action::SelectAll => play.select_all(),
        Action::Delete => play.remove_selected(),
        Action::Duplicate => play.duplicate_selected(),
        _ => {}
    }
}
