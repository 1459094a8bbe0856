//! Scene: bodies, commands and settings, as one value that can be read, written and handed to the engine.

use std::collections::BTreeMap;
use std::path::Path;

use forerun_dynamics::{BodyDef, Environment, StepSettings};
use forerun_geometry::{Shape, Vec3};
use serde::{Deserialize, Serialize};

use crate::body::BodyEntry;
use crate::build::{Shapes, build_body, build_mesh};
use crate::command::{Roster, TimedCommand};
use crate::command_entry::CommandEntry;
use crate::error::{Fault, SceneError, Within};
use crate::mesh::MeshEntry;
use crate::mesh_baking::{BakeSite, MeshBaking};
use crate::settings::SettingsEntry;
use crate::source::{Format, Source};
use crate::{range, read, write};

/// Largest scene file that is read. Bytes.
const FILE_BYTES_MAX: u64 = 256 << 20;

/// A scene: what there is at frame 0, and what happens later. Its fields are those of a scene file.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// What the scene is called.
    pub name: String,
    /// What it shows, in a sentence.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
    /// How long it is worth looking at. Seconds, above 0. Default 10.
    #[serde(default = "default_seconds")]
    pub seconds: f32,
    /// Length of a frame. Seconds, 0.00001 to 1. Default 1/60.
    #[serde(default = "default_frame_seconds")]
    pub frame_seconds: f32,
    /// Acceleration of free fall. m/s². Default (0, -9.81, 0).
    #[serde(default = "default_gravity")]
    pub gravity: [f32; 3],
    /// What differs from the default settings of the step.
    #[serde(default)]
    pub settings: SettingsEntry,
    /// Meshes by name, for the bodies to share.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub meshes: BTreeMap<String, MeshEntry>,
    /// Bodies at frame 0. Their order is their number.
    #[serde(default)]
    pub bodies: Vec<BodyEntry>,
    /// What happens later.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub commands: Vec<CommandEntry>,
    #[serde(skip)]
    pub(crate) source: Source,
    /// How its meshes are baked: where fields are kept, and who is told. Not part of the file.
    #[serde(skip)]
    pub baking: MeshBaking,
}

fn default_seconds() -> f32 {
    10.0
}

fn default_frame_seconds() -> f32 {
    StepSettings::default().frame_seconds
}

fn default_gravity() -> [f32; 3] {
    Environment::default().gravity.to_array()
}

impl Scene {
    /// An empty scene with default settings.
    #[must_use]
    pub fn new(name: impl Into<String>, description: impl Into<String>) -> Scene {
        let name = name.into();
        Scene {
            source: Source::named(&name),
            name,
            description: description.into(),
            seconds: default_seconds(),
            frame_seconds: default_frame_seconds(),
            gravity: default_gravity(),
            settings: SettingsEntry::default(),
            meshes: BTreeMap::new(),
            bodies: Vec::new(),
            commands: Vec::new(),
            baking: MeshBaking::default(),
        }
    }

    /// Reads a scene from a text and checks it. `source_name` is its file name: it stands in messages, and mesh files are
    /// looked for in its folder (when [`Scene::bodies`] is called).
    ///
    /// # Errors
    /// The first mistake in the text, with its line.
    pub fn parse(text: &str, format: Format, source_name: &str) -> Result<Scene, SceneError> {
        let mut scene = read::read(text, format, source_name)?;
        scene.source = Source::new(source_name, text, format);
        scene.check()?;
        Ok(scene)
    }

    /// Reads a `.toml` or `.json` file and checks it.
    ///
    /// # Errors
    /// When the file cannot be read, or its first mistake, with its line.
    pub fn load(path: impl AsRef<Path>) -> Result<Scene, SceneError> {
        let path = path.as_ref();
        let name = path.display().to_string();
        let source = Source::named(&name);
        let Some(format) = Format::of(path) else {
            let fault = Fault::new("a scene file ends in .toml or .json", "rename the file");
            return Err(source.error(fault));
        };
        let text = read_text(path).map_err(|fault| source.error(fault))?;
        Scene::parse(&text, format, &name)
    }

    /// A built-in scene by its name, or a scene from a file: what a command line calls a scene.
    ///
    /// # Errors
    /// As [`Scene::load`] for what ends in `.toml` or `.json` or has a folder in front, else as
    /// [`builtin::scene`](crate::builtin::scene).
    pub fn open(name_or_path: &str) -> Result<Scene, SceneError> {
        let path = Path::new(name_or_path);
        if Format::of(path).is_some() || path.components().count() > 1 {
            Scene::load(path)
        } else {
            crate::builtin::scene(name_or_path)
        }
    }

    /// Checks everything but the contents of mesh files.
    ///
    /// # Errors
    /// The first mistake, with its line if the scene came from a text.
    pub fn check(&self) -> Result<(), SceneError> {
        self.find_fault().map_err(|fault| self.source.error(fault))
    }

    fn find_fault(&self) -> Result<(), Fault> {
        range::name(&self.name, "name")?;
        range::above_zero(self.seconds, "seconds")?;
        range::between(self.frame_seconds, (0.000_01, 1.0), "frame_seconds")?;
        range::vector(self.gravity, "gravity")?;
        self.settings.check().in_field("settings")?;
        for (name, mesh) in &self.meshes {
            mesh.check().in_field(name).in_field("meshes")?;
        }
        for (i, body) in self.bodies.iter().enumerate() {
            body.check(&self.meshes).in_item(i).in_field("bodies")?;
        }
        for (i, command) in self.commands.iter().enumerate() {
            command.check(&self.meshes).in_item(i).in_field("commands")?;
        }
        let roster = Roster::new(self)?;
        for (i, command) in self.commands.iter().enumerate() {
            roster.check(command, self).in_item(i).in_field("commands")?;
        }
        Ok(())
    }

    /// The bodies at frame 0, in order. Reads mesh files.
    ///
    /// # Errors
    /// The first mistake; a mesh file that cannot be read; a shape or mass that the engine cannot make.
    pub fn bodies(&self) -> Result<Vec<BodyDef>, SceneError> {
        self.check()?;
        let fault = |fault| self.source.error(fault);
        let shapes = Shapes::new(self.build_meshes().map_err(fault)?);
        let build = |(i, body)| build_body(body, &shapes).in_item(i).in_field("bodies");
        self.bodies.iter().enumerate().map(build).collect::<Result<_, _>>().map_err(fault)
    }

    /// The commands in the order of their frames; those of one frame in the order in which they are written. Reads mesh files if a
    /// command adds a body.
    ///
    /// # Errors
    /// As [`Scene::bodies`].
    pub fn commands(&self) -> Result<Vec<TimedCommand>, SceneError> {
        self.check()?;
        let mut commands = self.build_commands().map_err(|fault| self.source.error(fault))?;
        commands.sort_by_key(|command| command.frame);
        Ok(commands)
    }

    fn build_commands(&self) -> Result<Vec<TimedCommand>, Fault> {
        let roster = Roster::new(self)?;
        let adds = self.commands.iter().any(|command| command.add.is_some());
        let shapes = Shapes::new(if adds { self.build_meshes()? } else { BTreeMap::new() });
        let mut added = 0;
        let build =
            |(i, command)| roster.build(command, (self, &shapes), &mut added).in_item(i).in_field("commands");
        self.commands.iter().enumerate().map(build).collect()
    }

    fn build_meshes(&self) -> Result<BTreeMap<String, Shape>, Fault> {
        let folder = self.source.folder();
        let build = |(name, mesh): (&String, &MeshEntry)| {
            let site = BakeSite { folder: &folder, name, baking: &self.baking };
            let shape = build_mesh(mesh, &site).in_field(name).in_field("meshes")?;
            Ok((name.clone(), shape))
        };
        self.meshes.iter().map(build).collect()
    }

    /// Gravity and settings of the step.
    #[must_use]
    pub fn environment(&self) -> Environment {
        let settings = StepSettings { frame_seconds: self.frame_seconds, ..StepSettings::default() };
        Environment { gravity: Vec3::from_array(self.gravity), settings: self.settings.over(settings) }
    }

    /// The frame nearest to a time.
    #[must_use]
    pub fn frame_at(&self, seconds: f32) -> u64 {
        // In f64, so that 10 s of 1/60 s are 600 frames; casting saturates.
        (f64::from(seconds) / f64::from(self.frame_seconds)).round() as u64
    }

    /// How many frames [`seconds`](Scene::seconds) are.
    #[must_use]
    pub fn frames(&self) -> u64 {
        self.frame_at(self.seconds)
    }

    /// The scene as TOML. Parsed again it gives the same scene, bit for bit; only a relative mesh file has to lie beside it.
    #[must_use]
    pub fn to_toml(&self) -> String {
        write::to_toml(self)
    }

    /// The scene as JSON, with the same promise.
    #[must_use]
    pub fn to_json(&self) -> String {
        write::to_json(self)
    }
}

impl CommandEntry {
    /// The frame of a command; 1 when it has neither frame nor time, which the check refuses.
    pub(crate) fn frame_in(&self, scene: &Scene) -> u64 {
        let given = self.frame.or(self.seconds.map(|seconds| scene.frame_at(seconds)));
        given.unwrap_or_default().max(1)
    }
}

fn read_text(path: &Path) -> Result<String, Fault> {
    let unreadable = |error: std::io::Error| {
        Fault::new(format!("cannot be read: {error}"), "`forerun scenes` lists the scenes that need no file")
    };
    let bytes = std::fs::metadata(path).map_err(unreadable)?.len();
    if bytes > FILE_BYTES_MAX {
        let message = format!("has {bytes} bytes, a scene file has at most {FILE_BYTES_MAX}");
        return Err(Fault::new(message, "put large meshes into glTF, PLY, OBJ or STL files"));
    }
    std::fs::read_to_string(path).map_err(unreadable)
}
