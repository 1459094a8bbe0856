//! Plots: queues, clocks, pictures, stages, slices and edits over real time, live.

mod curves;

use three_d::egui::{self, Button, Rect, Ui};

use self::curves::Kind;
use super::palette::Palette;
use super::{Board, Wish, icons};
use crate::actions::Action;
use crate::capture::Want;

/// How much of the past is shown. Seconds.
const SPANS_S: [f64; 4] = [5.0, 15.0, 30.0, 60.0];
/// The bar that scrolls, below the plots. Points.
const SCROLL_BAR: f32 = 12.0;
/// Lower plots cannot be read either. Points.
const HEIGHT_MIN: f32 = 40.0;
/// In a narrower window the row of buttons is two. Points.
const BAR_MIN: f32 = 600.0;
/// Narrower plots cannot be read. Points.
const WIDTH_MIN: f32 = 220.0;

/// Which plots are shown.
#[derive(Debug)]
pub(super) struct Plots {
    shown: Vec<Kind>,
    span_s: f64,
    /// Where they were in the picture before: what a picture of them keeps.
    rect: Rect,
}

impl Default for Plots {
    fn default() -> Self {
        Plots {
            shown: vec![Kind::Queue, Kind::Clocks, Kind::Interval, Kind::Stages],
            span_s: SPANS_S[1],
            rect: Rect::NOTHING,
        }
    }
}

impl Plots {
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        board: &mut Board<'_>,
        palette: &Palette,
        wishes: &mut Vec<Wish>,
    ) {
        // All of the panel, or it would shrink to what is in it.
        ui.set_min_height(ui.available_height());
        self.bar(ui, board, wishes);
        self.rect = ui.available_rect_before_wrap();
        if self.shown.is_empty() {
            ui.centered_and_justified(|ui| ui.weak("Choose plots above."));
            return;
        }
        let room = ui.available_size();
        let count = self.shown.len();
        let gap = ui.spacing().item_spacing.x;
        let width = ((room.x - gap * (count - 1) as f32) / count as f32).max(WIDTH_MIN);
        let bottom = self.rect.bottom() - SCROLL_BAR;
        let end_s = board.series.pictures.last().map_or(0.0, |picture| picture.row.time_real_s);
        egui::ScrollArea::horizontal().show(ui, |ui| {
            ui.horizontal_top(|ui| {
                for kind in &self.shown {
                    ui.vertical(|ui| {
                        ui.set_width(width);
                        ui.label(egui::RichText::new(kind.title()).strong().size(12.0))
                            .on_hover_text(kind.meaning());
                        curves::legend(ui, *kind, palette);
                        let size = egui::vec2(width, (bottom - ui.cursor().top()).max(HEIGHT_MIN));
                        curves::show(ui, *kind, board.series, end_s - self.span_s..=end_s, (size, palette));
                    });
                }
            });
        });
    }

    fn bar(&mut self, ui: &mut Ui, board: &mut Board<'_>, wishes: &mut Vec<Wish>) {
        let narrow = ui.available_width() < BAR_MIN;
        ui.horizontal(|ui| {
            self.kinds(ui);
            if !narrow {
                self.controls(ui, board, wishes);
            }
        });
        if narrow {
            ui.horizontal(|ui| self.controls(ui, board, wishes));
        }
    }

    /// Which plots there are to choose from.
    fn kinds(&mut self, ui: &mut Ui) {
        for kind in Kind::ALL {
            let on = self.shown.contains(&kind);
            if ui.selectable_label(on, kind.name()).on_hover_text(kind.meaning()).clicked() {
                if on {
                    self.shown.retain(|shown| *shown != kind);
                } else {
                    self.shown.push(kind);
                    self.shown.sort_unstable();
                }
            }
        }
    }

    /// How much is shown, and what is kept of it.
    fn controls(&mut self, ui: &mut Ui, board: &Board<'_>, wishes: &mut Vec<Wish>) {
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.button("x").on_hover_text(icons::tip_of(Action::Plots, "Close the plots")).clicked() {
                wishes.push(Wish::Do(Action::Plots));
            }
            if ui.button("PNG").on_hover_text("Keep a picture of the plots").clicked() {
                wishes.push(Wish::Keep(Want::Part(self.rect)));
            }
            let tip = "Keep the numbers: pictures, computed frames and edits";
            if ui.button("CSV").on_hover_text(tip).clicked() {
                wishes.push(Wish::KeepNumbers);
            }
            let held = board.series.held;
            let button = Button::selectable(held, if held { "Held" } else { "Hold" });
            let tip = icons::tip_of(Action::HoldPlots, "Hold the plots, or let them go on");
            if ui.add(button).on_hover_text(tip).clicked() {
                wishes.push(Wish::Do(Action::HoldPlots));
            }
            egui::ComboBox::from_id_salt("span")
                .width(50.0)
                .selected_text(format!("{} s", self.span_s))
                .show_ui(ui, |ui| {
                    for span_s in SPANS_S {
                        ui.selectable_value(&mut self.span_s, span_s, format!("{span_s} s"));
                    }
                });
        });
    }
}
