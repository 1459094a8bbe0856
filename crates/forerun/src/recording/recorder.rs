//! Recorder: writes down a session while it goes on.
//!
//! Promise: what was recorded was handed to the operating system, so it is in the file even when the program crashes right after; when the machine
//! does, only what the system had written by then. [`Recorder::finish`] waits for the disk. A disk that is full ends the recording, not
//! the session.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use forerun_timeline::parts::Keep;
use forerun_timeline::{Frame, Order, Timeline};

use super::encode::Encoder;
use super::error::RecordingError;
use super::file::replace_file;
use super::{Mark, RESERVED_MAX};

/// A hash so often. Seconds of display time.
const MARK_EVERY_S: f64 = 1.0;

/// Writes down a session: the orders that were obeyed, and now and then a hash. Each record goes to the file at once, in one piece.
///
/// A clone writes to the same file, so that who hands one to a [driver](crate::DecoupledSettings) can [finish](Recorder::finish) it after. What cannot
/// be written is told then, and does not disturb the session.
#[derive(Clone, Debug)]
pub struct Recorder(Arc<Mutex<Writing>>);

#[derive(Debug)]
struct Writing {
    path: PathBuf,
    file: File,
    /// `None` once the file is complete, or where something could not be written.
    encoder: Option<Encoder>,
    failure: Option<RecordingError>,
    /// The oldest frame kept, as far as the file tells.
    oldest: Frame,
    /// Names of bodies that who reads the file knows.
    names: usize,
    /// The displayed frame at the last mark.
    marked: Option<Frame>,
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
        let encoder = Some(begun.map_err(|error| error.in_file(&path))?);
        let file = replace_file(&path, &bytes).map_err(|error| RecordingError::io(&path, &error))?;
        let (oldest, names) = (timeline.oldest(), timeline.names());
        let writing = Writing { path, file, encoder, failure: None, oldest, names, marked: None };
        Ok(Recorder(Arc::new(Mutex::new(writing))))
    }

    /// Records an order: to be called with every order that `timeline` obeyed, right after it did. One that was refused is not recorded, except an
    /// undo or redo for which there was something: that is forgotten by it.
    pub fn order(&self, order: &Order, timeline: &Timeline) {
        let mut writing = self.writing();
        if let Order::Submit(command) | Order::Replace(command) = order
            && let Some(body) = command.change.body()
        {
            let name = body.0 as usize;
            if name > writing.names + RESERVED_MAX {
                // No reader makes up so many names for one number: they are written down.
                writing.restart(timeline);
                return;
            }
            writing.names = writing.names.max(name + 1);
        }
        // What is undone next depends on what has been forgotten, so a reader has to know. The order only acts after what the mark hashes.
        if matches!(order, Order::Undo | Order::Redo) && writing.oldest != timeline.oldest() {
            writing.mark(timeline);
        }
        writing.record(|encoder, bytes| encoder.order(order, bytes));
    }

    /// Records that a fork was adopted: the timeline as it is now, in full, as its past may be another one too.
    pub fn restart(&self, timeline: &Timeline) {
        self.writing().restart(timeline);
    }

    /// Records what the timeline is now: a replay compares.
    pub fn mark(&self, timeline: &Timeline) {
        self.writing().mark(timeline);
    }

    /// The same once for every second of display time.
    pub fn mark_when_due(&self, timeline: &Timeline) {
        let frame_seconds = f64::from(timeline.environment_at(timeline.oldest()).settings.frame_seconds);
        let mut writing = self.writing();
        let since = writing.marked.map_or(u64::MAX, |marked| timeline.display().0.abs_diff(marked.0));
        if since as f64 * frame_seconds >= MARK_EVERY_S {
            writing.mark(timeline);
        }
    }

    /// Completes the file. Nothing is recorded after.
    ///
    /// # Errors
    /// The first thing that could not be written. The readable part of the file can be [recovered](super::Recording::recover).
    pub fn finish(&self) -> Result<(), RecordingError> {
        let mut writing = self.writing();
        if let Some(encoder) = writing.encoder.take() {
            let mut bytes = Vec::new();
            let ended = encoder.end(&mut bytes);
            writing.write(ended.map(|()| bytes));
            if writing.failure.is_none() {
                let synced = writing.file.sync_all();
                writing.failure = synced.err().map(|error| RecordingError::io(&writing.path, &error));
            }
        }
        writing.failure.clone().map_or(Ok(()), Err)
    }

    fn writing(&self) -> MutexGuard<'_, Writing> {
        // Who panicked while writing left at worst half a record behind: the file is readable up to there.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Writing {
    fn restart(&mut self, timeline: &Timeline) {
        let parts = timeline.parts(Keep::Commands);
        self.names = parts.names.len();
        self.record(|encoder, bytes| encoder.start(&parts, bytes));
        // What follows it says that it is complete.
        self.mark(timeline);
    }

    fn mark(&mut self, timeline: &Timeline) {
        let mark = Mark::of(timeline);
        (self.oldest, self.marked) = (mark.oldest, Some(mark.display));
        self.record(|encoder, bytes| encoder.mark(&mark, bytes));
    }

    fn record(&mut self, encode: impl FnOnce(&mut Encoder, &mut Vec<u8>) -> Result<(), RecordingError>) {
        let Some(encoder) = &mut self.encoder else { return };
        let mut bytes = Vec::new();
        let encoded = encode(encoder, &mut bytes);
        self.write(encoded.map(|()| bytes));
    }

    fn write(&mut self, bytes: Result<Vec<u8>, RecordingError>) {
        let written = bytes.map_err(|error| error.in_file(&self.path)).and_then(|bytes| {
            self.file.write_all(&bytes).map_err(|error| RecordingError::io(&self.path, &error))
        });
        if let Err(error) = written {
            // What comes after a gap could not be read.
            (self.encoder, self.failure) = (None, Some(error));
        }
    }
}
