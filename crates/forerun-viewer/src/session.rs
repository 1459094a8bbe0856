//! Session: the scene that is open, from the choice in a menu to its end.

mod play;
mod selection;

pub use play::Play;
pub use selection::Selection;

use crate::host::{Host, SceneSource, Starting};

/// What stands where the scene is to be.
#[derive(Debug)]
pub enum Stage {
    /// It is being read.
    Loading(Starting),
    /// It plays.
    Playing(Box<Play>),
    /// It cannot be played: why, and what to do.
    Failed(String),
}

/// The open scene.
#[derive(Debug)]
pub struct Session {
    /// Where the scene comes from.
    pub source: SceneSource,
    /// How far it is.
    pub stage: Stage,
    /// How many scenes were opened so far: who keeps something of a scene keeps this number with it.
    pub opened: u64,
    host: Host,
}

impl Session {
    /// Begins to open a scene.
    #[must_use]
    pub fn new(host: Host, source: SceneSource) -> Session {
        let stage = Stage::Loading(host.start(&source));
        Session { source, stage, opened: 1, host }
    }

    /// Opens another scene. The one before ends.
    pub fn open(&mut self, source: SceneSource) {
        self.stage = Stage::Loading(self.host.start(&source));
        self.source = source;
        self.opened += 1;
    }

    /// Reads the scene again, from its start.
    pub fn reload(&mut self) {
        self.open(self.source.clone());
    }

    /// Takes what is there by now and shows it at the window's clock (seconds).
    pub fn show(&mut self, real_s: f64) {
        if let Stage::Loading(starting) = &mut self.stage
            && let Some(started) = starting.poll()
        {
            self.stage = match started {
                Ok(started) => Stage::Playing(Box::new(Play::of(started))),
                Err(message) => Stage::Failed(message),
            };
        }
        if let Stage::Playing(play) = &mut self.stage
            && let Err(message) = play.show(real_s)
        {
            self.stage = Stage::Failed(message);
        }
    }

    /// The scene, when it plays.
    #[must_use]
    pub fn play(&self) -> Option<&Play> {
        match &self.stage {
            Stage::Playing(play) => Some(play),
            _ => None,
        }
    }

    /// The scene, when it plays.
    pub fn play_mut(&mut self) -> Option<&mut Play> {
        match &mut self.stage {
            Stage::Playing(play) => Some(play),
            _ => None,
        }
    }
}
