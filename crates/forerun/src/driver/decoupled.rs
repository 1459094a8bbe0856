//! Decoupled: the display's side of physics that runs ahead in a thread of its own (dissertation, section 3.2).
//!
//! Promise: no call here waits for a step. What the physics knows comes by one atomic read, what the user does goes by a bounded queue.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use forerun_timeline::{Frame, Sample, Timeline};

use super::blend::{Blend, Blending, Offset};
use super::driver_error::DriverError;
use super::fork::{Fork, Names};
use super::hearing::{Heard, Message};
use super::inquiry::desk::Inquiry;
use super::pace::{Pace, Supply};
use super::physics::{self, Hinder, Published, Shared};
use super::picture::Picture;
use super::reach::Reach;
use super::refusal::Refusal;
use super::stage_times::StageWatch;
use crate::{BodyId, Clock, Recorder, Threads};

/// The largest queue: its memory is taken at the start, and a queue without room would never be drained.
pub(super) const COMMANDS_MAX: usize = 65_536;

/// The fastest that a display may go. No physics feeds more, and times stay exact.
const SPEED_MAX: f64 = 1000.0;

/// Forks that may wait to be taken.
const FORKS_MAX: usize = 16;

/// How the physics thread works.
#[derive(Debug)]
pub struct DecoupledSettings {
    /// Threads of the physics.
    pub threads: Threads,
    /// Orders that may wait for the physics; more are refused. 1 to 65536, default 1024.
    pub command_capacity: usize,
    /// Makes every computed frame this much slower, to see what a slow scene does. Default 0.
    pub slow_down: Duration,
    /// Counts the areas in which a body moved, for every frame ([`FrameNote::areas_active`](crate::FrameNote::areas_active)): costs a
    /// look at each body that moves. Default false.
    pub count_areas: bool,
    /// Measures the stages of every computed frame with this clock: see [`Decoupled::stage_times`]. Default none: nothing is measured.
    pub stage_clock: Option<Clock>,
    /// Writes down the session. Who keeps a clone of it [finishes](Recorder::finish) the file when the driver is dropped. Default none.
    pub recorder: Option<Recorder>,
}

impl DecoupledSettings {
    /// The defaults with these threads.
    #[must_use]
    pub const fn new(threads: Threads) -> Self {
        DecoupledSettings {
            threads,
            command_capacity: 1024,
            slow_down: Duration::ZERO,
            count_areas: false,
            stage_clock: None,
            recorder: None,
        }
    }
}

/// The display's handle on a physics thread. Dropping it stops the thread and waits for the step that it is in.
#[derive(Debug)]
pub struct Decoupled {
    shared: Arc<Shared>,
    /// `None` where the physics is elsewhere.
    physics: Option<JoinHandle<()>>,
    messages: SyncSender<Message>,
    refusals: Receiver<Refusal>,
    forks: Receiver<Fork>,
    frame_seconds: f64,
    /// How far ahead physics may be. Seconds.
    lookahead_s: f64,
    pace: Pace,
    blend: Blend,
    names: Arc<Names>,
    /// Where questions are laid down, once something was asked.
    inquiry: Option<Inquiry>,
    /// The number of the next question.
    tickets: u64,
}

impl Decoupled {
    /// Hands a timeline to a new physics thread, which at once begins to run ahead.
    ///
    /// # Errors
    /// When the command capacity is out of its range, or the system refuses to start a thread.
    pub fn start(timeline: Timeline, settings: DecoupledSettings) -> Result<Self, DriverError> {
        let slow_down = settings.slow_down;
        let sleep = move || {
            if !slow_down.is_zero() {
                std::thread::sleep(slow_down);
            }
        };
        Self::start_hindered(timeline, settings, Box::new(sleep))
    }

    /// The same with something done after every computed frame, in the physics thread: to see what a stall does.
    ///
    /// # Errors
    /// As [`Decoupled::start`].
    pub fn start_hindered(
        mut timeline: Timeline,
        settings: DecoupledSettings,
        hinder: Hinder,
    ) -> Result<Self, DriverError> {
        let capacity = settings.command_capacity;
        if !(1..=COMMANDS_MAX).contains(&capacity) {
            let message = format!("must be from 1 to {COMMANDS_MAX}, is {capacity}");
            return Err(DriverError::Setting { field: "command_capacity", message });
        }
        let (messages, message_queue) = sync_channel(capacity);
        let (fork_queue, forks) = sync_channel(FORKS_MAX);
        let (refusal_queue, refusals) = sync_channel(capacity);
        let snapshot = timeline.snapshot();
        let frame_seconds = f64::from(snapshot.frame_seconds());
        let displayed = timeline.display();
        let names = Names::after(&mut timeline);
        let lookahead = timeline.settings().lookahead;
        let reach = Reach::new(lookahead);
        let shared = Arc::new(Shared::new(Published::of(&timeline), &timeline.settings(), displayed));
        let physics = physics::Physics {
            timeline,
            shared: Arc::clone(&shared),
            messages: message_queue,
            refusals: refusal_queue,
            forks: fork_queue,
            heard: Heard::new(Arc::clone(&names)),
            command_capacity: capacity,
            count_areas: settings.count_areas,
            stage_watch: settings.stage_clock.map(StageWatch::new),
            reach,
            caught_up: true,
            pictures: 0,
            hinder,
            recorder: settings.recorder,
        };
        let thread = physics::spawn(physics, settings.threads)
            .map_err(|error| DriverError::NotStarted(error.to_string()))?;
        Ok(Decoupled {
            shared,
            physics: Some(thread),
            messages,
            refusals,
            forks,
            frame_seconds,
            lookahead_s: f64::from(lookahead) * frame_seconds,
            pace: Pace::starting_at(displayed.seconds(snapshot.frame_seconds())),
            blend: Blend::default(),
            names,
            inquiry: None,
            tickets: 0,
        })
    }

    /// A handle on a physics that is elsewhere: what it says comes through the other ends of these queues.
    pub(super) fn elsewhere(
        shared: Arc<Shared>,
        names: Arc<Names>,
        lookahead: u32,
        ends: (SyncSender<Message>, Receiver<Refusal>, Inquiry),
    ) -> Self {
        let (frame, _) = shared.shown();
        let frame_seconds = shared.published.load().snapshot.frame_seconds();
        let (messages, refusals, inquiry) = ends;
        // Nobody sends any.
        let (_, forks) = sync_channel(1);
        Decoupled {
            shared,
            physics: None,
            messages,
            refusals,
            forks,
            frame_seconds: f64::from(frame_seconds),
            lookahead_s: f64::from(lookahead) * f64::from(frame_seconds),
            pace: Pace::starting_at(frame.seconds(frame_seconds)),
            blend: Blend::default(),
            names,
            inquiry: Some(inquiry),
            tickets: 0,
        }
    }

    /// What to draw when the caller's clock shows `real_s` (seconds; the first call says where it begins, and one that goes back stands
    /// still). Never waits. Display time goes on by what passed times the speed; where physics is late it goes slower, down to
    /// standing still, and makes up for it later at no more than 1.05 times that. A body that is merely out of date does not slow it:
    /// its samples are extrapolated for a while, then held, and say so.
    ///
    /// # Errors
    /// When the physics thread has panicked; [`Decoupled::last_picture`] still works.
    pub fn show(&mut self, real_s: f64) -> Result<Picture, DriverError> {
        self.alive()?;
        let published = self.shared.published.load_full();
        self.pace.go_on(real_s, &self.supply(&published));
        self.shared.tell_display(self.displayed_frame());
        Ok(Picture { dropped_to: self.shared.take_drop(), ..self.picture(&published) })
    }

    /// How fast display time goes: 0 is a pause, 1 (the default) real time, 10 ten times that. Physics may be too slow for what is asked.
    ///
    /// # Errors
    /// When the speed is not from 0 to 1000.
    pub fn set_speed(&mut self, speed: f64) -> Result<(), DriverError> {
        if !(0.0..=SPEED_MAX).contains(&speed) {
            let message = format!("must be from 0 to {SPEED_MAX}, is {speed}");
            return Err(DriverError::Setting { field: "speed", message });
        }
        self.pace.set_speed(speed);
        Ok(())
    }

    /// How fast display time goes.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.pace.speed()
    }

    /// Goes to another display time at once, on purpose also back, and on from there: the time then shown, which is `time_s` (seconds), or the
    /// nearest that is kept. What is changed there is an edit like any other: commands given for later frames stay in force.
    ///
    /// # Errors
    /// When `time_s` is not a finite number, or the physics thread has panicked.
    pub fn seek(&mut self, time_s: f64) -> Result<f64, DriverError> {
        if !time_s.is_finite() {
            let message = format!("must be a finite number, is {time_s}");
            return Err(DriverError::Setting { field: "time_s", message });
        }
        self.alive()?;
        let supply = self.supply(&self.shared.published.load_full());
        let shown_s = self.pace.seek(time_s, &supply);
        self.blend.forget();
        self.shared.tell_display(self.displayed_frame());
        Ok(shown_s)
    }

    /// The picture at the last display time, with what physics knows by now.
    #[must_use]
    pub fn last_picture(&self) -> Picture {
        self.picture(&self.shared.published.load_full())
    }

    /// All bodies of a picture as they are to be drawn, in the order of their ids, and how far that is off the truth: where a newer snapshot
    /// contradicts what was drawn (a command came late, one was taken back, an extrapolated body is known now), the body is led to
    /// where it is within about 0.15 s. `samples` is emptied first and keeps its memory.
    ///
    /// To be called once for each picture, the latest; the plain truth is in [`Snapshot::sample_all`](crate::Snapshot::sample_all).
    pub fn sample_all(&mut self, picture: &Picture, samples: &mut Vec<(BodyId, Sample)>) -> Blending {
        self.blend.sample_all(picture, samples)
    }

    /// The bodies that [`Decoupled::sample_all`] drew elsewhere than they are. Sorted by body.
    #[must_use]
    pub fn offsets(&self) -> &[(BodyId, Offset)] {
        self.blend.offsets()
    }

    fn picture(&self, published: &Published) -> Picture {
        let frame = self.displayed_frame();
        Picture {
            snapshot: Arc::clone(&published.snapshot),
            time_s: self.pace.time_s(),
            wished_s: self.pace.wished_s(),
            real_s: self.pace.real_s(),
            rate: self.pace.rate(),
            frame,
            note: self.shared.notes.read(frame.min(published.snapshot.horizon())),
            dropped_to: None,
            stats: published.stats,
        }
    }

    fn supply(&self, published: &Published) -> Supply {
        let snapshot = &published.snapshot;
        let frame_seconds = snapshot.frame_seconds();
        Supply {
            oldest_s: snapshot.oldest().seconds(frame_seconds),
            horizon_s: snapshot.horizon().seconds(frame_seconds),
            lookahead_s: self.lookahead_s,
            frame_s: self.frame_seconds,
            full: self.shared.is_physics_done(),
        }
    }

    /// The last frame at or before the display time.
    fn displayed_frame(&self) -> Frame {
        // As in the dissertation's algorithm 1, a time within a hair of a frame is that frame: k·h/h may round to below k. The hair is
        // that of the snapshot's sampling, so that the frame is the one that is shown.
        const HAIR: f64 = 1e-9;
        let frames = self.pace.time_s() / self.frame_seconds;
        Frame((frames + HAIR * frames.max(1.0)) as u64)
    }

    fn alive(&self) -> Result<(), DriverError> {
        let failed = match &self.physics {
            Some(thread) => thread.is_finished(),
            None => self.shared.panic.lock().unwrap_or_else(PoisonError::into_inner).is_some(),
        };
        if failed { Err(self.failure()) } else { Ok(()) }
    }

    fn failure(&self) -> DriverError {
        let message = self.shared.panic.lock().unwrap_or_else(PoisonError::into_inner).clone();
        DriverError::Panicked(message.unwrap_or_else(|| "without a message".to_owned()))
    }
}

impl Drop for Decoupled {
    fn drop(&mut self) {
        self.shared.stop();
        if let Some(thread) = self.physics.take() {
            // A panic of the physics was kept as a message by the thread itself, which therefore ends well.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod order_tests;
mod orders;
#[cfg(test)]
mod question_tests;
mod questions;
#[cfg(test)]
#[allow(clippy::float_cmp, reason = "times are kept to the bit where nothing is late")]
pub(super) mod tests;
