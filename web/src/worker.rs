//! Worker: the physics' role. JavaScript carries the messages and gives it time.

use std::path::Path;

use forerun::recording::Recording;
use forerun::scene::Format;
use forerun::timeline::Progress;
use forerun::{Frame, RemotePhysics, Scene, Timeline, TimelineSettings, timeline_of};
use forerun_viewer::host as page_host;
use wasm_bindgen::prelude::*;

use crate::{error, now_s};

/// A physics, for a display in another thread.
#[wasm_bindgen]
pub struct PhysicsWorker {
    physics: RemotePhysics,
    /// How much slower every frame is made: from, to. Seconds.
    slow_s: Option<[f64; 2]>,
    frames: u32,
}

#[wasm_bindgen]
impl PhysicsWorker {
    /// Opens a built-in scene by its name, such as `dominoes:100`; or, with a text, the scene that it describes: JSON where the name ends
    /// so, TOML otherwise.
    #[wasm_bindgen(constructor)]
    pub fn new(name: &str, text: Option<String>) -> Result<PhysicsWorker, JsError> {
        let scene = scene_of(name, text.as_deref())?;
        PhysicsWorker::of(timeline_of(&scene, page_host::timeline_settings()).map_err(error)?)
    }

    /// Goes on from a recording that a page made of a timeline. The page knows already what there is at first.
    pub fn resumed(recording: &[u8]) -> Result<PhysicsWorker, JsError> {
        let timeline = Recording::decode(recording).map_err(error)?.timeline().map_err(error)?;
        let mut worker = PhysicsWorker::of(timeline)?;
        drop(worker.publish());
        Ok(worker)
    }

    fn of(timeline: Timeline) -> Result<PhysicsWorker, JsError> {
        let physics = RemotePhysics::new(timeline, page_host::remote_settings()).map_err(error)?;
        Ok(PhysicsWorker { physics, slow_s: None, frames: 0 })
    }

    /// Makes every frame that much slower, from the first number of milliseconds to the second: to see that the page does not mind.
    pub fn hinder(&mut self, from_ms: f64, to_ms: f64) {
        self.slow_s = Some([from_ms, to_ms].map(|ms| ms.clamp(0.0, 10_000.0) / 1000.0));
    }

    /// Takes a message of the display.
    pub fn receive(&mut self, bytes: &[u8]) -> Result<(), JsError> {
        self.physics.receive(bytes).map_err(error)
    }

    /// Works for so long (milliseconds), or a little longer; whether there is more to do.
    pub fn work(&mut self, budget_ms: f64) -> bool {
        let end_s = now_s() + budget_ms / 1000.0;
        loop {
            let advanced = self.physics.turn() != Progress::Idle;
            if advanced {
                self.dawdle();
            }
            let asked = self.physics.answer(now_s());
            if !advanced && !asked {
                return false;
            }
            if now_s() >= end_s {
                return true;
            }
        }
    }

    /// Lets time pass, as a heavy frame would: a worker has no sleep.
    fn dawdle(&mut self) {
        let Some([from_s, to_s]) = self.slow_s else { return };
        // The golden ratio spreads the frames evenly over the range.
        self.frames = self.frames.wrapping_add(1);
        let part = (f64::from(self.frames) * 0.618_033_988_75).fract();
        let end_s = now_s() + from_s + part * (to_s - from_s);
        while now_s() < end_s {}
    }

    /// What is new for the display, if anything is.
    pub fn publish(&mut self) -> Option<Vec<u8>> {
        self.physics.publish()
    }
}

fn scene_of(name: &str, text: Option<&str>) -> Result<Scene, JsError> {
    let Some(text) = text else { return Scene::open(name).map_err(error) };
    let format = Format::of(Path::new(name)).unwrap_or(Format::Toml);
    Scene::parse(text, format, name).map_err(error)
}

/// The hash of all states of a built-in scene after some frames, as `forerun bench --json` tells it natively.
#[wasm_bindgen]
pub fn state_hash(scene: &str, frames: u32) -> Result<String, JsError> {
    let scene = Scene::open(scene).map_err(error)?;
    let settings = TimelineSettings { lookahead: frames.max(1), ..TimelineSettings::default() };
    let mut timeline = timeline_of(&scene, settings).map_err(error)?;
    while timeline.advance() != Progress::Idle {}
    let hash = timeline.state_hash(Frame(u64::from(frames)));
    Ok(format!("{:016x}", hash.ok_or_else(|| error("the frame is not there"))?))
}
