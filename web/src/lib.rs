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

/// The message of the last panic.
static LAST_PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Keeps the messages of panics, which end as a bare trap here.
#[wasm_bindgen(start)]
fn start() {
    std::panic::set_hook(Box::new(|panic| {
        *LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner) = Some(panic.to_string());
    }));
}

/// The message of the last panic, if there was one: a bug.
#[wasm_bindgen]
pub fn last_panic() -> Option<String> {
    LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// The host's clock. Seconds.
fn now_s() -> f64 {
    now_ms() / 1000.0
}

/// What JavaScript gets to see of an error.
fn error(message: impl std::fmt::Display) -> JsError {
    JsError::new(&message.to_string())
}
