//! Labels: words at points of the scene, written over the picture and under the panels.

use forerun::Vec3;
use three_d::egui::{self, Align2, Color32, FontId};

use super::colours::Rgb;
use super::{Scenery, overlays};

/// Height of the letters. Points.
const SIZE: f32 = 13.0;

/// Words at a point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Label {
    /// Where. Metres.
    pub(super) at: Vec3,
    /// What is written there.
    pub(super) text: String,
    /// In which colour.
    pub(super) rgb: Rgb,
}

/// Writes what the overlays say in words.
pub fn write_labels(context: &egui::Context, scenery: &Scenery<'_>) {
    let labels = overlays::labels(scenery);
    if labels.is_empty() {
        return;
    }
    let layer = egui::LayerId::new(egui::Order::Background, egui::Id::new("labels"));
    let (painter, screen) = (context.layer_painter(layer), context.content_rect());
    let aspect = screen.width() / screen.height().max(1.0);
    // The nearest last: over the others.
    for label in labels.iter().rev() {
        let Some([x, y]) = scenery.camera.project(label.at, aspect) else { continue };
        if x.abs() > 1.0 || y.abs() > 1.0 {
            continue;
        }
        let place = screen.center() + egui::vec2(0.5 * x * screen.width(), -0.5 * y * screen.height());
        let [red, green, blue] = label.rgb;
        let font = FontId::proportional(SIZE);
        let text = painter.layout_no_wrap(label.text.clone(), font, Color32::from_rgb(red, green, blue));
        let around = Align2::CENTER_CENTER.anchor_size(place, text.size());
        painter.rect_filled(around.expand2(egui::vec2(3.0, 0.0)), 3.0, Color32::from_black_alpha(150));
        painter.galley(around.min, text, Color32::WHITE);
    }
}

/// Says why there is nothing to be seen.
pub fn write_failure(context: &egui::Context, why: &str) {
    let first = why.lines().find(|line| !line.trim().is_empty()).unwrap_or(why);
    let text =
        format!("The graphics driver cannot draw bodies: {first}\nA newer driver may; physics goes on.");
    let painter =
        context.layer_painter(egui::LayerId::new(egui::Order::Background, egui::Id::new("failure")));
    let font = FontId::proportional(SIZE);
    painter.text(context.content_rect().center(), Align2::CENTER_CENTER, text, font, Color32::LIGHT_RED);
}
