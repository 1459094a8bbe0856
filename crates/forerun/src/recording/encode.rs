//! Encode: from a recording to the records of a file.

use std::path::Path;

use forerun_timeline::Order;
use forerun_timeline::parts::TimelineParts;

use super::error::RecordingError;
use super::file::{Record, Writer, replace_file};
use super::large_shapes::StoredShapes;
use super::orders::ToFile;
use super::start::start_value;
use super::states::LastStates;
use super::{Event, Mark, Recording};

/// Names of one record.
const NAMES_AT_A_TIME: usize = 256;

/// Writes records, each after the shapes that it refers to.
#[derive(Debug)]
pub(super) struct Encoder {
    writer: Writer,
    shapes: StoredShapes,
}

impl Encoder {
    /// Begins a file in `out`, with a timeline.
    pub(super) fn begin(start: &TimelineParts, out: &mut Vec<u8>) -> Result<Encoder, RecordingError> {
        let mut encoder = Encoder { writer: Writer::begin(out), shapes: StoredShapes::default() };
        encoder.start(start, out)?;
        Ok(encoder)
    }

    /// A timeline: the first, or another one.
    pub(super) fn start(&mut self, start: &TimelineParts, out: &mut Vec<u8>) -> Result<(), RecordingError> {
        self.writer.add(&Record::Start(start_value(start)), out)?;
        for names in start.names.chunks(NAMES_AT_A_TIME) {
            self.add(out, |to| Record::Names(names.iter().map(|name| to.name(name)).collect()))?;
        }
        for command in &start.commands {
            self.add(out, |to| Record::Command(to.command(command)))?;
        }
        for order in &start.undo {
            self.add(out, |to| Record::Undo(to.order(order)))?;
        }
        for order in &start.redo {
            self.add(out, |to| Record::Redo(to.order(order)))?;
        }
        let first = start.names.iter().map(|name| name.body.map(|body| body.state));
        let mut last = LastStates::new(first);
        for entries in &start.frames {
            self.writer.add(&Record::Frame(last.encode(entries)), out)?;
        }
        Ok(())
    }

    pub(super) fn order(&mut self, order: &Order, out: &mut Vec<u8>) -> Result<(), RecordingError> {
        self.add(out, |to| Record::Order(to.order(order)))
    }

    pub(super) fn mark(&mut self, mark: &Mark, out: &mut Vec<u8>) -> Result<(), RecordingError> {
        let Mark { display, oldest, frame, hash } = *mark;
        self.writer.add(&Record::Mark { display: display.0, oldest: oldest.0, frame: frame.0, hash }, out)
    }

    pub(super) fn end(self, out: &mut Vec<u8>) -> Result<(), RecordingError> {
        self.writer.end(out)
    }

    /// Adds a record, after the shapes that it needs and that are not stored yet.
    fn add(
        &mut self,
        out: &mut Vec<u8>,
        record: impl FnOnce(&mut ToFile) -> Record,
    ) -> Result<(), RecordingError> {
        let mut new = Vec::new();
        let record = record(&mut ToFile { stored: &mut self.shapes, new: &mut new });
        for shape in new {
            self.writer.add(&Record::Shape(shape), out)?;
        }
        self.writer.add(&record, out)
    }
}

impl Recording {
    /// The bytes of a file.
    ///
    /// # Errors
    /// When a single record would have more than 4 GiB.
    pub fn encode(&self) -> Result<Vec<u8>, RecordingError> {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::begin(&self.start, &mut bytes)?;
        for event in &self.events {
            match event {
                Event::Order(order) => encoder.order(order, &mut bytes)?,
                Event::Mark(mark) => encoder.mark(mark, &mut bytes)?,
                Event::Restart(parts) => encoder.start(parts, &mut bytes)?,
            }
        }
        encoder.end(&mut bytes)?;
        Ok(bytes)
    }

    /// Writes a file. What was at `path` is replaced once all is written.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), RecordingError> {
        let path = path.as_ref();
        let bytes = self.encode().map_err(|error| error.in_file(path))?;
        replace_file(path, &bytes).map(drop).map_err(|error| RecordingError::io(path, &error))
    }
}
