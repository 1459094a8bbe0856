//! Panels: played with the mouse without a window; what comes of it is checked by state.

mod harness;

use std::time::Duration;

use forerun_viewer::actions::Action;
use forerun_viewer::capture::Capture;
use forerun_viewer::keeper::Keeper;
use forerun_viewer::panels::{Board, Panels, Wish};
use forerun_viewer::report::StripPlace;
use forerun_viewer::series::Series;
use forerun_viewer::settings::Settings;
use forerun_viewer::{SceneSource, view::View};
use harness::{BOXES, INTERVAL_S, SIZE, User};
use three_d::egui::{self, Event, Pos2, Rect, pos2, vec2};

/// Somebody who uses panels.
struct Clerk {
    user: User,
    panels: Panels,
    settings: Settings,
    series: Series,
    ctx: egui::Context,
}

impl Clerk {
    fn new() -> Clerk {
        let settings = Settings { greeted: true, ..Settings::default() };
        let mut clerk = Clerk {
            user: User::of(BOXES),
            panels: Panels::default(),
            settings,
            series: Series::default(),
            ctx: egui::Context::default(),
        };
        clerk.user.play().set_paused(true);
        // Sizes are known after the first picture.
        (0..3).for_each(|_| drop(clerk.picture(Vec::new())));
        clerk
    }

    /// One picture of the panels; what was wished.
    fn picture(&mut self, events: Vec<Event>) -> Vec<Wish> {
        self.drawn(events).0
    }

    /// What was wished, and what is written.
    fn drawn(&mut self, events: Vec<Event>) -> (Vec<Wish>, String) {
        self.user.picture(Vec::new());
        let Clerk { user, panels, settings, series, ctx } = self;
        let User { session, view, .. } = user;
        if let Some(play) = session.play() {
            series.take(play, session.opened, user.real_s);
        }
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, vec2(SIZE[0] as f32, SIZE[1] as f32)));
        let input =
            egui::RawInput { screen_rect, time: Some(user.real_s), events, ..egui::RawInput::default() };
        let capture = Capture::default();
        let mut board = Board { session, view, settings, series, capture: &capture };
        let mut wishes = Vec::new();
        let output = ctx.run_ui(input, |ui| wishes = panels.show(ui, &mut board));
        let written = output.shapes.iter().filter_map(|clipped| match &clipped.shape {
            egui::Shape::Text(text) => Some(text.galley.text()),
            _ => None,
        });
        let written = written.collect::<Vec<_>>().join("\n");
        (wishes, written)
    }

    fn strip(&self) -> StripPlace {
        self.user.session.strip.expect("the strip is shown")
    }

    /// Where a time is on the strip.
    fn at(&self, time_s: f64) -> Pos2 {
        let StripPlace { rect: [left, top, width, height], from_s, to_s } = self.strip();
        pos2(left + ((time_s - from_s) / (to_s - from_s)) as f32 * width, top + 0.7 * height)
    }

    fn press(&mut self, at: Pos2, pressed: bool) -> Vec<Wish> {
        let button = egui::PointerButton::Primary;
        let modifiers = egui::Modifiers::default();
        self.picture(vec![
            Event::PointerMoved(at),
            Event::PointerButton { pos: at, button, pressed, modifiers },
        ])
    }

    fn time_s(&mut self) -> f64 {
        self.user.picture(Vec::new());
        self.user.play().picture.time_s
    }
}

#[test]
fn the_playhead_goes_where_it_is_dragged_and_no_farther_than_physics() {
    let mut clerk = Clerk::new();
    let [early, late] = [0.4, 1.2];
    let at = clerk.at(late);
    clerk.press(at, true);
    assert!((clerk.time_s() - late).abs() < 0.03, "{} s", clerk.time_s());
    let at = clerk.at(early);
    clerk.picture(vec![Event::PointerMoved(at)]);
    assert!((clerk.time_s() - early).abs() < 0.03, "{} s", clerk.time_s());
    let beyond = pos2(SIZE[0] as f32, at.y);
    clerk.picture(vec![Event::PointerMoved(beyond)]);
    clerk.press(beyond, false);
    let horizon_s = {
        let snapshot = clerk.user.play().picture.snapshot.clone();
        snapshot.horizon().seconds(snapshot.frame_seconds())
    };
    let shown_s = clerk.time_s();
    assert!(shown_s > late && shown_s <= horizon_s, "{shown_s} s of {horizon_s} s");
    // The button is up: the mouse moves and time does not.
    let at = clerk.at(early);
    clerk.picture(vec![Event::PointerMoved(at)]);
    assert!((clerk.time_s() - shown_s).abs() < 1e-9);
}

#[test]
fn the_wheel_zooms_the_strip_round_the_mouse() {
    let mut clerk = Clerk::new();
    let whole = clerk.strip();
    let at = clerk.at(0.8);
    let turn = |delta: f32| Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, delta),
        phase: egui::TouchPhase::Move,
        modifiers: egui::Modifiers::default(),
    };
    clerk.picture(vec![Event::PointerMoved(at), turn(120.0)]);
    (0..30).for_each(|_| drop(clerk.picture(Vec::new())));
    let part = clerk.strip();
    assert!(part.to_s - part.from_s < 0.8 * (whole.to_s - whole.from_s), "{part:?} of {whole:?}");
    assert!((clerk.at(0.8).x - at.x).abs() < 2.0);
    clerk.picture(vec![Event::PointerMoved(at), turn(-900.0)]);
    (0..30).for_each(|_| drop(clerk.picture(Vec::new())));
    assert!((clerk.strip().to_s - whole.to_s).abs() < 1e-6);
}

#[test]
fn the_button_in_the_middle_of_the_transport_plays() {
    let mut clerk = Clerk::new();
    let strip = clerk.strip();
    // Buttons are 24 points wide, 2 apart, from 8 points off the window's edge: the middle of the fourth.
    let at = pos2(8.0 + 3.0 * 26.0 + 12.0, strip.rect[1] - 16.0);
    clerk.press(at, true);
    let wishes = clerk.press(at, false);
    assert_eq!(wishes, [Wish::Do(Action::PlayPause)]);
}

#[test]
fn every_panel_can_be_shown_in_both_themes() {
    let mut clerk = Clerk::new();
    clerk.settings.greeted = false;
    clerk.panels.toggle_scenes();
    for theme in [clerk.user.view.theme, clerk.user.view.theme.other()] {
        clerk.user.view = View { theme, ..View::default() };
        clerk.user.view.open.plots = true;
        clerk.user.view.open.help = true;
        (0..5).for_each(|_| drop(clerk.picture(Vec::new())));
        assert!(clerk.ctx.globally_used_rect().is_finite());
    }
    assert!(clerk.series.pictures.iter().len() > 5);
    let last = clerk.series.pictures.last().expect("pictures were taken").row;
    assert!((last.interval_ms - INTERVAL_S * 1e3).abs() < 1e-6);
    assert!(last.queue_min >= 99 && last.queue_max >= last.queue_min);
}

#[test]
fn an_edit_is_a_row_of_the_series_with_its_cost() {
    let mut clerk = Clerk::new();
    let push = forerun::Change::Push {
        body: forerun::BodyId(3),
        impulse: forerun::Vec3::new(500.0, 0.0, 0.0),
        at_point: None,
    };
    clerk.user.play().change(push);
    clerk.user.settle();
    (0..3).for_each(|_| drop(clerk.picture(Vec::new())));
    let rows: Vec<_> = clerk.series.edits.iter().collect();
    assert_eq!(rows.len(), 1, "{rows:?}");
    assert!(rows[0].edit.recomputed > 0 && rows[0].edit.recomputed < rows[0].edit.full);
    assert!(clerk.series.steps.iter().len() > 100);
}

#[test]
fn a_scene_that_cannot_be_read_leaves_the_one_that_plays() {
    let mut user = User::of(BOXES);
    user.session.open(SceneSource::File("no/such/scene.toml".into()));
    user.wait("the scene is refused", |user| {
        user.picture_now(Vec::new());
        user.session.refused.last().is_some()
    });
    let bodies = user.play().samples.len();
    assert_eq!((user.session.opened, bodies), (1, 5));
    let (_, why) = user.session.refused.last().cloned().expect("it was refused");
    assert!(why.contains("scene.toml"), "{why}");
}

#[test]
fn a_file_that_changes_is_read_again_and_a_broken_one_is_not() {
    let path = std::env::temp_dir().join(format!("forerun-reload-{}.toml", std::process::id()));
    std::fs::write(&path, BOXES).expect("temporary files can be written");
    let mut user = User::of_source(SceneSource::File(path.clone()));
    let mut keeper = Keeper::new(Settings::default());
    let mut look = |user: &mut User| {
        user.picture_now(Vec::new());
        let view = user.view;
        keeper.look(&mut user.session, &view, 0.0);
        keeper.settings.recent.clone()
    };
    let recent = look(&mut user);
    assert_eq!(recent.len(), 1);
    std::thread::sleep(Duration::from_millis(30));
    std::fs::write(&path, format!("{BOXES}[[bodies]\n")).expect("temporary files can be written");
    user.wait("the broken file is refused", |user| {
        look(user);
        user.session.refused.last().is_some()
    });
    assert_eq!(user.session.opened, 1);
    let more = "[[bodies]]\nshape = { sphere = { radius = 0.5 } }\nposition = [6.0, 0.5, 0.0]\n";
    std::fs::write(&path, format!("{BOXES}{more}")).expect("temporary files can be written");
    user.wait("the file is read again", |user| {
        look(user);
        user.session.opened == 2 && user.play().samples.len() == 6
    });
    assert_eq!(user.session.refused.last(), None);
    std::fs::remove_file(path).expect("it was written above");
}

#[test]
fn what_is_not_possible_is_said_again_when_it_is_tried_again() {
    let mut clerk = Clerk::new();
    let shown = |clerk: &mut Clerk| clerk.drawn(Vec::new()).1.matches("no room for it").count();
    for _ in 0..2 {
        assert_eq!(shown(&mut clerk), 0);
        clerk.user.play().notice.tell("There is no room for it.".to_owned());
        // Areas are measured in their first picture.
        shown(&mut clerk);
        assert_eq!(shown(&mut clerk), 1);
        clerk.user.play().notice.tell("There is no room for it.".to_owned());
        shown(&mut clerk);
        assert_eq!(shown(&mut clerk), 1, "once at a time");
        clerk.user.real_s += 20.0;
        shown(&mut clerk);
    }
}
