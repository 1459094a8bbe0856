//! Output: the one place that writes to standard output.

use std::io::{self, Write};

use serde::Serialize;

use crate::failure::Failure;

/// Prints a text and a line end.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    writeln!(io::stdout().lock(), "{text}").map_err(|error| match error.kind() {
        io::ErrorKind::BrokenPipe => Failure::OutputClosed,
        _ => Failure::Input(format!("standard output: cannot be written: {error}")),
    })
}

/// Prints one JSON object.
pub(crate) fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    print(&to_json(value))
}

/// A value as JSON, indented.
pub(crate) fn to_json(value: &impl Serialize) -> String {
    // Our types are plain structs of numbers and strings: they have no map with odd keys, the one thing that fails.
    serde_json::to_string_pretty(value).expect("plain structs always serialise")
}
