//! Keeper: what outlives a picture or the viewer: settings, the files opened last, and the watch over the open one.

use crate::host::{self, SceneSource, Watch};
use crate::session::{Session, Stage};
use crate::settings::{Settings, WindowPlace};
use crate::view::View;

/// How often settings that have changed are written. Seconds.
const KEEP_EVERY_S: f64 = 2.0;

/// Keeps settings, remembers files, reads again what has changed.
#[derive(Debug)]
pub struct Keeper {
    /// What is remembered.
    pub settings: Settings,
    /// Whether nothing is written: the viewer runs for a script.
    pub silent: bool,
    /// As it was written last.
    kept: String,
    kept_s: f64,
    watch: Option<Watch>,
    /// The scene that was looked at last.
    opened: u64,
}

impl Keeper {
    /// With these settings, as they were loaded.
    #[must_use]
    pub fn new(settings: Settings) -> Keeper {
        let kept = settings.text();
        Keeper { settings, silent: false, kept, kept_s: 0.0, watch: None, opened: 0 }
    }

    /// Once a picture, at the window's clock (seconds).
    pub fn look(&mut self, session: &mut Session, view: &View, real_s: f64) {
        if self.opened != session.opened && matches!(session.stage, Stage::Playing(_)) {
            self.opened = session.opened;
            if let SceneSource::File(path) = &session.source {
                let path = std::path::absolute(path).unwrap_or_else(|_| path.clone());
                self.settings.remember(&path.display().to_string());
            }
        }
        if self.watch.as_ref().is_none_or(|watch| *watch.source() != session.source) {
            self.watch = host::watch(&session.source);
        }
        if self.watch.as_mut().is_some_and(Watch::changed) {
            session.reload();
        }
        if real_s - self.kept_s > KEEP_EVERY_S {
            self.kept_s = real_s;
            self.keep(view);
        }
    }

    /// Writes the settings if they have changed.
    pub fn keep(&mut self, view: &View) {
        self.settings.view = *view;
        let text = self.settings.text();
        if text != self.kept && !self.silent {
            host::save_settings(&text);
            self.kept = text;
        }
    }

    /// The window is so large now.
    pub fn place(&mut self, place: WindowPlace) {
        // The size before it was maximised is the one to go back to.
        let size = if place.maximized { self.settings.window.size } else { place.size };
        self.settings.window = WindowPlace { size, ..place };
    }
}
