//! Cache: the folder in which baked meshes are kept from run to run.

use std::path::PathBuf;

use forerun::scene::MeshCache;

/// Names the folder; empty for none.
const VARIABLE: &str = "FORERUN_CACHE_DIR";

/// The cache of this user: in the folder that the environment names, else where the platform keeps such things. None where it does not say.
pub(crate) fn of_meshes() -> Option<MeshCache> {
    let folder = match std::env::var_os(VARIABLE) {
        Some(folder) if folder.is_empty() => return None,
        Some(folder) => PathBuf::from(folder),
        None => directories::ProjectDirs::from("", "", "forerun")?.cache_dir().to_owned(),
    };
    Some(MeshCache::in_folder(folder.join("meshes")))
}
