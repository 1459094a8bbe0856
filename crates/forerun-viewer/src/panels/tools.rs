//! The panel of tools: what the left button does and how, what is brought in and taken back, and the driver.

use three_d::egui::{self, Grid, Slider, Ui};

use super::Wish;
use crate::actions::Action;
use crate::session::{SLOW_DOWN_MAX_S, Session};
use crate::view::{Grip, Missile, Tool, View};

const TOOLS: [(Tool, &str, &str); 3] = [
    (
        Tool::Select,
        "Select",
        "Click to pick, with Shift or Ctrl one more; drag by a spring, with Shift along the ground.",
    ),
    (Tool::Throw, "Throw", "Hold to aim, release to throw; Esc throws nothing."),
    (Tool::Push, "Push", "Click on a body to push it away."),
];

const MISSILES: [(Missile, &str); 4] = [
    (Missile::Ball, "ball"),
    (Missile::Box, "box"),
    (Missile::Torus, "torus"),
    (Missile::Selected, "like selected"),
];

pub(super) fn show(ui: &mut Ui, session: &mut Session, view: &mut View, wishes: &mut Vec<Wish>) {
    if !view.open.tools {
        return;
    }
    let panel = egui::Panel::left("tools").resizable(false).default_size(190.0);
    panel.show_inside(ui, |ui| {
        egui::ScrollArea::vertical().show(ui, |ui| {
            ui.horizontal(|ui| {
                for (tool, name, help) in TOOLS {
                    ui.selectable_value(&mut view.grip.tool, tool, name).on_hover_text(help);
                }
            });
            match view.grip.tool {
                Tool::Select => spring(ui, &mut view.grip),
                Tool::Throw => {
                    missile(ui, &mut view.grip);
                    ui.checkbox(&mut view.ghosts.preview, "preview while aiming");
                    slider(ui, "looks ahead", &mut view.ghosts.trail_seconds, (0.1..=10.0, " s"));
                }
                Tool::Push => slider(ui, "push", &mut view.grip.push, (0.1..=50.0, " m/s")),
            }
            ui.separator();
            bodies(ui, session, &mut view.grip, wishes);
            ui.separator();
            steps(ui, session, wishes);
            ui.separator();
            driver(ui, session, wishes);
        });
    });
}

fn spring(ui: &mut Ui, grip: &mut Grip) {
    slider(ui, "spring", &mut grip.frequency, (0.2..=20.0, " Hz"));
}

fn missile(ui: &mut Ui, grip: &mut Grip) {
    Grid::new("missiles").num_columns(2).show(ui, |ui| {
        for (i, (missile, name)) in MISSILES.into_iter().enumerate() {
            ui.radio_value(&mut grip.missile, missile, name);
            if i % 2 == 1 {
                ui.end_row();
            }
        }
    });
    if grip.missile != Missile::Selected {
        slider(ui, "size", &mut grip.size, (0.02..=5.0, " m"));
        slider(ui, "density", &mut grip.density, (1.0..=20_000.0, " kg/m³"));
    }
    slider(ui, "speed", &mut grip.speed, (0.1..=200.0, " m/s"));
}

fn slider(ui: &mut Ui, name: &str, value: &mut f32, (range, unit): (std::ops::RangeInclusive<f32>, &str)) {
    ui.add(Slider::new(value, range).logarithmic(true).suffix(unit).text(name).max_decimals(2));
}

/// Bring in, copy, remove.
fn bodies(ui: &mut Ui, session: &Session, grip: &mut Grip, wishes: &mut Vec<Wish>) {
    let selected = session.play().map_or(0, |play| play.selection.bodies().len());
    let mut button = |ui: &mut Ui, text: &str, enabled: bool, action: Action| {
        if ui.add_enabled(enabled, egui::Button::new(text)).clicked() {
            wishes.push(Wish::Do(action));
        }
    };
    ui.horizontal(|ui| {
        button(ui, "Add", session.play().is_some(), Action::Add);
        button(ui, "Duplicate", selected > 0, Action::Duplicate);
        button(ui, "Remove", selected > 0, Action::Delete);
    });
    if grip.tool != Tool::Throw {
        ui.collapsing("what is added", |ui| missile(ui, grip));
    }
}

/// Undo and redo, with what they are about.
fn steps(ui: &mut Ui, session: &Session, wishes: &mut Vec<Wish>) {
    let Some(play) = session.play() else { return };
    let asked = [("Undo", play.to_undo(), Action::Undo), ("Redo", play.to_redo(), Action::Redo)];
    for (name, (step, count), action) in asked {
        let text = step.map_or_else(|| name.to_owned(), |step| format!("{name}: {}", step.label));
        let button = ui.add_enabled(count > 0, egui::Button::new(text));
        if button.on_hover_text(format!("{count} steps")).clicked() {
            wishes.push(Wish::Do(action));
        }
    }
}

/// The switch between the drivers, and how slow physics is made.
fn driver(ui: &mut Ui, session: &mut Session, wishes: &mut Vec<Wish>) {
    let Some(mut coupled) = session.play().map(|play| play.is_coupled()) else { return };
    let help = "The traditional driver: one step, then one picture. Who shows a picture waits for its step; there is no past and no future.";
    if ui.checkbox(&mut coupled, "coupled").on_hover_text(help).changed() {
        wishes.push(Wish::Do(Action::Coupled));
    }
    let help =
        "Every step of the physics sleeps for so long, to see what a slow scene does under both drivers.";
    let slider =
        Slider::new(&mut session.slow_down_s, 0.0..=SLOW_DOWN_MAX_S).suffix(" s").text("slow physics");
    ui.add(slider.max_decimals(2)).on_hover_text(help);
}
