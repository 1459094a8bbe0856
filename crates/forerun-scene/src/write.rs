//! Writing: a scene as TOML that a person can read, and as JSON.

use serde::Serialize;

use crate::body::BodyEntry;
use crate::command_entry::CommandEntry;
use crate::mesh::MeshEntry;
use crate::scene::Scene;
use crate::settings::SettingsEntry;

/// One line for each field, one table for each body. Shapes and the like stay on one line.
pub(crate) fn to_toml(scene: &Scene) -> String {
    let mut out = Writer::default();
    out.field("name", &scene.name);
    out.field_unless(scene.description.is_empty(), "description", &scene.description);
    out.field("seconds", &scene.seconds);
    out.field("frame_seconds", &scene.frame_seconds);
    out.field("gravity", &scene.gravity);
    if scene.settings != SettingsEntry::default() {
        out.header("[settings]");
        out.settings(&scene.settings);
    }
    for (name, mesh) in &scene.meshes {
        out.header(&format!("[meshes.{}]", key(name)));
        out.mesh(mesh);
    }
    for body in &scene.bodies {
        out.header("[[bodies]]");
        out.body(body);
    }
    for command in &scene.commands {
        out.header("[[commands]]");
        out.command(command);
    }
    out.text
}

pub(crate) fn to_json(scene: &Scene) -> String {
    let mut text = serde_json::to_string_pretty(scene)
        // Fails only for maps whose keys are not text and for types that refuse: a scene has neither.
        .expect("a scene has only text, numbers, lists and named fields");
    text.push('\n');
    text
}

#[derive(Default)]
struct Writer {
    text: String,
}

impl Writer {
    fn header(&mut self, header: &str) {
        self.text.push('\n');
        self.text.push_str(header);
        self.text.push('\n');
    }

    fn field<T: Serialize + ?Sized>(&mut self, name: &str, value: &T) {
        self.text.push_str(name);
        self.text.push_str(" = ");
        self.text.push_str(&inline(value));
        self.text.push('\n');
    }

    fn field_unless<T: Serialize + ?Sized>(&mut self, is_default: bool, name: &str, value: &T) {
        if !is_default {
            self.field(name, value);
        }
    }

    fn optional<T: Serialize>(&mut self, name: &str, value: &Option<T>) {
        if let Some(value) = value {
            self.field(name, value);
        }
    }

    fn vector(&mut self, name: &str, value: &[f32; 3]) {
        self.field_unless(crate::body::is_zero(value), name, value);
    }

    fn settings(&mut self, s: &SettingsEntry) {
        self.optional("substeps", &s.substeps);
        self.optional("first_sweeps", &s.first_sweeps);
        self.optional("first_sweeps_hard", &s.first_sweeps_hard);
        self.optional("contact_margin_m", &s.contact_margin_m);
        self.optional("overlap_allowed_m", &s.overlap_allowed_m);
        self.optional("overlap_recovery", &s.overlap_recovery);
        self.optional("recovery_speed_max", &s.recovery_speed_max);
        self.optional("shock_propagation", &s.shock_propagation);
        self.optional("shock_yield", &s.shock_yield);
        self.optional("rest_speed", &s.rest_speed);
        self.optional("rest_seconds", &s.rest_seconds);
        self.optional("rest_overlap_m", &s.rest_overlap_m);
        self.optional("deep_overlap_part", &s.deep_overlap_part);
        self.optional("slices_max", &s.slices_max);
    }

    fn mesh(&mut self, mesh: &MeshEntry) {
        let (source, value) = mesh.source.to_toml();
        self.text.push_str(&format!("{source} = {value}\n"));
        self.field_unless(mesh.scale.to_bits() == 1.0_f32.to_bits(), "scale", &mesh.scale);
        self.field_unless(mesh.up.is_y(), "up", &mesh.up);
        self.optional("cell", &mesh.cell);
        self.field_unless(!mesh.open, "open", &mesh.open);
    }

    fn body(&mut self, body: &BodyEntry) {
        self.optional("name", &body.name);
        self.field("shape", &body.shape);
        self.vector("position", &body.position);
        self.optional("rotation", &body.rotation);
        self.vector("velocity", &body.velocity);
        self.vector("angular_velocity", &body.angular_velocity);
        self.field_unless(body.kind == crate::body::KindEntry::Dynamic, "kind", &body.kind);
        self.optional("friction", &body.friction);
        self.optional("static_friction", &body.static_friction);
        self.optional("restitution", &body.restitution);
        self.optional("density", &body.density);
        self.optional("mass", &body.mass);
        self.optional("centre_of_mass", &body.centre_of_mass);
        self.optional("inertia", &body.inertia);
        self.optional("inertia_rotation", &body.inertia_rotation);
        self.optional("gravity_scale", &body.gravity_scale);
        self.vector("force", &body.force);
        self.vector("torque", &body.torque);
    }

    fn command(&mut self, command: &CommandEntry) {
        self.optional("frame", &command.frame);
        self.optional("seconds", &command.seconds);
        self.optional("add", &command.add);
        self.optional("remove", &command.remove);
        self.optional("move", &command.move_to);
        self.optional("push", &command.push);
        self.optional("set_velocity", &command.set_velocity);
        self.optional("set_force", &command.set_force);
        self.optional("set_material", &command.set_material);
        self.optional("set_gravity_scale", &command.set_gravity_scale);
        self.optional("set_mass", &command.set_mass);
        self.optional("set_kind", &command.set_kind);
        self.optional("hold", &command.hold);
        self.optional("release", &command.release);
        self.optional("set_gravity", &command.set_gravity);
    }
}

/// A value as it stands on the right of `=`.
pub(crate) fn inline<T: Serialize + ?Sized>(value: &T) -> String {
    let mut text = String::new();
    value
        .serialize(toml::ser::ValueSerializer::new(&mut text))
        // Fails only for types that TOML does not have, such as a unit: a scene has none.
        .expect("a scene has only what TOML can say");
    text
}

/// A key: bare where TOML allows it, else quoted.
fn key(name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !name.is_empty() && name.chars().all(bare) { name.to_owned() } else { inline(name) }
}
