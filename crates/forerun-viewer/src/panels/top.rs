//! The row of menus.

use three_d::egui;

use super::Wish;
use crate::actions::Action;
use crate::host::SceneSource;
use crate::session::{Session, Stage};
use crate::view::{ColourBy, View};

pub(super) fn show(ui: &mut egui::Ui, session: &Session, view: &mut View, wishes: &mut Vec<Wish>) {
    egui::MenuBar::new().ui(ui, |ui| {
        ui.menu_button("Scene", |ui| scenes(ui, wishes));
        ui.menu_button("View", |ui| {
            ui.checkbox(&mut view.shadows, "Shadows");
            ui.checkbox(&mut view.grid, "Grid");
            for by in ColourBy::ALL {
                ui.radio_value(&mut view.colour_by, by, format!("Colour by {}", by.name()));
            }
        });
        if ui.button("Help").clicked() {
            wishes.push(Wish::Do(Action::Help));
        }
        ui.separator();
        match &session.stage {
            Stage::Loading(_) => drop(ui.spinner()),
            Stage::Failed(message) => drop(ui.colored_label(ui.visuals().error_fg_color, message)),
            Stage::Playing(play) => {
                ui.label(session.source.name());
                if let Some(notice) = &play.notice {
                    ui.colored_label(ui.visuals().warn_fg_color, notice);
                }
            }
        }
    });
}

fn scenes(ui: &mut egui::Ui, wishes: &mut Vec<Wish>) {
    egui::ScrollArea::vertical().max_height(500.0).show(ui, |ui| {
        for scene in forerun::scene::builtin::list() {
            if ui.button(scene.name).on_hover_text(scene.description).clicked() {
                wishes.push(Wish::Open(SceneSource::BuiltIn(scene.name.to_owned())));
                ui.close();
            }
        }
    });
}
