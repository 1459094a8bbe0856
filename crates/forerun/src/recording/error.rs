//! Recording error: which file, which byte, what is wrong, and what to do about it.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a recording cannot be read or written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordingError {
    /// The file; empty where the bytes came from elsewhere.
    pub file: PathBuf,
    /// Where the first record begins that cannot be read. Bytes from the start of the file.
    pub offset: u64,
    /// What is wrong.
    pub fault: RecordingFault,
}

/// What is wrong with a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecordingFault {
    /// The system cannot read or write the file.
    Io(String),
    /// It begins like no recording.
    NoRecording,
    /// It is of a version that this library does not know.
    Version(u32),
    /// It ends before it is complete.
    Cut,
    /// A record is not what was written.
    Corrupt(String),
    /// It is as it was written, and no timeline can be like that.
    Impossible(String),
}

impl RecordingError {
    pub(super) fn new(offset: u64, fault: RecordingFault) -> Self {
        RecordingError { file: PathBuf::new(), offset, fault }
    }

    pub(super) fn io(file: &Path, error: &io::Error) -> Self {
        RecordingError { file: file.to_owned(), offset: 0, fault: RecordingFault::Io(error.to_string()) }
    }

    pub(super) fn impossible(what: impl fmt::Display) -> Self {
        RecordingError::new(0, RecordingFault::Impossible(what.to_string()))
    }

    pub(super) fn in_file(mut self, file: &Path) -> Self {
        file.clone_into(&mut self.file);
        self
    }
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.file.as_os_str().is_empty() {
            write!(f, "{}: ", self.file.display())?;
        }
        let offset = self.offset;
        match &self.fault {
            RecordingFault::Io(error) => write!(f, "{error}; choose another file"),
            RecordingFault::NoRecording => {
                write!(
                    f,
                    "is no recording: it does not begin as one; give a file that `forerun run SCENE --record FILE` wrote"
                )
            }
            RecordingFault::Version(version) => write!(
                f,
                "byte {offset}: is a recording of version {version}, and this program reads version {}; use the program that wrote it",
                super::file::VERSION
            ),
            RecordingFault::Cut => write!(
                f,
                "is cut at byte {offset}: no end is recorded; `forerun replay FILE --recover OUT` saves what comes before"
            ),
            RecordingFault::Corrupt(what) => write!(
                f,
                "byte {offset}: {what}; `forerun replay FILE --recover OUT` saves what comes before"
            ),
            RecordingFault::Impossible(what) => {
                write!(f, "holds what cannot be: {what}; record it again with this program")
            }
        }
    }
}

impl std::error::Error for RecordingError {}
