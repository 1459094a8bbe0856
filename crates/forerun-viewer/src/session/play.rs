//! Play: a scene that runs, and what is shown of it. What the user does to it is in the rooms beside this one.

use std::sync::Arc;

use forerun::{
    Aabb, Body, BodyId, Coupled, Decoupled, DriverError, Frame, Picture, Refusal, Sample, Scene, Vec3,
};

use super::editing::Editing;
use super::history::History;
use super::questions::Questions;
use super::selection::Selection;
use crate::host::{Link, Started};
use crate::news::News;

/// How fast a rewind goes, against the clock.
const REWIND_SPEED: f64 = 1.0;

/// A scene that runs.
#[derive(Debug)]
pub struct Play {
    /// What there was at frame 0.
    pub scene: Scene,
    /// The display's handle on the physics that runs ahead. In coupled mode it stands still.
    pub driver: Decoupled,
    /// The traditional driver, in coupled mode.
    pub(super) coupled: Option<Coupled>,
    /// The way to the physics.
    pub(super) link: Link,
    /// What was shown last.
    pub picture: Picture,
    /// The bodies as they are drawn, by id.
    pub samples: Vec<(BodyId, Sample)>,
    /// What the user has picked.
    pub selection: Selection,
    /// What was not possible, for the user to read.
    pub notice: News<String>,
    /// Whether display time stands still because the user asked for it.
    pub paused: bool,
    /// How fast display time is to go when it is not paused: 1 is real time.
    pub speed: f64,
    /// Whether display time runs backwards.
    pub rewinding: bool,
    /// What the user did.
    pub(super) history: History,
    /// What is being changed in a panel.
    pub(super) editing: Option<Editing>,
    /// What physics was asked.
    pub(super) questions: Questions,
    /// The last body that the user brought in.
    pub added: Option<BodyId>,
    /// The clock of the last picture. Seconds.
    real_s: f64,
}

impl Play {
    pub(super) fn of(started: Started) -> Play {
        let picture = started.driver.last_picture();
        Play {
            scene: started.scene,
            driver: started.driver,
            coupled: None,
            link: started.link,
            picture,
            samples: Vec::new(),
            selection: Selection::default(),
            notice: News::default(),
            paused: false,
            speed: 1.0,
            rewinding: false,
            history: History::default(),
            editing: None,
            questions: Questions::default(),
            added: None,
            real_s: 0.0,
        }
    }

    /// Takes the picture for a time of the window's clock (seconds).
    pub(super) fn show(&mut self, real_s: f64) -> Result<(), String> {
        let since_s = (real_s - self.real_s).max(0.0);
        self.real_s = real_s;
        self.link.carry()?;
        if self.coupled.is_some() {
            self.show_coupled(real_s);
        } else {
            self.show_decoupled(real_s, since_s).map_err(|error| error.to_string())?;
            // What this picture asked for need not wait for the next.
            self.link.carry()?;
        }
        let there = |body| self.samples.binary_search_by_key(&body, |(id, _)| *id).is_ok();
        self.selection.keep(there);
        Ok(())
    }

    fn show_decoupled(&mut self, real_s: f64, since_s: f64) -> Result<(), DriverError> {
        if self.rewinding {
            let asked = self.picture.time_s - REWIND_SPEED * self.speed * since_s;
            if self.driver.seek(asked)? > asked + 1e-9 {
                // There is nothing before it: it stands still, and says so.
                self.set_paused(true);
            }
        }
        self.picture = self.driver.show(real_s)?;
        self.driver.sample_all(&self.picture, &mut self.samples);
        for refusal in self.driver.refusals() {
            self.refused(&refusal);
        }
        self.history.forget_to(self.picture.snapshot.oldest());
        match self.driver.answers() {
            Ok(answers) => self.questions.learn(answers),
            // Who answers is gone; physics is not.
            Err(error) => self.notice.tell(error.to_string()),
        }
        Ok(())
    }

    fn refused(&mut self, refusal: &Refusal) {
        // What was not replaced stands as it was.
        let stands = matches!(refusal, Refusal::Replace(..));
        if let Some(key) = refusal.key().filter(|_| !stands) {
            self.history.forget(key);
        }
        self.notice.tell(refusal.to_string());
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
        self.rewinding = rewinding && self.coupled.is_none();
        self.tell_speed();
    }

    /// Goes so fast from now on: 1 is real time. Kept within 1/64 and 64.
    pub fn set_speed(&mut self, speed: f64) {
        self.speed = speed.clamp(1.0 / 64.0, 64.0);
        self.tell_speed();
    }

    pub(super) fn tell_speed(&mut self) {
        let still = self.paused || self.rewinding || self.coupled.is_some();
        let told = self.driver.set_speed(if still { 0.0 } else { self.speed });
        self.note(told);
    }

    /// Shows another time (seconds), or the nearest that is kept. Not in coupled mode: there is no other time then.
    pub fn seek(&mut self, time_s: f64) {
        if self.coupled.is_none() {
            let sought = self.driver.seek(time_s).map(drop);
            self.note(sought);
        }
    }

    /// Goes so many frames on or back, to a whole frame, and stands still.
    pub fn step(&mut self, frames: i64) {
        self.set_paused(true);
        const HAIR: f64 = 1e-6;
        let shown = self.picture.time_s / self.frame_seconds();
        // From between two frames, the one before is a step back and the one after a step on.
        let from = if frames < 0 { (shown - HAIR).ceil() } else { (shown + HAIR).floor() };
        let frame = from as i64 + frames;
        self.seek(frame.max(0) as f64 * self.frame_seconds());
    }

    /// Gravity where it is shown. m/s².
    #[must_use]
    pub fn gravity(&self) -> Vec3 {
        let snapshot = &self.picture.snapshot;
        snapshot.environment_at(self.picture.frame.min(snapshot.horizon())).gravity
    }

    /// The time of a frame. Seconds.
    #[must_use]
    pub fn seconds_of(&self, frame: Frame) -> f64 {
        frame.seconds(self.picture.snapshot.frame_seconds())
    }

    /// Keeps what was not possible for the user to read.
    pub(crate) fn note(&mut self, told: Result<(), DriverError>) {
        if let Err(error) = told {
            self.notice.tell(error.to_string());
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
