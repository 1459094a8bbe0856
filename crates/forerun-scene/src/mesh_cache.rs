//! Mesh cache: baked fields in a folder, by the hash of what they were made of.
//!
//! Promise: the folder may be deleted, damaged, full, read-only or used by several programs at once. Whatever happens to it, meshes come out
//! the same; at worst they are baked again, and somebody is told.

use std::fs::{self, File};
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use forerun_geometry::shape::{Mesh, MeshDraft};

/// What takes less is baked again in less time than it would be worth to keep (some tens of milliseconds). Bytes.
const SMALLEST_KEPT: usize = 48 << 10;
/// Largest file that is read. Bytes.
const LARGEST_READ: u64 = 256 << 20;
/// When all files take more than this, the oldest go. Bytes.
const LARGEST_FOLDER: u64 = 512 << 20;
const EXTENSION: &str = "field";

/// A folder with baked fields.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshCache {
    folder: PathBuf,
}

impl MeshCache {
    /// A cache in a folder, which is made when there is something to keep.
    #[must_use]
    pub fn in_folder(folder: impl Into<PathBuf>) -> MeshCache {
        MeshCache { folder: folder.into() }
    }

    /// The mesh of a draft that was baked before.
    pub(crate) fn find(&self, draft: &MeshDraft, warn: &dyn Fn(&str)) -> Option<Mesh> {
        let path = self.path_of(draft);
        let bytes = match read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return None,
            Err(error) => {
                warn(&format!(
                    "the field kept in {} cannot be read: {error}; it is baked again",
                    path.display()
                ));
                return None;
            }
        };
        match draft.restore(&bytes) {
            Ok(mesh) => Some(mesh),
            Err(error) => {
                warn(&format!(
                    "the field kept in {} is of no use: {error}; it is baked again",
                    path.display()
                ));
                None
            }
        }
    }

    /// Keeps what was baked, if it is worth it.
    pub(crate) fn keep(&self, draft: &MeshDraft, mesh: &Mesh, warn: &dyn Fn(&str)) {
        if mesh.collider().field.as_ref().is_none_or(|field| field.bytes() < SMALLEST_KEPT) {
            return;
        }
        let written = fs::create_dir_all(&self.folder)
            .and_then(|()| write_whole(&self.path_of(draft), &mesh.baked_bytes()));
        match written {
            Ok(()) => self.prune(),
            Err(error) => warn(&format!(
                "the field cannot be kept in {}: {error}; it will be baked again next time",
                self.folder.display()
            )),
        }
    }

    fn path_of(&self, draft: &MeshDraft) -> PathBuf {
        self.folder.join(draft.key().to_string()).with_extension(EXTENSION)
    }

    /// Removes the oldest files where all together are too large. What cannot be looked at or removed stays.
    fn prune(&self) {
        let Ok(entries) = fs::read_dir(&self.folder) else { return };
        let mut files: Vec<_> = entries
            .flatten()
            .filter(|entry| entry.path().extension().is_some_and(|extension| extension == EXTENSION))
            .filter_map(|entry| {
                let about = entry.metadata().ok()?;
                Some((about.modified().ok()?, entry.path(), about.len()))
            })
            .collect();
        files.sort();
        let mut bytes: u64 = files.iter().map(|(.., bytes)| bytes).sum();
        for (_, path, size) in files {
            if bytes <= LARGEST_FOLDER {
                return;
            }
            if fs::remove_file(path).is_ok() {
                bytes -= size;
            }
        }
    }
}

fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(LARGEST_READ).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Writes a file so that nobody ever sees a part of it.
fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    // Two threads of this program may keep the same mesh.
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let unfinished = path.with_extension(format!("{}-{number}.part", std::process::id()));
    let written = File::create(&unfinished)
        .and_then(|mut file| {
            file.write_all(bytes)?;
            file.sync_all()
        })
        .and_then(|()| fs::rename(&unfinished, path));
    if written.is_err() {
        // It may not even have been made.
        let _ = fs::remove_file(&unfinished);
    }
    written
}
