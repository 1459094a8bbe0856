//! Results: the files that a playback leaves behind.

use std::fs;
use std::io::{BufWriter, Write as _};
use std::path::Path;

use forerun::{Playback, write_queue_csv};

use crate::failure::Failure;
use crate::output::to_json;

/// Makes a folder and those above it.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|error| Failure::write(folder, &error))
}

/// Writes `queue.csv` and `report.json` into an existing folder.
pub(crate) fn write_playback(playback: &Playback, folder: &Path) -> Result<(), Failure> {
    let csv = folder.join("queue.csv");
    let written = fs::File::create(&csv).and_then(|file| {
        let mut out = BufWriter::new(file);
        write_queue_csv(&playback.rows, &mut out)?;
        out.flush()
    });
    written.map_err(|error| Failure::write(&csv, &error))?;
    write_text(&folder.join("report.json"), &(to_json(&playback.report) + "\n"))
}

/// Writes a text file.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    fs::write(path, text).map_err(|error| Failure::write(path, &error))
}
