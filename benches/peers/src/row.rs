//! Row: one engine on one scene, whatever was measured (`M`), as it stands in the tables and in the JSON.

use serde::Serialize;

use crate::engine::Kind;
use crate::measure::Task;

/// One engine on one scene.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Row<M> {
    pub(crate) scene: String,
    pub(crate) bodies: usize,
    /// That were asked for.
    pub(crate) frames: u32,
    pub(crate) threads: u16,
    pub(crate) kind: Kind,
    pub(crate) engine: String,
    #[serde(flatten)]
    pub(crate) outcome: Outcome<M>,
}

/// What came of it.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Outcome<M> {
    Measured(M),
    /// The engine cannot do the scene, and why.
    Cannot(String),
}

impl<M> Row<M> {
    pub(crate) fn new(task: Task, bodies: usize, outcome: Result<M, String>) -> Self {
        let Task { scene, kind, frames, threads } = task;
        let outcome = outcome.map_or_else(Outcome::Cannot, Outcome::Measured);
        Row { scene, bodies, frames, threads, kind, engine: kind.label(), outcome }
    }

    /// What was measured, if the engine can do the scene.
    pub(crate) fn measured(&self) -> Option<&M> {
        if let Outcome::Measured(measured) = &self.outcome { Some(measured) } else { None }
    }
}
