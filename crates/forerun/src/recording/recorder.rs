//! Recorder: writes down a session while it goes on.
//!
//! Promise: what was recorded is in the file, whatever happens to the program after. A disk that is full ends the recording, not the session.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use forerun_timeline::parts::Keep;
use forerun_timeline::{Order, Timeline};

use super::Mark;
use super::encode::Encoder;
use super::error::RecordingError;
use super::file::replace_file;

/// Writes down a session: each order that is obeyed, and now and then a hash. Each record goes to the file at once, in one piece.
///
/// What cannot be written is told at the end, by [`Recorder::finish`].
#[derive(Debug)]
pub struct Recorder {
    path: PathBuf,
    file: File,
    encoder: Encoder,
    failure: Option<RecordingError>,
}

impl Recorder {
    /// Begins a recording with a timeline as it is now. What was at `path` is replaced once the beginning is written.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn create(path: impl AsRef<Path>, timeline: &Timeline) -> Result<Recorder, RecordingError> {
        let path = path.as_ref().to_owned();
        let mut bytes = Vec::new();
        let begun = Encoder::begin(&timeline.parts(Keep::Commands), &mut bytes);
        let encoder = begun.map_err(|error| error.in_file(&path))?;
        let file = replace_file(&path, &bytes).map_err(|error| RecordingError::io(&path, &error))?;
        Ok(Recorder { path, file, encoder, failure: None })
    }

    /// Records an order that a timeline has obeyed. Orders that were refused changed nothing and are not recorded.
    pub fn order(&mut self, order: &Order) {
        self.write(|encoder, bytes| encoder.order(order, bytes));
    }

    /// Records what the timeline is now: a replay compares.
    pub fn mark(&mut self, timeline: &Timeline) {
        let mark = Mark::of(timeline);
        self.write(|encoder, bytes| encoder.mark(&mark, bytes));
    }

    /// Completes the file.
    ///
    /// # Errors
    /// The first thing that could not be written. The readable part of the file can be [recovered](super::Recording::recover).
    pub fn finish(mut self) -> Result<(), RecordingError> {
        if let Some(failure) = self.failure {
            return Err(failure);
        }
        let mut bytes = Vec::new();
        self.encoder.end(&mut bytes).map_err(|error| error.in_file(&self.path))?;
        let written = self.file.write_all(&bytes).and_then(|()| self.file.sync_all());
        written.map_err(|error| RecordingError::io(&self.path, &error))
    }

    fn write(&mut self, encode: impl FnOnce(&mut Encoder, &mut Vec<u8>) -> Result<(), RecordingError>) {
        if self.failure.is_some() {
            return;
        }
        let mut bytes = Vec::new();
        let encoded = encode(&mut self.encoder, &mut bytes).map_err(|error| error.in_file(&self.path));
        let written = encoded.and_then(|()| {
            self.file.write_all(&bytes).map_err(|error| RecordingError::io(&self.path, &error))
        });
        self.failure = written.err();
    }
}
