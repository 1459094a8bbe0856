//! Baking: meshes that take long show progress, and what is odd about them is said on standard error.

use std::sync::{Arc, Mutex, PoisonError};

use forerun::Scene;
use forerun::scene::{MeshBaking, MeshWatch};
use indicatif::ProgressBar;

use crate::cache;
use crate::failure::Failure;
use crate::progress;

/// Opens a scene by its name or file; its meshes are looked for in the cache, and their warnings printed.
pub(crate) fn open_scene(name_or_path: &str) -> Result<Scene, Failure> {
    let mut scene = Scene::open(name_or_path)?;
    scene.baking =
        MeshBaking { cache: cache::of_meshes(), watch: Some(Arc::new(Watch::new(Warnings::Printed))) };
    Ok(scene)
}

/// What becomes of warnings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Warnings {
    /// They are printed at once, each once.
    Printed,
    /// They are only kept.
    Kept,
}

/// Shows a bar for the mesh that is being baked.
#[derive(Debug)]
pub(crate) struct Watch {
    warnings: Warnings,
    said: Mutex<Vec<String>>,
    bar: Mutex<Option<ProgressBar>>,
}

impl Watch {
    pub(crate) fn new(warnings: Warnings) -> Watch {
        Watch { warnings, said: Mutex::default(), bar: Mutex::default() }
    }

    /// All warnings so far.
    pub(crate) fn warnings(&self) -> Vec<String> {
        self.said.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl MeshWatch for Watch {
    fn baking(&self, name: &str, _done: usize, total: usize) {
        let mut bar = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
        let shown = bar.get_or_insert_with(|| progress::bar(total as u64, &format!("baking {name}")));
        // Each call is one more, and the largest number may not be the last to come.
        shown.inc(1);
        if shown.position() >= total as u64 {
            shown.finish_and_clear();
            *bar = None;
        }
    }

    fn warning(&self, name: &str, message: &str) {
        let warning = format!("{name}: {message}");
        let mut said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        // Meshes are made again for every use of a scene.
        if said.contains(&warning) {
            return;
        }
        if self.warnings == Warnings::Printed {
            eprintln!("forerun: warning: mesh {warning}");
        }
        said.push(warning);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_goes_with_the_last_call_and_not_with_the_largest_number() {
        let watch = Watch::new(Warnings::Kept);
        let is_shown = || watch.bar.lock().expect("no panic").is_some();
        for _ in 0..2 {
            for done in [2, 4, 1, 3] {
                watch.baking("thing", done, 4);
                assert_eq!(is_shown(), done != 3, "after {done}");
            }
        }
    }
}
