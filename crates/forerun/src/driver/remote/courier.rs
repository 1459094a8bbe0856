//! Courier: the display's end of the way to a physics that is elsewhere.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, PoisonError};

use forerun_timeline::parts::FRAME_MAX;
use forerun_timeline::{Frame, TimelineSettings};

use super::answer_value::{answered_of, preview_value};
use super::delta_value::{delta_of, stats_of};
use super::refusal_value::refusal_of;
use super::wire::{Letter, Reader, Report, Start, Writer};
use super::{LETTERS_MAX, RemoteError};
use crate::driver::decoupled::{COMMANDS_MAX, Decoupled};
use crate::driver::fork::Names;
use crate::driver::frame_notes::FrameNote;
use crate::driver::hearing::Message;
use crate::driver::inquiry::Answered;
use crate::driver::inquiry::desk::{Desk, Inquiry};
use crate::driver::physics::{Published, Shared};
use crate::driver::refusal::Refusal;
use crate::driver::stage_times::StageTimes;
use crate::recording::orders::ToFile;

/// Carries what a [`Decoupled`] says to a [`RemotePhysics`](crate::RemotePhysics), and what that answers. When it is dropped, the driver's
/// orders fail.
#[derive(Debug)]
pub struct Courier {
    shared: Arc<Shared>,
    names: Arc<Names>,
    messages: Receiver<Message>,
    refusals: SyncSender<Refusal>,
    /// Where the display lays down questions, and where it finds answers.
    desk: Arc<Desk>,
    answers: SyncSender<Answered>,
    writer: Writer,
    reader: Reader,
    /// Letters written.
    pub(super) letters: u64,
    /// Letters that the physics has taken, as far as it told.
    pub(super) heard: u64,
    /// Reports taken.
    reports: u64,
    /// What the last letter said: pictures, and reports taken.
    said: (u64, u64),
}

impl Decoupled {
    /// The display's half of a driver whose physics is elsewhere. `first` is the first message of that physics
    /// ([`RemotePhysics::publish`](crate::RemotePhysics::publish)).
    ///
    /// Everything is as with a physics thread, but [`Decoupled::request_fork`] and [`Decoupled::adopt`]: timelines do not leave where they are.
    ///
    /// # Errors
    /// When these are not the bytes of a first message.
    pub fn remote(first: &[u8]) -> Result<(Decoupled, Courier), RemoteError> {
        let mut reader = Reader::default();
        let opened = reader.open::<Report>(first)?;
        let mut report = opened.message;
        let (Some(start), 1) = (report.start.take(), report.number) else {
            return Err(RemoteError::OutOfTurn { due: 1, number: report.number });
        };
        let capacity = start.command_capacity as usize;
        if !(1..=COMMANDS_MAX).contains(&capacity) || start.display > FRAME_MAX {
            return Err(RemoteError::Impossible(format!("a queue of {capacity}, frame {}", start.display)));
        }
        let delta = report.delta.take().ok_or_else(|| RemoteError::Impossible("no snapshot".to_owned()))?;
        let delta = delta_of(delta, &opened.shapes).map_err(RemoteError::Impossible)?;
        let snapshot = delta.apply(None).map_err(|error| RemoteError::Impossible(error.to_string()))?;
        reader.keep(opened.shapes);
        let Start { lookahead, past, display, body, sequence, .. } = start;
        let settings = TimelineSettings { lookahead, past, ..TimelineSettings::default() };
        let published = Published { snapshot, stats: stats_of(&report.stats) };
        let shared = Arc::new(Shared::new(published, &settings, Frame(display)));
        let names = Names::from(body, sequence);
        let (message_sender, messages) = sync_channel(capacity);
        let (refusals, refusal_receiver) = sync_channel(capacity);
        let (inquiry, desk, answers) = Inquiry::elsewhere();
        let ends = (message_sender, refusal_receiver, inquiry);
        let driver = Decoupled::elsewhere(Arc::clone(&shared), Arc::clone(&names), lookahead, ends);
        let courier = Courier {
            shared,
            names,
            messages,
            refusals,
            desk,
            answers,
            writer: Writer::default(),
            reader,
            letters: 0,
            heard: 0,
            reports: 1,
            said: (0, 0),
        };
        Ok((driver, courier))
    }
}

impl Courier {
    /// The messages that the physics has to get now, in this order: at most one after each picture. To be asked for after every
    /// [`Decoupled::show`], and while nothing is shown as often as messages come. None while the physics has not taken many of those before: then
    /// orders wait in the driver's queue, which says when it is full.
    #[must_use]
    pub fn outgoing(&mut self) -> Vec<Vec<u8>> {
        // A physics that may not report any more has to hear that its reports were taken, whatever it has not read.
        if self.letters - self.heard >= LETTERS_MAX && self.said.1 == self.reports {
            return Vec::new();
        }
        // What is shown is read first: see `Physics::catch_up`.
        let (shown, pictures) = self.shared.shown();
        let (names, _) = self.names.next();
        let orders: Vec<Message> = self.messages.try_iter().collect();
        let inspection = self.desk.take_inspection();
        let preview = self.shared.take_preview();
        let asks = inspection.is_some() || preview.is_some();
        if orders.is_empty() && !asks && self.said == (pictures, self.reports) {
            return Vec::new();
        }
        self.said = (pictures, self.reports);
        self.letters += 1;
        let (number, acknowledged) = (self.letters, self.reports);
        let letter = self.writer.write(|stored, new| {
            let mut to = ToFile { stored, new };
            let orders = orders.iter().filter_map(|message| match message {
                Message::Obey(order) => Some(to.order(order)),
                // The driver does not send them.
                Message::Fork | Message::Adopt(_) => None,
            });
            let orders = orders.collect();
            let inspection = inspection.map(|asked| (asked.ticket.0, asked.frame.0));
            let preview = preview.map(|asked| preview_value(asked.ticket, &asked.preview, &mut to));
            Letter { number, acknowledged, shown: shown.0, pictures, names, orders, inspection, preview }
        });
        vec![letter]
    }

    /// Takes a message of the physics: from the next picture on the display sees what it says.
    ///
    /// # Errors
    /// When it is damaged, or not the one after the last: then nothing changed, and nothing that comes later fits.
    pub fn receive(&mut self, bytes: &[u8]) -> Result<(), RemoteError> {
        let opened = self.reader.open::<Report>(bytes)?;
        let report = opened.message;
        let due = self.reports + 1;
        if report.number != due || report.start.is_some() {
            return Err(RemoteError::OutOfTurn { due, number: report.number });
        }
        if report.heard > self.letters || report.heard < self.heard {
            let (heard, letters) = (report.heard, self.letters);
            return Err(RemoteError::Impossible(format!("letter {heard} of {letters} was taken")));
        }
        let before = self.shared.published.load_full();
        let snapshot = match report.delta {
            Some(delta) => delta_of(delta, &opened.shapes)
                .and_then(|delta| delta.apply(Some(&before.snapshot)).map_err(|error| error.to_string()))
                .map_err(RemoteError::Impossible)?,
            None => Arc::clone(&before.snapshot),
        };
        self.reader.keep(opened.shapes);
        (self.reports, self.heard) = (report.number, report.heard);
        for (frame, slices_max, areas_active) in report.notes {
            self.shared.notes.write(Frame(frame), FrameNote { slices_max, areas_active });
        }
        if let Some(frame) = report.dropped_to {
            self.shared.learn_drop(Frame(frame));
        }
        self.shared.learn_published(Published { snapshot, stats: stats_of(&report.stats) }, report.done);
        for refusal in report.refusals {
            // When it is full, nobody has asked for refusals for a whole queue's length, and nobody wants this one either.
            let _ = self.refusals.try_send(refusal_of(refusal));
        }
        for answered in report.answers {
            // The same.
            let _ = self.answers.try_send(answered_of(answered));
        }
        for (frame, extended, recomputed, affected, seconds, other_s) in report.stage_times {
            let frame = Frame(frame);
            let times = StageTimes { number: 0, frame, extended, recomputed, affected, seconds, other_s };
            self.shared.stage_times.write(&times);
        }
        Ok(())
    }

    /// Says that the physics has ended, and why: from now on the driver's calls return
    /// [`DriverError::Panicked`](crate::DriverError::Panicked). What came before can still be shown.
    pub fn fail(&self, message: impl Into<String>) {
        *self.shared.panic.lock().unwrap_or_else(PoisonError::into_inner) = Some(message.into());
    }
}

impl Drop for Courier {
    fn drop(&mut self) {
        let mut panic = self.shared.panic.lock().unwrap_or_else(PoisonError::into_inner);
        panic.get_or_insert_with(|| "its courier is gone".to_owned());
    }
}
