//! The web page: physics in a worker, scenes by name or by their content.

use forerun::{Courier, Decoupled, Scene};
use wasm_bindgen::prelude::*;

use super::{SceneSource, Started};

#[wasm_bindgen(module = "/src/host/worker_link.js")]
extern "C" {
    #[derive(Debug)]
    type WorkerLink;

    #[wasm_bindgen(constructor)]
    fn new(name: &str, text: Option<String>, slow_ms: Option<Vec<f64>>) -> WorkerLink;

    #[wasm_bindgen(method)]
    fn post(this: &WorkerLink, letter: Vec<u8>);

    #[wasm_bindgen(method)]
    fn take(this: &WorkerLink) -> Option<Vec<u8>>;

    #[wasm_bindgen(method)]
    fn failure(this: &WorkerLink) -> Option<String>;

    #[wasm_bindgen(method)]
    fn end(this: &WorkerLink);
}

/// A worker of the page; it ends with this.
#[derive(Debug)]
struct Worker(WorkerLink);

impl Drop for Worker {
    fn drop(&mut self) {
        self.0.end();
    }
}

/// The page that the viewer runs in.
#[derive(Clone, Debug, Default)]
pub struct Host {
    /// How much slower every frame of the physics is made, from and to: to see that the page does not mind. Milliseconds.
    pub slow_ms: Option<[f64; 2]>,
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

impl Host {
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
        let slow_ms = self.slow_ms.map(|slow| slow.to_vec());
        Ok((scene, Worker(WorkerLink::new(name, text, slow_ms))))
    }
}

impl Starting {
    /// The scene, once its physics runs; or why it cannot.
    pub fn poll(&mut self) -> Option<Result<Started, String>> {
        let begun = match &mut self.begun {
            Ok(begun) => begun,
            Err(message) => return Some(Err(message.clone())),
        };
        let (_, worker) = begun.as_ref()?;
        if let Some(message) = worker.0.failure() {
            return Some(Err(message));
        }
        let first = worker.0.take()?;
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
        if let Some(message) = self.worker.0.failure() {
            self.courier.fail(message);
        }
        while let Some(report) = self.worker.0.take() {
            self.courier.receive(&report).map_err(|error| error.to_string())?;
        }
        for letter in self.courier.outgoing() {
            self.worker.0.post(letter);
        }
        Ok(())
    }
}
