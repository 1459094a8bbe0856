//! Tidy: the rules of the house that no compiler checks.

use std::fmt;
use std::io;
use std::path::Path;

use crate::{files, floors, links, map, rooms};

/// A rule that is not kept, and where.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Complaint {
    /// The file, with a line where that helps.
    pub(crate) place: String,
    /// What is wrong and what to do.
    pub(crate) message: String,
}

impl Complaint {
    pub(crate) fn new(place: impl Into<String>, message: impl Into<String>) -> Complaint {
        Complaint { place: place.into(), message: message.into() }
    }
}

impl fmt::Display for Complaint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}

/// Everything in the repository that is not as it should be.
pub(crate) fn complaints(root: &Path) -> io::Result<Vec<Complaint>> {
    let files = files::list(root)?;
    let mut complaints = files::check_sizes(&files);
    for file in files.iter().filter(|file| file.is_rust()) {
        let text = file.read(root)?;
        complaints.extend(rooms::check_marks(&file.path, &text));
        if file.is_room() {
            complaints.extend(rooms::check(&file.path, &text));
        }
    }
    for file in files.iter().filter(|file| file.is_manifest()) {
        complaints.extend(floors::check(&file.path, &file.read(root)?));
    }
    if let Some(file) = files.iter().find(|file| file.path == map::FILE) {
        complaints.extend(map::check(&file.read(root)?, &files));
    }
    for page in files.iter().filter(|file| links::PAGES.contains(&file.path.as_str())) {
        complaints.extend(links::check(&page.path, &page.read(root)?, &files));
    }
    Ok(complaints)
}
