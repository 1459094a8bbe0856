//! Page: the viewer in the canvas of a web page, instead of a window.

use std::cell::RefCell;

use forerun::scene::Format;
use three_d::{Window, WindowSettings};

use crate::host::{Host, SceneSource, load_settings};
use crate::report::Report;
use crate::settings::Settings;
use crate::viewer::Viewer;

thread_local! {
    /// Scenes that the page was given since the last picture.
    static GIVEN: RefCell<Vec<SceneSource>> = const { RefCell::new(Vec::new()) };
    /// The state after the last picture.
    static STATE: RefCell<Option<Report>> = const { RefCell::new(None) };
}

/// Plays in the first canvas of the page, over all of it. Returns by an exception that is none, as the window library does.
///
/// # Errors
/// When there is no canvas, or it has no WebGL 2.
pub fn run(source: SceneSource, host: Host) -> Result<(), String> {
    let settings = WindowSettings { title: "forerun".to_owned(), ..WindowSettings::default() };
    let window = Window::new(settings).map_err(|error| error.to_string())?;
    let settings = Settings::of_text(&load_settings().unwrap_or_default());
    let mut viewer = Viewer::new(&window.gl(), host, source, settings);
    window.render_loop(move |frame| {
        for source in GIVEN.take() {
            viewer.session.open(source);
        }
        let output = viewer.picture(frame);
        STATE.set(Some(viewer.report()));
        output
    });
    Ok(())
}

/// Opens a scene file by its content at the next picture.
pub fn open_text(name: &str, text: String) {
    let format = if name.ends_with(".json") { Format::Json } else { Format::Toml };
    GIVEN.with_borrow_mut(|given| given.push(SceneSource::Text { name: name.to_owned(), text, format }));
}

/// The state after the last picture as JSON; `null` before the first.
#[must_use]
pub fn state() -> String {
    // Plain values have a text.
    STATE.with_borrow(|state| serde_json::to_string(state).unwrap_or_default())
}
