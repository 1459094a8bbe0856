//! Capture: screenshots and films of what the viewer shows.
//!
//! A film is taken from the window's clock stretched: while it runs, display time goes on by exactly one picture of the film for each picture taken, so the film
//! is smooth even where the machine that draws it is slow.

mod film;
mod shot;

pub use film::{Film, FilmFormat, FilmSettings, FilmSize};
pub use shot::Shot;

use three_d::egui;

use crate::host::{self, Saving};
use crate::news::News;
use crate::session::Session;

/// A picture that is to be kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Want {
    /// The window as it is.
    Window,
    /// The window without its panels.
    Bare,
    /// A part of the window, in points: the plots.
    Part(egui::Rect),
    /// The window, for who asked for it.
    Hand,
}

/// What of a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawn {
    /// The scene, without panels.
    Scene,
    /// All of it.
    All,
}

impl Drawn {
    fn suits(self, want: Want) -> bool {
        (want == Want::Bare) == (self == Drawn::Scene)
    }
}

/// Pictures that are to be kept, those that are being written, and the film that is being taken.
#[derive(Debug, Default)]
pub struct Capture {
    /// What is to be kept of the next picture.
    pub wants: Vec<Want>,
    /// The film that is being taken.
    pub film: Option<Film>,
    /// The picture that was wanted by [hand](Want::Hand).
    pub handed: Option<Shot>,
    saving: Vec<Saving>,
    /// What came of the last one: where it went, or why not.
    pub message: News<Result<String, String>>,
}

impl Capture {
    /// Whether a picture is wanted of what would be drawn so.
    #[must_use]
    pub fn is_wanted(&self, drawn: Drawn) -> bool {
        self.wants.iter().any(|want| drawn.suits(*want))
    }

    /// Takes those of the wanted pictures that can be taken of what is drawn.
    pub fn take(&mut self, drawn: Drawn, pixels_per_point: f32, session: &Session, read: impl Fn() -> Shot) {
        if !self.is_wanted(drawn) {
            return;
        }
        let due = |want: &Want| drawn.suits(*want);
        let whole = read();
        let (now, later) = self.wants.drain(..).partition(due);
        self.wants = later;
        let taken: Vec<Want> = now;
        for want in taken {
            let (shot, name) = match want {
                Want::Part(part) => {
                    (whole.cropped(part, pixels_per_point), format!("{}-plots.png", stem(session)))
                }
                Want::Hand => {
                    self.handed = Some(whole.clone());
                    continue;
                }
                Want::Window | Want::Bare => (whole.clone(), format!("{}.png", stem(session))),
            };
            self.saving.push(host::save_picture(&name, shot));
        }
    }

    /// Keeps a text beside the pictures.
    pub fn save_text(&mut self, name: &str, text: String) {
        self.saving.push(host::save_text(name, text));
    }

    /// Hears of what has been written since.
    pub fn listen(&mut self) {
        let message = &mut self.message;
        self.saving.retain_mut(|saving| match saving.poll() {
            Some(saved) => {
                message.tell(saved);
                false
            }
            None => true,
        });
        if let Some(ended) = self.film.as_mut().and_then(Film::ended) {
            message.tell(ended);
            self.film = None;
        }
    }

    /// Whether something is still being written or taken.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        !self.wants.is_empty() || !self.saving.is_empty() || self.film.is_some()
    }

    /// No more pictures come: ends the film, and says whether nothing is being written any more.
    pub fn finish(&mut self) -> bool {
        self.wants.clear();
        if let Some(film) = self.film.as_mut().filter(|film| !film.is_ending()) {
            film.end();
        }
        self.listen();
        !self.is_busy()
    }

    /// Begins a film, or ends the one that is being taken.
    pub fn toggle_film(&mut self, settings: &FilmSettings, session: &Session, window: [u32; 2]) {
        match &mut self.film {
            Some(film) => film.end(),
            None => match Film::begin(settings, &stem(session), window) {
                Ok(film) => self.film = Some(film),
                Err(message) => self.message.tell(Err(message)),
            },
        }
    }
}

/// How files of the scene begin: its name, and the time that is shown.
#[must_use]
pub fn stem(session: &Session) -> String {
    let name = session.source.name();
    let name = std::path::Path::new(&name).file_stem().unwrap_or_default().to_string_lossy();
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '-' };
    let name: String = name.chars().map(plain).collect();
    match session.play() {
        Some(play) => format!("forerun-{name}-{:.3}s", play.picture.time_s),
        None => format!("forerun-{name}"),
    }
}
