//! Help: all keys, which are the table of actions, and what the mouse does; and a hint for who starts for the first time.

use three_d::egui::{self, Align2, Frame, RichText, Ui};

use super::Wish;
use crate::actions::{Action, SHORTCUTS, Shortcut};
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

/// So wide is a column of the list with its gap. Points.
const COLUMN: f32 = 400.0;

pub(super) fn show(ctx: &egui::Context, view: &mut View) {
    let room = ctx.content_rect();
    let columns = ((room.width() - 40.0) / COLUMN).clamp(1.0, 3.0) as usize;
    egui::Window::new("Keys and mouse")
        .open(&mut view.open.help)
        .collapsible(false)
        .resizable(false)
        .default_width(COLUMN * columns as f32)
        .default_height(room.height() - 80.0)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(room.center())
        .show(ctx, |ui| {
            let height = (room.height() - 160.0).max(120.0);
            egui::ScrollArea::both().max_height(height).max_width(room.width() - 40.0).show(ui, |ui| {
                ui.horizontal_top(|ui| {
                    for tables in tables().chunks(3_usize.div_ceil(columns)) {
                        ui.vertical(|ui| {
                            for (i, rows) in tables {
                                table(ui, &format!("keys {i}"), rows);
                            }
                        });
                        ui.add_space(16.0);
                    }
                });
            });
        });
}

/// What is done, and how.
type Row = (String, &'static str);

/// Keys in two tables, and what the mouse does, with their numbers.
fn tables() -> [(usize, Vec<Row>); 3] {
    let (first, second) = SHORTCUTS.split_at(SHORTCUTS.len().div_ceil(2));
    let keys = |of: &'static [Shortcut]| of.iter().map(|key| (key.keys(), key.help)).collect();
    [
        (0, keys(first)),
        (1, keys(second)),
        (2, MOUSE.iter().map(|(what, does)| ((*what).to_owned(), *does)).collect()),
    ]
}

fn table(ui: &mut Ui, id: &str, rows: &[Row]) {
    egui::Grid::new(id).striped(true).num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
        for (keys, help) in rows {
            ui.label(RichText::new(keys).strong());
            ui.label(*help);
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
