//! The panel of the selection: what a body is and how it moves, to be looked at and changed. Every change is a command, in the past too.

mod euler;

use std::ops::RangeInclusive;

use forerun::{Body, BodyId, BodyKind, Change, Material, Pose, Sample, Shape, Vec3};
use three_d::egui::{self, ComboBox, DragValue, Grid, Response, Ui, emath};

use crate::session::Play;
use crate::session::Session;
use crate::view::View;

/// As menus say it.
const KINDS: [(BodyKind, &str); 3] =
    [(BodyKind::Dynamic, "dynamic"), (BodyKind::Fixed, "fixed"), (BodyKind::Kinematic, "kinematic")];

pub(super) fn show(ui: &mut Ui, session: &mut Session, view: &mut View) {
    let Some(play) = session.play_mut().filter(|_| view.open.inspector) else { return };
    let panel = egui::Panel::right("inspector").resizable(true).default_size(250.0);
    panel.show_inside(ui, |ui| {
        egui::ScrollArea::vertical().show(ui, |ui| {
            match play.selection.active() {
                Some(body) => show_body(ui, play, body),
                None => drop(ui.weak("Nothing is selected: click on a body.")),
            }
            ui.separator();
            show_scene(ui, play);
        });
    });
    // Between one drag and the next nothing is held down and nothing typed in.
    if !ui.ctx().egui_wants_keyboard_input() && !ui.input(|input| input.pointer.any_down()) {
        play.end_edit();
    }
}

fn show_body(ui: &mut Ui, play: &mut Play, id: BodyId) {
    let Some((body, sample)) = play.body(id).cloned().zip(play.sample(id).copied()) else { return };
    ui.heading(format!("Body {}", id.0));
    let others = play.selection.bodies().len() - 1;
    ui.label(if others > 0 {
        format!("{}; {others} more selected", shape_name(&body.shape))
    } else {
        shape_name(&body.shape)
    });
    ui.weak(state_of(play, id));
    Grid::new("body").num_columns(2).spacing([4.0, 4.0]).show(ui, |ui| {
        motion(ui, play, id, &sample);
        matter(ui, play, id, &body);
    });
    ui.weak(if play.is_coupled() {
        "an edit acts with the next step".to_owned()
    } else {
        format!("an edit acts at frame {}", play.edit_frame().0)
    });
}

/// Where it is, and how it moves.
fn motion(ui: &mut Ui, play: &mut Play, id: BodyId, sample: &Sample) {
    // While it is dragged, the value that was asked for, and not yet what has come of it.
    let pose = match play.edited() {
        Some(Change::Move { body, pose }) if *body == id => *pose,
        _ => sample.pose,
    };
    let mut position = pose.position;
    if vector(ui, "position", &mut position, Number { speed: 0.02, suffix: " m" }) {
        play.edit(Change::Move { body: id, pose: Pose { position, ..pose } });
    }
    let mut degrees = euler::degrees_of(pose.rotation);
    if vector(ui, "orientation", &mut degrees, Number { speed: 0.5, suffix: "°" }) {
        let rotation = euler::rotation_of(degrees);
        play.edit(Change::Move { body: id, pose: Pose { rotation, ..pose } });
    }
    let (mut velocity, mut angular_velocity) = match play.edited() {
        Some(Change::SetVelocity { body, velocity, angular_velocity }) if *body == id => {
            (*velocity, *angular_velocity)
        }
        _ => (sample.velocity, sample.angular_velocity),
    };
    let moved = vector(ui, "velocity", &mut velocity, Number { speed: 0.05, suffix: " m/s" });
    let turned = vector(ui, "turning", &mut angular_velocity, Number { speed: 0.05, suffix: " rad/s" });
    if moved || turned {
        play.edit(Change::SetVelocity { body: id, velocity, angular_velocity });
    }
}

/// What it is made of.
fn matter(ui: &mut Ui, play: &mut Play, id: BodyId, body: &Body) {
    if body.is_dynamic() {
        let mut mass = match play.edited() {
            Some(Change::SetMass { body, mass }) if *body == id => *mass,
            _ => 1.0 / body.inverse_mass,
        };
        let speed = 0.01 * f64::from(mass);
        if row(ui, "mass", DragValue::new(&mut mass).speed(speed).range(1e-6..=1e9).suffix(" kg")) {
            play.edit(Change::SetMass { body: id, mass });
        }
    }
    let mut material = match play.edited() {
        Some(Change::SetMaterial { body, material }) if *body == id => *material,
        _ => body.material,
    };
    let slipping = row(ui, "friction", DragValue::new(&mut material.friction).speed(0.01).range(0.0..=100.0));
    let least = material.friction;
    material.static_friction = material.static_friction.max(least);
    let sticking = row(
        ui,
        "static friction",
        DragValue::new(&mut material.static_friction).speed(0.01).range(least..=100.0),
    );
    let bouncing =
        row(ui, "restitution", DragValue::new(&mut material.restitution).speed(0.01).range(0.0..=1.0));
    if slipping || sticking || bouncing {
        // Who had one friction keeps one.
        let one = body.material.friction.to_bits() == body.material.static_friction.to_bits() && !sticking;
        let static_friction = if one { material.friction } else { material.static_friction };
        play.edit(Change::SetMaterial { body: id, material: Material { static_friction, ..material } });
    }
    let mut scale = match play.edited() {
        Some(Change::SetGravityScale { body, scale }) if *body == id => *scale,
        _ => body.gravity_scale,
    };
    if row(ui, "gravity factor", DragValue::new(&mut scale).speed(0.01)) {
        play.edit(Change::SetGravityScale { body: id, scale });
    }
    ui.label("kind");
    let now = KINDS.iter().find(|(kind, _)| *kind == body.kind).map_or("", |(_, name)| name);
    ComboBox::from_id_salt("kind").selected_text(now).show_ui(ui, |ui| {
        for (kind, name) in KINDS {
            if ui.selectable_label(kind == body.kind, name).clicked() && kind != body.kind {
                play.change(Change::SetKind { body: id, kind });
            }
        }
    });
    ui.end_row();
}

/// What all bodies have in common.
fn show_scene(ui: &mut Ui, play: &mut Play) {
    ui.label("Scene");
    Grid::new("scene").num_columns(2).spacing([4.0, 4.0]).show(ui, |ui| {
        let mut gravity = match play.edited() {
            Some(Change::SetGravity { gravity }) => *gravity,
            _ => play.gravity(),
        };
        if vector(ui, "gravity", &mut gravity, Number { speed: 0.05, suffix: " m/s²" }) {
            play.edit(Change::SetGravity { gravity });
        }
    });
}

/// How a number is dragged and read.
#[derive(Clone, Copy)]
struct Number {
    /// By how much it changes for a point of the mouse.
    speed: f64,
    suffix: &'static str,
}

/// Three numbers; whether one was changed.
fn vector(ui: &mut Ui, name: &str, value: &mut Vec3, number: Number) -> bool {
    ui.label(name);
    let mut changed = false;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (axis, part) in ["x", "y", "z"].into_iter().zip(value.as_mut()) {
            let widget = DragValue::new(part).speed(number.speed).max_decimals(3).custom_formatter(plain);
            let response = ui.add(widget).on_hover_text(format!("{name} {axis},{}", number.suffix));
            changed |= said(&response);
        }
    });
    ui.end_row();
    changed && value.is_finite()
}

/// One number; whether it was changed.
fn row(ui: &mut Ui, name: &str, widget: DragValue<'_>) -> bool {
    ui.label(name);
    let changed = said(&ui.add(widget.max_decimals(4)));
    ui.end_row();
    changed
}

/// As numbers are written, but without the sign of what is shown as nothing.
fn plain(number: f64, decimals: RangeInclusive<usize>) -> String {
    let text = emath::format_with_decimals_in_range(number, decimals);
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.to_owned(),
        _ => text,
    }
}

fn said(response: &Response) -> bool {
    response.changed()
}

fn shape_name(shape: &Shape) -> String {
    match shape {
        Shape::HalfSpace => "half-space".to_owned(),
        Shape::Cuboid(cuboid) => {
            let size = cuboid.half_extents * 2.0;
            format!("box, {:.3} x {:.3} x {:.3} m", size.x, size.y, size.z)
        }
        Shape::Sphere(sphere) => format!("ball, radius {:.3} m", sphere.radius),
        Shape::Capsule(capsule) => {
            format!(
                "capsule, radius {:.3} m, {:.3} m between its centres",
                capsule.radius,
                2.0 * capsule.half_height
            )
        }
        Shape::Cylinder(cylinder) => {
            format!("cylinder, radius {:.3} m, height {:.3} m", cylinder.radius, 2.0 * cylinder.half_height)
        }
        Shape::Hull(hull) => format!("convex hull, {} corners", hull.vertices.len()),
        Shape::Compound(compound) => format!("compound of {} shapes", compound.parts.len()),
        Shape::Mesh(mesh) => format!("mesh, {} triangles", mesh.triangles.len()),
    }
}

/// Whether it rests, and how far ahead it is known.
fn state_of(play: &Play, id: BodyId) -> String {
    let (picture, snapshot) = (&play.picture, &play.picture.snapshot);
    let frame = picture.frame.min(snapshot.horizon());
    let rest = snapshot.state(id, frame).map_or(0, |state| state.rest);
    let full = snapshot.environment_at(frame).settings.rest_frames();
    let rests = if full > 0 && rest >= full { "at rest" } else { "awake" };
    if play.is_coupled() {
        return rests.to_owned();
    }
    let ahead = snapshot.known_to(id).0.saturating_sub(frame.0);
    let certainty = play.sample(id).map(|sample| format!("{:?}", sample.certainty).to_lowercase());
    format!("{rests}, known {ahead} frames ahead, {}", certainty.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shown_as_nothing_has_no_sign() {
        assert_eq!(plain(-0.0, 1..=3), "0.0");
        assert_eq!(plain(-0.0001, 2..=2), "0.00");
        assert_eq!(plain(-0.01, 2..=2), "-0.01");
        assert_eq!(plain(-9.81, 2..=2), "-9.81");
    }
}
