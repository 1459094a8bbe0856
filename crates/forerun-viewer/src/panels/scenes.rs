//! The list of built-in scenes: in groups, with what they show and how large they are.

use std::collections::BTreeMap;

use forerun::scene::builtin::{self, BuiltIn};
use three_d::egui::{self, DragValue, RichText, Ui};

use super::Wish;
use crate::host::SceneSource;

/// Groups in the order of the list, and the scenes in them. What is in none comes last.
const GROUPS: [(&str, &[&str]); 6] = [
    (
        "From the dissertation",
        &["dominoes", "meshes", "interaction", "domino_lines", "walls", "break", "meeting"],
    ),
    (
        "Stacks and structures",
        &[
            "stack",
            "pyramid",
            "large_pyramid",
            "many_pyramids",
            "islands",
            "tower",
            "falling_tower",
            "jenga",
            "kapla",
            "card_house",
            "tiny_pyramid",
            "arch",
            "plank",
            "capstone",
            "cradle",
            "slope",
        ],
    ),
    ("Heaps", &["rain", "pile", "hail", "rings", "convex_pile", "ball_cube", "elastic_ball_cube"]),
    ("Meshes", &["tori", "mugs", "bowl", "chairs", "letters", "hills", "gears", "nut", "chain", "swing"]),
    (
        "Physics with a known answer",
        &[
            "a01a", "a01b", "a01c", "a04a", "a04b", "a04c", "a04d", "a04e", "a06a", "a06b", "a07", "a09a",
            "a09b", "a09c", "a09d", "a11a", "a11b", "a12a", "a12b", "a16a", "a16b", "a16c", "a18a", "a18b",
            "a18c", "a18d", "a19a", "a19b", "a19c", "a19d",
        ],
    ),
    ("More", &[]),
];

/// The largest built-in scene of any kind.
const SIZE_MAX: u32 = 100_000;

/// In a narrower window, what a scene shows is written below its name. Points.
const BESIDE_FROM: f32 = 560.0;

/// The list.
#[derive(Debug, Default)]
pub(super) struct Scenes {
    open: bool,
    search: String,
    /// Sizes that the user has changed.
    sizes: BTreeMap<&'static str, u32>,
}

impl Scenes {
    pub(super) fn toggle(&mut self) {
        self.open ^= true;
    }

    pub(super) fn show(&mut self, ctx: &egui::Context, wishes: &mut Vec<Wish>) {
        let mut open = self.open;
        let room = ctx.content_rect().size();
        egui::Window::new("Scenes")
            .open(&mut open)
            .collapsible(false)
            .default_width(620.0_f32.min(0.9 * room.x))
            .default_height(0.6 * room.y)
            .pivot(egui::Align2::CENTER_CENTER)
            .default_pos(ctx.content_rect().center())
            .show(ctx, |ui| self.list(ui, wishes));
        self.open &= open;
    }

    fn list(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        let beside = ui.ctx().content_rect().width() > BESIDE_FROM;
        ui.horizontal(|ui| {
            ui.label("Search");
            ui.add(egui::TextEdit::singleline(&mut self.search).desired_width(180.0));
            if beside {
                ui.weak("Click a name to open it; drag or type its size.");
            }
        });
        ui.separator();
        let wanted = self.search.to_lowercase();
        let fits = |scene: &BuiltIn| {
            wanted.is_empty()
                || scene.name.contains(&wanted)
                || scene.description.to_lowercase().contains(&wanted)
        };
        egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
            for (i, (title, _)) in GROUPS.iter().enumerate() {
                let scenes: Vec<&'static BuiltIn> =
                    group(i).into_iter().filter(|scene| fits(scene)).collect();
                if scenes.is_empty() {
                    continue;
                }
                ui.add_space(4.0);
                ui.label(RichText::new(*title).strong().size(14.0));
                if !beside {
                    scenes.into_iter().for_each(|scene| self.entry(ui, scene, wishes));
                    continue;
                }
                egui::Grid::new(title).num_columns(3).striped(true).spacing([14.0, 4.0]).show(ui, |ui| {
                    scenes.into_iter().for_each(|scene| self.row(ui, scene, wishes));
                });
            }
        });
    }

    fn row(&mut self, ui: &mut Ui, scene: &'static BuiltIn, wishes: &mut Vec<Wish>) {
        self.name(ui, scene, wishes);
        ui.horizontal(|ui| self.size(ui, scene));
        ui.label(scene.description);
        ui.end_row();
    }

    fn entry(&mut self, ui: &mut Ui, scene: &'static BuiltIn, wishes: &mut Vec<Wish>) {
        ui.horizontal(|ui| {
            self.name(ui, scene, wishes);
            self.size(ui, scene);
        });
        ui.add(egui::Label::new(scene.description).wrap());
        ui.add_space(3.0);
    }

    fn name(&mut self, ui: &mut Ui, scene: &'static BuiltIn, wishes: &mut Vec<Wish>) {
        let name = egui::Button::new(scene.name).min_size(egui::vec2(128.0, 0.0));
        if ui.add(name).on_hover_text(scene.description).clicked() {
            let name = match self.sizes.get(scene.name) {
                Some(size) if Some(*size) != scene.default_size => format!("{}:{size}", scene.name),
                _ => scene.name.to_owned(),
            };
            wishes.push(Wish::Open(SceneSource::BuiltIn(name)));
            self.open = false;
        }
    }

    fn size(&mut self, ui: &mut Ui, scene: &'static BuiltIn) {
        let Some(usual) = scene.default_size else { return };
        let size = self.sizes.entry(scene.name).or_insert(usual);
        let drag = DragValue::new(size).range(1..=SIZE_MAX).speed(f64::from(usual) * 0.01);
        ui.add(drag).on_hover_text(format!("How many {}; usually {usual}", scene.size_counts));
        ui.weak(scene.size_counts);
    }
}

/// The scenes of a group.
fn group(number: usize) -> Vec<&'static BuiltIn> {
    let named = |name: &&str| builtin::list().iter().find(|scene| scene.name == *name);
    if number + 1 < GROUPS.len() {
        return GROUPS[number].1.iter().filter_map(named).collect();
    }
    let placed = |scene: &&BuiltIn| GROUPS.iter().any(|(_, names)| names.contains(&scene.name));
    builtin::list().iter().filter(|scene| !placed(scene)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_scene_is_listed_once() {
        let mut listed: Vec<&str> = (0..GROUPS.len()).flat_map(group).map(|scene| scene.name).collect();
        let mut all: Vec<&str> = builtin::list().iter().map(|scene| scene.name).collect();
        listed.sort_unstable();
        all.sort_unstable();
        assert_eq!(listed, all);
    }

    #[test]
    fn groups_name_only_scenes_that_there_are() {
        for name in GROUPS.iter().flat_map(|(_, names)| names.iter()) {
            assert!(builtin::list().iter().any(|scene| scene.name == *name), "{name}");
        }
    }
}
