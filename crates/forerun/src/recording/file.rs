//! File: the bytes around the records.
//!
//! Promise: a record is believed only if its checksum, which goes on from those before it, is right. So a record that is cut, changed, left out
//! or comes from another file is noticed.

use std::io::{self, Read, Write};

use serde::{Deserialize, Serialize};

use super::error::{RecordingError, RecordingFault};
use super::large_shapes::LargeShape;
use super::orders::{CommandValue, OrderValue};
use super::start::{NameValue, StartValue};

/// What a file begins with: a byte that no text has, and the name.
const MAGIC: [u8; 8] = *b"\x89forerun";

/// The version of the format. It counts up whenever an old program could not read a new file.
pub(super) const VERSION: u32 = 2;

/// One record. The number of the variant is the first byte: new ones go to the end.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Record {
    /// Settings and frames; always the first, and again where another timeline takes the place of the one before.
    Start(StartValue),
    /// A shape that others refer to by how many of these came before it.
    Shape(LargeShape),
    /// The next names.
    Names(Vec<NameValue>),
    /// A command that was accepted before the start.
    Command(CommandValue),
    /// What takes back an order of before the start.
    Undo(OrderValue),
    /// What does again an order that was taken back before the start.
    Redo(OrderValue),
    /// The next frame: see `states`.
    Frame(#[serde(with = "bytes")] Vec<u8>),
    /// An order that was obeyed after the start.
    Order(OrderValue),
    /// A hash to compare with.
    Mark { display: u64, oldest: u64, frame: u64, hash: u64 },
    /// Nothing follows.
    End { records: u64 },
}

/// Bytes as they are, not one by one.
mod bytes {
    use serde::de::{Error, Visitor};
    use serde::{Deserializer, Serializer};
    use std::fmt;

    pub(super) fn serialize<S: Serializer>(bytes: &[u8], to: S) -> Result<S::Ok, S::Error> {
        to.serialize_bytes(bytes)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<u8>, D::Error> {
        struct Bytes;
        impl Visitor<'_> for Bytes {
            type Value = Vec<u8>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("bytes")
            }
            fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Vec<u8>, E> {
                Ok(bytes.to_vec())
            }
        }
        from.deserialize_bytes(Bytes)
    }
}

/// The checksum of everything so far.
#[derive(Clone, Copy, Debug)]
struct Checksum(u32);

impl Checksum {
    fn add(&mut self, parts: [&[u8]; 2]) -> u32 {
        let mut hasher = crc32fast::Hasher::new_with_initial(self.0);
        parts.iter().for_each(|part| hasher.update(part));
        self.0 = hasher.finalize();
        self.0
    }
}

/// Turns records into bytes.
#[derive(Debug)]
pub(super) struct Writer {
    checksum: Checksum,
    records: u64,
}

impl Writer {
    /// Begins a file in `out`.
    pub(super) fn begin(out: &mut Vec<u8>) -> Writer {
        let begin = out.len();
        out.extend(MAGIC);
        out.extend(VERSION.to_le_bytes());
        let mut checksum = Checksum(0);
        checksum.add([&out[begin..], &[]]);
        Writer { checksum, records: 0 }
    }

    /// Adds a record to `out`.
    pub(super) fn add(&mut self, record: &Record, out: &mut Vec<u8>) -> Result<(), RecordingError> {
        let content = postcard::to_stdvec(record).map_err(RecordingError::impossible)?;
        let length = u32::try_from(content.len())
            .map_err(|_| RecordingError::impossible("a record of more than 4 GiB"))?
            .to_le_bytes();
        let checksum = self.checksum.add([&length, &content]);
        out.extend(length);
        out.extend(content);
        out.extend(checksum.to_le_bytes());
        self.records += 1;
        Ok(())
    }

    /// Adds the last record.
    pub(super) fn end(mut self, out: &mut Vec<u8>) -> Result<(), RecordingError> {
        let records = self.records;
        self.add(&Record::End { records }, out)
    }
}

/// Takes records out of bytes.
pub(super) struct Reader<'a> {
    from: &'a mut dyn Read,
    checksum: Checksum,
    /// Where the record begins that is read next.
    pub(super) offset: u64,
    records: u64,
}

impl<'a> Reader<'a> {
    /// Reads what every file begins with.
    pub(super) fn begin(from: &'a mut dyn Read) -> Result<Reader<'a>, RecordingError> {
        let mut head = [0; MAGIC.len() + 4];
        let count = fill(from, &mut head).map_err(|error| fault(0, RecordingFault::Io(error.to_string())))?;
        if count < MAGIC.len() || head[..MAGIC.len()] != MAGIC {
            return Err(fault(0, RecordingFault::NoRecording));
        }
        let at = MAGIC.len() as u64;
        if count < head.len() {
            return Err(fault(at, RecordingFault::Cut));
        }
        let version = u32::from_le_bytes([head[8], head[9], head[10], head[11]]);
        if version != VERSION {
            return Err(fault(at, RecordingFault::Version(version)));
        }
        let mut checksum = Checksum(0);
        checksum.add([&head, &[]]);
        Ok(Reader { from, checksum, offset: head.len() as u64, records: 0 })
    }

    /// The next record; `None` after the last one. The offset stays where a record begins that cannot be read.
    pub(super) fn next(&mut self) -> Result<Option<Record>, RecordingError> {
        let at = self.offset;
        let system = |error: io::Error| fault(at, RecordingFault::Io(error.to_string()));
        let corrupt = |what: &str| fault(at, RecordingFault::Corrupt(what.to_owned()));
        let mut length = [0; 4];
        if fill(self.from, &mut length).map_err(system)? < length.len() {
            return Err(fault(at, RecordingFault::Cut));
        }
        // The content and four bytes; memory grows with what is there, not with what the length says.
        let wanted = u64::from(u32::from_le_bytes(length)) + 4;
        let mut content = Vec::new();
        (&mut *self.from).take(wanted).read_to_end(&mut content).map_err(system)?;
        if (content.len() as u64) < wanted {
            return Err(fault(at, RecordingFault::Cut));
        }
        let (content, checksum) = content.split_at(content.len() - 4);
        if self.checksum.add([&length, content]).to_le_bytes() != *checksum {
            return Err(corrupt("the checksum is wrong: the file was changed after it was written"));
        }
        let (record, rest) = postcard::take_from_bytes::<Record>(content)
            .map_err(|error| corrupt(&format!("is no record of version {VERSION} ({error})")))?;
        if !rest.is_empty() {
            return Err(corrupt(&format!("a record has {} bytes too many", rest.len())));
        }
        self.offset += wanted + 4;
        if let Record::End { records } = record {
            if records != self.records {
                return Err(corrupt(&format!("{} records, of {records} written", self.records)));
            }
            let mut more = [0];
            return match fill(self.from, &mut more).map_err(system)? {
                0 => Ok(None),
                _ => Err(fault(self.offset, RecordingFault::Corrupt("something follows the end".to_owned()))),
            };
        }
        self.records += 1;
        Ok(Some(record))
    }
}

fn fault(offset: u64, fault: RecordingFault) -> RecordingError {
    RecordingError::new(offset, fault)
}

/// Reads until `buffer` is full or nothing is left; how many bytes.
fn fill(from: &mut dyn Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut count = 0;
    while count < buffer.len() {
        match from.read(&mut buffer[count..]) {
            Ok(0) => break,
            Ok(read) => count += read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(count)
}

/// Writes a whole file beside `path` and then puts it in its place: what is there stays until all is written.
pub(super) fn replace_file(path: &std::path::Path, content: &[u8]) -> io::Result<std::fs::File> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let beside = path.with_file_name(format!(".{name}.{}.part", std::process::id()));
    let written = std::fs::File::create(&beside).and_then(|mut file| {
        file.write_all(content)?;
        file.sync_all()?;
        std::fs::rename(&beside, path)?;
        Ok(file)
    });
    if written.is_err() {
        // It may not even be there; the first error is the one to tell.
        let _ = std::fs::remove_file(&beside);
    }
    written
}
