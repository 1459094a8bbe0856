//! Page: the viewer in the canvas of a web page, instead of a window.

use std::cell::RefCell;

use three_d::{FrameOutput, Window, WindowSettings};

use crate::host::{Host, SceneSource, load_settings};
use crate::settings::Settings;
use crate::viewer::Viewer;

thread_local! {
    /// The viewer of the page. It is never let go again: after a fault in the middle of a picture it stays borrowed, and whoever asks gets nothing.
    static VIEWER: RefCell<Option<Viewer>> = const { RefCell::new(None) };
}

/// Plays in the first canvas of the page, over all of it. Returns by an exception that is none, as the window library does.
///
/// # Errors
/// When there is no canvas, or it has no WebGL 2.
pub fn run(source: SceneSource, host: Host) -> Result<(), String> {
    let settings = WindowSettings { title: "forerun".to_owned(), ..WindowSettings::default() };
    let window = Window::new(settings).map_err(|error| error.to_string())?;
    let settings = Settings::of_text(&load_settings().unwrap_or_default());
    VIEWER.set(Some(Viewer::new(&window.gl(), host, source, settings)));
    window.render_loop(|frame| with(|viewer| viewer.picture(frame)).unwrap_or_else(FrameOutput::default));
    Ok(())
}

/// Opens a scene by its content.
pub fn open_text(name: &str, text: String) {
    with(|viewer| viewer.session.open(SceneSource::of_text(name, text)));
}

/// Keeps the settings: the page may be left at any moment.
pub fn keep_settings() {
    with(|viewer| viewer.keeper.keep(&viewer.view));
}

/// The state after the last picture as JSON; `null` where there is no viewer.
#[must_use]
pub fn state() -> String {
    // Plain values have a text.
    serde_json::to_string(&with(|viewer| viewer.report())).unwrap_or_default()
}

fn with<T>(act: impl FnOnce(&mut Viewer) -> T) -> Option<T> {
    VIEWER.with(|viewer| viewer.try_borrow_mut().ok()?.as_mut().map(act))
}
