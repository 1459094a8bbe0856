//! Viewer: one picture after another, as a short story: take what happened, show, do what was asked, draw.

mod keeping;

use three_d::{Context, Event, FrameInput, FrameOutput, GUI, egui};

use crate::actions::Action;
use crate::camera::Camera;
use crate::capture::{Capture, Want};
use crate::desk::{Desk, keys_of};
use crate::draw::{Painter, Scenery, needs_inspection, write_failure, write_labels};
use crate::hands::{Hands, take_flight};
use crate::host::{Host, SceneSource};
use crate::input::Input;
use crate::keeper::Keeper;
use crate::panels::{Board, Panels, Wish};
use crate::report::{Report, Reported, Window};
use crate::series::Series;
use crate::session::{Session, Stage};
use crate::settings::Settings;
use crate::view::View;

/// A little larger or smaller text.
const SCALE_FACTOR: f32 = 1.1;

/// The whole viewer, but the window that it is in.
pub struct Viewer {
    /// The scene that is open.
    pub session: Session,
    /// What is shown and how.
    pub view: View,
    /// Where it is seen from.
    pub camera: Camera,
    /// What is remembered.
    pub keeper: Keeper,
    /// What plots show.
    pub series: Series,
    /// Screenshots and films.
    pub capture: Capture,
    hands: Hands,
    panels: Panels,
    painter: Painter,
    gui: GUI,
    context: Context,
    /// The scene that the camera has looked at as a whole.
    framed: u64,
    pictures: u64,
    window: Window,
    /// The session's clock: the window's, but while a film is taken it waits for it. Seconds.
    clock_s: f64,
    /// Whether this picture belongs into the film.
    filmed: bool,
}

impl Viewer {
    /// A viewer that begins with this scene and draws into windows of this context.
    #[must_use]
    pub fn new(context: &Context, host: Host, source: SceneSource, settings: Settings) -> Viewer {
        Viewer {
            session: Session::new(host, source),
            view: settings.view,
            camera: Camera::default(),
            keeper: Keeper::new(settings),
            series: Series::default(),
            capture: Capture::default(),
            hands: Hands::default(),
            panels: Panels::default(),
            painter: Painter::new(context),
            gui: GUI::new(context),
            context: context.clone(),
            framed: 0,
            pictures: 0,
            window: Window::default(),
            clock_s: 0.0,
            filmed: false,
        }
    }

    /// One picture.
    pub fn picture(&mut self, mut frame: FrameInput) -> FrameOutput {
        let mut input = Input::of(&mut frame);
        self.window = Window { viewport: input.viewport, pixels_per_point: input.pixels_per_point };
        self.show(&input);
        let wishes = self.show_panels(&mut input);
        self.frame_new_scene();
        wishes.into_iter().for_each(|wish| self.grant(wish));
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

    /// The window is not looked at any more.
    pub fn lose_focus(&mut self) {
        self.desk().lose_focus();
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

    /// As the window's title says it.
    #[must_use]
    pub fn title(&self) -> String {
        format!("forerun: {}", self.session.source.name())
    }

    /// Whether the next picture is like this one, unless something happens.
    #[must_use]
    pub fn is_still(&self) -> bool {
        let resting = match &self.session.stage {
            Stage::Playing(play) => {
                let snapshot = &play.picture.snapshot;
                let reached = snapshot.horizon() == snapshot.valid_to();
                play.paused && !play.rewinding && reached && self.session.coming().is_none()
            }
            Stage::Loading(_) => false,
            Stage::Failed(_) => true,
        };
        resting && !self.capture.is_busy() && !self.camera.is_moving()
    }

    /// Does what a key, a menu or a button asks for.
    pub fn perform(&mut self, action: Action) {
        match action {
            Action::Open => self.panels.choose_file(),
            Action::Scenes => self.panels.toggle_scenes(),
            Action::Screenshot => self.capture.wants.push(Want::Window),
            Action::BareScreenshot => self.capture.wants.push(Want::Bare),
            Action::Film => {
                let Window { viewport, .. } = self.window;
                let size = [viewport.width, viewport.height];
                self.capture.toggle_film(&self.keeper.settings.film, &self.session, size);
            }
            Action::HoldPlots => self.series.held ^= true,
            Action::Theme => self.view.theme = self.view.theme.other(),
            Action::Larger => Settings::rescale(&mut self.view, SCALE_FACTOR),
            Action::Smaller => Settings::rescale(&mut self.view, 1.0 / SCALE_FACTOR),
            action => self.desk().perform(action),
        }
    }

    fn desk(&mut self) -> Desk<'_> {
        let Viewer { session, view, camera, hands, .. } = self;
        Desk { session, view, camera, hands }
    }

    /// What physics has by now, for the picture and for the plots.
    fn show(&mut self, input: &Input) {
        self.turn_clock(input.elapsed_s);
        self.session.show(self.clock_s);
        let opened = self.session.opened;
        if let Some(play) = self.session.play_mut() {
            if needs_inspection(&self.view) {
                play.ask_inspection();
            }
            self.series.take(play, opened, input.real_s);
        }
        self.keeper.look(&mut self.session, &self.view, input.real_s);
        self.capture.listen();
    }

    fn grant(&mut self, wish: Wish) {
        match wish {
            Wish::Do(action) => self.perform(action),
            Wish::Open(source) => self.session.open(source),
            Wish::Keep(want) => self.capture.wants.push(want),
            Wish::KeepNumbers => self.keep_numbers(),
        }
    }

    fn show_panels(&mut self, input: &mut Input) -> Vec<Wish> {
        let Viewer { gui, session, view, camera, hands, keeper, series, capture, panels, painter, .. } = self;
        let (mut wishes, mut free, mut middle) = (Vec::new(), [1.0; 2], [0.0; 2]);
        let scale = input.pixels_per_point * view.scale;
        gui.update(&mut input.events, input.real_s * 1e3, input.viewport, scale, |ui| {
            if let Some(scenery) = scenery(session, camera, view, hands) {
                write_labels(ui.ctx(), &scenery);
            }
            if let Some(why) = painter.failure() {
                write_failure(ui.ctx(), why);
            }
            let mut board = Board { session, view, settings: &mut keeper.settings, series, capture };
            wishes = panels.show(ui, &mut board);
            let (window, left) = (ui.ctx().content_rect(), ui.available_rect_before_wrap());
            free = (left.size() / window.height().max(1.0)).into();
            let off = (left.center() - window.center()) / (0.5 * window.size()).max(egui::Vec2::splat(1.0));
            middle = [off.x, -off.y];
        });
        camera.set_free(free, middle);
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

    /// A scene that has just begun is looked at as a whole, beside its panels.
    fn frame_new_scene(&mut self) {
        let opened = self.session.opened;
        // Only with the second picture it is known how large panels are on a screen of fine pixels.
        let placed = self.pictures > 1;
        if placed && self.framed != opened && self.session.play().is_some_and(|play| !play.samples.is_empty())
        {
            self.perform(Action::FrameAll);
            self.camera.arrive();
            self.framed = opened;
        }
    }

    fn draw(&mut self, frame: &FrameInput) {
        let target = frame.screen();
        if self.session.play().is_some() {
            self.draw_scene(&target, frame.viewport);
        } else {
            target.clear(three_d::ClearState::color_and_depth(0.2, 0.22, 0.25, 1.0, 1.0));
        }
        // Only a panic in the library could make this fail.
        let _ = target.write(|| self.gui.render());
        self.keep_picture(&target);
    }
}

/// What there is to draw, when a scene plays.
fn scenery<'a>(
    session: &'a Session,
    camera: &'a Camera,
    view: &'a View,
    hands: &'a Hands,
) -> Option<Scenery<'a>> {
    let play = session.play()?;
    Some(Scenery {
        play,
        scene_number: session.opened,
        camera,
        view,
        extras: &hands.extras,
        inside: play.inspection().filter(|_| needs_inspection(view)),
    })
}
