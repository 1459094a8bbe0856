//! The web page: physics in a worker, scenes by name or by their content.

use std::cell::Cell;
use std::rc::Rc;

use forerun::recording::Recording;
use forerun::scene::mesh::MeshSource;
use forerun::{
    Clock, Courier, Decoupled, Keep, RemotePhysics, RemoteSettings, Scene, Threads, Timeline,
    TimelineSettings,
};
use wasm_bindgen::prelude::*;

use super::{SceneSource, Started};

/// States of the past that may be gone back to. Frames: a minute of them, as pages have less memory.
const PAST_FRAMES: u32 = 3600;

/// What states may take at most, in the worker and once more in the page. Bytes: a page has 4 GiB, and a phone less.
const STATES_MAX: usize = 256 << 20;

/// Orders that may wait while physics is in a step: to take back a long drag is some thousands.
const ORDERS_MAX: usize = 16_384;

#[wasm_bindgen(module = "/src/host/worker_link.js")]
extern "C" {
    #[derive(Debug)]
    type WorkerLink;

    /// A worker of this module that opens a scene by its name or its text; or that goes on from a recording.
    #[wasm_bindgen(constructor)]
    fn new(module: JsValue, name: &str, text: Option<String>, recording: Option<Vec<u8>>) -> WorkerLink;

    #[wasm_bindgen(method)]
    fn post(this: &WorkerLink, letter: Vec<u8>);

    /// Makes every frame slower, from the first number of milliseconds to the second.
    #[wasm_bindgen(method)]
    fn hinder(this: &WorkerLink, from_ms: f64, to_ms: f64);

    #[wasm_bindgen(method)]
    fn take(this: &WorkerLink) -> Option<Vec<u8>>;

    #[wasm_bindgen(method)]
    fn failure(this: &WorkerLink) -> Option<String>;

    #[wasm_bindgen(method)]
    fn end(this: &WorkerLink);
}

#[wasm_bindgen]
extern "C" {
    /// Milliseconds since some moment.
    #[wasm_bindgen(js_namespace = performance, js_name = now)]
    fn now_ms() -> f64;
}

/// How much slower every frame of the physics is made: from, to. Milliseconds.
type SlowMs = Rc<Cell<[f64; 2]>>;

/// A worker of the page; it ends with this.
#[derive(Debug)]
struct Worker {
    link: WorkerLink,
    slow_ms: SlowMs,
    /// What it was told of that.
    told_ms: [f64; 2],
}

impl Worker {
    fn open(name: &str, text: Option<String>, slow_ms: &SlowMs) -> Worker {
        Worker::of(WorkerLink::new(wasm_bindgen::module(), name, text, None), slow_ms)
    }

    fn resume(recording: Vec<u8>, slow_ms: &SlowMs) -> Worker {
        Worker::of(WorkerLink::new(wasm_bindgen::module(), "", None, Some(recording)), slow_ms)
    }

    fn of(link: WorkerLink, slow_ms: &SlowMs) -> Worker {
        let mut worker = Worker { link, slow_ms: Rc::clone(slow_ms), told_ms: [0.0; 2] };
        worker.hinder();
        worker
    }

    fn hinder(&mut self) {
        let slow_ms = self.slow_ms.get();
        if slow_ms != self.told_ms {
            self.link.hinder(slow_ms[0], slow_ms[1]);
            self.told_ms = slow_ms;
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.link.end();
    }
}

/// The page that the viewer runs in.
#[derive(Debug, Default)]
pub struct Host {
    slow_ms: SlowMs,
    /// How slow it is at least, whatever the viewer says.
    least_ms: [f64; 2],
}

/// A scene that a worker reads, and whose physics it starts.
#[derive(Debug)]
pub struct Starting {
    begun: Result<Option<(Scene, Worker)>, String>,
}

/// The way to the physics.
#[derive(Debug)]
pub struct Link {
    worker: Worker,
    courier: Courier,
}

/// How the physics of a page works, here and in the worker.
#[must_use]
pub fn remote_settings() -> RemoteSettings {
    RemoteSettings { command_capacity: ORDERS_MAX, count_areas: true, stage_clock: Some(clock()) }
}

/// How far timelines look ahead and back.
#[must_use]
pub fn timeline_settings() -> TimelineSettings {
    TimelineSettings { past: PAST_FRAMES, bytes_max: Some(STATES_MAX), ..TimelineSettings::default() }
}

fn clock() -> Clock {
    Clock::host(|| now_ms() / 1000.0)
}

impl Host {
    /// The page; every frame of the physics is made slower, from the first number of milliseconds to the second: to see that the page does not mind.
    #[must_use]
    pub fn new(slow_ms: [f64; 2]) -> Host {
        Host { slow_ms: Rc::new(Cell::new(slow_ms)), least_ms: slow_ms }
    }

    /// Begins to start a scene.
    #[must_use]
    pub fn start(&self, source: &SceneSource) -> Starting {
        Starting { begun: self.begin(source).map(Some) }
    }

    fn begin(&self, source: &SceneSource) -> Result<(Scene, Worker), String> {
        let (scene, name, text) = match source {
            SceneSource::BuiltIn(name) => (Scene::open(name), name, None),
            SceneSource::Text { name, text, format } => {
                (Scene::parse(text, *format, name), name, Some(text.clone()))
            }
            SceneSource::File(path) => {
                return Err(format!("{}: a page reads no files; drop it here", path.display()));
            }
        };
        let scene = scene.map_err(|error| error.to_string())?;
        if let Some(why) = unreachable_mesh(&scene) {
            return Err(format!("{name}: {why}"));
        }
        Ok((scene, Worker::open(name, text, &self.slow_ms)))
    }

    /// Physics goes on from a timeline, in a worker of its own.
    ///
    /// # Errors
    /// When the timeline cannot be sent.
    pub fn restart(&self, timeline: Timeline) -> Result<(Decoupled, Link), String> {
        let recording = Recording::of(&timeline, Keep::States).encode().map_err(|error| error.to_string())?;
        // The worker begins as this does, to the bit: so there is nothing to wait for.
        let twin =
            RemotePhysics::new(timeline, remote_settings()).map_err(|error| error.to_string())?.publish();
        let first = twin.ok_or("there is always a first report")?;
        let (driver, courier) = Decoupled::remote(&first).map_err(|error| error.to_string())?;
        Ok((driver, Link { worker: Worker::resume(recording, &self.slow_ms), courier }))
    }

    /// How far timelines look ahead and back.
    #[must_use]
    pub fn timeline_settings(&self) -> TimelineSettings {
        timeline_settings()
    }

    /// Makes every step that is computed from now on this much slower. Seconds.
    pub fn slow_down(&self, seconds: f32) {
        self.slow_ms.set(self.least_ms.map(|least_ms| least_ms + f64::from(seconds.max(0.0)) * 1000.0));
    }

    /// Ends a driver: its worker ends with its link.
    pub fn end(&self, driver: Decoupled) {
        drop(driver);
    }

    /// The clock of a driver that steps here.
    #[must_use]
    pub fn clock(&self) -> Clock {
        clock()
    }

    /// Threads of a driver that steps here.
    ///
    /// # Errors
    /// None here.
    pub fn threads(&self) -> Result<Threads, String> {
        Threads::all().map_err(|error| error.to_string())
    }
}

/// Why a page cannot play a scene some of whose meshes are files.
fn unreachable_mesh(scene: &Scene) -> Option<String> {
    scene.meshes.iter().find_map(|(mesh, entry)| {
        let MeshSource::File(file) = &entry.source else { return None };
        Some(format!(
            "the mesh {mesh} is in the file {file}, and a web page reads no file beside the scene; open it with `forerun view`"
        ))
    })
}

impl Starting {
    /// The scene, once its physics runs; or why it cannot.
    pub fn poll(&mut self) -> Option<Result<Started, String>> {
        let begun = match &mut self.begun {
            Ok(begun) => begun,
            Err(message) => return Some(Err(message.clone())),
        };
        let (_, worker) = begun.as_ref()?;
        if let Some(message) = worker.link.failure() {
            return Some(Err(message));
        }
        let first = worker.link.take()?;
        let (scene, worker) = begun.take()?;
        let started = Decoupled::remote(&first).map(|(driver, courier)| {
            let link = Link { worker, courier };
            Started { scene, driver, link }
        });
        Some(started.map_err(|error| error.to_string()))
    }
}

impl Link {
    /// Carries what was said on both sides since the last call.
    ///
    /// # Errors
    /// When a message is damaged or lost.
    pub fn carry(&mut self) -> Result<(), String> {
        self.worker.hinder();
        if let Some(message) = self.worker.link.failure() {
            self.courier.fail(message);
        }
        while let Some(report) = self.worker.link.take() {
            self.courier.receive(&report).map_err(|error| error.to_string())?;
        }
        for letter in self.courier.outgoing() {
            self.worker.link.post(letter);
        }
        Ok(())
    }
}
