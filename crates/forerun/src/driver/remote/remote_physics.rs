//! Remote physics: the physics' end of the way to a display that is elsewhere.

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use forerun_timeline::parts::FRAME_MAX;
use forerun_timeline::{Frame, Order, Preview, Progress, Snapshot, SnapshotDelta, Timeline};

use super::answer_value::{answered_value, preview_of};
use super::delta_value::{delta_value, stats_value};
use super::refusal_value::refusal_value;
use super::wire::{Letter, Reader, Report, StageTimesValue, Start, Writer};
use super::{LETTERS_MAX, REPORTS_MAX, RemoteError, RemoteSettings, WAITING_BYTES_MAX};
use crate::DriverError;
use crate::driver::decoupled::COMMANDS_MAX;
use crate::driver::fork::Names;
use crate::driver::hearing::{Heard, Message};
use crate::driver::inquiry::{Answered, Inquirer, Ticket};
use crate::driver::physics::{Physics, Published, Shared};
use crate::driver::reach::Reach;
use crate::driver::refusal::Refusal;
use crate::driver::stage_times::{StageTimes, StageWatch};
use crate::recording::orders::order_of;

/// So many names a letter may give without using them: who reads it is not to run out of memory for one number in it.
const RESERVED_MAX: u32 = 65_536;

/// A physics whose display is elsewhere: whoever has it calls [`turn`](RemotePhysics::turn) as often as there is time, and carries
/// messages. It starts no threads and reads no clock; parallel loops run in the pool of the caller.
///
/// ```
/// use forerun::{Decoupled, RemotePhysics, RemoteSettings, Scene, TimelineSettings, timeline_of};
/// use forerun::timeline::Progress;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // On one side:
/// let timeline = timeline_of(&Scene::open("dominoes:20")?, TimelineSettings::default())?;
/// let mut physics = RemotePhysics::new(timeline, RemoteSettings::default())?;
/// let first = physics.publish().ok_or("there is always a first report")?;
/// // On the other:
/// let (mut display, mut courier) = Decoupled::remote(&first)?;
/// display.show(0.0)?;
/// for letter in courier.outgoing() {
///     physics.receive(&letter)?;
/// }
/// while physics.turn() != Progress::Idle {}
/// if let Some(report) = physics.publish() {
///     courier.receive(&report)?;
/// }
/// assert_eq!(display.show(0.1)?.snapshot.horizon().0, 100);
/// # Ok(())
/// # }
/// ```
pub struct RemotePhysics {
    physics: Physics,
    names: Arc<Names>,
    messages: SyncSender<Message>,
    refusals: Receiver<Refusal>,
    inquirer: Inquirer,
    /// A preview that waits until what was ordered before it is heard.
    preview: Option<(Ticket, Preview)>,
    /// Answers that the display does not have.
    answers: Vec<Answered>,
    writer: Writer,
    reader: Reader,
    /// Letters taken.
    letters: u64,
    /// Reports written.
    reports: u64,
    /// Reports that the display has taken.
    acknowledged: u64,
    /// How long those are that it has not, in bytes.
    pub(super) waiting: VecDeque<usize>,
    /// How many letters were taken, as the last report tells.
    told_letters: u64,
    /// What the display has, or will have when it has taken all reports.
    sent: Option<Arc<Snapshot>>,
    /// Frames whose notes it does not have.
    noted: BTreeSet<Frame>,
    /// The number of the first stage times that it does not have.
    timed: u64,
    /// The picture for which it was told that all is done.
    told_done: Option<u64>,
}

impl std::fmt::Debug for RemotePhysics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { letters, reports, acknowledged, .. } = self;
        write!(f, "RemotePhysics {{ letters: {letters}, reports: {reports}, acknowledged: {acknowledged} }}")
    }
}

impl RemotePhysics {
    /// A physics that goes on from a timeline.
    ///
    /// # Errors
    /// When the command capacity is out of its range.
    pub fn new(mut timeline: Timeline, settings: RemoteSettings) -> Result<RemotePhysics, DriverError> {
        let capacity = settings.command_capacity;
        if !(1..=COMMANDS_MAX).contains(&capacity) {
            let message = format!("must be from 1 to {COMMANDS_MAX}, is {capacity}");
            return Err(DriverError::Setting { field: "command_capacity", message });
        }
        let names = Names::after(&mut timeline);
        let shown = timeline.display();
        let shared = Shared::new(Published::of(&timeline), &timeline.settings(), shown);
        let (messages, message_queue) = sync_channel(capacity);
        let (refusal_queue, refusals) = sync_channel(capacity);
        // Nobody takes forks.
        let (forks, _) = sync_channel(1);
        let reach = Reach::new(timeline.settings().lookahead);
        let physics = Physics {
            timeline,
            shared: Arc::new(shared),
            messages: message_queue,
            refusals: refusal_queue,
            forks,
            heard: Heard::new(Arc::clone(&names)),
            command_capacity: capacity,
            count_areas: settings.count_areas,
            stage_watch: settings.stage_clock.map(StageWatch::new),
            reach,
            caught_up: true,
            pictures: 0,
            hinder: Box::new(|| {}),
            recorder: None,
        };
        Ok(RemotePhysics {
            physics,
            names,
            messages,
            refusals,
            inquirer: Inquirer::default(),
            preview: None,
            answers: Vec::new(),
            writer: Writer::default(),
            reader: Reader::default(),
            letters: 0,
            reports: 0,
            acknowledged: 0,
            waiting: VecDeque::new(),
            told_letters: 0,
            sent: None,
            noted: BTreeSet::new(),
            timed: 0,
            told_done: None,
        })
    }

    /// The timeline: look at it.
    #[must_use]
    pub fn timeline(&self) -> &Timeline {
        &self.physics.timeline
    }

    /// Takes a message of the display. What it orders is obeyed in the next [`turn`](RemotePhysics::turn).
    ///
    /// # Errors
    /// When it is damaged, or not the one after the last: then nothing changed, and nothing that comes later fits.
    pub fn receive(&mut self, bytes: &[u8]) -> Result<(), RemoteError> {
        let opened = self.reader.open::<Letter>(bytes)?;
        let letter = opened.message;
        let due = self.letters + 1;
        if letter.number != due {
            return Err(RemoteError::OutOfTurn { due, number: letter.number });
        }
        let impossible = |what: String| Err(RemoteError::Impossible(what));
        if letter.acknowledged > self.reports || letter.acknowledged < self.acknowledged {
            return impossible(format!("report {} of {} was taken", letter.acknowledged, self.reports));
        }
        if letter.shown > FRAME_MAX {
            return impossible(format!("frame {} is shown, of at most {FRAME_MAX}", letter.shown));
        }
        let (known, _) = self.names.next();
        if letter.names > known.saturating_add(RESERVED_MAX) {
            return impossible(format!("{} names, after {known}", letter.names));
        }
        let orders: Result<Vec<Order>, String> =
            letter.orders.into_iter().map(|order| order_of(order, &opened.shapes)).collect();
        let orders = orders.map_err(RemoteError::Impossible)?;
        let preview = letter.preview.map(|preview| preview_of(preview, &opened.shapes)).transpose();
        let preview = preview.map_err(RemoteError::Impossible)?;
        self.reader.keep(opened.shapes);
        (self.letters, self.acknowledged) = (letter.number, letter.acknowledged);
        let taken = self.waiting.len().saturating_sub((self.reports - self.acknowledged) as usize);
        self.waiting.drain(..taken);
        if let Some(last) = letter.names.checked_sub(1) {
            self.names.learn_body(crate::BodyId(last));
        }
        for order in orders {
            self.names.learn_sequence(&order);
            self.order(order);
        }
        self.physics.shared.learn_shown(Frame(letter.shown), letter.pictures);
        if let Some((ticket, frame)) = letter.inspection {
            let snapshot = Arc::clone(&self.physics.shared.published.load().snapshot);
            self.inquirer.ask_inspect(Ticket(ticket), snapshot, Frame(frame));
        }
        // Of each kind the newest question counts.
        self.preview = preview.or(self.preview.take());
        Ok(())
    }

    /// Queues an order. Where the queue is full, those before it are obeyed at once: the display's own queue bounds them.
    fn order(&mut self, order: Order) {
        if let Err(TrySendError::Full(message)) = self.messages.try_send(Message::Obey(order)) {
            self.physics.catch_up();
            // Just emptied, and this end is the only one that sends.
            let _ = self.messages.try_send(message);
        }
    }

    /// Obeys what was ordered, and computes at most one frame. [`Progress::Idle`] when nothing is to be done until a message comes.
    pub fn turn(&mut self) -> Progress {
        let progress = self.physics.turn();
        // After that everything is heard that was ordered before the question.
        if let Some((ticket, preview)) = self.preview.take() {
            self.inquirer.ask_preview(ticket, self.physics.timeline.fork(), preview);
        }
        if let Progress::Advanced(advance) = progress {
            self.noted.insert(advance.frame);
        }
        progress
    }

    /// Works at what the display asked, about a frame's worth; whether there is more to do. Between two calls of [`turn`](RemotePhysics::turn), so that
    /// neither waits for the other. `now_s` is the caller's clock (seconds): a preview that takes long, while a newer one waits, is answered as far
    /// as it is known.
    pub fn answer(&mut self, now_s: f64) -> bool {
        self.answers.extend(self.inquirer.work(now_s));
        !self.inquirer.is_idle()
    }

    /// What is new since the last report, as a message for the display; `None` when nothing is, or when the display has not acknowledged
    /// enough of those before: then it is in a later one.
    #[must_use]
    pub fn publish(&mut self) -> Option<Vec<u8>> {
        let waiting_bytes: usize = self.waiting.iter().sum();
        if self.reports - self.acknowledged >= REPORTS_MAX || waiting_bytes >= WAITING_BYTES_MAX {
            return None;
        }
        let shared = Arc::clone(&self.physics.shared);
        let published = shared.published.load_full();
        let (_, pictures) = shared.shown();
        let done = shared.is_physics_done();
        let refusals: Vec<Refusal> = self.refusals.try_iter().collect();
        let sent = self.sent.clone();
        let is_new = sent.as_ref().is_none_or(|sent| !Arc::ptr_eq(sent, &published.snapshot));
        // Before the display has to wait for it, it hears that its letters were taken.
        let heard = self.letters - self.told_letters < LETTERS_MAX / 2;
        let told = refusals.is_empty() && self.answers.is_empty();
        if !is_new && told && heard && (!done || self.told_done == Some(pictures)) {
            return None;
        }
        self.told_done = done.then_some(pictures);
        self.reports += 1;
        let delta = is_new.then(|| SnapshotDelta::between(sent.as_deref(), &published.snapshot));
        let notes = std::mem::take(&mut self.noted).into_iter().filter_map(|frame| {
            let note = shared.notes.read(frame)?;
            Some((frame.0, note.slices_max, note.areas_active))
        });
        let notes = notes.collect();
        let mut times = Vec::new();
        self.timed = shared.stage_times.read(self.timed, &mut times);
        let number = self.reports;
        let answers = std::mem::take(&mut self.answers);
        let start = (number == 1).then(|| self.start());
        self.sent = Some(Arc::clone(&published.snapshot));
        self.told_letters = self.letters;
        let report = self.writer.write(|stored, new| Report {
            number,
            heard: self.letters,
            start,
            delta: delta.map(|delta| delta_value(&delta, stored, new)),
            stats: stats_value(&published.stats),
            notes,
            dropped_to: shared.take_drop().map(|frame| frame.0),
            done,
            refusals: refusals.iter().filter_map(refusal_value).collect(),
            answers: answers.iter().map(answered_value).collect(),
            stage_times: times.iter().map(times_value).collect(),
        });
        self.waiting.push_back(report.len());
        Some(report)
    }

    fn start(&self) -> Start {
        let timeline = &self.physics.timeline;
        let (body, sequence) = self.names.next();
        Start {
            lookahead: timeline.settings().lookahead,
            past: timeline.settings().past,
            display: timeline.display().0,
            // At most `COMMANDS_MAX`.
            command_capacity: self.physics.command_capacity as u32,
            body,
            sequence,
        }
    }
}

fn times_value(times: &StageTimes) -> StageTimesValue {
    let StageTimes { frame, extended, recomputed, affected, seconds, other_s, .. } = *times;
    (frame.0, extended, recomputed, affected, seconds, other_s)
}
