//! The web page: the viewer in a canvas, and its physics in a worker. One module has both roles; which one it plays is what its JavaScript calls.

mod page;
mod worker;

use std::sync::{Mutex, PoisonError};

use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// Milliseconds since some moment; in pages, workers and Node.
    #[wasm_bindgen(js_namespace = performance, js_name = now)]
    fn now_ms() -> f64;
}

/// The message of the first panic: those after it only come of it.
static PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Keeps the message of a panic, which ends as a bare trap here.
#[wasm_bindgen(start)]
fn start() {
    std::panic::set_hook(Box::new(|panic| {
        PANIC.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(|| panic.to_string());
    }));
}

/// The message of the first panic, if there was one: a bug.
#[wasm_bindgen]
pub fn panic_message() -> Option<String> {
    PANIC.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// The host's clock. Seconds.
fn now_s() -> f64 {
    now_ms() / 1000.0
}

/// What JavaScript gets to see of an error.
fn error(message: impl std::fmt::Display) -> JsError {
    JsError::new(&message.to_string())
}
