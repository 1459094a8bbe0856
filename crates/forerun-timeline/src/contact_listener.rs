//! Contact listener: tells each contact event once, when the display passes it, and not before.
//!
//! The future is computed long before it is shown, and may be edited until then. So an event is told when the display time reaches its
//! frame and the frame is known to be true; one that an edit made go away before that is never told.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::contact_event::events_of;
use crate::frame_table::FrameTable;
use crate::{ContactEvent, Frame, Snapshot};

/// What is done about events behind the display, when a command comes so late that it changes what was shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LateEdits {
    /// They are let be: nothing is taken back, and what newly happens behind the display is not told. Beginnings and ends of a pair still
    /// take turns: a touch that is gone ends with the next frame that is told, one that is there by then begins with it.
    #[default]
    LetBe,
    /// Events that did not happen after all are retracted and new ones are told, as long as their frames are stored: what was told less what
    /// was retracted is what [`Snapshot::contact_events`] lists. An event that only changed in strength or place stays as it was told. Keeps
    /// the states of all frames that can still be corrected, as they were told.
    Correct,
}

/// What a [`ContactListener`] is to tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ListenerSettings {
    /// Two bodies that come together at this speed or faster [hit](crate::ContactKind::Hit) each other. m/s; infinite (the default) for no hits.
    pub hit_speed_min: f32,
    /// What is done about events behind the display.
    pub late_edits: LateEdits,
}

impl Default for ListenerSettings {
    fn default() -> Self {
        ListenerSettings { hit_speed_min: f32::INFINITY, late_edits: LateEdits::LetBe }
    }
}

/// News for whoever plays sounds, counts points or opens doors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactNotice {
    /// The display has passed this event.
    Happened(ContactEvent),
    /// This event was told, and a late edit made it untrue. Only with [`LateEdits::Correct`].
    Retracted(ContactEvent),
}

/// Tells each contact event of a timeline once, when the display passes it. Has no thread, no clock and no lock: whoever shows a picture
/// asks it what that picture has passed.
///
/// ```
/// # use forerun_dynamics::{BodyDef, BodyId, Environment};
/// # use forerun_geometry::{Vec3, shape::Shape};
/// # use forerun_timeline::{Change, ContactKind, ContactListener, ContactNotice, Frame, Progress, Timeline, TimelineSettings};
/// let ball = BodyDef::new(Shape::sphere(0.5)?).at(Vec3::new(0.0, 2.0, 0.0));
/// let settings = TimelineSettings { record_contacts: true, ..TimelineSettings::default() };
/// let mut timeline =
///     Timeline::new(&[BodyDef::fixed(Shape::HalfSpace), ball], Environment::default(), settings)?;
/// while timeline.advance() != Progress::Idle {}
/// let mut listener = ContactListener::default();
/// // At 0.5 s nothing has touched yet, though it is known that the ball will land at 0.567 s.
/// assert!(listener.pass(&timeline.snapshot(), 0.5).is_empty());
/// // Somebody catches it in mid-air, and lets go later.
/// let caught = Change::Move { body: BodyId(1), pose: forerun_geometry::Pose::from_position(Vec3::Y) };
/// timeline.change(Frame(32), caught)?;
/// while timeline.advance() != Progress::Idle {}
/// assert!(listener.pass(&timeline.snapshot(), 0.55).is_empty());
/// let notices = listener.pass(&timeline.snapshot(), 0.7);
/// assert!(matches!(&notices[..], [ContactNotice::Happened(event)] if event.kind == ContactKind::Begin));
/// assert!(listener.pass(&timeline.snapshot(), 0.7).is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct ContactListener {
    settings: ListenerSettings,
    /// The frames that were told, consecutive but where frames were forgotten unseen; the last one, and with [`LateEdits::Correct`] those
    /// before it that are stored.
    told: VecDeque<Told>,
}

/// What was told of one frame, and from what.
#[derive(Clone, Debug)]
struct Told {
    frame: Frame,
    /// `None` where listening began.
    before: Option<Arc<FrameTable>>,
    now: Arc<FrameTable>,
    /// Only where they may have to be corrected.
    events: Vec<ContactEvent>,
}

impl Told {
    fn events(&self, settings: &ListenerSettings) -> Vec<ContactEvent> {
        let mut events = Vec::new();
        let before = self.before.as_ref().map(|before| before.touches());
        events_of(self.frame, before, self.now.touches(), settings.hit_speed_min, &mut events);
        events
    }
}

impl ContactListener {
    /// A listener that has heard nothing yet.
    #[must_use]
    pub fn new(settings: ListenerSettings) -> ContactListener {
        ContactListener { settings, told: VecDeque::new() }
    }

    /// Forgets what was told: the next call is a first one. For a display that jumps back, as by scrubbing.
    pub fn restart(&mut self) {
        self.told.clear();
    }

    /// What the display has passed since the last call, now that it shows this snapshot at this time (seconds since frame 0): corrections
    /// first, then what happened, both sorted by frame, then pair.
    ///
    /// The first call begins all that touches at its frame. A display that stands still or runs backwards passes nothing. Where
    /// physics is late, events wait until their frame is known to be true; frames that were forgotten before they were told are skipped,
    /// and what they changed is told with the first that is left.
    #[must_use]
    pub fn pass(&mut self, snapshot: &Snapshot, seconds: f64) -> Vec<ContactNotice> {
        let mut notices = Vec::new();
        if seconds.is_nan() {
            return notices;
        }
        if self.settings.late_edits == LateEdits::Correct {
            self.correct(snapshot, &mut notices);
        }
        let last = snapshot.frame_by(seconds).min(snapshot.valid_to());
        let first = match self.told.back() {
            Some(told) => told.frame.next().max(snapshot.oldest()),
            None => last,
        };
        for frame in (first.0..=last.0).map(Frame) {
            let Some(now) = snapshot.tables.get(frame) else { break };
            let told = Told {
                frame,
                before: self.before(snapshot, frame),
                now: Arc::clone(now),
                events: Vec::new(),
            };
            let events = told.events(&self.settings);
            notices.extend(events.iter().copied().map(ContactNotice::Happened));
            match self.settings.late_edits {
                LateEdits::LetBe => self.told = VecDeque::from([told]),
                LateEdits::Correct => self.told.push_back(Told { events, ..told }),
            }
        }
        notices
    }

    /// What the events of a frame are told in comparison with: what was told last, or with corrections, what is true.
    fn before(&self, snapshot: &Snapshot, frame: Frame) -> Option<Arc<FrameTable>> {
        let last = self.told.back()?;
        let stored = frame.0.checked_sub(1).and_then(|before| snapshot.tables.get(Frame(before)));
        match (self.settings.late_edits, stored) {
            (LateEdits::Correct, Some(stored)) => Some(Arc::clone(stored)),
            _ => Some(Arc::clone(&last.now)),
        }
    }

    /// Compares what was told with what is true now, where both are known.
    fn correct(&mut self, snapshot: &Snapshot, notices: &mut Vec<ContactNotice>) {
        // The last one is kept: the next frame may be told in comparison with it.
        while self.told.len() > 1 && self.told[0].frame <= snapshot.oldest() {
            self.told.pop_front();
        }
        for told in self.told.iter_mut().filter(|told| told.frame <= snapshot.valid_to()) {
            let before = told.frame.0.checked_sub(1).and_then(|frame| snapshot.tables.get(Frame(frame)));
            let (Some(now), true) =
                (snapshot.tables.get(told.frame), told.before.is_none() || before.is_some())
            else {
                continue;
            };
            let before = told.before.as_ref().and(before);
            let same = |a: Option<&Arc<FrameTable>>, b: Option<&Arc<FrameTable>>| {
                a.map(Arc::as_ptr) == b.map(Arc::as_ptr)
            };
            if Arc::ptr_eq(now, &told.now) && same(before, told.before.as_ref()) {
                continue;
            }
            (told.before, told.now) = (before.cloned(), Arc::clone(now));
            let events = told.events(&self.settings);
            // Both sorted by pair, then kind.
            let key = |event: &ContactEvent| (event.touch.first, event.touch.second, event.kind);
            let among = |event: &ContactEvent, others: &[ContactEvent]| {
                others.binary_search_by_key(&key(event), key).is_ok()
            };
            let gone = told.events.iter().filter(|event| !among(event, &events));
            notices.extend(gone.copied().map(ContactNotice::Retracted));
            let news = events.iter().filter(|event| !among(event, &told.events));
            notices.extend(news.copied().map(ContactNotice::Happened));
            told.events = events;
        }
    }
}
