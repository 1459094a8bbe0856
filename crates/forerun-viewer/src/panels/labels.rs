//! What overlays say in words, at their places in the picture; and what the colours of bodies mean.

use three_d::egui::{self, Align2, Area, Color32, FontId, Frame, Id, Order, Rect, Sense, Ui, pos2, vec2};

use super::Board;
use crate::draw;

/// Labels that are written; the nearest. More cannot be read.
const LABELS_MAX: usize = 200;

/// Writes labels over the picture, under all panels.
pub(super) fn show(ui: &Ui, board: &Board<'_>) {
    let window = ui.ctx().content_rect();
    let free = ui.available_rect_before_wrap();
    let painter = ui.ctx().layer_painter(egui::LayerId::background()).with_clip_rect(free);
    let aspect = window.width() / window.height().max(1.0);
    let dark = ui.visuals().dark_mode;
    for label in board.labels.iter().take(LABELS_MAX) {
        let Some([x, y]) = board.camera.project(label.at, aspect) else { continue };
        let at = pos2(
            window.left() + 0.5 * (x + 1.0) * window.width(),
            window.top() + 0.5 * (1.0 - y) * window.height(),
        );
        let [red, green, blue] = label.rgb;
        let font = FontId::proportional(12.0);
        let text = painter.layout_no_wrap(label.text.clone(), font, Color32::from_rgb(red, green, blue));
        let room = Rect::from_center_size(at, text.size() + vec2(6.0, 2.0));
        let behind = if dark { Color32::from_black_alpha(170) } else { Color32::from_white_alpha(200) };
        painter.rect_filled(room, 3.0, behind);
        painter.galley(Align2::CENTER_CENTER.anchor_size(at, text.size()).min, text, Color32::PLACEHOLDER);
    }
}

/// The legend in the corner, where colours tell more than bodies apart.
pub(super) fn legend(ui: &Ui, board: &Board<'_>) {
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
