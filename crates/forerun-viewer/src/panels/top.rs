//! The row of menus.

use three_d::egui::containers::menu::{MenuButton, MenuConfig};
use three_d::egui::{self, Button, PopupCloseBehavior, Slider, Ui};

use super::icons::{self, Icon, IconButton};
use super::palette::Palette;
use super::{Board, Wish};
use crate::actions::Action;
use crate::capture::{FilmFormat, FilmSize};
use crate::host::{IN_PAGE, SceneSource};
use crate::session::Stage;
use crate::view::{ColourBy, Theme, View};

pub(super) fn show(ui: &mut Ui, board: &mut Board<'_>, palette: &Palette, wishes: &mut Vec<Wish>) {
    egui::MenuBar::new().ui(ui, |ui| {
        ui.menu_button("Scene", |ui| scene(ui, board, wishes));
        ui.menu_button("Edit", |ui| edit(ui, board, wishes));
        lasting(ui, "View", |ui| view(ui, board.view, wishes));
        lasting(ui, "Capture", |ui| capture(ui, board, wishes));
        ui.menu_button("Help", |ui| item(ui, wishes, Action::Help, "Keys and mouse"));
        ui.separator();
        let camera =
            IconButton { icon: Icon::Camera, action: Action::Screenshot, on: false, tip: "Screenshot" };
        if camera.show(ui) {
            wishes.push(Wish::Do(Action::Screenshot));
        }
        film_button(ui, board, palette, wishes);
        ui.separator();
        title(ui, board);
    });
}

/// A menu that stays open while things in it are changed.
fn lasting(ui: &mut Ui, title: &str, content: impl FnOnce(&mut Ui)) {
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    MenuButton::new(title).config(config).ui(ui, content);
}

/// A row of a menu with its keys.
fn item(ui: &mut Ui, wishes: &mut Vec<Wish>, action: Action, text: &str) {
    let button = Button::new(text).shortcut_text(action.keys().unwrap_or_default());
    if ui.add(button).clicked() {
        wishes.push(Wish::Do(action));
        ui.close();
    }
}

fn scene(ui: &mut Ui, board: &Board<'_>, wishes: &mut Vec<Wish>) {
    ui.set_min_width(220.0);
    item(ui, wishes, Action::Scenes, "Built-in scenes...");
    item(ui, wishes, Action::Open, "Open file...");
    item(ui, wishes, Action::Reload, "Read again");
    ui.separator();
    if IN_PAGE {
        ui.weak("Or drop a file on the page.");
        return;
    }
    ui.add_enabled_ui(!board.settings.recent.is_empty(), |ui| {
        ui.menu_button("Recent files", |ui| {
            for file in &board.settings.recent {
                let name = std::path::Path::new(file)
                    .file_name()
                    .map_or(file.clone().into(), |name| name.to_string_lossy());
                if ui.button(name.as_ref()).on_hover_text(file).clicked() {
                    wishes.push(Wish::Open(SceneSource::of(file)));
                    ui.close();
                }
            }
        });
    });
    ui.separator();
    ui.weak("A file that changes is read again.");
}

fn edit(ui: &mut Ui, board: &Board<'_>, wishes: &mut Vec<Wish>) {
    ui.set_min_width(200.0);
    let play = board.session.play();
    let (undo, redo) = play.map_or((false, false), |play| (play.to_undo().1 > 0, play.to_redo().1 > 0));
    let picked = play.is_some_and(|play| play.selection.active().is_some());
    let mut row = |ui: &mut Ui, enabled: bool, action, text| {
        ui.add_enabled_ui(enabled, |ui| item(ui, wishes, action, text));
    };
    row(ui, undo, Action::Undo, "Undo");
    row(ui, redo, Action::Redo, "Redo");
    ui.separator();
    row(ui, true, Action::SelectAll, "Select all that moves");
    row(ui, picked, Action::Deselect, "Select nothing");
    row(ui, picked, Action::Focus, "Look at the selection");
    ui.separator();
    row(ui, true, Action::Add, "Add a body");
    row(ui, picked, Action::Duplicate, "Duplicate");
    row(ui, picked, Action::Delete, "Remove");
}

fn view(ui: &mut Ui, view: &mut View, wishes: &mut Vec<Wish>) {
    ui.set_min_width(260.0);
    ui.horizontal(|ui| {
        ui.label("Theme");
        ui.selectable_value(&mut view.theme, Theme::Dark, "Dark")
            .on_hover_text(icons::tip_of(Action::Theme, "Dark"));
        ui.selectable_value(&mut view.theme, Theme::Light, "Light")
            .on_hover_text(icons::tip_of(Action::Theme, "Light"));
    });
    ui.horizontal(|ui| {
        ui.label("Size of text and buttons");
        item(ui, wishes, Action::Smaller, "-");
        ui.monospace(format!("{:.0} %", 100.0 * view.scale));
        item(ui, wishes, Action::Larger, "+");
    });
    ui.separator();
    item(ui, wishes, Action::FrameAll, "Look at everything");
    ui.checkbox(&mut view.shadows, "Shadows");
    ui.checkbox(&mut view.grid, "Grid on the ground");
    ui.menu_button(format!("Colour by {}", view.colour_by.name()), |ui| {
        for by in ColourBy::ALL {
            ui.radio_value(&mut view.colour_by, by, by.name());
        }
    })
    .response
    .on_hover_text(icons::tip_of(Action::NextColour, "The next one"));
    ui.separator();
    ghosts(ui, view);
    ui.separator();
    overlays(ui, view);
    ui.separator();
    let panel = |ui: &mut Ui, open: &mut bool, text: &str, action| {
        ui.checkbox(open, text).on_hover_text(icons::tip_of(action, text));
    };
    panel(ui, &mut view.open.plots, "Plots", Action::Plots);
    panel(ui, &mut view.open.inspector, "Panel of the selection", Action::Inspector);
    ui.checkbox(&mut view.open.tools, "Panel of tools");
}

fn ghosts(ui: &mut Ui, view: &mut View) {
    let ghosts = &mut view.ghosts;
    ui.checkbox(&mut ghosts.shown, "Ghosts of the future").on_hover_text(icons::tip_of(
        Action::Ghosts,
        "Transparent pictures of states that are computed already",
    ));
    ui.add_enabled_ui(ghosts.shown, |ui| {
        ui.indent("ghosts", |ui| {
            ui.add(Slider::new(&mut ghosts.count, 1..=20).text("ghosts"));
            ui.add(Slider::new(&mut ghosts.opacity, 0.05..=1.0).text("opacity"));
        });
    });
    ui.checkbox(&mut ghosts.trails, "Trail of the selection");
    ui.checkbox(&mut ghosts.preview, "Preview of a throw while aiming");
    ui.add_enabled_ui(ghosts.trails || ghosts.preview, |ui| {
        ui.indent("trails", |ui| {
            ui.add(
                Slider::new(&mut ghosts.trail_seconds, 0.1..=10.0)
                    .logarithmic(true)
                    .suffix(" s")
                    .text("ahead"),
            );
        });
    });
}

fn overlays(ui: &mut Ui, view: &mut View) {
    let overlays = &mut view.overlays;
    ui.checkbox(&mut overlays.contacts, "Contacts and normals")
        .on_hover_text(icons::tip_of(Action::Contacts, "Where bodies touch"));
    ui.checkbox(&mut overlays.impulses, "Impulses").on_hover_text("How hard contacts push");
    ui.checkbox(&mut overlays.levels, "Levels of the contact graph")
        .on_hover_text("Who rests on whom, from the ground up");
    ui.checkbox(&mut overlays.bounds, "Bounding boxes");
    ui.checkbox(&mut overlays.areas, "Areas and their clocks");
    ui.checkbox(&mut overlays.field, "Slice of the distance field").on_hover_text("Of the selected mesh");
    ui.add_enabled_ui(overlays.field, |ui| {
        ui.indent("field", |ui| ui.add(Slider::new(&mut overlays.field_height, 0.0..=1.0).text("height")));
    });
}

fn capture(ui: &mut Ui, board: &mut Board<'_>, wishes: &mut Vec<Wish>) {
    ui.set_min_width(260.0);
    item(ui, wishes, Action::Screenshot, "Screenshot");
    item(ui, wishes, Action::BareScreenshot, "Screenshot without panels");
    ui.separator();
    if IN_PAGE {
        ui.weak("Files are downloads of the browser.");
        ui.weak("Films are taken by the viewer on the desktop.");
        return;
    }
    let filming = board.capture.film.is_some();
    item(ui, wishes, Action::Film, if filming { "End the film" } else { "Start a film" });
    let film = &mut board.settings.film;
    ui.add_enabled_ui(!filming, |ui| {
        labelled(ui, "Film as", film.format.name(), |ui| {
            FilmFormat::ALL.into_iter().for_each(|format| {
                ui.selectable_value(&mut film.format, format, format.name());
            });
        });
        labelled(ui, "Size", film.size.name(), |ui| {
            FilmSize::ALL.into_iter().for_each(|size| {
                ui.selectable_value(&mut film.size, size, size.name());
            });
        });
        ui.add(Slider::new(&mut film.fps, 1..=60).text("pictures a second"));
        let window = film.size == FilmSize::Window;
        ui.add_enabled(window, egui::Checkbox::new(&mut film.panels, "with panels"));
    });
    ui.separator();
    ui.weak("Files go to the folder that the viewer was started in.");
}

/// A choice with its name before it.
fn labelled(ui: &mut Ui, name: &str, chosen: &str, choices: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        ui.label(name);
        egui::ComboBox::from_id_salt(name).selected_text(chosen).show_ui(ui, choices);
    });
}

fn film_button(ui: &mut Ui, board: &Board<'_>, palette: &Palette, wishes: &mut Vec<Wish>) {
    if IN_PAGE {
        return;
    }
    let film = board.capture.film.as_ref();
    let (icon, tip) =
        if film.is_some() { (Icon::Stop, "End the film") } else { (Icon::Record, "Start a film") };
    if (IconButton { icon, action: Action::Film, on: film.is_some(), tip }).show(ui) {
        wishes.push(Wish::Do(Action::Film));
    }
    if let Some(film) = film {
        let seconds = film.taken as f64 / f64::from(film.settings.fps);
        let state = if film.is_ending() { "writing" } else { "filming" };
        ui.colored_label(palette.fewest, format!("{state}: {} pictures, {seconds:.1} s", film.taken));
    }
}

fn title(ui: &mut Ui, board: &Board<'_>) {
    match &board.session.stage {
        Stage::Loading(_) => {
            ui.spinner();
            ui.label(format!("Opening {}", board.session.source.name()));
        }
        Stage::Failed(_) => drop(ui.strong(board.session.source.name())),
        Stage::Playing(play) => {
            ui.strong(board.session.source.name());
            ui.weak(format!("{} bodies", play.samples.len()));
        }
    }
    if let Some(source) = board.session.coming() {
        ui.spinner();
        ui.label(format!("Opening {}", source.name()));
    }
}
