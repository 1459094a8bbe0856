//! Page: the display's role. The viewer draws into the canvas and has its physics in a worker.

use forerun_viewer::page;
use forerun_viewer::{SceneSource, host::Host};
use wasm_bindgen::prelude::*;

use crate::error;

/// Starts the viewer in the first canvas of the page, with a built-in scene; or, with a text, the scene that it describes. `slow_ms` makes every
/// frame of the physics slower, by the first number of milliseconds to the second. Leaves by an exception that is none (`isn't actually an
/// error`), as the window library does.
#[wasm_bindgen]
pub fn run_page(scene: &str, text: Option<String>, slow_ms: Option<Vec<f64>>) -> Result<(), JsError> {
    let source = match text {
        Some(text) => SceneSource::of_text(scene, text),
        None => SceneSource::BuiltIn(scene.to_owned()),
    };
    let slow_ms = slow_ms.and_then(|slow| Some([*slow.first()?, *slow.get(1)?]));
    let host = slow_ms.map_or_else(Host::default, Host::new);
    page::run(source, host).map_err(error)
}

/// Opens a scene file by its content.
#[wasm_bindgen]
pub fn open_text(name: &str, text: String) {
    page::open_text(name, text);
}

/// Keeps the settings now, as the page may be left.
#[wasm_bindgen]
pub fn keep_settings() {
    page::keep_settings();
}

/// The state of the viewer as JSON, for scripts.
#[wasm_bindgen]
#[must_use]
pub fn forerun_state() -> String {
    page::state()
}
