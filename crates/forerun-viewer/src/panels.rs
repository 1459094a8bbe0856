//! Panels: menus, buttons and the timeline strip, over the picture.

mod help;
mod inspector;
mod tools;
mod top;
mod transport;

use three_d::egui;

use crate::actions::Action;
use crate::host::SceneSource;
use crate::session::Session;
use crate::view::View;

/// What the user asked for in a panel.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// What a key could have asked for too.
    Do(Action),
    /// Another scene.
    Open(SceneSource),
}

/// Draws all panels; what the user asked for in them.
pub fn show(ui: &mut egui::Ui, session: &mut Session, view: &mut View) -> Vec<Wish> {
    let mut wishes = Vec::new();
    egui::Panel::top("menus").show_inside(ui, |ui| top::show(ui, session, view, &mut wishes));
    egui::Panel::bottom("time").show_inside(ui, |ui| transport::show(ui, session, &mut wishes));
    tools::show(ui, session, view, &mut wishes);
    inspector::show(ui, session, view);
    help::show(ui.ctx(), view);
    wishes
}
