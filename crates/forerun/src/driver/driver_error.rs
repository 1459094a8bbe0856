//! Driver error: why a driver does not start or go on.

use std::fmt;

use crate::EnvironmentError;

/// Why a driver cannot do what it is asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DriverError {
    /// A setting is out of its range.
    Setting {
        /// The field at fault.
        field: &'static str,
        /// What is wrong and what is allowed.
        message: String,
    },
    /// Gravity or a setting of the step is out of its range.
    Environment(EnvironmentError),
    /// The physics thread could not be started.
    NotStarted(String),
    /// Too many commands wait already: show a picture and try again.
    QueueFull,
    /// The physics is elsewhere, and forks cannot be had from there.
    Elsewhere,
    /// The physics thread panicked: a bug. What was published before can still be shown.
    Panicked(String),
    /// The thread that answers questions panicked: a bug. Physics and pictures go on.
    AnswersPanicked(String),
}

impl fmt::Display for DriverError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DriverError::Setting { field, message } => write!(f, "{field}: {message}"),
            DriverError::Environment(error) => write!(f, "environment: {error}"),
            DriverError::NotStarted(cause) => write!(f, "the physics thread cannot be started: {cause}"),
            DriverError::QueueFull => {
                f.write_str("the command queue is full: physics is behind; try again after the next picture")
            }
            DriverError::Elsewhere => {
                f.write_str("the physics runs elsewhere, and forks stay there: ask it for a preview instead")
            }
            DriverError::Panicked(message) => write!(f, "the physics thread panicked: {message}"),
            DriverError::AnswersPanicked(message) => {
                write!(f, "the thread that answers questions panicked: {message}")
            }
        }
    }
}

impl std::error::Error for DriverError {}
