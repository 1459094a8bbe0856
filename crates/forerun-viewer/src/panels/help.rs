//! The list of keys: the table of actions, as it is.

use three_d::egui;

use crate::actions::SHORTCUTS;
use crate::view::View;

pub(super) fn show(ctx: &egui::Context, view: &mut View) {
    egui::Window::new("Keys").open(&mut view.open.help).resizable(false).show(ctx, |ui| {
        egui::Grid::new("keys").striped(true).show(ui, |ui| {
            for shortcut in SHORTCUTS {
                ui.monospace(shortcut.keys());
                ui.label(shortcut.help);
                ui.end_row();
            }
        });
    });
}
