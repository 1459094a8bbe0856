//! The files of the repository.

use std::path::Path;
use std::{fs, io};

use crate::tidy::Complaint;

/// Folders that are made, not written.
const NOT_OURS: [&str; 6] = ["target", ".git", "out", "dist", "node_modules", "pkg"];

/// Larger files do not belong into a repository of text.
const BYTES_MAX: u64 = 256 * 1024;

/// A file by its path from the root, with `/` on every platform.
#[derive(Debug)]
pub(crate) struct File {
    pub(crate) path: String,
    pub(crate) bytes: u64,
}

impl File {
    pub(crate) fn is_rust(&self) -> bool {
        self.path.ends_with(".rs")
    }

    /// Whether it is a file of a crate's sources: a room.
    pub(crate) fn is_room(&self) -> bool {
        self.is_rust() && self.path.starts_with("crates/") && self.path.contains("/src/")
    }

    pub(crate) fn is_manifest(&self) -> bool {
        self.path.ends_with("/Cargo.toml")
    }

    pub(crate) fn read(&self, root: &Path) -> io::Result<String> {
        fs::read_to_string(root.join(&self.path))
    }
}

/// All files, sorted by path.
pub(crate) fn list(root: &Path) -> io::Result<Vec<File>> {
    let mut files = Vec::new();
    let mut folders = vec![String::new()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(root.join(&folder))? {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let path = if folder.is_empty() { name.clone() } else { format!("{folder}/{name}") };
            let kind = entry.file_type()?;
            if kind.is_dir() && !NOT_OURS.contains(&name.as_str()) {
                folders.push(path);
            } else if kind.is_file() {
                files.push(File { path, bytes: entry.metadata()?.len() });
            }
        }
    }
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(files)
}

/// Complains about large files.
pub(crate) fn check_sizes(files: &[File]) -> Vec<Complaint> {
    let too_large = files.iter().filter(|file| file.bytes > BYTES_MAX);
    let complain = |file: &File| {
        let message = format!("has {} KB, at most {} KB are allowed", file.bytes / 1024, BYTES_MAX / 1024);
        Complaint::new(&file.path, message)
    };
    too_large.map(complain).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_files_are_named() {
        let file = |path: &str, bytes| File { path: path.to_owned(), bytes };
        let files = [file("small", BYTES_MAX), file("large.bin", BYTES_MAX + 1)];
        let complaints = check_sizes(&files);
        assert_eq!(complaints.len(), 1);
        assert_eq!(complaints[0].place, "large.bin");
    }

    #[test]
    fn rooms_are_the_sources_of_crates() {
        let is_room = |path: &str| File { path: path.to_owned(), bytes: 0 }.is_room();
        assert!(is_room("crates/a/src/b/c.rs"));
        assert!(!is_room("crates/a/tests/b.rs") && !is_room("xtask/src/main.rs"));
        assert!(!is_room("crates/a/src/b.txt"));
    }

    #[test]
    fn this_repository_is_listed_without_what_is_built() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let files = list(&root).unwrap();
        assert!(files.iter().any(|file| file.path == "xtask/src/files.rs"));
        assert!(!files.iter().any(|file| file.path.starts_with("target/")));
    }
}
