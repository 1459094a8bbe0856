//! Cache: the folder in which baked meshes are kept from run to run.

use std::path::PathBuf;

use etcetera::base_strategy::{BaseStrategy as _, choose_native_strategy};
use forerun::scene::MeshCache;

/// Names the folder; empty for none.
const VARIABLE: &str = "FORERUN_CACHE_DIR";

/// The cache of this user: in the folder that the environment names, else where the platform keeps such things. None where it does not say.
pub(crate) fn of_meshes() -> Option<MeshCache> {
    let folder = match std::env::var_os(VARIABLE) {
        Some(folder) if folder.is_empty() => return None,
        Some(folder) => PathBuf::from(folder),
        None => choose_native_strategy().ok()?.cache_dir().join("forerun"),
    };
    Some(MeshCache::in_folder(folder.join("meshes")))
}
