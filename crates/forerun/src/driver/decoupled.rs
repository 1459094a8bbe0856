//! Decoupled: the display's side of physics that runs ahead in a thread of its own (dissertation, section 3.2).
//!
//! Promise: no call here waits for a step. What the physics knows comes by one atomic read, what the user does goes by a bounded queue.

use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use forerun_timeline::{
    Change, Command, CommandError, CommandKey, Frame, Sample, Snapshot, Stats, Timeline,
};

use super::blend::{Blend, Blending, Offset};
use super::driver_error::DriverError;
use super::frame_notes::FrameNote;
use super::pace::{Pace, Supply};
use super::physics::{self, Hinder, Published, Shared};
use super::reach::Reach;
use crate::{BodyDef, BodyId, Threads};

/// The largest queue: its memory is taken at the start, and a queue without room would never be drained.
const COMMANDS_MAX: usize = 65_536;

/// The fastest that a display may go. No physics feeds more, and times stay exact.
const SPEED_MAX: f64 = 1000.0;

/// A picture whose clock went slower than this was slowed; less is rounding.
const FULL_RATE: f64 = 1.0 - 1e-6;

/// How the physics thread works.
#[derive(Debug)]
pub struct DecoupledSettings {
    /// Threads of the physics.
    pub threads: Threads,
    /// Commands that may wait for the physics; more are refused. 1 to 65536, default 1024.
    pub command_capacity: usize,
    /// Makes every computed frame this much slower, to see what a slow scene does. Default 0.
    pub slow_down: Duration,
}

impl DecoupledSettings {
    /// The defaults with these threads.
    #[must_use]
    pub const fn new(threads: Threads) -> Self {
        DecoupledSettings { threads, command_capacity: 1024, slow_down: Duration::ZERO }
    }
}

/// What there is to draw at a display time.
#[derive(Clone, Debug)]
pub struct Picture {
    /// All that physics knew when the picture was taken: sample it at `time_s`.
    pub snapshot: Arc<Snapshot>,
    /// Display time T. Seconds; never less than in the picture before, and never past the horizon.
    pub time_s: f64,
    /// What T would be if physics had never been late. Seconds.
    pub wished_s: f64,
    /// The caller's clock when the picture was asked for. Seconds.
    pub real_s: f64,
    /// How fast T went since the picture before, against the caller's clock times the speed: below 1 where physics was late, at most 1.05
    /// where lost time is being made good. 1 in the first picture and after [`Decoupled::seek`].
    pub rate: f64,
    /// The frame shown: the last one at or before `time_s`.
    pub frame: Frame,
    /// How that frame was computed; none while it is not.
    pub note: Option<FrameNote>,
    /// How far back commands threw the physics since the picture before: the last frame that was true for all bodies right after.
    pub dropped_to: Option<Frame>,
    /// Work of the physics so far.
    pub stats: Stats,
}

impl Picture {
    /// Whether the clock was slowed because physics was late.
    #[must_use]
    pub fn is_slowed(&self) -> bool {
        self.rate < FULL_RATE
    }
}

/// The display's handle on a physics thread. Dropping it stops the thread and waits for the step that it is in.
#[derive(Debug)]
pub struct Decoupled {
    shared: Arc<Shared>,
    physics: Option<JoinHandle<()>>,
    commands: SyncSender<Command>,
    refusals: Receiver<(CommandKey, CommandError)>,
    frame_seconds: f64,
    /// How far ahead physics may be. Seconds.
    lookahead_s: f64,
    pace: Pace,
    blend: Blend,
    next_body: BodyId,
    next_sequence: u64,
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

    /// The same with something done after every computed frame.
    fn start_hindered(
        mut timeline: Timeline,
        settings: DecoupledSettings,
        hinder: Hinder,
    ) -> Result<Self, DriverError> {
        let capacity = settings.command_capacity;
        if !(1..=COMMANDS_MAX).contains(&capacity) {
            let message = format!("must be from 1 to {COMMANDS_MAX}, is {capacity}");
            return Err(DriverError::Setting { field: "command_capacity", message });
        }
        let (commands, command_queue) = sync_channel(capacity);
        let (refusal_queue, refusals) = sync_channel(capacity);
        let snapshot = timeline.snapshot();
        let frame_seconds = f64::from(snapshot.frame_seconds());
        let displayed = timeline.display();
        let next_body = timeline.reserve_body();
        let next_sequence = timeline.next_sequence();
        let lookahead = timeline.settings().lookahead;
        let reach = Reach::new(lookahead);
        let shared = Arc::new(Shared::new(&timeline));
        let physics = physics::Physics {
            timeline,
            shared: Arc::clone(&shared),
            commands: command_queue,
            refusals: refusal_queue,
            command_capacity: capacity,
            reach,
            pictures: 0,
            hinder,
        };
        let thread = physics::spawn(physics, settings.threads)
            .map_err(|error| DriverError::NotStarted(error.to_string()))?;
        Ok(Decoupled {
            shared,
            physics: Some(thread),
            commands,
            refusals,
            frame_seconds,
            lookahead_s: f64::from(lookahead) * frame_seconds,
            pace: Pace::starting_at(displayed.seconds(snapshot.frame_seconds())),
            blend: Blend::default(),
            next_body,
            next_sequence,
        })
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
    /// To be called once for each picture, the latest; the plain truth is in [`Snapshot::sample_all`].
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
            full: self.shared.is_physics_done(),
        }
    }

    /// A change by the local user, from the first frame after the displayed one on: nothing on the screen is taken back.
    ///
    /// # Errors
    /// [`DriverError::QueueFull`] when too many commands wait; [`DriverError::Panicked`]. Whether the change is possible is found
    /// out by the physics thread: see [`Decoupled::refusals`].
    pub fn change(&mut self, change: Change) -> Result<CommandKey, DriverError> {
        let key =
            CommandKey { frame: self.displayed_frame().next(), source: 0, sequence: self.next_sequence };
        self.submit(Command { key, change })?;
        self.next_sequence = self.next_sequence.saturating_add(1);
        Ok(key)
    }

    /// Adds a body from the first frame after the displayed one on.
    ///
    /// # Errors
    /// As [`Decoupled::change`].
    pub fn add(&mut self, def: BodyDef) -> Result<BodyId, DriverError> {
        let body = self.reserve_body();
        self.change(Change::Add { body, def: Box::new(def) })?;
        Ok(body)
    }

    /// A name for a body to be added by a command of one's own. The timeline learns it with that command.
    pub fn reserve_body(&mut self) -> BodyId {
        let body = self.next_body;
        self.next_body = BodyId(body.0 + 1);
        body
    }

    /// A command with a frame of its own, possibly in the past, as they come from a network. Local changes use source 0.
    ///
    /// # Errors
    /// As [`Decoupled::change`].
    pub fn submit(&self, command: Command) -> Result<(), DriverError> {
        self.alive()?;
        match self.commands.try_send(command) {
            Ok(()) => {
                self.shared.wake();
                Ok(())
            }
            Err(TrySendError::Full(_)) => Err(DriverError::QueueFull),
            Err(TrySendError::Disconnected(_)) => Err(self.failure()),
        }
    }

    /// Commands that the timeline refused since the last call, and why. When nobody asks for long, the latest are lost.
    pub fn refusals(&mut self) -> Vec<(CommandKey, CommandError)> {
        self.refusals.try_iter().collect()
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
        match self.physics.as_ref().is_some_and(JoinHandle::is_finished) {
            true => Err(self.failure()),
            false => Ok(()),
        }
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
mod tests;
