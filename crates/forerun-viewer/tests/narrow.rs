//! Narrow: panels in a window as small as a phone, and where a scene cannot be played; checked by the texts that are painted.

mod harness;

use forerun_viewer::actions::Action;
use forerun_viewer::capture::Capture;
use forerun_viewer::panels::{Board, Panels, Wish};
use forerun_viewer::series::Series;
use forerun_viewer::session::{Session, Stage};
use forerun_viewer::settings::Settings;
use forerun_viewer::{SceneSource, host::Host, view::View};
use harness::{BOXES, User};
use three_d::egui::{self, Event, Pos2, Rect, Shape, Vec2, vec2};

const PHONE: Vec2 = vec2(390.0, 844.0);

/// A text, and where it is. Points.
type Text = (String, Rect);

struct Window {
    size: Vec2,
    panels: Panels,
    settings: Settings,
    series: Series,
    ctx: egui::Context,
}

impl Window {
    fn new(size: Vec2) -> Window {
        Window {
            size,
            panels: Panels::default(),
            settings: Settings::default(),
            series: Series::default(),
            ctx: egui::Context::default(),
        }
    }

    /// A picture of the panels: the texts in it, and what was wished.
    fn picture(
        &mut self,
        session: &mut Session,
        view: &mut View,
        events: Vec<Event>,
    ) -> (Vec<Text>, Vec<Wish>) {
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, self.size));
        let input = egui::RawInput { screen_rect, events, ..egui::RawInput::default() };
        let capture = Capture::default();
        let Window { panels, settings, series, ctx, .. } = self;
        let mut board = Board { session, view, settings, series, capture: &capture };
        let mut wishes = Vec::new();
        let output = ctx.run_ui(input, |ui| wishes = panels.show(ui, &mut board));
        let mut texts = Vec::new();
        output.shapes.into_iter().for_each(|shape| collect(shape.shape, &mut texts));
        (texts, wishes)
    }
}

fn collect(shape: Shape, texts: &mut Vec<Text>) {
    match shape {
        Shape::Vec(shapes) => shapes.into_iter().for_each(|shape| collect(shape, texts)),
        Shape::Text(text) => texts.push((text.galley.text().to_owned(), text.visual_bounding_rect())),
        _ => {}
    }
}

/// As a page begins on a phone.
fn bare() -> View {
    let mut view = View::default();
    (view.open.tools, view.open.inspector) = (false, false);
    view
}

#[test]
fn a_phone_is_wide_enough_for_the_row_of_time() {
    let mut user = User::of(BOXES);
    let mut window = Window::new(PHONE);
    let mut view = bare();
    // Sizes are known after the first picture.
    (0..3).for_each(|_| drop(window.picture(&mut user.session, &mut view, Vec::new())));
    let (texts, _) = window.picture(&mut user.session, &mut view, Vec::new());
    // In eight places, which nothing else is.
    let row = texts.iter().find(|(text, _)| text.len() == 10 && text.ends_with(" s"));
    let (_, time) = row.expect("the time is shown");
    let beside: Vec<&Text> =
        texts.iter().filter(|(_, rect)| rect.y_range().intersects(time.y_range())).collect();
    for (i, (text, rect)) in beside.iter().enumerate() {
        assert!(rect.left() >= 0.0 && rect.right() <= PHONE.x, "{text} at {rect}");
        let over = beside[..i].iter().find(|(_, other)| other.shrink(1.0).intersects(*rect));
        assert!(over.is_none(), "{text} over {over:?}");
    }
}

#[test]
fn a_scene_that_does_not_play_says_why_and_what_else_there_is() {
    let mut session = Session::new(Host::default(), SceneSource::BuiltIn("nosuch".to_owned()));
    for _ in 0..1000 {
        session.show(0.0);
        if matches!(session.stage, Stage::Failed(_)) {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    for size in [PHONE, vec2(1280.0, 720.0)] {
        let mut window = Window::new(size);
        let mut view = bare();
        (0..3).for_each(|_| drop(window.picture(&mut session, &mut view, Vec::new())));
        let (texts, _) = window.picture(&mut session, &mut view, Vec::new());
        let why = texts.iter().find(|(text, _)| text.contains("no built-in scene"));
        let (_, place) = why.expect("it says why");
        assert!(Rect::from_min_size(Pos2::ZERO, size).contains_rect(*place), "{place} in {size}");
        let way = texts.iter().find(|(text, _)| text == "Built-in scenes...");
        let at = way.expect("it says what else there is").1.center();
        let press = |pressed| Event::PointerButton {
            pos: at,
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::default(),
        };
        window.picture(&mut session, &mut view, vec![Event::PointerMoved(at), press(true)]);
        let (_, wishes) = window.picture(&mut session, &mut view, vec![press(false)]);
        assert!(matches!(wishes.as_slice(), [Wish::Do(Action::Scenes)]), "{wishes:?}");
    }
}
