//! Desk: the thread that answers, and where questions are laid down for it.
//!
//! It starts with the first question and sleeps between them. A question is one atomic swap: the one that lay there is dropped.

use std::io;
use std::num::NonZeroU16;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread::{JoinHandle, Thread};

use arc_swap::ArcSwapOption;
use forerun_timeline::{Preview, Snapshot, Timeline};

use super::{Answered, Inquirer, Ticket};
use crate::driver::driver_error::DriverError;
use crate::driver::physics::message_of;
use crate::{Clock, Frame, Threads};

/// Answers that may wait to be taken.
const ANSWERS_MAX: usize = 64;

/// A look into a frame that somebody wants.
#[derive(Clone, Debug)]
pub(in crate::driver) struct AskedInspection {
    pub(in crate::driver) ticket: Ticket,
    pub(in crate::driver) snapshot: Arc<Snapshot>,
    pub(in crate::driver) frame: Frame,
}

/// A preview that somebody wants; it still lacks a fork, which physics makes.
#[derive(Clone, Debug)]
pub(in crate::driver) struct AskedPreview {
    pub(in crate::driver) ticket: Ticket,
    pub(in crate::driver) preview: Preview,
    pub(in crate::driver) desk: Arc<Desk>,
}

/// A preview with its fork.
#[derive(Clone, Debug)]
struct ForkedPreview {
    ticket: Ticket,
    preview: Preview,
    fork: Timeline,
}

/// Where questions lie.
#[derive(Debug, Default)]
pub(in crate::driver) struct Desk {
    inspection: ArcSwapOption<AskedInspection>,
    preview: ArcSwapOption<ForkedPreview>,
    stopping: AtomicBool,
    /// Message of a panic of the thread; locked only after it has ended.
    panic: Mutex<Option<String>>,
    sleeper: OnceLock<Thread>,
}

impl Desk {
    /// Takes the question that lies here, to have it answered elsewhere.
    pub(in crate::driver) fn take_inspection(&self) -> Option<Arc<AskedInspection>> {
        // A look is cheaper than a swap, and nearly always there is nothing.
        if self.inspection.load().is_none() { None } else { self.inspection.swap(None) }
    }

    fn ask_inspection(&self, asked: AskedInspection) {
        self.inspection.store(Some(Arc::new(asked)));
        self.wake();
    }

    /// Called by physics.
    pub(in crate::driver) fn ask_preview(&self, ticket: Ticket, preview: Preview, fork: Timeline) {
        self.preview.store(Some(Arc::new(ForkedPreview { ticket, preview, fork })));
        self.wake();
    }

    fn wake(&self) {
        // Set before the thread is handed out by `start`.
        if let Some(thread) = self.sleeper.get() {
            thread.unpark();
        }
    }

    fn run(&self, answers: &SyncSender<Answered>) {
        let clock = Clock::system();
        let mut inquirer = Inquirer::default();
        while !self.stopping.load(Ordering::Relaxed) {
            if let Some(asked) = self.inspection.swap(None) {
                let AskedInspection { ticket, snapshot, frame } = Arc::unwrap_or_clone(asked);
                inquirer.ask_inspect(ticket, snapshot, frame);
            }
            if let Some(asked) = self.preview.swap(None) {
                let ForkedPreview { ticket, preview, fork } = Arc::unwrap_or_clone(asked);
                inquirer.ask_preview(ticket, fork, preview);
            }
            if inquirer.is_idle() {
                std::thread::park();
            } else if let Some(answered) = inquirer.work(clock.now().as_secs_f64()) {
                // When nobody takes the answers that there are, nobody wants this one either.
                let _ = answers.try_send(answered);
            }
        }
    }
}

/// The display's side of the thread. Dropping it stops the thread and waits for the frame that it is at.
#[derive(Debug)]
pub(in crate::driver) struct Inquiry {
    desk: Arc<Desk>,
    /// `None` where questions are answered elsewhere.
    thread: Option<JoinHandle<()>>,
    answers: Receiver<Answered>,
}

impl Inquiry {
    /// Starts the thread; returns once it can be woken. It has one processor: the others are for physics.
    pub(in crate::driver) fn start() -> Result<Inquiry, DriverError> {
        let threads = Threads::exactly(NonZeroU16::MIN);
        let threads = threads.map_err(|error| DriverError::NotStarted(error.to_string()))?;
        let (answer_queue, answers) = sync_channel(ANSWERS_MAX);
        let desk = Arc::new(Desk::default());
        let thread = spawn(Arc::clone(&desk), answer_queue, threads);
        let thread = thread.map_err(|error| DriverError::NotStarted(error.to_string()))?;
        Ok(Inquiry { desk, thread: Some(thread), answers })
    }

    /// Where questions are laid down that are answered elsewhere, the desk where they lie, and where the answers go.
    pub(in crate::driver) fn elsewhere() -> (Inquiry, Arc<Desk>, SyncSender<Answered>) {
        let (answer_queue, answers) = sync_channel(ANSWERS_MAX);
        let desk = Arc::new(Desk::default());
        (Inquiry { desk: Arc::clone(&desk), thread: None, answers }, desk, answer_queue)
    }

    pub(in crate::driver) fn ask_inspection(&self, asked: AskedInspection) -> Result<(), DriverError> {
        self.alive()?;
        self.desk.ask_inspection(asked);
        Ok(())
    }

    /// A preview for physics to make a fork for.
    pub(in crate::driver) fn preview(
        &self,
        ticket: Ticket,
        preview: Preview,
    ) -> Result<AskedPreview, DriverError> {
        self.alive()?;
        Ok(AskedPreview { ticket, preview, desk: Arc::clone(&self.desk) })
    }

    /// What was answered since the last call. Those that came before the thread died come first.
    pub(in crate::driver) fn answers(&self) -> Result<Vec<Answered>, DriverError> {
        let answered: Vec<Answered> = self.answers.try_iter().collect();
        if answered.is_empty() {
            self.alive()?;
        }
        Ok(answered)
    }

    /// Ends the thread as a panic would.
    #[cfg(test)]
    pub(in crate::driver) fn kill(&self, message: &str) {
        *self.desk.panic.lock().unwrap_or_else(PoisonError::into_inner) = Some(message.to_owned());
        self.desk.stopping.store(true, Ordering::Relaxed);
        self.desk.wake();
    }

    fn alive(&self) -> Result<(), DriverError> {
        if !self.thread.as_ref().is_some_and(JoinHandle::is_finished) {
            return Ok(());
        }
        let message = self.desk.panic.lock().unwrap_or_else(PoisonError::into_inner).clone();
        Err(DriverError::AnswersPanicked(message.unwrap_or_else(|| "without a message".to_owned())))
    }
}

impl Drop for Inquiry {
    fn drop(&mut self) {
        self.desk.stopping.store(true, Ordering::Relaxed);
        self.desk.wake();
        if let Some(thread) = self.thread.take() {
            // A panic was kept as a message by the thread itself, which therefore ends well.
            let _ = thread.join();
        }
    }
}

fn spawn(desk: Arc<Desk>, answers: SyncSender<Answered>, threads: Threads) -> io::Result<JoinHandle<()>> {
    let (ready, is_ready) = sync_channel::<()>(1);
    let thread = std::thread::Builder::new().name("forerun-answers".to_owned()).spawn(move || {
        let ended = catch_unwind(AssertUnwindSafe(|| {
            // On a thread of a pool of its own, so that its steps do not share out their work to that of others.
            threads.install(|| {
                // The thread is new and the cell empty.
                let _ = desk.sleeper.set(std::thread::current());
                let _ = ready.send(());
                desk.run(&answers);
            });
        }));
        if let Err(panic) = ended {
            *desk.panic.lock().unwrap_or_else(PoisonError::into_inner) = Some(message_of(&*panic));
        }
    })?;
    // An error means that the thread ended before it was ready, which the next call reports.
    let _ = is_ready.recv();
    Ok(thread)
}
