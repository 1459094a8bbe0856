//! The desktop: physics in a thread, scenes and settings in files.

use std::sync::mpsc::{Receiver, TryRecvError, channel};

use forerun::scene::MeshBaking;
use forerun::{Decoupled, DecoupledSettings, Scene, Threads, TimelineSettings, timeline_of};

use super::{SceneSource, Started};

/// States of the past that may be gone back to. Frames: ten minutes of them.
const PAST_FRAMES: u32 = 36_000;

/// The machine that the viewer runs on.
#[derive(Debug, Default)]
pub struct Host {
    /// How meshes are baked: where fields are kept.
    pub baking: MeshBaking,
}

/// A scene that is being read, its meshes baked, and its physics started, in a thread of its own.
#[derive(Debug)]
pub struct Starting {
    started: Receiver<Result<Started, String>>,
}

/// The way to the physics: there is none, as the two share memory.
#[derive(Debug)]
pub struct Link;

impl Link {
    /// Carries what was said on both sides since the last call: nothing here.
    ///
    /// # Errors
    /// None here.
    pub fn carry(&mut self) -> Result<(), String> {
        Ok(())
    }
}

impl Host {
    /// Begins to start a scene.
    #[must_use]
    pub fn start(&self, source: &SceneSource) -> Starting {
        let (sender, started) = channel();
        let (source, baking) = (source.clone(), self.baking.clone());
        // When nobody waits for it any more, another scene was chosen.
        std::thread::spawn(move || drop(sender.send(start(&source, baking))));
        Starting { started }
    }
}

impl Starting {
    /// The scene, once its physics runs; or why it cannot.
    pub fn poll(&mut self) -> Option<Result<Started, String>> {
        match self.started.try_recv() {
            Ok(started) => Some(started),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err("the scene could not be read: its thread ended early".to_owned()))
            }
        }
    }
}

fn start(source: &SceneSource, baking: MeshBaking) -> Result<Started, String> {
    let mut scene = match source {
        SceneSource::BuiltIn(name) => Scene::open(name),
        SceneSource::File(path) => Scene::load(path),
        SceneSource::Text { name, text, format } => Scene::parse(text, *format, name),
    }
    .map_err(|error| error.to_string())?;
    scene.baking = baking;
    let settings =
        TimelineSettings { past: PAST_FRAMES, record_contacts: true, ..TimelineSettings::default() };
    let timeline = timeline_of(&scene, settings).map_err(|error| error.to_string())?;
    let threads = Threads::all().map_err(|error| error.to_string())?;
    let settings = DecoupledSettings { count_areas: true, ..DecoupledSettings::new(threads) };
    let driver = Decoupled::start(timeline, settings).map_err(|error| error.to_string())?;
    Ok(Started { scene, driver, link: Link })
}
