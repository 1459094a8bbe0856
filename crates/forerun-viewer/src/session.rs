//! Session: the scene that is open, from the choice in a menu to its end.

mod acts;
mod coupling;
mod editing;
mod history;
mod play;
mod questions;
mod selection;

use std::time::Duration;

pub use acts::Last;
pub use history::{History, Step};
pub use play::Play;
pub use selection::Selection;

use crate::host::{Host, SceneSource, Starting};
use crate::news::News;
use crate::report::StripPlace;

/// The slowest that physics is made on purpose. Seconds a step.
pub const SLOW_DOWN_MAX_S: f32 = 1.0;

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
    /// Another scene that is being read while this one still plays.
    coming: Option<(SceneSource, Starting)>,
    /// Why the scene that was asked for last did not come, and which it was.
    pub refused: News<(SceneSource, String)>,
    /// How much slower every step of the physics is made, to see what a slow scene does. Seconds, 0 to 1.
    pub slow_down_s: f32,
    /// Where the timeline strip was drawn last, for scripts.
    pub strip: Option<StripPlace>,
    host: Host,
}

impl Session {
    /// Begins to open a scene.
    #[must_use]
    pub fn new(host: Host, source: SceneSource) -> Session {
        let stage = Stage::Loading(host.start(&source));
        Session {
            source,
            stage,
            opened: 1,
            coming: None,
            refused: News::default(),
            slow_down_s: 0.0,
            strip: None,
            host,
        }
    }

    /// Opens another scene. The one before goes on until this one is there, and stays if it cannot be played.
    pub fn open(&mut self, source: SceneSource) {
        self.refused.forget();
        let starting = self.host.start(&source);
        if matches!(self.stage, Stage::Playing(_)) {
            self.coming = Some((source, starting));
        } else {
            self.stage = Stage::Loading(starting);
            self.source = source;
            self.opened += 1;
        }
    }

    /// The scene that is being read while another one still plays.
    #[must_use]
    pub fn coming(&self) -> Option<&SceneSource> {
        self.coming.as_ref().map(|(source, _)| source)
    }

    fn take_coming(&mut self) {
        let Some((_, starting)) = &mut self.coming else { return };
        let Some(started) = starting.poll() else { return };
        let Some((source, _)) = self.coming.take() else { return };
        match started {
            Ok(started) => {
                let playing = Stage::Playing(Box::new(Play::of(started)));
                if let Stage::Playing(play) = std::mem::replace(&mut self.stage, playing) {
                    self.host.end(play.driver);
                }
                self.source = source;
                self.opened += 1;
            }
            Err(message) => self.refused.tell((source, message)),
        }
    }

    /// Reads the scene again, from its start.
    pub fn reload(&mut self) {
        self.open(self.source.clone());
    }

    /// Takes what is there by now and shows it at the window's clock (seconds).
    pub fn show(&mut self, real_s: f64) {
        self.take_coming();
        if let Stage::Loading(starting) = &mut self.stage
            && let Some(started) = starting.poll()
        {
            self.stage = match started {
                Ok(started) => Stage::Playing(Box::new(Play::of(started))),
                Err(message) => Stage::Failed(message),
            };
        }
        let slow_down_s = self.slow_down_s.clamp(0.0, SLOW_DOWN_MAX_S);
        self.host.slow_down(slow_down_s);
        if let Stage::Playing(play) = &mut self.stage {
            play.slow_coupled(Duration::from_secs_f32(slow_down_s));
            if let Err(message) = play.show(real_s) {
                let before = std::mem::replace(&mut self.stage, Stage::Failed(message));
                if let Stage::Playing(play) = before {
                    // Nobody waits for the step that physics may be in.
                    self.host.end(play.driver);
                }
            }
        }
    }

    /// From the driver that runs ahead to the traditional one, or back. What is shown goes on from where it is.
    pub fn switch_driver(&mut self) {
        let Stage::Playing(play) = &mut self.stage else { return };
        let switched = match play.is_coupled() {
            true => play
                .decouple(&self.host)
                .map(|before| before.into_iter().for_each(|before| self.host.end(before))),
            false => play.couple(&self.host),
        };
        if let Err(message) = switched {
            play.notice.tell(message);
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
