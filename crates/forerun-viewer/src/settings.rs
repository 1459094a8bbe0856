//! Settings: what the viewer remembers from one start to the next. A file that is missing, broken or of another version gives the defaults.

use serde::{Deserialize, Serialize};

use crate::capture::FilmSettings;
use crate::view::View;

/// Files that are remembered.
const RECENT_MAX: usize = 10;

/// Smallest and largest size of text and buttons, against the system's.
const SCALES: [f32; 2] = [0.5, 3.0];

/// What the viewer remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// What is shown and how.
    pub view: View,
    /// The window as it was last.
    pub window: WindowPlace,
    /// Scene files that were opened, the latest first.
    pub recent: Vec<String>,
    /// How films are made.
    pub film: FilmSettings,
    /// Whether the hint for newcomers has been closed.
    pub greeted: bool,
}

/// How large the window is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct WindowPlace {
    /// Width and height when it is not maximised. Points.
    pub size: [u32; 2],
    /// Whether it is as large as the screen.
    pub maximized: bool,
}

impl Default for WindowPlace {
    fn default() -> Self {
        WindowPlace { size: [1280, 720], maximized: true }
    }
}

impl Settings {
    /// From what was kept as text; the defaults where it cannot be read.
    #[must_use]
    pub fn of_text(text: &str) -> Settings {
        let mut settings: Settings = serde_json::from_str(text).unwrap_or_default();
        settings.mend();
        settings
    }

    /// As text, to be kept.
    #[must_use]
    pub fn text(&self) -> String {
        // Plain values with names; no number of them is worth a failure.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// Puts a file at the head of those opened last.
    pub fn remember(&mut self, file: &str) {
        self.recent.retain(|known| known != file);
        self.recent.insert(0, file.to_owned());
        self.recent.truncate(RECENT_MAX);
    }

    /// Text and buttons by this factor larger, within limits.
    pub fn rescale(view: &mut View, factor: f32) {
        view.scale = (view.scale * factor).clamp(SCALES[0], SCALES[1]);
    }

    /// A file that someone wrote by hand must not make the viewer unusable.
    fn mend(&mut self) {
        let default = View::default();
        let view = &mut self.view;
        if !view.scale.is_finite() {
            view.scale = default.scale;
        }
        Self::rescale(view, 1.0);
        view.ghosts.count = view.ghosts.count.clamp(1, 20);
        let within = |value: &mut f32, least: f32, most: f32, otherwise: f32| {
            *value = if value.is_finite() { value.clamp(least, most) } else { otherwise };
        };
        within(&mut view.ghosts.opacity, 0.0, 1.0, default.ghosts.opacity);
        within(&mut view.ghosts.trail_seconds, 0.0, 10.0, default.ghosts.trail_seconds);
        within(&mut view.overlays.field_height, 0.0, 1.0, default.overlays.field_height);
        self.window.size = self.window.size.map(|side| side.clamp(320, 16_384));
        self.recent.truncate(RECENT_MAX);
        self.film.mend();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_comes_back() {
        let mut settings = Settings::default();
        settings.view.scale = 1.5;
        settings.view.ghosts.count = 7;
        settings.remember("a.toml");
        assert_eq!(Settings::of_text(&settings.text()), settings);
    }

    #[test]
    fn what_cannot_be_read_gives_defaults_and_what_is_missing_too() {
        for broken in ["", "{", "[1]", "{\"view\": 3}", "{\"view\": {\"scale\": \"big\"}}"] {
            assert_eq!(Settings::of_text(broken), Settings::default(), "{broken}");
        }
        assert!(Settings::of_text("{\"greeted\": true, \"from a later version\": 1}").greeted);
    }

    #[test]
    fn no_number_of_a_file_makes_the_viewer_unusable() {
        let text = r#"{"view": {"scale": 1e9}, "window": {"size": [0, 4294967295]}, "film": {"fps": 0}}"#;
        let settings = Settings::of_text(text);
        assert!((settings.view.scale - SCALES[1]).abs() < 1e-6);
        assert_eq!(settings.window.size, [320, 16_384]);
        assert_eq!(settings.film.fps, 1);
    }

    #[test]
    fn the_file_opened_last_comes_first_and_once() {
        let mut settings = Settings::default();
        for i in 0..20 {
            settings.remember(&format!("{i}.toml"));
        }
        settings.remember("15.toml");
        assert_eq!(settings.recent.len(), RECENT_MAX);
        assert_eq!(settings.recent[0], "15.toml");
        assert_eq!(settings.recent.iter().filter(|file| *file == "15.toml").count(), 1);
    }
}
