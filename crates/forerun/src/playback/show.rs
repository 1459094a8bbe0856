//! Show: what a picture costs and knows under each driver.

use std::collections::VecDeque;
use std::time::Duration;

use forerun_scene::Scene;
use forerun_timeline::{Certainty, Change, Frame, Sample, TimelineSettings};

use super::log::QueueRow;
use super::settings::{DriverKind, PlaybackError, PlaybackSettings};
use crate::driver::{Clock, Coupled, Decoupled, DecoupledSettings, DriverError, StepLimits, Threads};
use crate::recording::Recorder;
use crate::staging::{TimedChange, bare_timeline_of, changes_of, world_of};
use crate::{BodyId, Pose};

/// A scene under a driver, ready to show one picture after the other.
pub(super) enum Show {
    Decoupled(Box<DecoupledShow>),
    Coupled(Box<CoupledShow>),
}

impl Show {
    /// The scene's commands are played as a user's: the driver hears of each when its time has come, not before.
    pub(super) fn new(
        scene: &Scene,
        settings: &PlaybackSettings,
        clock: &Clock,
    ) -> Result<Self, PlaybackError> {
        let threads = settings.threads.map_or_else(Threads::all, Threads::exactly)?;
        let script = VecDeque::from(changes_of(scene)?);
        match settings.driver {
            DriverKind::Decoupled => {
                DecoupledShow::new(scene, script, (settings, threads)).map(Box::new).map(Show::Decoupled)
            }
            DriverKind::Coupled => {
                let driver = Coupled::new(world_of(scene)?, clock.clone(), threads, StepLimits::default())?
                    .with_slow_down(settings.slow_down);
                Ok(Show::Coupled(Box::new(CoupledShow {
                    driver,
                    script,
                    scene: scene.name.clone(),
                    frame_seconds: f64::from(scene.frame_seconds),
                    quarantined: 0,
                })))
            }
        }
    }

    /// Makes the picture for `real` time since the start. The row lacks what only the caller knows: when the picture was shown.
    pub(super) fn picture(&mut self, real: Duration) -> Result<QueueRow, PlaybackError> {
        match self {
            Show::Decoupled(show) => show.picture(real.as_secs_f64()),
            Show::Coupled(show) => show.picture(),
        }
    }

    /// Bodies that were stopped because their next state was not finite, each time it happened.
    pub(super) fn quarantined(&self) -> u64 {
        match self {
            Show::Decoupled(show) => {
                let stats = show.driver.last_picture().stats;
                stats.ahead.quarantined + stats.edits.quarantined
            }
            Show::Coupled(show) => show.quarantined,
        }
    }

    /// Commands that did nothing. The coupled driver has none: what it cannot do is an error.
    pub(super) fn ignored(&self) -> u64 {
        match self {
            Show::Decoupled(show) => show.driver.last_picture().stats.ignored,
            Show::Coupled(_) => 0,
        }
    }

    /// Ends the show, and completes the record of it.
    pub(super) fn finish(self) -> Result<(), PlaybackError> {
        let Show::Decoupled(show) = self else { return Ok(()) };
        let DecoupledShow { driver, recorder, .. } = *show;
        drop(driver);
        Ok(recorder.map_or(Ok(()), |recorder| recorder.finish())?)
    }

    /// Where the bodies were in the last picture.
    pub(super) fn poses(&self) -> Vec<(BodyId, Pose)> {
        match self {
            Show::Decoupled(show) => show.samples.iter().map(|(body, sample)| (*body, sample.pose)).collect(),
            Show::Coupled(show) => {
                let world = show.driver.world();
                let places = world.bodies().iter().zip(world.states()).enumerate();
                places.map(|(i, (body, state))| (BodyId(i as u32), body.own_pose(state))).collect()
            }
        }
    }
}

/// A scene under the decoupled driver.
pub(super) struct DecoupledShow {
    driver: Decoupled,
    script: VecDeque<TimedChange>,
    scene: String,
    samples: Vec<(BodyId, Sample)>,
    computed: u64,
    recomputed: u64,
    recorder: Option<Recorder>,
}

impl DecoupledShow {
    fn new(
        scene: &Scene,
        script: VecDeque<TimedChange>,
        (settings, threads): (&PlaybackSettings, Threads),
    ) -> Result<Self, PlaybackError> {
        let lookahead = TimelineSettings { lookahead: settings.lookahead, ..TimelineSettings::default() };
        let timeline = bare_timeline_of(scene, lookahead)?;
        let recorder = settings.record.as_ref().map(|path| Recorder::create(path, &timeline)).transpose()?;
        let how = DecoupledSettings {
            slow_down: settings.slow_down,
            count_areas: true,
            recorder: recorder.clone(),
            ..DecoupledSettings::new(threads)
        };
        let mut driver = Decoupled::start(timeline, how)?;
        // The scene numbers the bodies that its commands add after those that are there at first, and so do we.
        for _ in script.iter().filter(|c| matches!(c.change, Change::Add { .. })) {
            driver.reserve_body();
        }
        let scene = scene.name.clone();
        Ok(DecoupledShow { driver, script, scene, samples: Vec::new(), computed: 0, recomputed: 0, recorder })
    }

    fn picture(&mut self, real_s: f64) -> Result<QueueRow, PlaybackError> {
        let picture = self.driver.show(real_s)?;
        let snapshot = &picture.snapshot;
        self.driver.sample_all(&picture, &mut self.samples);
        let starved = self.samples.iter().filter(|(_, s)| s.certainty > Certainty::Presumed).count();
        let physics_s = snapshot.valid_to().seconds(snapshot.frame_seconds());
        let slices_max = picture.note.map_or(1, |note| u32::from(note.slices_max));
        let (ahead, edits) = (picture.stats.ahead.recomputed, picture.stats.edits.recomputed);
        let queue_min = small(snapshot.queue_min(picture.time_s));
        let low = picture.dropped_to.map_or(snapshot.valid_to(), |frame| frame.min(snapshot.valid_to()));
        let row = QueueRow {
            time_display_s: picture.time_s.min(physics_s),
            time_physics_s: physics_s,
            time_physics_low_s: low.seconds(snapshot.frame_seconds()),
            queue_min,
            queue_low: queue_min.min(small(low.since(picture.frame))),
            queue_max: small(snapshot.queue_max(picture.time_s)),
            starved: starved as u32,
            slices_max,
            time_step_s: f64::from(snapshot.frame_seconds()) / f64::from(slices_max),
            areas_active: picture.note.and_then(|note| note.areas_active).unwrap_or(0),
            clock_rate: picture.rate,
            computed: ahead + edits - self.computed,
            recomputed: edits - self.recomputed,
            ..QueueRow::default()
        };
        (self.computed, self.recomputed) = (ahead + edits, edits);
        self.act(picture.frame)?;
        Ok(row)
    }

    /// Does what the script says for the frame after the displayed one.
    fn act(&mut self, displayed: Frame) -> Result<(), PlaybackError> {
        while self.script.front().is_some_and(|next| next.frame <= displayed.next()) {
            match self.driver.change(self.script[0].change.clone()) {
                Ok(_) => self.script.pop_front(),
                // Backpressure: this one and those behind it wait for the next picture.
                Err(DriverError::QueueFull) => break,
                Err(error) => return Err(error.into()),
            };
        }
        match self.driver.refusals().into_iter().next() {
            Some(refusal) => {
                Err(PlaybackError::Change { scene: self.scene.clone(), message: refusal.to_string() })
            }
            None => Ok(()),
        }
    }
}

/// A scene under the coupled driver.
pub(super) struct CoupledShow {
    driver: Coupled,
    script: VecDeque<TimedChange>,
    scene: String,
    frame_seconds: f64,
    quarantined: u64,
}

impl CoupledShow {
    fn picture(&mut self) -> Result<QueueRow, PlaybackError> {
        // A change of frame k is in the states of frame k, which the next step leaves: the same rule as in a timeline.
        let now = Frame((self.driver.time_s() / self.frame_seconds) as u64);
        while self.script.front().is_some_and(|next| next.frame <= now) {
            let Some(next) = self.script.pop_front() else { break };
            let changed = self.driver.change(&next.change);
            changed.map_err(|error| PlaybackError::change(&self.scene, &error))?;
        }
        let before_s = self.driver.time_s();
        let report = self.driver.show();
        self.quarantined += u64::from(report.quarantined);
        let slices_max = report.slices_max.max(1);
        let time_s = self.driver.time_s();
        Ok(QueueRow {
            time_display_s: time_s,
            time_physics_s: time_s,
            time_physics_low_s: time_s,
            clock_rate: 1.0,
            slices_max,
            time_step_s: (time_s - before_s) / f64::from(slices_max),
            computed: if time_s > before_s { self.driver.world().bodies().len() as u64 } else { 0 },
            ..QueueRow::default()
        })
    }
}

/// Queues are bounded by the lookahead, which is far below 2³².
fn small(count: u64) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}
