//! Play, pause, step, speed; where display time is, and how physics is doing.

use three_d::egui::{self, RichText, Ui};

use super::Wish;
use super::icons::{Icon, IconButton};
use super::palette::Palette;
use crate::actions::Action;
use crate::session::Play;

/// Speeds to choose from.
const SPEEDS: [(f64, &str); 7] =
    [(0.125, "1/8x"), (0.25, "1/4x"), (0.5, "1/2x"), (1.0, "1x"), (2.0, "2x"), (4.0, "4x"), (8.0, "8x")];

/// With less room beside the time the frame is not told. Points.
const FRAME_ROOM: f32 = 400.0;
/// With less room physics is told of in few words. Points.
const WORDS_ROOM: f32 = 280.0;
/// With less room, on a phone, in none: its colour stands for it.
const FEW_ROOM: f32 = 120.0;

/// How much is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Words {
    All,
    Few,
    None,
}

impl Words {
    fn in_room(room: f32) -> Words {
        match room {
            room if room > WORDS_ROOM => Words::All,
            room if room > FEW_ROOM => Words::Few,
            _ => Words::None,
        }
    }
}

/// How physics is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Physics {
    /// As far ahead as it may be.
    Full,
    /// On the way there.
    Working,
    /// The display's clock is slowed for it.
    Late,
}

pub(super) fn show(ui: &mut Ui, play: &mut Play, palette: &Palette, wishes: &mut Vec<Wish>) {
    ui.horizontal(|ui| {
        ui.scope(|ui| buttons(ui, play, wishes));
        ui.add_space(6.0);
        ui.add_enabled_ui(!play.is_coupled(), |ui| speeds(ui, play));
        ui.add_space(6.0);
        let shown = format!("{:>8.3} s", play.picture.time_s);
        ui.label(RichText::new(shown).monospace().strong().size(15.0)).on_hover_text("Display time");
        let room = ui.available_width();
        if room > FRAME_ROOM {
            ui.label(RichText::new(format!("frame {}", play.picture.frame.0)).weak());
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            physics(ui, play, palette, Words::in_room(room));
        });
    });
}

fn buttons(ui: &mut Ui, play: &Play, wishes: &mut Vec<Wish>) {
    ui.spacing_mut().item_spacing.x = 2.0;
    // The traditional driver has neither a past nor a future to go to.
    let ahead = !play.is_coupled();
    let mut put = |ui: &mut Ui, icon, action, on, tip| {
        let enabled = ahead || action == Action::PlayPause;
        let button = IconButton { icon, action, on, tip };
        if ui.add_enabled_ui(enabled, |ui| button.show(ui)).inner {
            wishes.push(Wish::Do(action));
        }
    };
    put(ui, Icon::ToStart, Action::GoToStart, false, "To the oldest frame");
    put(ui, Icon::PlayBack, Action::Rewind, play.rewinding, "Rewind");
    put(ui, Icon::StepBack, Action::StepBack, false, "One frame back");
    let (icon, tip) = if play.paused { (Icon::Play, "Play") } else { (Icon::Pause, "Pause") };
    put(ui, icon, Action::PlayPause, play.paused, tip);
    put(ui, Icon::StepForward, Action::StepForward, false, "One frame on");
    put(ui, Icon::ToEnd, Action::GoToHorizon, false, "To the horizon: as far as physics has come");
}

fn speeds(ui: &mut Ui, play: &mut Play) {
    let name = |speed: f64| match SPEEDS.iter().find(|(known, _)| (known - speed).abs() < 1e-9) {
        Some((_, name)) => (*name).to_owned(),
        None => format!("{speed:.3}x"),
    };
    let tip = format!(
        "Speed. Half: {}; double: {}",
        Action::Slower.keys().unwrap_or_default(),
        Action::Faster.keys().unwrap_or_default()
    );
    let mut speed = play.speed;
    egui::ComboBox::from_id_salt("speed")
        .width(52.0)
        .selected_text(name(speed))
        .show_ui(ui, |ui| {
            for (value, name) in SPEEDS {
                ui.selectable_value(&mut speed, value, name);
            }
        })
        .response
        .on_hover_text(tip);
    if (speed - play.speed).abs() > 1e-12 {
        play.set_speed(speed);
    }
}

fn physics(ui: &mut Ui, play: &Play, palette: &Palette, words: Words) {
    let picture = &play.picture;
    if let Some(coupled) = play.coupled() {
        let step_ms = 1e3 * coupled.step_s();
        let text = match words {
            Words::All => format!("coupled: steps of {step_ms:.1} ms"),
            Words::Few => format!("steps of {step_ms:.0} ms"),
            Words::None => format!("{step_ms:.0} ms"),
        };
        ui.label(text)
            .on_hover_text("Physics and display take turns: who shows a picture waits for its step.");
        return;
    }
    let snapshot = &picture.snapshot;
    let ahead = snapshot.valid_to().since(picture.frame);
    let full = u64::from(forerun::TimelineSettings::default().lookahead);
    let state = match ahead {
        _ if picture.is_slowed() => Physics::Late,
        ahead if ahead + 2 >= full => Physics::Full,
        _ => Physics::Working,
    };
    let (word, colour, tip) = match state {
        Physics::Full => ("full", palette.good, "Physics is as far ahead as it may be, and waits."),
        Physics::Working => ("working", palette.stale, "Physics computes ahead."),
        Physics::Late => {
            ("late", palette.fewest, "Physics is slower than the display's clock, which is slowed for it.")
        }
    };
    let ahead_s = ahead as f64 * play.frame_seconds();
    let text = match words {
        Words::All => format!("physics {word}, {ahead} frames ({ahead_s:.2} s) ahead"),
        Words::Few => format!("{ahead_s:.2} s ahead"),
        Words::None => String::new(),
    };
    let label = ui.label(text);
    let (dot, beside) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), egui::Sense::hover());
    ui.painter().circle_filled(dot.center(), 4.5, colour);
    let memory = picture.stats.state_bytes as f64 / 1_048_576.0;
    label
        .union(beside)
        .on_hover_text(format!("{tip}\n{} bodies, {memory:.1} MiB of stored states", play.samples.len()));
}
