//! Files of the web page: settings in the browser's storage, pictures and numbers as downloads, scenes by the browser's dialog.

use wasm_bindgen::prelude::*;

use super::SceneSource;
use crate::capture::{FilmSettings, Shot};

#[wasm_bindgen(module = "/src/host/files.js")]
extern "C" {
    fn load() -> Option<String>;
    fn keep(text: &str);
    fn download(name: &str, content: &[u8]);

    /// A dialog that is open.
    #[derive(Debug)]
    type Dialog;

    #[wasm_bindgen(constructor)]
    fn new() -> Dialog;

    /// Whether the user has decided.
    #[wasm_bindgen(method)]
    fn decided(this: &Dialog) -> bool;

    #[wasm_bindgen(method)]
    fn name(this: &Dialog) -> Option<String>;

    #[wasm_bindgen(method)]
    fn text(this: &Dialog) -> Option<String>;
}

/// The settings as they were kept; none where there are none to be read.
#[must_use]
pub fn load_settings() -> Option<String> {
    load()
}

/// Keeps the settings, where the browser lets a page keep anything.
pub fn save_settings(text: &str) {
    keep(text);
}

/// A file that is being written: where it went, or why not.
#[derive(Debug)]
pub struct Saving {
    saved: Option<Result<String, String>>,
}

/// Hands a picture to the browser as a PNG file.
#[must_use]
pub fn save_picture(name: &str, shot: Shot) -> Saving {
    Saving { saved: Some(shot.png().map(|file| save(name, &file))) }
}

/// Hands a text to the browser as a file.
#[must_use]
pub fn save_text(name: &str, text: String) -> Saving {
    Saving { saved: Some(Ok(save(name, text.as_bytes()))) }
}

/// What goes wrong from here on, the browser tells the user itself.
fn save(name: &str, content: &[u8]) -> String {
    download(name, content);
    format!("{name}, as a download")
}

impl Saving {
    /// Where it went or why not, once it is written.
    pub fn poll(&mut self) -> Option<Result<String, String>> {
        self.saved.take()
    }
}

/// Writes a film: not here.
#[derive(Debug)]
pub struct FilmWriter;

impl FilmWriter {
    /// Begins a film.
    ///
    /// # Errors
    /// Always: a page has no files to write it into.
    pub fn start(_settings: &FilmSettings, _stem: &str, _size: [u32; 2]) -> Result<FilmWriter, String> {
        Err("films are taken by the viewer on the desktop, or by `forerun render --film`".to_owned())
    }

    /// Whether one more picture can wait.
    #[must_use]
    pub fn has_room(&self) -> bool {
        false
    }

    /// One more picture.
    pub fn push(&mut self, _shot: Shot) {}

    /// No more pictures.
    pub fn end(&mut self) {}

    /// Where it went or why not, once all of it is written.
    pub fn poll(&mut self) -> Option<Result<String, String>> {
        None
    }
}

/// A dialog that is open.
#[derive(Debug)]
pub struct Choosing {
    dialog: Dialog,
}

/// Asks the user for a scene file by the browser's dialog.
#[must_use]
pub fn choose_scene() -> Choosing {
    Choosing { dialog: Dialog::new() }
}

impl Choosing {
    /// What the user chose, once he has: none when he chose nothing.
    pub fn poll(&mut self) -> Option<Option<SceneSource>> {
        if !self.dialog.decided() {
            return None;
        }
        let (Some(name), Some(text)) = (self.dialog.name(), self.dialog.text()) else { return Some(None) };
        Some(Some(SceneSource::of_text(&name, text)))
    }
}

/// Looks at a file: a page cannot.
#[derive(Debug)]
pub struct Watch {
    source: SceneSource,
}

/// Watches nothing: what a page was given is a copy.
#[must_use]
pub fn watch(_source: &SceneSource) -> Option<Watch> {
    None
}

impl Watch {
    /// What is watched.
    #[must_use]
    pub fn source(&self) -> &SceneSource {
        &self.source
    }

    /// Whether it has changed since it was asked last.
    pub fn changed(&mut self) -> bool {
        false
    }
}
