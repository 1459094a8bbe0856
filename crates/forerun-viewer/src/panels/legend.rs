//! The legend: what the colours of bodies mean.

use three_d::egui::{self, Area, Color32, Frame, Id, Order, Sense, Ui, vec2};

use super::Board;
use crate::draw;

/// The legend in the corner, where colours tell more than bodies apart.
pub(super) fn show(ui: &Ui, board: &Board<'_>) {
    let rows = draw::legend(board.view);
    if rows.is_empty() {
        return;
    }
    let corner = ui.available_rect_before_wrap().left_top();
    Area::new(Id::new("legend"))
        .order(Order::Middle)
        .interactable(false)
        .fixed_pos(corner + vec2(10.0, 10.0))
        .show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).shadow(egui::Shadow::NONE).show(ui, |ui| {
                ui.strong(format!("Colour: {}", board.view.colour_by.name()));
                for (text, [red, green, blue]) in rows {
                    ui.horizontal(|ui| {
                        let (swatch, _) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
                        ui.painter().rect_filled(swatch, 2.0, Color32::from_rgb(red, green, blue));
                        ui.label(text);
                    });
                }
            });
        });
}
