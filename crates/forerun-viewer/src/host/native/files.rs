//! Files of the desktop: settings, pictures, the dialog that chooses a scene, and the watch over the one that is open.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, channel, sync_channel};
use std::sync::{Arc, Weak};
use std::time::Duration;

use etcetera::BaseStrategy;

use super::super::SceneSource;

/// Where settings are kept instead of in the platform's folder; empty: nowhere.
const CONFIG_DIR: &str = "FORERUN_CONFIG_DIR";
const SETTINGS_FILE: &str = "viewer.json";
/// How often the open file is looked at.
const LOOK_EVERY: Duration = Duration::from_millis(500);

/// The settings as they were kept; none where there are none to be read.
#[must_use]
pub fn load_settings() -> Option<String> {
    std::fs::read_to_string(config_folder()?.join(SETTINGS_FILE)).ok()
}

/// Keeps the settings. A folder that cannot be written to keeps none, and that is all.
pub fn save_settings(text: &str) {
    let Some(folder) = config_folder() else { return };
    let part = folder.join(format!("{SETTINGS_FILE}.{}", std::process::id()));
    // Whole or not at all: another viewer may be reading.
    let kept = std::fs::create_dir_all(&folder)
        .and_then(|()| std::fs::write(&part, text))
        .and_then(|()| std::fs::rename(&part, folder.join(SETTINGS_FILE)));
    if kept.is_err() {
        let _ = std::fs::remove_file(part);
    }
}

fn config_folder() -> Option<PathBuf> {
    match std::env::var_os(CONFIG_DIR) {
        Some(folder) if folder.is_empty() => None,
        Some(folder) => Some(PathBuf::from(folder)),
        None => Some(etcetera::choose_base_strategy().ok()?.config_dir().join("forerun")),
    }
}

/// Writes a file into the folder that the viewer was started in, under a name that is free: `name.png`, else `name-2.png` and so on. Where it
/// went.
///
/// # Errors
/// When the folder cannot be written to.
pub(super) fn save_file(name: &str, content: &[u8]) -> Result<String, String> {
    let (stem, ending) = name.rsplit_once('.').unwrap_or((name, ""));
    let (path, mut file) = new_file(stem, ending)?;
    file.write_all(content)
        .map(|()| path.display().to_string())
        .map_err(|error| format!("cannot write {}: {error}", path.display()))
}

/// Makes a file in the folder that the viewer was started in, under a name that is free. The ending is without its point.
///
/// # Errors
/// When the folder cannot be written to.
pub(super) fn new_file(stem: &str, ending: &str) -> Result<(PathBuf, File), String> {
    make_new(stem, &format!(".{ending}"), |path| File::create_new(path))
}

/// Makes a folder in the one that the viewer was started in, under a name that is free.
///
/// # Errors
/// When the folder cannot be written to.
pub(super) fn new_folder(stem: &str) -> Result<PathBuf, String> {
    make_new(stem, "", |path| std::fs::create_dir(path)).map(|(path, ())| path)
}

/// Makes what does not exist yet: to look first for a name that is free would let two take the same.
fn make_new<T>(
    stem: &str,
    ending: &str,
    make: impl Fn(&Path) -> io::Result<T>,
) -> Result<(PathBuf, T), String> {
    let folder = std::env::current_dir().unwrap_or_default();
    // There are more numbers than files.
    let mut number = 1_u64;
    loop {
        let name = if number == 1 { format!("{stem}{ending}") } else { format!("{stem}-{number}{ending}") };
        let path = folder.join(name);
        match make(&path) {
            Ok(made) => return Ok((path, made)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
            Err(error) => return Err(format!("cannot make {}: {error}", path.display())),
        }
    }
}

/// A dialog that is open, in a thread of its own.
#[derive(Debug)]
pub struct Choosing {
    chosen: Receiver<Option<PathBuf>>,
}

/// Asks the user for a scene file by the desktop's dialog.
#[must_use]
pub fn choose_scene() -> Choosing {
    let (sender, chosen) = channel();
    std::thread::spawn(move || {
        let dialog = rfd::FileDialog::new().set_title("Open a scene").add_filter("Scenes", &["toml", "json"]);
        // When nobody waits for it any more, the viewer has ended.
        let _ = sender.send(dialog.pick_file());
    });
    Choosing { chosen }
}

impl Choosing {
    /// What the user chose, once he has: none when he chose nothing, or the desktop has no dialogs.
    pub fn poll(&mut self) -> Option<Option<SceneSource>> {
        match self.chosen.try_recv() {
            Ok(chosen) => Some(chosen.map(SceneSource::File)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(None),
        }
    }
}

/// Looks at a file every half second, from a thread of its own: disks may be slow.
#[derive(Debug)]
pub struct Watch {
    source: SceneSource,
    changes: Receiver<()>,
    /// Who watches holds it; the thread ends when it is gone.
    _alive: Arc<()>,
}

/// Watches the file of a scene; none when it is not from a file.
#[must_use]
pub fn watch(source: &SceneSource) -> Option<Watch> {
    let SceneSource::File(path) = source else { return None };
    let (sender, changes) = sync_channel(1);
    let path = path.clone();
    let alive = Arc::new(());
    let watched = Arc::downgrade(&alive);
    std::thread::spawn(move || look(&path, &watched, &sender));
    Some(Watch { source: source.clone(), changes, _alive: alive })
}

impl Watch {
    /// What is watched.
    #[must_use]
    pub fn source(&self) -> &SceneSource {
        &self.source
    }

    /// Whether the file has changed since it was asked last.
    pub fn changed(&mut self) -> bool {
        self.changes.try_recv().is_ok()
    }
}

/// Tells of changes until nobody watches.
fn look(path: &Path, watched: &Weak<()>, changes: &SyncSender<()>) {
    let stamp = || std::fs::metadata(path).and_then(|data| Ok((data.modified()?, data.len()))).ok();
    let mut known = stamp();
    while watched.strong_count() > 0 {
        std::thread::sleep(LOOK_EVERY);
        let now = stamp();
        // While it is being replaced there may be none; that is no change worth telling.
        if now.is_some() && now != known {
            known = now;
            // One that was not taken yet tells this one too.
            let _ = changes.try_send(());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_written_under_a_name_that_is_free() {
        let name = format!("forerun-free-name-{}.txt", std::process::id());
        let first = save_file(&name, b"1").expect("the folder of tests can be written to");
        let second = save_file(&name, b"2").expect("the folder of tests can be written to");
        assert_ne!(first, second);
        assert_eq!(std::fs::read(&first).ok().as_deref(), Some(&b"1"[..]));
        assert!(second.ends_with("-2.txt"), "{second}");
        for file in [first, second] {
            std::fs::remove_file(file).expect("it was written just now");
        }
    }

    #[test]
    fn many_who_save_at_once_get_a_name_each() {
        let stem = format!("forerun-race-{}", std::process::id());
        let save = |number: usize| save_file(&format!("{stem}.txt"), &[number as u8]);
        let saved: Vec<(usize, String)> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..16).map(|number| scope.spawn(move || (number, save(number)))).collect();
            let saved = threads.into_iter().map(|thread| thread.join().expect("it does not panic"));
            saved.map(|(number, path)| (number, path.expect("it can be written"))).collect()
        });
        for (number, path) in saved {
            assert_eq!(std::fs::read(&path).expect("it is there"), [number as u8]);
            std::fs::remove_file(path).expect("it was written just now");
        }
    }

    #[test]
    fn a_change_of_the_watched_file_is_told_once() {
        let path = std::env::temp_dir().join(format!("forerun-watch-{}.toml", std::process::id()));
        std::fs::write(&path, "a").expect("temporary files can be written");
        let mut watch = watch(&SceneSource::File(path.clone())).expect("it is a file");
        std::thread::sleep(LOOK_EVERY / 2);
        assert!(!watch.changed());
        std::fs::write(&path, "another length").expect("temporary files can be written");
        let told = (0..40).any(|_| {
            std::thread::sleep(LOOK_EVERY / 5);
            watch.changed()
        });
        assert!(told);
        std::thread::sleep(2 * LOOK_EVERY);
        assert!(!watch.changed());
        std::fs::remove_file(path).expect("it was written just now");
    }
}
