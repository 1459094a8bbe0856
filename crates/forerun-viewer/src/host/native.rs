//! The desktop: physics in a thread, scenes and settings in files.

mod files;
mod making;
mod pictures;

pub use files::{Choosing, Watch, choose_scene, load_settings, save_settings, watch};
pub use making::{Making, make};
pub use pictures::{FilmWriter, Saving, save_picture, save_text};

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::Duration;

use forerun::scene::MeshBaking;
use forerun::{
    Clock, Decoupled, DecoupledSettings, Hinder, Scene, Threads, Timeline, TimelineSettings, timeline_of,
};

use super::{SceneSource, Started};

/// Most that states may take; the oldest past goes first. Bytes: half a minute of 10 000 bodies that all move, an hour of most scenes.
const STATES_MAX: usize = 2 << 30;
/// States of the past that may be gone back to. Frames: ten minutes of them.
const PAST_FRAMES: u32 = 36_000;

/// Orders that may wait while physics is in a step: to take back a long drag is some thousands.
const ORDERS_MAX: usize = 16_384;

/// The machine that the viewer runs on.
#[derive(Debug, Default)]
pub struct Host {
    /// How meshes are baked: where fields are kept.
    baking: MeshBaking,
    slow_down: SlowDown,
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
    /// This machine, with fields of meshes kept as `baking` says.
    #[must_use]
    pub fn new(baking: MeshBaking) -> Host {
        Host { baking, ..Host::default() }
    }

    /// Begins to start a scene.
    #[must_use]
    pub fn start(&self, source: &SceneSource) -> Starting {
        let (sender, started) = channel();
        let (source, baking, slow_down) = (source.clone(), self.baking.clone(), self.slow_down.clone());
        // When nobody waits for it any more, another scene was chosen.
        std::thread::spawn(move || drop(sender.send(start(&source, baking, &slow_down))));
        Starting { started }
    }

    /// Physics goes on from a timeline.
    ///
    /// # Errors
    /// When the system refuses threads.
    pub fn restart(&self, timeline: Timeline) -> Result<(Decoupled, Link), String> {
        Ok((decoupled(timeline, &self.slow_down)?, Link))
    }

    /// How far timelines look ahead and back.
    #[must_use]
    pub fn timeline_settings(&self) -> TimelineSettings {
        TimelineSettings {
            past: PAST_FRAMES,
            bytes_max: Some(STATES_MAX),
            record_contacts: true,
            ..TimelineSettings::default()
        }
    }

    /// Makes every step that is computed from now on this much slower. Seconds.
    pub fn slow_down(&self, seconds: f32) {
        self.slow_down.set(Duration::from_secs_f32(seconds.max(0.0)));
    }

    /// Ends a driver. It ends with the step that it is in, for which nobody waits.
    pub fn end(&self, driver: Decoupled) {
        std::thread::spawn(move || drop(driver));
    }

    /// The clock of a driver that steps here.
    #[must_use]
    pub fn clock(&self) -> Clock {
        Clock::system()
    }

    /// Threads of a driver that steps here.
    ///
    /// # Errors
    /// When the system refuses them.
    pub fn threads(&self) -> Result<Threads, String> {
        Threads::all().map_err(|error| error.to_string())
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

/// A sleep after every computed frame, which may be set while physics runs.
#[derive(Clone, Debug, Default)]
struct SlowDown {
    micros: Arc<AtomicU64>,
}

impl SlowDown {
    fn set(&self, sleep: Duration) {
        // A number on its own: no order with other memory.
        self.micros.store(u64::try_from(sleep.as_micros()).unwrap_or(u64::MAX), Ordering::Relaxed);
    }

    fn hinder(&self) -> Hinder {
        let micros = Arc::clone(&self.micros);
        Box::new(move || {
            let sleep = micros.load(Ordering::Relaxed);
            if sleep > 0 {
                std::thread::sleep(Duration::from_micros(sleep));
            }
        })
    }
}

fn start(source: &SceneSource, baking: MeshBaking, slow_down: &SlowDown) -> Result<Started, String> {
    let mut scene = match source {
        SceneSource::BuiltIn(name) => Scene::open(name),
        SceneSource::File(path) => Scene::load(path),
        SceneSource::Text { name, text, format } => Scene::parse(text, *format, name),
    }
    .map_err(|error| error.to_string())?;
    scene.baking = baking;
    let settings = Host::default().timeline_settings();
    let timeline = timeline_of(&scene, settings).map_err(|error| error.to_string())?;
    Ok(Started { driver: decoupled(timeline, slow_down)?, scene, link: Link })
}

fn decoupled(timeline: Timeline, slow_down: &SlowDown) -> Result<Decoupled, String> {
    let threads = Threads::all().map_err(|error| error.to_string())?;
    let settings = DecoupledSettings {
        count_areas: true,
        command_capacity: ORDERS_MAX,
        stage_clock: Some(Clock::system()),
        ..DecoupledSettings::new(threads)
    };
    Decoupled::start_hindered(timeline, settings, slow_down.hinder()).map_err(|error| error.to_string())
}
