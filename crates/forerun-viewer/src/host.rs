//! Host: what the viewer asks of where it runs. A desktop has threads and files, a web page a worker and downloads; the rest of the viewer knows neither.

use std::path::{Path, PathBuf};

use forerun::scene::Format;
use forerun::{Decoupled, Scene};

#[cfg(not(target_arch = "wasm32"))]
mod native;
#[cfg(target_arch = "wasm32")]
mod web;
#[cfg(target_arch = "wasm32")]
mod web_files;
#[cfg(target_arch = "wasm32")]
mod web_making;

#[cfg(not(target_arch = "wasm32"))]
pub use native::{
    Choosing, FilmWriter, Host, Link, Making, Saving, Starting, Watch, choose_scene, load_settings, make,
    save_picture, save_settings, save_text, watch,
};

#[cfg(target_arch = "wasm32")]
pub use web::{Host, Link, Starting, remote_settings, timeline_settings};
#[cfg(target_arch = "wasm32")]
pub use web_files::{
    Choosing, FilmWriter, Saving, Watch, choose_scene, load_settings, save_picture, save_settings, save_text,
    watch,
};
#[cfg(target_arch = "wasm32")]
pub use web_making::{Making, make};

/// Whether the viewer runs in a web page: it has no folders there and takes no films, and what it is given is a copy.
pub const IN_PAGE: bool = cfg!(target_arch = "wasm32");

/// Where a scene comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneSource {
    /// A built-in scene and its size, as on the command line: `dominoes:100`.
    BuiltIn(String),
    /// A file of this machine.
    File(PathBuf),
    /// A file that came as its content: dropped on a web page.
    Text {
        /// Its name, for messages.
        name: String,
        /// Its content.
        text: String,
        /// How it is written down.
        format: Format,
    },
}

impl SceneSource {
    /// As on the command line: a file when it ends in `.toml` or `.json`, a built-in scene otherwise.
    #[must_use]
    pub fn of(name_or_path: &str) -> SceneSource {
        let path = PathBuf::from(name_or_path);
        match Format::of(&path) {
            Some(_) => SceneSource::File(path),
            None => SceneSource::BuiltIn(name_or_path.to_owned()),
        }
    }

    /// A scene by its content: JSON where the name ends in `.json`, TOML otherwise.
    #[must_use]
    pub fn of_text(name: &str, text: String) -> SceneSource {
        let format = Format::of(Path::new(name)).unwrap_or(Format::Toml);
        SceneSource::Text { name: name.to_owned(), text, format }
    }

    /// As a title says it.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            SceneSource::BuiltIn(name) | SceneSource::Text { name, .. } => name.clone(),
            SceneSource::File(path) => path.display().to_string(),
        }
    }
}

/// A scene whose physics runs.
#[derive(Debug)]
pub struct Started {
    /// What there was at frame 0.
    pub scene: Scene,
    /// The display's handle on the physics.
    pub driver: Decoupled,
    /// The way to the physics, where that is elsewhere.
    pub link: Link,
}
