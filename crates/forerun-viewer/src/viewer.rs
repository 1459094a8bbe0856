//! Viewer: one picture after another, as a short story: take what happened, show, do what was asked, draw.

use three_d::{Context, Event, FrameInput, FrameOutput, GUI};

use crate::actions::Action;
use crate::camera::Camera;
use crate::desk::{Desk, keys_of};
use crate::draw::{Painter, Scenery, needs_inspection, write_labels};
use crate::hands::{Hands, take_flight};
use crate::host::{Host, SceneSource};
use crate::input::Input;
use crate::panels::{self, Wish};
use crate::report::{Report, Reported, Window};
use crate::session::Session;
use crate::view::View;

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
        if needs_inspection(&self.view)
            && let Some(play) = self.session.play_mut()
        {
            play.ask_inspection();
        }
        self.frame_new_scene();
        let wishes = self.show_panels(&mut input);
        for wish in wishes {
            match wish {
                Wish::Do(action) => self.perform(action),
                Wish::Open(source) => self.session.open(source),
            }
        }
        self.window = Window { viewport: input.viewport, pixels_per_point: input.pixels_per_point };
        // Keys that fly mean nothing else while they do.
        take_flight(&mut input, &mut self.camera);
        for action in keys_of(&mut input) {
            self.perform(action);
        }
        self.desk().take_mouse(&mut input);
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
        self.desk().perform(action);
    }

    fn desk(&mut self) -> Desk<'_> {
        let Viewer { session, view, camera, hands, .. } = self;
        Desk { session, view, camera, hands }
    }

    fn show_panels(&mut self, input: &mut Input) -> Vec<Wish> {
        let Viewer { gui, session, view, camera, hands, .. } = self;
        let mut wishes = Vec::new();
        let scale = input.pixels_per_point * view.scale;
        gui.update(&mut input.events, input.real_s * 1e3, input.viewport, scale, |ui| {
            if let Some(play) = session.play() {
                let scenery = Scenery {
                    play,
                    scene_number: session.opened,
                    camera,
                    view,
                    extras: &hands.extras,
                    inside: play.inspection().filter(|_| needs_inspection(view)),
                };
                write_labels(ui.ctx(), &scenery);
            }
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

    /// A scene that has just begun is looked at as a whole.
    fn frame_new_scene(&mut self) {
        let opened = self.session.opened;
        if self.framed != opened && self.session.play().is_some_and(|play| !play.samples.is_empty()) {
            self.perform(Action::FrameAll);
            self.camera.arrive();
            self.framed = opened;
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
                inside: play.inspection().filter(|_| needs_inspection(&self.view)),
            };
            self.painter.draw(&target, frame.viewport, &scenery);
        } else {
            target.clear(three_d::ClearState::color_and_depth(0.2, 0.22, 0.25, 1.0, 1.0));
        }
        // Only a panic in the library could make this fail.
        let _ = target.write(|| self.gui.render());
    }
}
