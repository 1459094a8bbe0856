//! Failure: why nothing plays, where the scene would be, and what can be done.

use three_d::egui::{self, Align2, Frame, RichText, Ui};

use super::palette::Palette;
use super::{Board, Wish};
use crate::actions::Action;
use crate::session::Stage;

/// Wider lines are hard to read. Points.
const WIDTH_MAX: f32 = 560.0;

/// What is offered instead.
const WAYS_ON: [(Action, &str); 3] =
    [(Action::Scenes, "Built-in scenes..."), (Action::Open, "Open file..."), (Action::Reload, "Read again")];

/// The message, when the scene cannot be played.
pub(super) fn show(ui: &Ui, board: &Board<'_>, palette: &Palette, wishes: &mut Vec<Wish>) {
    let Stage::Failed(message) = &board.session.stage else { return };
    let free = ui.available_rect_before_wrap();
    egui::Area::new(egui::Id::new("failure"))
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(free.center())
        .order(egui::Order::Middle)
        .show(ui.ctx(), |ui| {
            let edge = egui::Stroke::new(1.5, palette.fewest);
            Frame::popup(ui.style()).stroke(edge).inner_margin(12.0).show(ui, |ui| {
                ui.set_max_width((free.width() - 50.0).clamp(150.0, WIDTH_MAX));
                ui.label(RichText::new("This scene does not play").strong().size(16.0));
                ui.add(egui::Label::new(message).wrap());
                ui.add_space(6.0);
                ui.horizontal_wrapped(|ui| {
                    for (action, text) in WAYS_ON {
                        if ui.button(text).clicked() {
                            wishes.push(Wish::Do(action));
                        }
                    }
                });
            });
        });
}
