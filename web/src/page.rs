//! Page: the display's role. The viewer draws into the canvas and has its physics in a worker.

use forerun_viewer::page;
use forerun_viewer::{SceneSource, host::Host};
use wasm_bindgen::prelude::*;

use crate::error;

/// Starts the viewer in the first canvas of the page, with a built-in scene. `slow_ms` makes every frame of the physics slower, by the first number
/// of milliseconds to the second. Leaves by an exception that is none (`isn't actually an error`), as the window library does.
#[wasm_bindgen]
pub fn run_page(scene: &str, slow_ms: Option<Vec<f64>>) -> Result<(), JsError> {
    let slow_ms = slow_ms.and_then(|slow| Some([*slow.first()?, *slow.get(1)?]));
    let host = slow_ms.map_or_else(Host::default, Host::new);
    page::run(SceneSource::BuiltIn(scene.to_owned()), host).map_err(error)
}

/// Opens a scene file by its content.
#[wasm_bindgen]
pub fn open_text(name: &str, text: String) {
    page::open_text(name, text);
}

/// The state of the viewer as JSON, for scripts.
#[wasm_bindgen]
#[must_use]
pub fn forerun_state() -> String {
    page::state()
}
