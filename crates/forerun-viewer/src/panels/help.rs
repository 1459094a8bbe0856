//! Help: all keys, which are the table of actions, and what the mouse does; and a hint for who starts for the first time.

use three_d::egui::{self, Align2, Frame, RichText, Ui};

use super::Wish;
use crate::actions::{Action, SHORTCUTS};
use crate::settings::Settings;
use crate::view::View;

/// What the mouse does, and where.
pub(super) const MOUSE: &[(&str, &str)] = &[
    ("Left: click", "pick a body; with Shift or Ctrl one more"),
    ("Left: drag a body", "pull it; with Shift along the ground"),
    ("Left, tool throw", "hold to aim, let go to throw; Esc: nothing"),
    ("Left, tool push", "push the body away"),
    ("Left beside bodies, right: drag", "turn round the scene"),
    ("Right held, W A S D Q E", "fly; with Shift faster"),
    ("Middle, Shift and right: drag", "move sideways"),
    ("Wheel", "nearer to what is under the mouse"),
    ("Timeline: click, drag", "show another time"),
    ("Timeline: wheel", "zoom the strip"),
    ("Timeline: right drag, twice right", "move the strip, show all of it"),
    ("Drop a file", "open it"),
];

pub(super) fn show(ctx: &egui::Context, view: &mut View) {
    let room = ctx.content_rect();
    egui::Window::new("Keys and mouse")
        .open(&mut view.open.help)
        .collapsible(false)
        .resizable(false)
        .default_width(1120.0)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(room.center())
        .show(ctx, |ui| {
            egui::ScrollArea::both().max_height((room.height() - 160.0).max(120.0)).show(ui, |ui| {
                let half = SHORTCUTS.len().div_ceil(2);
                ui.horizontal_top(|ui| {
                    for (i, column) in SHORTCUTS.chunks(half).enumerate() {
                        let rows = column.iter().map(|shortcut| (shortcut.keys(), shortcut.help));
                        table(ui, &format!("keys {i}"), rows);
                        ui.add_space(16.0);
                    }
                    table(ui, "mouse", MOUSE.iter().map(|(what, does)| ((*what).to_owned(), *does)));
                });
            });
        });
}

fn table(ui: &mut Ui, id: &str, rows: impl Iterator<Item = (String, &'static str)>) {
    egui::Grid::new(id).striped(true).num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
        for (keys, help) in rows {
            ui.label(RichText::new(keys).strong());
            ui.label(help);
            ui.end_row();
        }
    });
}

/// A hint over the picture until it is closed, once and for all.
pub(super) fn greet(ui: &Ui, settings: &mut Settings, wishes: &mut Vec<Wish>) {
    if settings.greeted {
        return;
    }
    let free = ui.available_rect_before_wrap();
    let top = free.center_top();
    egui::Area::new(egui::Id::new("greeting"))
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(top + egui::vec2(0.0, 12.0))
        .show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width((free.width() - 30.0).clamp(200.0, 600.0));
                ui.horizontal_wrapped(|ui| {
                    ui.label("Space: play and pause.  Drag the timeline below.  F1: all keys.");
                    if ui.button("Keys").clicked() {
                        wishes.push(Wish::Do(Action::Help));
                        settings.greeted = true;
                    }
                    settings.greeted |= ui.button("Got it").clicked();
                });
            });
        });
}
