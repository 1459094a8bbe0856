//! Decoupled: the display's side of physics that runs ahead in a thread of its own (dissertation, section 3.2).
//!
//! Promise: no call here waits for a step. What the physics knows comes by one atomic read, what the user does goes by a bounded queue.

use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use forerun_timeline::{Change, Command, CommandError, CommandKey, Frame, Snapshot, Stats, Timeline};

use super::driver_error::DriverError;
use super::frame_notes::FrameNote;
use super::physics::{self, Hinder, Shared};
use super::reach::Reach;
use crate::{BodyDef, BodyId, Threads};

/// The largest queue: its memory is taken at the start, and a queue without room would never be drained.
const COMMANDS_MAX: usize = 65_536;

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
    /// Display time T. Seconds; never less than in the picture before. Past the horizon, samples hold the last state.
    pub time_s: f64,
    /// The frame shown: the last one at or before `time_s`.
    pub frame: Frame,
    /// How that frame was computed; none while it is not.
    pub note: Option<FrameNote>,
    /// How far back commands threw the physics since the picture before: the last frame that was true for all bodies right after.
    pub dropped_to: Option<Frame>,
    /// Work of the physics so far.
    pub stats: Stats,
}

/// The display's handle on a physics thread. Dropping it stops the thread and waits for the step that it is in.
#[derive(Debug)]
pub struct Decoupled {
    shared: Arc<Shared>,
    physics: Option<JoinHandle<()>>,
    commands: SyncSender<Command>,
    refusals: Receiver<(CommandKey, CommandError)>,
    frame_seconds: f64,
    time_s: f64,
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
        let next_body = timeline.reserve_body();
        let next_sequence = timeline.next_sequence();
        let reach = Reach::new(timeline.settings().lookahead);
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
            time_s: 0.0,
            next_body,
            next_sequence,
        })
    }

    /// What to draw at display time `time_s` (seconds; an earlier time than before counts as that). Never waits: past the
    /// horizon the picture holds the last state.
    ///
    /// # Errors
    /// When the physics thread has panicked; [`Decoupled::last_picture`] still works.
    pub fn show(&mut self, time_s: f64) -> Result<Picture, DriverError> {
        self.time_s = self.time_s.max(time_s);
        self.shared.tell_display(self.displayed_frame());
        self.alive()?;
        Ok(Picture { dropped_to: self.shared.take_drop(), ..self.last_picture() })
    }

    /// The picture at the last display time, with what physics knows by now.
    #[must_use]
    pub fn last_picture(&self) -> Picture {
        let frame = self.displayed_frame();
        let published = self.shared.published.load();
        Picture {
            snapshot: Arc::clone(&published.snapshot),
            time_s: self.time_s,
            frame,
            note: self.shared.notes.read(frame.min(published.snapshot.horizon())),
            dropped_to: None,
            stats: published.stats,
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
        let frames = self.time_s / self.frame_seconds;
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
