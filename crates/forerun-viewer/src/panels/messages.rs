//! Messages: what was not possible, and where pictures went. They go after a while, or by a click.

use three_d::egui::{self, Align2, Color32, Frame, RichText, Sense, Ui};

use super::Board;
use super::palette::Palette;

/// How long good news stays. Seconds.
const GOOD_S: f64 = 6.0;
/// How long bad news stays. Seconds.
const BAD_S: f64 = 14.0;
/// Messages at a time.
const AT_ONCE: usize = 4;

#[derive(Clone, Debug, PartialEq)]
struct Message {
    text: String,
    bad: bool,
    until_s: f64,
}

#[derive(Debug, Default)]
struct Heard {
    /// The scene of the notices.
    scene: u64,
    notices: u64,
    refused: u64,
    kept: u64,
}

/// The messages that are shown.
#[derive(Debug, Default)]
pub(super) struct Messages {
    shown: Vec<Message>,
    /// How much was heard from each source: what is new is told once.
    heard: Heard,
}

impl Messages {
    pub(super) fn show(&mut self, ui: &Ui, board: &Board<'_>, palette: &Palette) {
        let now_s = ui.input(|input| input.time);
        self.hear(board, now_s);
        self.shown.retain(|message| message.until_s > now_s);
        if self.shown.is_empty() {
            return;
        }
        let mut closed = None;
        let corner = ui.available_rect_before_wrap().left_bottom();
        egui::Area::new(egui::Id::new("messages"))
            .pivot(Align2::LEFT_BOTTOM)
            .fixed_pos(corner + egui::vec2(10.0, -10.0))
            .order(egui::Order::Foreground)
            .show(ui.ctx(), |ui| {
                for (i, message) in self.shown.iter().enumerate() {
                    if bubble(ui, message, palette) {
                        closed = Some(i);
                    }
                }
            });
        if let Some(i) = closed {
            self.shown.remove(i);
        }
    }

    fn hear(&mut self, board: &Board<'_>, now_s: f64) {
        let heard = &mut self.heard;
        if heard.scene != board.session.opened {
            // Its notices are counted anew.
            (heard.scene, heard.notices) = (board.session.opened, 0);
        }
        let notice = board.session.play().and_then(|play| play.notice.since(&mut heard.notices)).cloned();
        let refused = board.session.refused.since(&mut heard.refused);
        let refused = refused.map(|(source, why)| format!("{} was not opened: {why}", source.name()));
        let kept = board.capture.message.since(&mut heard.kept).cloned();
        notice.into_iter().chain(refused).for_each(|text| self.say(text, true, now_s));
        match kept {
            Some(Ok(place)) => self.say(format!("Saved: {place}"), false, now_s),
            Some(Err(why)) => self.say(why, true, now_s),
            None => {}
        }
    }

    fn say(&mut self, text: String, bad: bool, now_s: f64) {
        // What is still shown stays longer: a drag may say the same in every picture.
        self.shown.retain(|message| message.text != text);
        if self.shown.len() == AT_ONCE {
            self.shown.remove(0);
        }
        self.shown.push(Message { text, bad, until_s: now_s + if bad { BAD_S } else { GOOD_S } });
    }
}

/// Paints one; whether it was clicked away.
fn bubble(ui: &mut Ui, message: &Message, palette: &Palette) -> bool {
    let edge = if message.bad { palette.fewest } else { palette.good };
    let frame = Frame::popup(ui.style()).stroke(egui::Stroke::new(1.5, edge)).shadow(egui::Shadow::NONE);
    let shown = frame.show(ui, |ui| {
        ui.set_max_width(520.0);
        ui.horizontal(|ui| {
            let (dot, _) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), Sense::hover());
            ui.painter().circle_filled(dot.center(), 4.0, edge);
            ui.add(
                egui::Label::new(RichText::new(&message.text).background_color(Color32::TRANSPARENT)).wrap(),
            );
        });
    });
    shown.response.interact(Sense::click()).on_hover_text("Click: away with it").clicked()
}
