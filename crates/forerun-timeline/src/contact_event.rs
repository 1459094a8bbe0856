//! Contact events: where touching begins and ends over a range of time, stored past and computed future alike, and how hard it hits.
//!
//! Promise: a function of the stored touches alone, which equal those of a full simulation, bit for bit, as states do. Frames and blocks
//! that are the same memory are not looked at.

use std::cmp::Ordering;

use forerun_dynamics::Touch;

use crate::touch_table::TouchTable;
use crate::{Frame, Snapshot};

/// What happened between two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ContactKind {
    /// They touch, and did not in the frame before.
    Begin,
    /// They come together at least as fast as was asked for ([`Touch::speed`]), and did not in the frame before: what makes a noise. The
    /// impulse may be that of the next frame in part, as what lands is slowed first and stopped then.
    Hit,
    /// They touched in the frame before, and do not any more.
    End,
}

/// Something that happened in the step that led to a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactEvent {
    /// The frame: the event is over when the display shows it.
    pub frame: Frame,
    /// What happened.
    pub kind: ContactKind,
    /// To whom, where and how hard. Of an end it is the last touch, that of the frame before.
    pub touch: Touch,
}

impl Snapshot {
    /// Who touched whom in the step that led to a frame, sorted by pair. None where the frame is not stored, at frame 0, and where touches
    /// are not recorded (see [`TimelineSettings::record_contacts`](crate::TimelineSettings::record_contacts)). Beyond
    /// [`valid_to`](Snapshot::valid_to) it may still come out otherwise.
    #[must_use]
    pub fn contacts(&self, frame: Frame) -> Vec<Touch> {
        let touches = self.tables.get(frame).map(|table| table.touches());
        let mut touches: Vec<Touch> = touches.into_iter().flat_map(TouchTable::iter).copied().collect();
        touches.sort_by_key(|touch| (touch.first, touch.second));
        touches
    }

    /// Where touching begins and ends after one time and up to another (seconds since frame 0), as far as frames are stored, sorted by
    /// frame, then pair. What lies beyond [`valid_to`](Snapshot::valid_to) may still come out otherwise. The oldest frame has no events,
    /// as the one before it is not known. None where a time is no number.
    ///
    /// ```
    /// # use forerun_dynamics::{BodyDef, BodyId, Environment};
    /// # use forerun_geometry::{Vec3, shape::Shape};
    /// # use forerun_timeline::{ContactKind, Frame, Progress, Timeline, TimelineSettings};
    /// let ball = BodyDef::new(Shape::sphere(0.5)?).at(Vec3::new(0.0, 2.0, 0.0));
    /// let settings = TimelineSettings { record_contacts: true, ..TimelineSettings::default() };
    /// let mut timeline =
    ///     Timeline::new(&[BodyDef::fixed(Shape::HalfSpace), ball], Environment::default(), settings)?;
    /// while timeline.advance() != Progress::Idle {}
    /// // The display is at 0, and the ball will land after the root of 2 h / g, 0.553 s: in the step to frame 33 it is already slowed.
    /// let events = timeline.snapshot().contact_events(0.0, 1.0);
    /// assert_eq!(events.len(), 1);
    /// assert_eq!((events[0].kind, events[0].frame.0), (ContactKind::Begin, 33));
    /// assert_eq!((events[0].touch.first, events[0].touch.second), (BodyId(0), BodyId(1)));
    /// // A ball of 524 kg at 5.4 m/s, stopped within two frames.
    /// let pushed = [33, 34].map(|frame| timeline.snapshot().contacts(Frame(frame))[0].impulse);
    /// assert!((pushed[0] + pushed[1] - 524.0 * 5.4).abs() < 100.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn contact_events(&self, from: f64, to: f64) -> Vec<ContactEvent> {
        let mut events = self.events(from, to, f32::INFINITY);
        events.retain(|event| event.kind != ContactKind::Hit);
        events
    }

    /// The touches after one time and up to another (seconds since frame 0) in which two bodies come together at a speed (m/s) or faster,
    /// and did not in the frame before, sorted by frame, then pair. As [`Snapshot::contact_events`] otherwise.
    #[must_use]
    pub fn hits(&self, from: f64, to: f64, speed_min: f32) -> Vec<ContactEvent> {
        let mut events = self.events(from, to, speed_min);
        events.retain(|event| event.kind == ContactKind::Hit);
        events
    }

    fn events(&self, from: f64, to: f64, speed_min: f32) -> Vec<ContactEvent> {
        let mut events = Vec::new();
        if from.is_nan() || to.is_nan() {
            return events;
        }
        let (after, last) = (self.frame_by(from), self.frame_by(to));
        // Within a run of equal tables nothing begins or ends.
        let runs = self.tables.runs().zip(self.tables.runs().skip(1));
        for ((_, before), (frame, now)) in runs.filter(|(_, (frame, _))| *frame > after && *frame <= last) {
            events_of(frame, Some(before.touches()), now.touches(), speed_min, &mut events);
        }
        events
    }
}

/// Adds the events of a frame from the touches of the frame before and its own, sorted by pair. Without a frame before, all touches begin,
/// and none is a hit.
pub(crate) fn events_of(
    frame: Frame,
    before: Option<&TouchTable>,
    now: &TouchTable,
    speed_min: f32,
    events: &mut Vec<ContactEvent>,
) {
    let nothing = TouchTable::default();
    let (mut old, mut new) = before.unwrap_or(&nothing).unshared(now);
    let pair = |touch: &Touch| (touch.first, touch.second);
    old.sort_by_key(|touch| pair(touch));
    new.sort_by_key(|touch| pair(touch));
    let (mut old, mut new) = (old.into_iter().peekable(), new.into_iter().peekable());
    let mut add = |kind, touch: &Touch| events.push(ContactEvent { frame, kind, touch: *touch });
    loop {
        let order = match (old.peek(), new.peek()) {
            (Some(a), Some(b)) => pair(a).cmp(&pair(b)),
            (Some(_), None) => Ordering::Less,
            (None, Some(_)) => Ordering::Greater,
            (None, None) => break,
        };
        // By the order, the lists that are asked for a touch have one.
        let ended = if order == Ordering::Greater { None } else { old.next() };
        let begun = if order == Ordering::Less { None } else { new.next() };
        match (ended, begun) {
            (Some(last), None) => add(ContactKind::End, last),
            (last, Some(touch)) => {
                if last.is_none() {
                    add(ContactKind::Begin, touch);
                }
                let fast = |touch: &Touch| touch.speed >= speed_min;
                if before.is_some() && fast(touch) && !last.is_some_and(fast) {
                    add(ContactKind::Hit, touch);
                }
            }
            (None, None) => {}
        }
    }
}
