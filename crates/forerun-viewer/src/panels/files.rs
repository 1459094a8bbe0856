//! Opening files: by the desktop's dialog, or by a path where there is none.

use three_d::egui;

use super::Wish;
use crate::host::{self, Choosing, IN_PAGE, SceneSource};

/// A dialog that ends sooner was none. Seconds.
const NO_DIALOG_S: f64 = 0.8;

/// The dialog, and the window that stands in for it.
#[derive(Debug, Default)]
pub(super) struct Files {
    /// The dialog that is open, and since when (seconds; none before the first picture of it).
    choosing: Option<(Choosing, Option<f64>)>,
    typing: bool,
    path: String,
}

impl Files {
    /// Opens the dialog, if none is open.
    pub(super) fn choose(&mut self) {
        if self.choosing.is_none() {
            self.choosing = Some((host::choose_scene(), None));
        }
    }

    pub(super) fn show(&mut self, ctx: &egui::Context, recent: &[String], wishes: &mut Vec<Wish>) {
        self.listen(ctx.input(|input| input.time), wishes);
        let mut typing = self.typing;
        egui::Window::new("Open a scene")
            .open(&mut typing)
            .collapsible(false)
            .resizable(false)
            .anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO)
            .show(ctx, |ui| self.type_path(ui, recent, wishes));
        self.typing &= typing;
    }

    fn listen(&mut self, now_s: f64, wishes: &mut Vec<Wish>) {
        let Some((choosing, since)) = &mut self.choosing else { return };
        let since_s = *since.get_or_insert(now_s);
        let Some(chosen) = choosing.poll() else { return };
        self.choosing = None;
        match chosen {
            Some(source) => wishes.push(Wish::Open(source)),
            // Nobody says no so fast: this desktop has no dialogs.
            None if now_s - since_s < NO_DIALOG_S => self.typing = !IN_PAGE,
            None => {}
        }
    }

    fn type_path(&mut self, ui: &mut egui::Ui, recent: &[String], wishes: &mut Vec<Wish>) {
        ui.label("Path of a scene file (.toml or .json), or drop one on the window:");
        let field =
            egui::TextEdit::singleline(&mut self.path).desired_width(420.0).hint_text("scenes/example.toml");
        let response = ui.add(field);
        response.request_focus();
        let entered = ui.input(|input| input.key_pressed(egui::Key::Enter));
        let escaped = ui.input(|input| input.key_pressed(egui::Key::Escape));
        let path = self.path.trim();
        let known = matches!(SceneSource::of(path), SceneSource::File(_));
        ui.horizontal(|ui| {
            let opened = ui.add_enabled(known, egui::Button::new("Open")).clicked();
            if (opened || entered) && known {
                wishes.push(Wish::Open(SceneSource::of(path)));
                self.typing = false;
            }
            if ui.button("Cancel").clicked() || escaped {
                self.typing = false;
            }
            if !known && !path.is_empty() {
                ui.weak("the name of a scene file ends in .toml or .json");
            }
        });
        for file in recent {
            if ui.link(file).clicked() {
                wishes.push(Wish::Open(SceneSource::of(file)));
                self.typing = false;
            }
        }
    }
}
