//! Viewer: one picture after another, as a short story: take what happened, show, do what was asked, draw.

use forerun::Change;
use three_d::{
    Context, DepthTexture2D, Event, FrameInput, FrameOutput, GUI, Interpolation, RenderTarget, Texture2D,
    Viewport, Wrapping,
};

use crate::actions::{Action, action_of};
use crate::camera::Camera;
use crate::capture::{self, Capture, FilmSize, Shot, Want};
use crate::draw::{Painter, Scenery};
use crate::hands::{Hands, Tool};
use crate::host::{Host, SceneSource};
use crate::input::Input;
use crate::keeper::Keeper;
use crate::panels::{Board, Panels, Wish};
use crate::report::Report;
use crate::series::{self, Series};
use crate::session::{Play, Session, Stage};
use crate::settings::Settings;
use crate::view::View;

/// Half and double speed.
const SPEED_FACTOR: f64 = 2.0;
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
    panels: Panels,
    hands: Hands,
    painter: Painter,
    gui: GUI,
    context: Context,
    /// The session's clock: the window's, but while a film is taken it waits for it. Seconds.
    clock_s: f64,
    /// Whether this picture belongs into the film.
    filmed: bool,
    /// Pixels of the window, and per point.
    window: ([u32; 2], f32),
    /// The scene that the camera has looked at as a whole.
    framed: u64,
    pictures: u64,
}

impl Viewer {
    /// A viewer that begins with this scene and draws into windows of this context.
    #[must_use]
    pub fn new(context: &Context, host: Host, source: SceneSource, settings: Settings) -> Viewer {
        Viewer {
            session: Session::new(host, source),
            view: settings.view,
            keeper: Keeper::new(settings),
            series: Series::default(),
            capture: Capture::default(),
            panels: Panels::default(),
            context: context.clone(),
            clock_s: 0.0,
            filmed: false,
            window: ([0, 0], 1.0),
            camera: Camera::default(),
            hands: Hands::default(),
            painter: Painter::new(context),
            gui: GUI::new(context),
            framed: 0,
            pictures: 0,
        }
    }

    /// One picture.
    pub fn picture(&mut self, mut frame: FrameInput) -> FrameOutput {
        let mut input = Input::of(&mut frame);
        self.window =
            ([input.viewport.width, input.viewport.height], input.pixels_per_point * self.view.scale);
        self.turn_clock(input.elapsed_s);
        self.session.show(self.clock_s);
        if let Some(play) = self.session.play() {
            self.series.take(play, self.session.opened, input.real_s);
        }
        self.keeper.look(&mut self.session, &self.view, input.real_s);
        self.capture.listen();
        self.frame_new_scene();
        let wishes = self.show_panels(&mut input);
        for wish in wishes {
            match wish {
                Wish::Do(action) => self.perform(action),
                Wish::Open(source) => self.session.open(source),
                Wish::Keep(want) => self.capture.wants.push(want),
                Wish::KeepNumbers => self.keep_numbers(),
            }
        }
        self.take_keys(&mut input);
        if let Some(play) = self.session.play_mut() {
            self.hands.take(&mut input, play, &mut self.camera, &self.view);
        }
        self.draw(&frame);
        self.pictures += 1;
        FrameOutput::default()
    }

    /// The state as plain values, for scripts.
    #[must_use]
    pub fn report(&self) -> Report {
        Report::of(&self.session, &self.view, self.pictures)
    }

    /// As the window's title says it.
    #[must_use]
    pub fn title(&self) -> String {
        format!("{} - forerun", self.session.source.name())
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
        resting && !self.capture.is_busy()
    }

    /// Does what a key, a menu or a button asks for.
    pub fn perform(&mut self, action: Action) {
        match action {
            Action::Reload => self.session.reload(),
            Action::Open => self.panels.choose_file(),
            Action::Scenes => self.panels.toggle_scenes(),
            Action::Screenshot => self.capture.wants.push(Want::Window),
            Action::BareScreenshot => self.capture.wants.push(Want::Bare),
            Action::Film => {
                self.capture.toggle_film(&self.keeper.settings.film, &self.session, self.window.0)
            }
            Action::HoldPlots => self.series.held ^= true,
            Action::Theme => self.view.theme = self.view.theme.other(),
            Action::Larger => Settings::rescale(&mut self.view, SCALE_FACTOR),
            Action::Smaller => Settings::rescale(&mut self.view, 1.0 / SCALE_FACTOR),
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
            action => {
                if let Some(play) = self.session.play_mut() {
                    perform_in(play, action);
                }
            }
        }
    }

    fn show_panels(&mut self, input: &mut Input) -> Vec<Wish> {
        let Viewer { gui, session, view, keeper, series, capture, panels, .. } = self;
        let mut wishes = Vec::new();
        let scale = input.pixels_per_point * view.scale;
        let mut board = Board { session, view, settings: &mut keeper.settings, series, capture };
        gui.update(&mut input.events, input.real_s * 1e3, input.viewport, scale, |ui| {
            wishes = panels.show(ui, &mut board);
        });
        if gui.context().egui_wants_pointer_input() {
            input.events.iter_mut().for_each(keep_from_hands);
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
        let scale = self.window.1;
        self.capture.take(true, scale, &self.session, || Shot::of(&target));
        self.film(&target, false);
        // Only a panic in the library could make this fail.
        let _ = target.write(|| self.gui.render());
        self.capture.take(false, scale, &self.session, || Shot::of(&target));
        self.film(&target, true);
    }

    /// The session's clock goes with the window's; while a film is taken, by a picture of the film at a time.
    fn turn_clock(&mut self, elapsed_s: f64) {
        let goes_on_s = match &mut self.capture.film {
            Some(film) => film.tick(elapsed_s),
            None => elapsed_s,
        };
        self.filmed = self.capture.film.is_some() && goes_on_s > 0.0;
        self.clock_s += goes_on_s;
    }

    /// Takes this picture for the film, if it is due: from the window before or after the panels are drawn, or drawn anew in the film's own size.
    fn film(&mut self, window: &RenderTarget<'_>, panels: bool) {
        let Some(film) = self.capture.film.as_ref().filter(|_| self.filmed) else { return };
        let settings = film.settings;
        if panels != (settings.panels && settings.size == FilmSize::Window) {
            return;
        }
        let shot = match settings.size.pixels() {
            None => Shot::of(window),
            Some(size) => self.draw_apart(size.map(|side| 2 * side)),
        };
        if let Some(film) = &mut self.capture.film {
            film.take(shot);
        }
    }

    /// The scene in a size of its own, without panels.
    fn draw_apart(&mut self, [width, height]: [u32; 2]) -> Shot {
        let colour = Texture2D::new_empty::<[u8; 4]>(
            &self.context,
            width,
            height,
            Interpolation::Linear,
            Interpolation::Linear,
            None,
            Wrapping::ClampToEdge,
            Wrapping::ClampToEdge,
        );
        let depth = DepthTexture2D::new::<f32>(
            &self.context,
            width,
            height,
            Wrapping::ClampToEdge,
            Wrapping::ClampToEdge,
        );
        let target = RenderTarget::new(colour.as_color_target(None), depth.as_depth_target());
        if let Some(play) = self.session.play() {
            let viewport = Viewport::new_at_origo(width, height);
            self.painter.draw(&target, viewport, play, self.session.opened, &self.camera, &self.view);
        }
        Shot::of(&target)
    }

    fn keep_numbers(&mut self) {
        let stem = capture::stem(&self.session);
        let series = &self.series;
        let tables = [
            ("queue", series::pictures_csv(&series.pictures)),
            ("steps", series::steps_csv(&series.steps)),
            ("edits", series::edits_csv(&series.edits)),
        ];
        for (name, table) in tables {
            self.capture.save_text(&format!("{stem}-{name}.csv"), &table);
        }
    }
}

/// What happens over a panel is not for the hands.
fn keep_from_hands(event: &mut Event) {
    if let Event::MousePress { handled, .. }
    | Event::MouseWheel { handled, .. }
    | Event::PinchGesture { handled, .. } = event
    {
        *handled = true;
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
        Action::SelectAll => {
            let moving = |id: &forerun::BodyId| play.body(*id).is_some_and(|body| body.is_dynamic());
            let bodies: Vec<_> = play.samples.iter().map(|(id, _)| *id).filter(moving).collect();
            play.selection.pick_all(bodies);
        }
        Action::Delete => {
            for body in play.selection.bodies().to_vec() {
                play.change(Change::Remove { body });
            }
        }
        _ => {}
    }
}
