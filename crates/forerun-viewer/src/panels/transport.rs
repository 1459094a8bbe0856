//! Play, pause, step, and where display time is.

use three_d::egui;

use super::Wish;
use crate::actions::Action;
use crate::session::Session;

pub(super) fn show(ui: &mut egui::Ui, session: &mut Session, wishes: &mut Vec<Wish>) {
    let Some(play) = session.play_mut() else { return };
    ui.horizontal(|ui| {
        let mut button = |ui: &mut egui::Ui, text: &str, action: Action| {
            if ui.button(text).clicked() {
                wishes.push(Wish::Do(action));
            }
        };
        button(ui, "⏮", Action::GoToStart);
        button(ui, "◀", Action::StepBack);
        button(ui, if play.paused { "▶" } else { "⏸" }, Action::PlayPause);
        button(ui, "▶|", Action::StepForward);
        button(ui, "⏭", Action::GoToHorizon);
        ui.monospace(format!("{:8.3} s  x{:.3}", play.picture.time_s, play.speed));
        let snapshot = play.picture.snapshot.clone();
        let seconds = snapshot.frame_seconds();
        let range = snapshot.oldest().seconds(seconds)..=snapshot.horizon().seconds(seconds);
        let mut time_s = play.picture.time_s;
        ui.spacing_mut().slider_width = ui.available_width() - 20.0;
        if ui.add(egui::Slider::new(&mut time_s, range).show_value(false)).changed() {
            play.seek(time_s);
        }
    });
}
