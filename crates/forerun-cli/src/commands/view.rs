//! View: the interactive viewer.

use forerun::Scene;
use forerun::scene::MeshBaking;
use forerun_viewer::host::Host;
use forerun_viewer::{NoWindow, SceneSource, Screenshot, WindowOptions};

use crate::args::ViewArgs;
use crate::cache;
use crate::failure::Failure;

/// The scene that is open when none is named.
const FIRST_SCENE: &str = "dominoes";

/// `forerun view`.
pub(crate) fn run(args: &ViewArgs) -> Result<(), Failure> {
    let named = args.scene.as_deref().unwrap_or(FIRST_SCENE);
    // A mistake in the name or the file is told here and not in a window.
    Scene::open(named)?;
    open(args, named).map_err(|error| Failure::Input(format!("{error}; `forerun render` draws without one")))
}

/// Opens the window; on the first scene when none is named.
pub(crate) fn open_first() -> Result<(), NoWindow> {
    open(&ViewArgs::default(), FIRST_SCENE)
}

fn open(args: &ViewArgs, scene: &str) -> Result<(), NoWindow> {
    forerun_viewer::open(WindowOptions {
        source: SceneSource::of(scene),
        host: Host::new(MeshBaking { cache: cache::of_meshes(), watch: None }),
        size: args.size,
        report: args.report.clone(),
        time_s: args.time,
        paused: args.paused,
        screenshot: args.screenshot.clone().map(|path| Screenshot { path, after_s: args.after }),
    })
}
