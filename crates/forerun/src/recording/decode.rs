//! Decode: from the records of a file to a recording, or to as much of one as can be read.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use forerun_geometry::Shape;
use forerun_timeline::Frame;
use forerun_timeline::parts::{FRAME_MAX, TimelineParts};

use super::error::{RecordingError, RecordingFault};
use super::file::{Reader, Record};
use super::large_shapes::large_shape_of;
use super::orders::{command_of, order_of};
use super::start::{name_of, start_of};
use super::states::LastStates;
use super::{Event, Mark, Recording, mark_reach};

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
    match decoder.end(lost.is_none()) {
        Some(recording) => Ok(Recovered { recording, lost }),
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
    /// The first timeline, once something follows it.
    start: Option<TimelineParts>,
    events: Vec<Event>,
    /// Of the timeline that was read last.
    mark_reach: u64,
    /// The timeline that is being read.
    building: Option<TimelineParts>,
    /// How many names it is to have.
    names: usize,
    /// The last of its states.
    last: Option<LastStates>,
}

impl Decoder {
    /// Takes the next record.
    fn take(&mut self, record: Record) -> Result<(), String> {
        match record {
            Record::Start(value) => {
                if self.building.as_ref().is_some_and(|building| building.names.len() != self.names) {
                    return Err("begins again before it is complete".to_owned());
                }
                self.complete();
                self.names = value.names as usize;
                self.building = Some(start_of(value));
                (self.part, self.last) = (Part::Start, None);
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
                self.event(Event::Order(order))?;
            }
            Record::Mark { display, oldest, frame, hash } => {
                let (display, oldest, frame) = (Frame(display), Frame(oldest), Frame(frame));
                self.event(Event::Mark(Mark { display, oldest, frame, hash }))?;
            }
            Record::End { .. } => {}
        }
        Ok(())
    }

    /// The timeline that is being read, where a record of this part may stand here: parts do not come back, and the names are
    /// complete before the rest.
    fn at(&mut self, part: Part) -> Result<&mut TimelineParts, String> {
        let building = self.building.as_mut().ok_or("there is no start before it")?;
        if part < self.part || (part > Part::Names && building.names.len() != self.names) {
            return Err(format!("a record of {part:?} is out of place"));
        }
        self.part = part;
        Ok(building)
    }

    fn event(&mut self, event: Event) -> Result<(), String> {
        if self.building.is_some() {
            self.at(Part::Events)?;
            self.complete();
        }
        if self.start.is_none() {
            return Err("there is no start before it".to_owned());
        }
        if let Event::Mark(mark) = &event {
            self.check_mark(mark)?;
        }
        self.events.push(event);
        Ok(())
    }

    /// Whether a session can have come to a mark: a replay computes up to there.
    fn check_mark(&self, mark: &Mark) -> Result<(), String> {
        let shown = mark.display.max(mark.oldest);
        if shown.0 > FRAME_MAX {
            return Err(format!("a mark where {shown} is shown, of at most {FRAME_MAX}"));
        }
        let most = shown.plus(self.mark_reach);
        if mark.frame > most {
            return Err(format!("a mark of {}, where {most} is the last there can be", mark.frame));
        }
        Ok(())
    }

    /// The timeline that is being read is complete, if it has all its names.
    fn complete(&mut self) {
        let Some(built) = self.building.take().filter(|building| building.names.len() == self.names) else {
            return;
        };
        self.mark_reach = mark_reach(&built.settings);
        if self.start.is_none() {
            self.start = Some(built);
        } else {
            self.events.push(Event::Restart(Box::new(built)));
        }
    }

    /// All that was read. Of a file that is cut in its first timeline that is what there is of it; another one that is cut does not count.
    fn end(mut self, whole: bool) -> Option<Recording> {
        if whole || self.start.is_none() {
            self.complete();
        }
        Some(Recording { start: self.start?, events: self.events })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Change, Scene, TimelineSettings, Vec3, timeline_of};
    use forerun_timeline::check::{Random, random_change};
    use forerun_timeline::parts::Keep;
    use forerun_timeline::{Order, Progress};

    /// A saved timeline with all kinds of shapes, commands and states.
    fn file(scene: &str) -> Vec<u8> {
        let settings = TimelineSettings { lookahead: 8, past: 4, ..TimelineSettings::default() };
        let mut timeline = timeline_of(&Scene::open(scene).unwrap(), settings).unwrap();
        let mut random = Random::new(3);
        for frame in 1..40 {
            let change = random_change(&mut timeline, Frame(frame), &mut random);
            let _ = timeline.change(Frame(frame), change);
            let _ = timeline.change(Frame(frame), Change::SetGravity { gravity: Vec3::Y * -9.0 });
            if frame % 5 == 0 {
                let _ = timeline.obey(Order::Undo);
            }
            timeline.set_display(Frame(frame));
            while timeline.advance() != Progress::Idle {}
        }
        Recording::of(&timeline, Keep::States).encode().unwrap()
    }

    /// The contents of the records of a file.
    fn contents(mut bytes: &[u8]) -> Vec<Vec<u8>> {
        let mut contents = Vec::new();
        bytes = &bytes[12..];
        while let Some((length, rest)) = bytes.split_first_chunk() {
            let (content, rest) = rest.split_at(u32::from_le_bytes(*length) as usize);
            contents.push(content.to_vec());
            bytes = &rest[4..];
        }
        contents
    }

    /// A file of these contents, with checksums that are right.
    fn sealed(head: &[u8], contents: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = head.to_vec();
        let mut checksum = crc32fast::hash(head);
        for content in contents {
            let length = (content.len() as u32).to_le_bytes();
            let mut hasher = crc32fast::Hasher::new_with_initial(checksum);
            hasher.update(&length);
            hasher.update(content);
            checksum = hasher.finalize();
            bytes.extend(length);
            bytes.extend(content);
            bytes.extend(checksum.to_le_bytes());
        }
        bytes
    }

    /// What somebody wrote who knows the format and wishes us ill: nothing panics, and no number that is not finite gets into a state.
    #[test]
    fn files_that_were_made_up_do_no_harm() {
        let mut random = Random::new(8);
        let (mut read, mut made) = (0, 0);
        // Meshes take their time: their distance fields are baked again.
        for (scene, times) in [("dominoes:3", 500), ("meshes:1", 20), ("rain:6", 500)] {
            let bytes = file(scene);
            let good = contents(&bytes);
            assert_eq!(sealed(&bytes[..12], &good), bytes);
            for _ in 0..times {
                let mut bad = good.clone();
                for _ in 0..=random.below(3) {
                    let count = bad.len() as u64;
                    let record = &mut bad[random.below(count) as usize];
                    let at = random.below(record.len().max(1) as u64) as usize;
                    match random.below(4) {
                        0 => record.truncate(at),
                        1 => record.insert(at, random.bits() as u8),
                        _ => record[at] ^= 1 << random.below(8),
                    }
                    if record.is_empty() {
                        record.push(0);
                    }
                }
                if random.below(10) == 0 {
                    let count = good.len() as u64;
                    bad.swap(random.below(count) as usize, random.below(count) as usize);
                }
                let Ok(Recovered { recording, .. }) = Recording::decode_readable(&sealed(&bytes[..12], &bad))
                else {
                    continue;
                };
                read += 1;
                let Ok(mut timeline) = recording.timeline() else { continue };
                made += 1;
                for _ in 0..3 {
                    timeline.advance();
                }
                let last = timeline.horizon();
                for body in timeline.bodies_at(last) {
                    assert!(timeline.state(body, last).is_some_and(|state| state.is_finite()));
                }
            }
        }
        assert!(read > 300 && made > 100, "{read} read, {made} made");
    }
}
