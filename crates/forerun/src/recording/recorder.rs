//! Recorder: writes down a session while it goes on.
//!
//! Promise: what was recorded is in the file, whatever happens to the program after. A disk that is full ends the recording, not the session.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use forerun_geometry::Shape;
use forerun_timeline::parts::Keep;
use forerun_timeline::{Change, Command, CommandKey, Frame, Order, Timeline};

use super::Mark;
use super::encode::Encoder;
use super::error::RecordingError;
use super::file::replace_file;

/// A hash so often. Seconds of display time.
const MARK_EVERY_S: f64 = 1.0;

/// Writes down a session: what changes among the commands, and now and then a hash. Each record goes to the file at once, in one piece.
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
    /// The commands that the file knows, but for those that no timeline keeps any more.
    known: BTreeMap<CommandKey, Change>,
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
        let known = known(timeline);
        let writing = Writing { path, file, encoder, failure: None, known, marked: None };
        Ok(Recorder(Arc::new(Mutex::new(writing))))
    }

    /// Records what has changed among the commands since the last time: to be called after every batch of orders, and before the
    /// display goes on, as what is forgotten by then cannot be recorded.
    pub fn follow(&self, timeline: &Timeline) {
        self.writing().follow(timeline);
    }

    /// Records that a fork was adopted: the timeline as it is now, in full, as its past may be another one too.
    pub fn restart(&self, timeline: &Timeline) {
        let parts = timeline.parts(Keep::Commands);
        let mut writing = self.writing();
        writing.known = known(timeline);
        writing.record(|encoder, bytes| encoder.start(&parts, bytes));
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
    fn follow(&mut self, timeline: &Timeline) {
        let oldest = timeline.oldest();
        self.known.retain(|key, _| key.frame > oldest);
        let mut gone = self.known.clone();
        let mut orders = Vec::new();
        for (key, change) in timeline.commands() {
            let command = || Command { key: *key, change: change.clone() };
            match gone.remove(key) {
                Some(known) if is_same(&known, change) => {}
                Some(_) => orders.push(Order::Replace(command())),
                None => orders.push(Order::Submit(command())),
            }
        }
        // First what is gone: a body may be added by the name of one that is not after all.
        for key in gone.into_keys() {
            self.known.remove(&key);
            self.order(&Order::Retract(key));
        }
        for order in orders {
            self.order(&order);
            if let Order::Submit(Command { key, change }) | Order::Replace(Command { key, change }) = order {
                self.known.insert(key, change);
            }
        }
    }

    fn order(&mut self, order: &Order) {
        self.record(|encoder, bytes| encoder.order(order, bytes));
    }

    fn mark(&mut self, timeline: &Timeline) {
        let mark = Mark::of(timeline);
        self.marked = Some(mark.display);
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

fn known(timeline: &Timeline) -> BTreeMap<CommandKey, Change> {
    timeline.commands().map(|(key, change)| (*key, change.clone())).collect()
}

/// Whether a command says the same as before. Large shapes are compared by where they are: comparing meshes would take long.
fn is_same(a: &Change, b: &Change) -> bool {
    let (Change::Add { body, def }, Change::Add { body: other_body, def: other }) = (a, b) else {
        return a == b;
    };
    let same_shape = match (&def.shape, &other.shape) {
        (Shape::Mesh(a), Shape::Mesh(b)) => Arc::ptr_eq(a, b),
        (Shape::Hull(a), Shape::Hull(b)) => Arc::ptr_eq(a, b),
        (Shape::Compound(a), Shape::Compound(b)) => Arc::ptr_eq(a, b),
        (a, b) => a == b,
    };
    let without = |def: &crate::BodyDef| crate::BodyDef { shape: Shape::HalfSpace, ..def.clone() };
    same_shape && body == other_body && without(def) == without(other)
}
