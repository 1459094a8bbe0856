//! Panels: menus, buttons, plots and the timeline strip, round the picture.

mod failure;
mod files;
mod help;
mod icons;
mod inspector;
mod legend;
mod messages;
mod palette;
mod plots;
mod scenes;
mod strip;
mod tools;
mod top;
mod transport;

use three_d::egui;

use crate::actions::Action;
use crate::capture::{Capture, Want};
use crate::host::SceneSource;
use crate::series::Series;
use crate::session::Session;
use crate::settings::Settings;
use crate::view::View;
use palette::Palette;

/// The plots are so high at first and at least (points), and at most this part of the window.
const PLOTS: f32 = 230.0;
const PLOTS_MIN: f32 = 120.0;
const PLOTS_MAX: f32 = 0.6;

/// What the user asked for in a panel.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// What a key could have asked for too.
    Do(Action),
    /// Another scene.
    Open(SceneSource),
    /// A picture.
    Keep(Want),
    /// The numbers behind the plots.
    KeepNumbers,
}

/// What panels show and edit.
pub struct Board<'a> {
    /// The scene that is open.
    pub session: &'a mut Session,
    /// What is shown and how.
    pub view: &'a mut View,
    /// What is remembered.
    pub settings: &'a mut Settings,
    /// What plots show.
    pub series: &'a mut Series,
    /// Screenshots and films.
    pub capture: &'a Capture,
}

/// What panels remember between pictures.
#[derive(Debug, Default)]
pub struct Panels {
    strip: strip::Strip,
    files: files::Files,
    scenes: scenes::Scenes,
    plots: plots::Plots,
    messages: messages::Messages,
    dressed: bool,
}

impl Panels {
    /// Draws all panels; what the user asked for in them.
    pub fn show(&mut self, ui: &mut egui::Ui, board: &mut Board<'_>) -> Vec<Wish> {
        let mut wishes = Vec::new();
        if !self.dressed {
            palette::dress(ui.ctx());
            self.dressed = true;
        }
        palette::choose(ui.ctx(), board.view.theme);
        let palette = Palette::of(board.view.theme);
        egui::Panel::top("menus").show_inside(ui, |ui| top::show(ui, board, &palette, &mut wishes));
        egui::Panel::bottom("time").show_inside(ui, |ui| self.time(ui, board, &palette, &mut wishes));
        if board.view.open.plots {
            // The scene keeps some room in a low window too.
            let most = (PLOTS_MAX * ui.ctx().content_rect().height()).max(PLOTS_MIN);
            egui::Panel::bottom("plots")
                .resizable(true)
                .default_size(PLOTS.min(most))
                .size_range(PLOTS_MIN..=most)
                .show_inside(ui, |ui| self.plots.show(ui, board, &palette, &mut wishes));
        }
        tools::show(ui, board.session, board.view, &mut wishes);
        inspector::show(ui, board.session, board.view);
        legend::show(ui, board);
        failure::show(ui, board, &palette, &mut wishes);
        self.scenes.show(ui.ctx(), &mut wishes);
        self.files.show(ui.ctx(), &board.settings.recent, &mut wishes);
        help::show(ui.ctx(), board.view);
        help::greet(ui, board.settings, &mut wishes);
        self.messages.show(ui, board, &palette);
        wishes
    }

    fn time(&mut self, ui: &mut egui::Ui, board: &mut Board<'_>, palette: &Palette, wishes: &mut Vec<Wish>) {
        let scene = board.session.opened;
        let Some(play) = board.session.play_mut() else { return };
        ui.add_space(3.0);
        transport::show(ui, play, palette, wishes);
        let there = !play.is_coupled();
        let place = ui.add_enabled_ui(there, |ui| self.strip.show(ui, play, scene, palette)).inner;
        board.session.strip = Some(place);
        ui.add_space(2.0);
    }

    /// Asks for a scene file.
    pub fn choose_file(&mut self) {
        self.files.choose();
    }

    /// Shows or hides the list of built-in scenes.
    pub fn toggle_scenes(&mut self) {
        self.scenes.toggle();
    }
}
