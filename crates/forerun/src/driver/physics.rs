//! Physics: the thread that owns the working timeline.
//!
//! The loop is a short story: hear what the display says, learn where the display is, compute the earliest frame that is out of date, publish; or
//! sleep when there is nothing to do. It never spins: whoever gives it something to do wakes it, and a wake that comes before the
//! sleep is not lost (`std::thread::park` keeps it).

use std::any::Any;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread::{JoinHandle, Thread};

use arc_swap::{ArcSwap, ArcSwapOption};
use forerun_timeline::{Frame, Order, Progress, Snapshot, Stats, Timeline, TimelineSettings};

use super::fork::Fork;
use super::frame_notes::{FrameNote, FrameNotes};
use super::hearing::{Heard, Message};
use super::inquiry::desk::AskedPreview;
use super::reach::Reach;
use super::refusal::Refusal;
use super::stage_times::{StageTimesRing, StageWatch};
use crate::{Recorder, Threads};

/// Frames whose notes are kept, at most: their memory is taken at the start, while of states bytes may bound what is kept.
const NOTES_MAX: usize = 65_536;

/// Done after every computed frame.
pub type Hinder = Box<dyn FnMut() + Send>;

/// What the physics thread last made known, as one immutable whole.
#[derive(Debug)]
pub(super) struct Published {
    pub(super) snapshot: Arc<Snapshot>,
    pub(super) stats: Stats,
}

impl Published {
    /// What there is to know of a timeline.
    pub(super) fn of(timeline: &Timeline) -> Published {
        Published { snapshot: timeline.snapshot(), stats: timeline.stats() }
    }
}

/// What both sides see.
#[derive(Debug)]
pub(super) struct Shared {
    /// The root that the display takes.
    pub(super) published: ArcSwap<Published>,
    pub(super) notes: FrameNotes,
    pub(super) stage_times: StageTimesRing,
    /// The newest preview that waits for a fork.
    preview: ArcSwapOption<AskedPreview>,
    /// Message of a panic of the physics thread; locked only after it has ended.
    pub(super) panic: Mutex<Option<String>>,
    /// The earliest frame up to which all was true right after commands were heard, since the display last asked.
    dropped_to: AtomicU64,
    display: AtomicU64,
    /// Pictures asked for so far.
    pictures: AtomicU64,
    stopping: AtomicBool,
    /// Whether physics has done all that it may for what the display last told it.
    done: AtomicBool,
    sleeper: OnceLock<Thread>,
}

impl Shared {
    /// What the display sees first: of physics with these settings, while this frame is shown.
    pub(super) fn new(published: Published, settings: &TimelineSettings, display: Frame) -> Self {
        // The newest note is at most the lookahead after the displayed frame; what is kept of the past may be shown too.
        let notes_kept =
            (settings.lookahead as usize).saturating_add(settings.past as usize).saturating_add(2);
        Shared {
            published: ArcSwap::from_pointee(published),
            notes: FrameNotes::with_capacity(notes_kept.min(NOTES_MAX)),
            stage_times: StageTimesRing::new(),
            preview: ArcSwapOption::empty(),
            panic: Mutex::new(None),
            dropped_to: AtomicU64::new(u64::MAX),
            display: AtomicU64::new(display.0),
            pictures: AtomicU64::new(0),
            stopping: AtomicBool::new(false),
            done: AtomicBool::new(false),
            sleeper: OnceLock::new(),
        }
    }

    /// Tells the physics that a picture of this frame is shown.
    pub(super) fn tell_display(&self, frame: Frame) {
        // Who learns this frame also finds what was ordered before it was shown: see `Physics::catch_up`.
        self.display.store(frame.0, Ordering::Release);
        self.pictures.fetch_add(1, Ordering::Relaxed);
        // Physics that is not even given a processor has not done its work.
        self.done.store(false, Ordering::Relaxed);
        self.wake();
    }

    /// The frame that is shown, and how many pictures were asked for so far.
    pub(super) fn shown(&self) -> (Frame, u64) {
        let pictures = self.pictures.load(Ordering::Relaxed);
        // What was ordered before this frame was shown has been sent: see `tell_display`.
        (Frame(self.display.load(Ordering::Acquire)), pictures)
    }

    /// Learns what is shown elsewhere.
    pub(super) fn learn_shown(&self, frame: Frame, pictures: u64) {
        self.display.store(frame.0, Ordering::Release);
        self.pictures.store(pictures, Ordering::Relaxed);
        self.done.store(false, Ordering::Relaxed);
    }

    /// Takes over what the physics elsewhere made known.
    pub(super) fn learn_published(&self, published: Published, done: bool) {
        self.published.store(Arc::new(published));
        self.done.store(done, Ordering::Relaxed);
    }

    /// Learns that commands threw the physics back to a frame.
    pub(super) fn learn_drop(&self, frame: Frame) {
        self.dropped_to.fetch_min(frame.0, Ordering::Relaxed);
    }

    /// Whether physics waits for the display.
    pub(super) fn is_physics_done(&self) -> bool {
        self.done.load(Ordering::Relaxed)
    }

    /// How far back commands have thrown the physics since the last call; none when no command came.
    pub(super) fn take_drop(&self) -> Option<Frame> {
        Some(self.dropped_to.swap(u64::MAX, Ordering::Relaxed)).filter(|frame| *frame != u64::MAX).map(Frame)
    }

    /// Asks for a fork for a preview; an older one that still waits is forgotten.
    pub(super) fn ask_preview(&self, asked: AskedPreview) {
        self.preview.store(Some(Arc::new(asked)));
        self.wake();
    }

    pub(super) fn take_preview(&self) -> Option<Arc<AskedPreview>> {
        // A look is cheaper than a swap, and nearly always there is nothing.
        if self.preview.load().is_none() { None } else { self.preview.swap(None) }
    }

    /// Asks the physics to end.
    pub(super) fn stop(&self) {
        self.stopping.store(true, Ordering::Relaxed);
        self.wake();
    }

    /// Wakes the physics, or keeps it from its next sleep.
    pub(super) fn wake(&self) {
        // Set before the thread is handed out by `spawn`.
        if let Some(thread) = self.sleeper.get() {
            thread.unpark();
        }
    }
}

/// All that the physics thread owns.
pub(super) struct Physics {
    pub(super) timeline: Timeline,
    pub(super) shared: Arc<Shared>,
    pub(super) messages: Receiver<Message>,
    pub(super) refusals: SyncSender<Refusal>,
    pub(super) forks: SyncSender<Fork>,
    pub(super) heard: Heard,
    /// Messages heard at a time, so that a flood of them cannot keep physics from its work.
    pub(super) command_capacity: usize,
    pub(super) count_areas: bool,
    pub(super) stage_watch: Option<StageWatch>,
    pub(super) reach: Reach,
    /// Whether all was done at some moment since the last commands came.
    pub(super) caught_up: bool,
    /// Pictures that the reach has grown for.
    pub(super) pictures: u64,
    pub(super) hinder: Hinder,
    pub(super) recorder: Option<Recorder>,
}

/// Starts the thread; returns once it can be woken.
pub(super) fn spawn(mut physics: Physics, threads: Threads) -> io::Result<JoinHandle<()>> {
    let (ready, is_ready) = sync_channel::<()>(1);
    let shared = Arc::clone(&physics.shared);
    let thread = std::thread::Builder::new().name("forerun-physics".to_owned()).spawn(move || {
        // The whole loop lives on a thread of the pool: parallel loops then start without handing over from thread to thread.
        let ended = catch_unwind(AssertUnwindSafe(|| {
            threads.install(|| {
                // The thread is new and the cell empty; were it not, the first sleeper would be the right one.
                let _ = physics.shared.sleeper.set(std::thread::current());
                let _ = ready.send(());
                physics.run();
            });
        }));
        if let Err(panic) = ended {
            *shared.panic.lock().unwrap_or_else(PoisonError::into_inner) = Some(message_of(&*panic));
        }
    })?;
    // An error means that the thread ended before it was ready, which the first call of `show` reports.
    let _ = is_ready.recv();
    Ok(thread)
}

impl Physics {
    fn run(&mut self) {
        while !self.shared.stopping.load(Ordering::Relaxed) {
            if self.turn() == Progress::Idle {
                std::thread::park();
                self.shared.done.store(false, Ordering::Relaxed);
            }
        }
        if let Some(recorder) = &self.recorder {
            recorder.mark(&self.timeline);
        }
    }

    /// Hears what waits, computes one frame and makes it known; `Idle` when there is none to compute.
    pub(super) fn turn(&mut self) -> Progress {
        self.catch_up();
        let progress = self.advance();
        match progress {
            Progress::Advanced(advance) => {
                let slices_max = u8::try_from(advance.slices_max).unwrap_or(u8::MAX);
                let areas_active = self.count_areas.then(|| self.timeline.areas_active(advance.frame));
                self.shared.notes.write(advance.frame, FrameNote { slices_max, areas_active });
                (self.hinder)();
                self.publish();
            }
            Progress::Idle => {
                self.caught_up = true;
                self.shared.done.store(true, Ordering::Relaxed);
            }
        }
        progress
    }

    /// Hears what waits and learns what is shown.
    ///
    /// What is shown is read first and learned last. So all that was ordered before it was shown is heard while the frames are still kept that it
    /// was ordered for, and what is heard is judged by what the user sees now.
    pub(super) fn catch_up(&mut self) {
        let shown = Frame(self.shared.display.load(Ordering::Acquire));
        self.hear(shown);
        self.learn_display(shown);
        if let Some(asked) = self.shared.take_preview() {
            asked.desk.ask_preview(asked.ticket, asked.preview.clone(), self.timeline.fork());
        }
    }

    /// Learns what is shown, and how far ahead of it to go.
    fn learn_display(&mut self, shown: Frame) {
        self.timeline.set_display(shown);
        let pictures = self.shared.pictures.load(Ordering::Relaxed);
        if pictures != self.pictures {
            self.pictures = pictures;
            self.reach.grow();
            if let Some(recorder) = &self.recorder {
                recorder.mark_when_due(&self.timeline);
            }
        }
    }

    /// The next frame of work, as far as the reach goes.
    fn advance(&mut self) -> Progress {
        let reached = self.timeline.display().plus(u64::from(self.reach.frames()));
        if self.timeline.valid_to() >= reached {
            return Progress::Idle;
        }
        match &mut self.stage_watch {
            Some(watch) => watch.advance(&mut self.timeline, &self.shared.stage_times),
            None => self.timeline.advance(),
        }
    }

    /// Takes the messages that wait, while this frame is shown.
    fn hear(&mut self, shown: Frame) {
        let messages: Vec<Message> = self.messages.try_iter().take(self.command_capacity).collect();
        let mut changed = false;
        for message in messages {
            match message {
                Message::Obey(order) => changed |= self.obey(order),
                // When nobody takes the forks that there are, nobody wants this one either.
                Message::Fork => drop(self.forks.try_send(self.heard.fork(&self.timeline))),
                Message::Adopt(fork) => changed |= self.adopt(*fork, shown),
            }
        }
        if changed {
            // What is thrown away then was computed in time that nobody else wanted.
            if !std::mem::take(&mut self.caught_up) {
                self.reach.shorten();
            }
            self.shared.dropped_to.fetch_min(self.timeline.valid_to().0, Ordering::Relaxed);
            self.publish();
        }
    }

    /// Obeys and records an order; whether it was possible.
    fn obey(&mut self, order: Order) -> bool {
        let recorded = self.recorder.is_some().then(|| order.clone());
        let refusal = self.heard.obey(&mut self.timeline, order).err();
        if let Some((recorder, order)) = self.recorder.as_ref().zip(recorded)
            && refusal.as_ref().is_none_or(Refusal::forgets)
        {
            recorder.order(&order, &self.timeline);
        }
        let obeyed = refusal.is_none();
        self.refuse(refusal);
        obeyed
    }

    /// Adopts a fork, and records the timeline that it is from now on; whether it was possible.
    fn adopt(&mut self, fork: Fork, shown: Frame) -> bool {
        match self.heard.adopt(&mut self.timeline, fork, shown) {
            Ok(refused) => self.refuse(refused),
            Err(error) => {
                self.refuse([Refusal::Adopt(error)]);
                return false;
            }
        }
        if let Some(recorder) = &self.recorder {
            recorder.restart(&self.timeline);
        }
        true
    }

    fn refuse(&self, refusals: impl IntoIterator<Item = Refusal>) {
        for refusal in refusals {
            // When it is full, nobody has asked for refusals for a whole queue's length, and nobody wants this one either.
            let _ = self.refusals.try_send(refusal);
        }
    }

    fn publish(&self) {
        self.shared.published.store(Arc::new(Published::of(&self.timeline)));
    }
}

pub(super) fn message_of(panic: &(dyn Any + Send)) -> String {
    match (panic.downcast_ref::<&str>(), panic.downcast_ref::<String>()) {
        (Some(text), _) => (*text).to_owned(),
        (_, Some(text)) => text.clone(),
        _ => "with a value that is no text".to_owned(),
    }
}

#[cfg(test)]
mod tests;
