//! Play: a scene that runs, what is shown of it, and what the user does to it. Everything that changes it is a command.

use std::sync::Arc;

use forerun::{Aabb, Body, BodyId, Change, Decoupled, DriverError, Picture, Sample, Scene, Vec3};

use super::Selection;
use crate::host::{Link, Started};

/// How fast a rewind goes, against the clock.
const REWIND_SPEED: f64 = 1.0;

/// A scene that runs.
#[derive(Debug)]
pub struct Play {
    /// What there was at frame 0.
    pub scene: Scene,
    /// The display's handle on the physics.
    pub driver: Decoupled,
    /// The way to the physics.
    link: Link,
    /// What was shown last.
    pub picture: Picture,
    /// The bodies as they are drawn, by id.
    pub samples: Vec<(BodyId, Sample)>,
    /// What the user has picked.
    pub selection: Selection,
    /// What the last thing that was not possible was, for the user to read.
    pub notice: Option<String>,
    /// Whether display time stands still because the user asked for it.
    pub paused: bool,
    /// How fast display time is to go when it is not paused: 1 is real time.
    pub speed: f64,
    /// Whether display time runs backwards.
    pub rewinding: bool,
    /// The clock of the last picture. Seconds.
    real_s: f64,
}

impl Play {
    pub(super) fn of(started: Started) -> Play {
        let picture = started.driver.last_picture();
        Play {
            scene: started.scene,
            driver: started.driver,
            link: started.link,
            picture,
            samples: Vec::new(),
            selection: Selection::default(),
            notice: None,
            paused: false,
            speed: 1.0,
            rewinding: false,
            real_s: 0.0,
        }
    }

    /// Takes the picture for a time of the window's clock (seconds).
    pub(super) fn show(&mut self, real_s: f64) -> Result<(), String> {
        self.link.carry()?;
        if self.rewinding {
            let back = REWIND_SPEED * self.speed * (real_s - self.real_s).max(0.0);
            let asked = self.picture.time_s - back;
            let shown = self.driver.seek(asked).map_err(|error| error.to_string())?;
            self.rewinding = shown <= asked + 1e-9;
        }
        self.real_s = real_s;
        self.picture = self.driver.show(real_s).map_err(|error| error.to_string())?;
        self.link.carry()?;
        self.driver.sample_all(&self.picture, &mut self.samples);
        for refusal in self.driver.refusals() {
            self.notice = Some(format!("{refusal:?}"));
        }
        let there = |body| self.samples.binary_search_by_key(&body, |(id, _)| *id).is_ok();
        self.selection.keep(there);
        Ok(())
    }

    /// How long a frame is. Seconds.
    #[must_use]
    pub fn frame_seconds(&self) -> f64 {
        f64::from(self.picture.snapshot.frame_seconds())
    }

    /// The body as it is drawn.
    #[must_use]
    pub fn sample(&self, body: BodyId) -> Option<&Sample> {
        let at = self.samples.binary_search_by_key(&body, |(id, _)| *id).ok()?;
        Some(&self.samples[at].1)
    }

    /// What does not change from frame to frame of a body that is drawn.
    #[must_use]
    pub fn body(&self, body: BodyId) -> Option<&Arc<Body>> {
        let snapshot = &self.picture.snapshot;
        snapshot.body_at(body, self.picture.frame.min(snapshot.horizon()))
    }

    /// Pauses or goes on.
    pub fn set_paused(&mut self, paused: bool) {
        self.paused = paused;
        self.rewinding = false;
        self.tell_speed();
    }

    /// Runs backwards, or no longer.
    pub fn set_rewinding(&mut self, rewinding: bool) {
        self.rewinding = rewinding;
        self.tell_speed();
    }

    /// Goes so fast from now on: 1 is real time. Kept within 1/64 and 64.
    pub fn set_speed(&mut self, speed: f64) {
        self.speed = speed.clamp(1.0 / 64.0, 64.0);
        self.tell_speed();
    }

    fn tell_speed(&mut self) {
        let speed = if self.paused || self.rewinding { 0.0 } else { self.speed };
        let told = self.driver.set_speed(speed);
        self.note(told);
    }

    /// Shows another time (seconds), or the nearest that is kept.
    pub fn seek(&mut self, time_s: f64) {
        let sought = self.driver.seek(time_s).map(drop);
        self.note(sought);
    }

    /// Goes so many frames on or back, to a whole frame, and stands still.
    pub fn step(&mut self, frames: i64) {
        self.set_paused(true);
        let frame = (self.picture.time_s / self.frame_seconds() + 1e-6).floor() as i64 + frames;
        self.seek(frame.max(0) as f64 * self.frame_seconds());
    }

    /// A change from the first frame after the one shown.
    pub fn change(&mut self, change: Change) {
        let told = self.driver.change(change).map(drop);
        self.note(told);
    }

    /// Takes back the last command.
    pub fn undo(&mut self) {
        let told = self.driver.undo();
        self.note(told);
    }

    /// Does again what was taken back.
    pub fn redo(&mut self) {
        let told = self.driver.redo();
        self.note(told);
    }

    /// Keeps what was not possible for the user to read.
    pub(crate) fn note(&mut self, told: Result<(), DriverError>) {
        if let Err(error) = told {
            self.notice = Some(error.to_string());
        }
    }

    /// A box around bodies as they are drawn: those picked, or with none all that has an end.
    #[must_use]
    pub fn bounds(&self, of: &[BodyId]) -> Option<(Vec3, Vec3)> {
        let mut all: Option<(Vec3, Vec3)> = None;
        for (id, sample) in self.samples.iter().filter(|(id, _)| of.is_empty() || of.contains(id)) {
            let Some(Aabb { min, max }) = self.body(*id).map(|body| body.shape.aabb(&sample.pose)) else {
                continue;
            };
            if min.is_finite() && max.is_finite() && (max - min).max_element() < 1e6 {
                let (low, high) = all.unwrap_or((min, max));
                all = Some((low.min(min), high.max(max)));
            }
        }
        all
    }
}
