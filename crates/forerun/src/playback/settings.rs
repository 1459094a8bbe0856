//! What is played, how fast and by whom.

use std::fmt;
use std::num::NonZeroU16;
use std::path::PathBuf;
use std::time::Duration;

use crate::driver::{ChangeError, DriverError, ThreadsError};
use crate::recording::RecordingError;
use crate::staging::StagingError;

/// Who steps the physics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriverKind {
    /// Physics runs ahead in a thread of its own.
    Decoupled,
    /// Step, then show: the traditional model.
    Coupled,
}

impl DriverKind {
    /// `decoupled` or `coupled`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            DriverKind::Decoupled => "decoupled",
            DriverKind::Coupled => "coupled",
        }
    }
}

/// How a scene is played.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaybackSettings {
    /// Who steps the physics. Default decoupled.
    pub driver: DriverKind,
    /// Length of the playback. Seconds of real time, above 0, at most 1 000 000. Default 10.
    pub seconds: f64,
    /// Pictures per second, 0.001 to 10 000. Default 30.
    pub fps: f64,
    /// Most frames that the decoupled physics is ahead of the display. 1 or more, default 100.
    pub lookahead: u32,
    /// Threads of the physics; `None` for one per core. Default `None`.
    pub threads: Option<NonZeroU16>,
    /// Makes every step this much slower. Default 0.
    pub slow_down: Duration,
    /// A file to record the session in, for `forerun replay`; the decoupled driver only. Default none.
    pub record: Option<PathBuf>,
}

impl PlaybackSettings {
    pub(super) fn check(&self) -> Result<(), PlaybackError> {
        let PlaybackSettings { seconds, fps, .. } = *self;
        let refused = |field, message| Err(PlaybackError::Setting { field, message });
        if !(seconds > 0.0 && seconds <= 1e6) {
            return refused("seconds", format!("must be above 0 and at most 1000000, is {seconds}"));
        }
        if !(0.001..=10_000.0).contains(&fps) {
            return refused("fps", format!("must be from 0.001 to 10000, is {fps}"));
        }
        if self.record.is_some() && self.driver != DriverKind::Decoupled {
            return refused("record", "needs the decoupled driver: the other has no timeline".to_owned());
        }
        Ok(())
    }
}

impl Default for PlaybackSettings {
    fn default() -> Self {
        PlaybackSettings {
            driver: DriverKind::Decoupled,
            seconds: 10.0,
            fps: 30.0,
            lookahead: 100,
            threads: None,
            slow_down: Duration::ZERO,
            record: None,
        }
    }
}

/// Why a scene cannot be played, or not to its end.
#[derive(Debug)]
pub enum PlaybackError {
    /// A setting is out of its range.
    Setting {
        /// The field at fault, as in [`PlaybackSettings`].
        field: &'static str,
        /// What is wrong and what is allowed.
        message: String,
    },
    /// The scene cannot be brought to the engine.
    Staging(StagingError),
    /// The threads cannot be started.
    Threads(ThreadsError),
    /// The driver failed.
    Driver(DriverError),
    /// The session cannot be recorded, or not to its end.
    Recording(RecordingError),
    /// A command of the scene cannot be carried out.
    Change {
        /// Name of the scene.
        scene: String,
        /// What is wrong.
        message: String,
    },
}

impl fmt::Display for PlaybackError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PlaybackError::Setting { field, message } => write!(f, "{field}: {message}"),
            PlaybackError::Staging(error) => write!(f, "{error}"),
            PlaybackError::Threads(error) => write!(f, "{error}"),
            PlaybackError::Driver(error) => write!(f, "{error}"),
            PlaybackError::Recording(error) => write!(f, "{error}"),
            PlaybackError::Change { scene, message } => write!(f, "{scene}: commands: {message}"),
        }
    }
}

impl std::error::Error for PlaybackError {}

impl From<StagingError> for PlaybackError {
    fn from(error: StagingError) -> Self {
        PlaybackError::Staging(error)
    }
}

impl From<ThreadsError> for PlaybackError {
    fn from(error: ThreadsError) -> Self {
        PlaybackError::Threads(error)
    }
}

impl From<DriverError> for PlaybackError {
    fn from(error: DriverError) -> Self {
        PlaybackError::Driver(error)
    }
}

impl From<RecordingError> for PlaybackError {
    fn from(error: RecordingError) -> Self {
        PlaybackError::Recording(error)
    }
}

impl PlaybackError {
    pub(crate) fn change(scene: &str, error: &ChangeError) -> Self {
        PlaybackError::Change { scene: scene.to_owned(), message: error.to_string() }
    }
}
