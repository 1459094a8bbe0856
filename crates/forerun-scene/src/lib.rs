//! Scenes: files (TOML or JSON, one schema) and the scenes that are built in.
//!
//! A scene says what there is at frame 0 and what happens later. Its types are its own: the engine's types do not know how they
//! are written down.
//!
//! *Architecture invariant:* a scene from outside is either right or refused with a [`SceneError`] that names file, line, field and remedy.
//! Nothing here panics on a bad file.

pub mod body;
mod build;
pub mod builtin;
pub mod command;
pub mod command_entry;
pub mod error;
pub mod mesh;
pub mod mesh_baking;
mod mesh_cache;
mod range;
mod read;
pub mod rotation;
pub mod scene;
pub mod settings;
pub mod shape;
mod source;
mod write;

pub use body::{BodyEntry, KindEntry};
pub use builtin::BuiltIn;
pub use command::{SceneCommand, TimedCommand};
pub use command_entry::{BodyRef, CommandEntry};
pub use error::{Place, SceneError};
pub use mesh::MeshEntry;
pub use mesh_baking::{MeshBaking, MeshWatch};
pub use mesh_cache::MeshCache;
pub use rotation::RotationEntry;
pub use scene::Scene;
pub use settings::{SettingsEntry, ShockEntry};
pub use shape::{PartEntry, ShapeEntry};
pub use source::Format;
