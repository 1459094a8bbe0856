//! Failure: every error of the program, where it becomes a message and an exit code.

use std::fmt;
use std::io;
use std::path::Path;
use std::process::ExitCode;

/// Why the program ends without having done what it was asked.
#[derive(Debug)]
pub(crate) enum Failure {
    /// A check that was asked for did not hold: exit code 1.
    Check(String),
    /// Wrong usage or bad input; the message names the place and the remedy: exit code 2.
    Input(String),
    /// Nobody reads our standard output any more (`forerun … | head`): exit code 0, no message.
    OutputClosed,
}

impl Failure {
    /// A file or folder that cannot be written.
    pub(crate) fn write(path: &Path, error: &io::Error) -> Self {
        Failure::Input(format!("{}: cannot be written: {error}; choose another folder", path.display()))
    }

    /// A command that this version only knows by name.
    pub(crate) fn not_there_yet(command: &str) -> Self {
        Failure::Input(format!(
            "`forerun {command}` is not there yet in this version; `forerun run SCENE --out DIR` writes what a scene does as \
             tables and charts"
        ))
    }

    /// A chart that cannot be drawn.
    pub(crate) fn chart(path: &Path, error: &str) -> Self {
        Failure::Input(format!(
            "{}: the chart cannot be drawn: {error}; choose another folder",
            path.display()
        ))
    }

    /// A picture that cannot be drawn or written.
    pub(crate) fn picture(path: &Path, error: &str) -> Self {
        Failure::Input(format!(
            "{}: the picture cannot be written: {error}; choose another file",
            path.display()
        ))
    }

    /// The exit code that scripts rely on.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Failure::Check(_) => ExitCode::from(1),
            Failure::Input(_) => ExitCode::from(2),
            Failure::OutputClosed => ExitCode::SUCCESS,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Check(message) | Failure::Input(message) => f.write_str(message),
            Failure::OutputClosed => Ok(()),
        }
    }
}

/// All of these name their place and remedy themselves.
macro_rules! input_failure {
    ($($error:ty),*) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Failure::Input(error.to_string())
            }
        })*
    };
}

input_failure!(
    forerun::DriverError,
    forerun::geometry::mesh_file::MeshFileError,
    forerun::PlaybackError,
    forerun::RecordingError,
    forerun::SceneError,
    forerun::StagingError,
    forerun::ThreadsError
);
