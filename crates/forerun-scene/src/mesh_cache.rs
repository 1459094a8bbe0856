//! Mesh cache: baked fields in a folder, by the hash of what they were made of.
//!
//! Promise: the folder may be deleted, damaged, full, read-only or used by several programs at once. Whatever happens to it, meshes come out
//! the same; at worst they are baked again, and somebody is told.

use std::fs::{self, File};
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use forerun_geometry::shape::{Mesh, MeshDraft};

/// What takes less is baked again in less time than it would be worth to keep (some tens of milliseconds). Bytes.
const SMALLEST_KEPT: usize = 48 << 10;
/// Largest file that is read. Bytes.
const LARGEST_READ: u64 = 256 << 20;
/// When all files take more than this, the oldest go. Bytes.
const LARGEST_FOLDER: u64 = 512 << 20;
const EXTENSION: &str = "field";
/// What is being written, or was when its program was ended.
const UNFINISHED: &str = "part";
/// Nobody writes a file for longer than this.
const WRITTEN_WITHIN: Duration = Duration::from_secs(24 * 3600);

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
        let path = self.path_of(draft);
        let written = fs::create_dir_all(&self.folder).and_then(|()| write_whole(&path, &mesh.baked_bytes()));
        match written {
            Ok(()) => self.prune(&path),
            Err(error) => warn(&format!(
                "the field cannot be kept in {}: {error}; it will be baked again next time",
                self.folder.display()
            )),
        }
    }

    fn path_of(&self, draft: &MeshDraft) -> PathBuf {
        self.folder.join(draft.key().to_string()).with_extension(EXTENSION)
    }

    /// Removes what was never finished, and the oldest fields where all together are too large. What cannot be looked at or removed stays.
    ///
    /// A file is as old as it is older than `written`, which was written just now: the clock of the folder may be another machine's.
    fn prune(&self, written: &Path) {
        let now = fs::metadata(written).and_then(|about| about.modified());
        let (Ok(now), Ok(entries)) = (now, fs::read_dir(&self.folder)) else { return };
        let mut fields = Vec::new();
        for entry in entries.flatten() {
            let path = entry.path();
            let Ok(about) = entry.metadata() else { continue };
            let Ok(modified) = about.modified() else { continue };
            if path.extension().is_some_and(|extension| extension == EXTENSION) {
                fields.push((modified, path, about.len()));
            } else if path.extension().is_some_and(|extension| extension == UNFINISHED)
                && now.duration_since(modified).is_ok_and(|age| age > WRITTEN_WITHIN)
            {
                // Whoever else removes it does the same.
                let _ = fs::remove_file(path);
            }
        }
        fields.sort();
        let mut bytes: u64 = fields.iter().map(|(.., bytes)| bytes).sum();
        for (_, path, size) in fields {
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
    let unfinished = path.with_extension(format!("{}-{number}.{UNFINISHED}", std::process::id()));
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
