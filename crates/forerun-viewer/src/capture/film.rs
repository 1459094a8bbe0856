//! A film that is being taken: picture after picture at a fixed rate, written elsewhere.

use serde::{Deserialize, Serialize};

use super::Shot;
use crate::host::FilmWriter;

/// What a film becomes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FilmFormat {
    /// A folder of numbered PNG files.
    #[default]
    Png,
    /// A GIF that repeats for ever.
    Gif,
    /// An MP4, by the program `ffmpeg`.
    Mp4,
}

/// How large its pictures are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FilmSize {
    /// As the window is when the film begins.
    #[default]
    Window,
    /// 640 x 360.
    Small,
    /// 1280 x 720.
    Hd,
    /// 1920 x 1080.
    FullHd,
}

/// How films are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct FilmSettings {
    /// What it becomes.
    pub format: FilmFormat,
    /// How large it is.
    pub size: FilmSize,
    /// Pictures a second of display time at normal speed, 1 to 60.
    pub fps: u32,
    /// Whether panels are in it: of films as large as the window.
    pub panels: bool,
}

impl Default for FilmSettings {
    fn default() -> Self {
        FilmSettings { format: FilmFormat::default(), size: FilmSize::default(), fps: 30, panels: false }
    }
}

impl FilmFormat {
    /// All, in the order of menus.
    pub const ALL: [FilmFormat; 3] = [FilmFormat::Png, FilmFormat::Gif, FilmFormat::Mp4];

    /// As menus say it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            FilmFormat::Png => "PNG files",
            FilmFormat::Gif => "GIF",
            FilmFormat::Mp4 => "MP4 (needs ffmpeg)",
        }
    }
}

impl FilmSize {
    /// All, in the order of menus.
    pub const ALL: [FilmSize; 4] = [FilmSize::Window, FilmSize::Small, FilmSize::Hd, FilmSize::FullHd];

    /// As menus say it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            FilmSize::Window => "as the window",
            FilmSize::Small => "640 x 360",
            FilmSize::Hd => "1280 x 720",
            FilmSize::FullHd => "1920 x 1080",
        }
    }

    /// Width and height, where they are not the window's. Pixels.
    #[must_use]
    pub const fn pixels(self) -> Option<[u32; 2]> {
        match self {
            FilmSize::Window => None,
            FilmSize::Small => Some([640, 360]),
            FilmSize::Hd => Some([1280, 720]),
            FilmSize::FullHd => Some([1920, 1080]),
        }
    }
}

impl FilmSettings {
    /// Puts what came from a file within its range.
    pub fn mend(&mut self) {
        self.fps = self.fps.clamp(1, 60);
    }
}

/// A film that is being taken.
#[derive(Debug)]
pub struct Film {
    /// How it is made.
    pub settings: FilmSettings,
    /// Pictures taken so far.
    pub taken: u64,
    /// Width and height of its pictures.
    pub size: [u32; 2],
    writer: FilmWriter,
    ending: bool,
    /// Real time since the last picture was taken. Seconds.
    waited_s: f64,
}

impl Film {
    /// Begins a film whose files begin with `stem`; `window` is how large the window is in pixels.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn begin(settings: &FilmSettings, stem: &str, window: [u32; 2]) -> Result<Film, String> {
        // Most players want even sides.
        let size = settings.size.pixels().unwrap_or(window).map(|side| side & !1);
        let writer = FilmWriter::start(settings, stem, size)?;
        Ok(Film { settings: *settings, taken: 0, size, writer, ending: false, waited_s: 0.0 })
    }

    /// By how much the clock of the session goes on after so much real time (seconds), and with it the film: one picture of the film or nothing. Not faster
    /// than real time, and not before the writer has room for the picture.
    pub fn tick(&mut self, elapsed_s: f64) -> f64 {
        let interval_s = 1.0 / f64::from(self.settings.fps);
        // What a slow machine is late by is not made good: display time waits for the film.
        self.waited_s = (self.waited_s + elapsed_s).min(2.0 * interval_s);
        if self.ending || self.waited_s < interval_s || !self.writer.has_room() {
            return 0.0;
        }
        self.waited_s -= interval_s;
        interval_s
    }

    /// Takes a picture: as large as the film, twice as large, or the window's after its size has changed.
    pub fn take(&mut self, shot: Shot) {
        if !self.ending {
            self.taken += 1;
            self.writer.push(shot);
        }
    }

    /// No more pictures; what is there is written to the end.
    pub fn end(&mut self) {
        self.ending = true;
        self.writer.end();
    }

    /// Whether the last pictures are being written.
    #[must_use]
    pub fn is_ending(&self) -> bool {
        self.ending
    }

    /// Where it went or why not, once it has ended.
    pub fn ended(&mut self) -> Option<Result<String, String>> {
        self.writer.poll()
    }
}
