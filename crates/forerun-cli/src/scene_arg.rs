//! Scene argument: a built-in name or a file, opened with an error that names both ways out.

use forerun::{Scene, StagingError};

use crate::failure::Failure;

/// Opens what was typed as SCENE.
pub(crate) fn open(typed: &str) -> Result<Scene, Failure> {
    Scene::open(typed).map_err(|error| Failure::Input(error.to_string()))
}

impl From<StagingError> for Failure {
    fn from(error: StagingError) -> Self {
        Failure::Input(error.to_string())
    }
}

impl From<forerun::PlaybackError> for Failure {
    fn from(error: forerun::PlaybackError) -> Self {
        Failure::Input(error.to_string())
    }
}
