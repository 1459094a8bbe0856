//! Decode: from the records of a file to a recording, or to as much of one as can be read.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use forerun_geometry::Shape;
use forerun_timeline::Frame;
use forerun_timeline::parts::TimelineParts;

use super::error::{RecordingError, RecordingFault};
use super::file::{Reader, Record};
use super::large_shapes::large_shape_of;
use super::orders::{command_of, order_of};
use super::start::{name_of, start_of};
use super::states::LastStates;
use super::{Event, Mark, Recording};

/// The readable part of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Recovered {
    /// Everything before the first record that cannot be read.
    pub recording: Recording,
    /// Where that is and what is wrong with it; `None` when the file is whole.
    pub lost: Option<RecordingError>,
}

impl Recording {
    /// Reads a whole file.
    ///
    /// # Errors
    /// When the file cannot be read, is no recording of a version that is known, is cut or corrupted: byte, fault and remedy.
    pub fn read(path: impl AsRef<Path>) -> Result<Recording, RecordingError> {
        let path = path.as_ref();
        whole(Recording::recover(path)?).map_err(|error| error.in_file(path))
    }

    /// Reads what can be read of a file.
    ///
    /// # Errors
    /// When the file cannot be read, is no recording of a version that is known, or is cut or corrupted before the bodies at the start are
    /// complete: then there is nothing to go on from.
    pub fn recover(path: impl AsRef<Path>) -> Result<Recovered, RecordingError> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|error| RecordingError::io(path, &error))?;
        let recovered = recover(&mut BufReader::new(file)).map_err(|error| error.in_file(path))?;
        Ok(Recovered { lost: recovered.lost.map(|error| error.in_file(path)), ..recovered })
    }

    /// Reads the bytes of a whole file.
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn decode(mut bytes: &[u8]) -> Result<Recording, RecordingError> {
        whole(recover(&mut bytes)?)
    }

    /// Reads what can be read of the bytes of a file.
    ///
    /// # Errors
    /// As [`Recording::recover`].
    pub fn decode_readable(mut bytes: &[u8]) -> Result<Recovered, RecordingError> {
        recover(&mut bytes)
    }
}

fn whole(recovered: Recovered) -> Result<Recording, RecordingError> {
    recovered.lost.map_or(Ok(recovered.recording), Err)
}

fn recover(from: &mut dyn Read) -> Result<Recovered, RecordingError> {
    let mut reader = Reader::begin(from)?;
    let mut decoder = Decoder::default();
    let lost = loop {
        let at = reader.offset;
        match reader.next() {
            Ok(Some(record)) => {
                if let Err(what) = decoder.take(record) {
                    break Some(RecordingError::new(at, RecordingFault::Corrupt(what)));
                }
            }
            Ok(None) => break None,
            Err(error) => break Some(error),
        }
    };
    match decoder.start.filter(|start| start.names.len() == decoder.names) {
        Some(start) => Ok(Recovered { recording: Recording { start, events: decoder.events }, lost }),
        // Whole, and without a start: nobody writes that.
        None => Err(lost.unwrap_or_else(|| {
            RecordingError::new(reader.offset, RecordingFault::Corrupt("there is no start".to_owned()))
        })),
    }
}

/// The parts of a file, in their order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    #[default]
    Start,
    Names,
    Commands,
    Undo,
    Redo,
    Frames,
    Events,
}

/// What was read so far.
#[derive(Default)]
struct Decoder {
    part: Part,
    shapes: Vec<Shape>,
    start: Option<TimelineParts>,
    /// How many names there are to be.
    names: usize,
    last: Option<LastStates>,
    events: Vec<Event>,
}

impl Decoder {
    /// Takes the next record.
    fn take(&mut self, record: Record) -> Result<(), String> {
        match record {
            Record::Start(value) => {
                self.names = value.names as usize;
                if self.start.replace(start_of(value)).is_some() {
                    return Err("begins again".to_owned());
                }
            }
            Record::Shape(shape) => self.shapes.push(large_shape_of(shape, &self.shapes)?),
            Record::Names(names) => {
                for name in names {
                    let name = name_of(name, &self.shapes)?;
                    self.at(Part::Names)?.names.push(name);
                }
                if self.at(Part::Names)?.names.len() > self.names {
                    return Err("more names than there are to be".to_owned());
                }
            }
            Record::Command(command) => {
                let command = command_of(command, &self.shapes)?;
                self.at(Part::Commands)?.commands.push(command);
            }
            Record::Undo(order) => {
                let order = order_of(order, &self.shapes)?;
                self.at(Part::Undo)?.undo.push(order);
            }
            Record::Redo(order) => {
                let order = order_of(order, &self.shapes)?;
                self.at(Part::Redo)?.redo.push(order);
            }
            Record::Frame(bytes) => self.frame(&bytes)?,
            Record::Order(order) => {
                let order = order_of(order, &self.shapes)?;
                self.at(Part::Events)?;
                self.events.push(Event::Order(order));
            }
            Record::Mark { display, oldest, frame, hash } => {
                self.at(Part::Events)?;
                let (display, oldest, frame) = (Frame(display), Frame(oldest), Frame(frame));
                self.events.push(Event::Mark(Mark { display, oldest, frame, hash }));
            }
            Record::End { .. } => {}
        }
        Ok(())
    }

    /// The start, where a record of this part may stand here: parts do not come back, and the names are complete before the rest.
    fn at(&mut self, part: Part) -> Result<&mut TimelineParts, String> {
        let start = self.start.as_mut().ok_or("there is no start before it")?;
        if part < self.part || (part > Part::Names && start.names.len() != self.names) {
            return Err(format!("a record of {part:?} is out of place"));
        }
        self.part = part;
        Ok(start)
    }

    fn frame(&mut self, bytes: &[u8]) -> Result<(), String> {
        let names = self.names;
        let start = self.at(Part::Frames)?;
        let states = start.names.iter().map(|name| name.body.map(|body| body.state));
        let states: Vec<_> = if start.frames.is_empty() { states.collect() } else { Vec::new() };
        let last = self.last.get_or_insert_with(|| LastStates::new(states.into_iter()));
        let entries = last.decode(bytes, names).ok_or("a frame that cannot be read")?;
        self.at(Part::Frames)?.frames.push(entries);
        Ok(())
    }
}
