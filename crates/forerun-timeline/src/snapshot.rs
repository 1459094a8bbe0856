//! Snapshot: an immutable picture of the timeline that a display keeps and samples without locks.

use std::collections::BTreeMap;
use std::sync::Arc;

use forerun_dynamics::{Body, BodyId, BodyState, Environment};
use forerun_geometry::{Pose, Vec3};

use crate::areas::Grid;
use crate::commanding::FrameEffects;
use crate::definitions::Definitions;
use crate::frame_table::FrameTable;
use crate::marks::Marks;
use crate::tables::Tables;
use crate::{Frame, Timeline, sample};

/// A body that physics is late with goes on for so many frames before it is held.
const EXTRAPOLATED_FRAMES: f32 = 3.0;

/// Times closer to a frame than this (relative, in frames) are that frame.
const SAME_FRAME: f64 = 1e-9;

/// How sure a sampled state is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Certainty {
    /// From states that are known to be true for all commands accepted before the snapshot.
    Exact,
    /// From stored states that nothing has put out of date yet, after a frame at which other bodies wait to be recomputed: those may still reach this one.
    Presumed,
    /// Physics has not yet recomputed the body so far: it goes on at its last velocity for a few frames.
    Extrapolated,
    /// Physics is late: the last state that is known, held. Or the time is forgotten: the oldest state that is kept.
    Held,
}

/// A body at some time, not only at a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Where the body's own frame is.
    pub pose: Pose,
    /// Velocity of the centre of mass. m/s.
    pub velocity: Vec3,
    /// Angular velocity in the world. rad/s.
    pub angular_velocity: Vec3,
    /// How sure this is.
    pub certainty: Certainty,
}

/// States of all bodies from [`oldest`](Snapshot::oldest) to [`horizon`](Snapshot::horizon), as they were known when it was made.
/// Making one costs a reference count per frame in which something moved; it never changes and has no locks.
#[derive(Clone, Debug)]
pub struct Snapshot {
    pub(crate) valid_to: Frame,
    pub(crate) tables: Tables,
    pub(crate) definitions: Arc<Definitions>,
    /// The bodies that wait to be recomputed. Sorted by body.
    pub(crate) doubtful: Vec<Doubt>,
    /// What the commands of each frame did.
    pub(crate) effects: Arc<BTreeMap<Frame, Arc<FrameEffects>>>,
    /// What the display marks along the time.
    pub(crate) marks: Marks,
    pub(crate) grid: Grid,
}

/// A body that waits to be recomputed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Doubt {
    pub(crate) body: BodyId,
    /// The last frame at which it is known to be true.
    pub(crate) known_to: Frame,
    /// Whether it is known where the step from there leads, and only what commands then do to it is not.
    pub(crate) arrives: bool,
}

impl Timeline {
    /// An immutable picture of the whole, for the display. Cheap.
    #[must_use]
    pub fn snapshot(&self) -> Arc<Snapshot> {
        Arc::new(Snapshot {
            valid_to: self.valid_to(),
            tables: self.tables.clone(),
            definitions: Arc::clone(&self.definitions),
            doubtful: self.doubtful(),
            effects: Arc::clone(&self.effects),
            marks: self.marks(),
            grid: self.areas.grid(),
        })
    }

    /// The bodies that wait to be recomputed. Sorted by body. There may be more: whom these will reach is not known yet.
    pub(crate) fn doubtful(&self) -> Vec<Doubt> {
        let mut doubtful: BTreeMap<BodyId, Doubt> = BTreeMap::new();
        for (known_to, stale) in &self.stale {
            let table = self.table(*known_to);
            let mut doubt = |body: BodyId, arrives: bool| {
                doubtful.entry(body).or_insert(Doubt { body, known_to: *known_to, arrives });
            };
            let differing = stale.differing(table, |body| self.definitions.body(body, *known_to));
            differing.into_iter().for_each(|body| doubt(body, false));
            stale.touched.iter().for_each(|body| doubt(*body, true));
            // Once all are in doubt there is nobody to look for in the frames that follow.
            if (stale.everyone || stale.all_touched) && doubtful.len() < table.population() {
                for (body, _) in table.iter() {
                    let doubt = Doubt { body, known_to: *known_to, arrives: !stale.everyone };
                    doubtful.entry(body).or_insert(doubt);
                }
            }
        }
        doubtful.into_values().collect()
    }
}

impl Snapshot {
    /// The oldest frame kept.
    #[must_use]
    pub fn oldest(&self) -> Frame {
        self.tables.oldest()
    }

    /// The last frame computed.
    #[must_use]
    pub fn horizon(&self) -> Frame {
        self.tables.horizon()
    }

    /// The last frame that is known to be true for all bodies.
    #[must_use]
    pub fn valid_to(&self) -> Frame {
        self.valid_to
    }

    /// Length of a frame. Seconds.
    #[must_use]
    pub fn frame_seconds(&self) -> f32 {
        self.definitions.environment(self.oldest()).settings.frame_seconds
    }

    /// The stored state of a body; `None` when there is none at that frame.
    #[must_use]
    pub fn state(&self, body: BodyId, frame: Frame) -> Option<&BodyState> {
        self.tables.get(frame)?.get(body)
    }

    /// The body as it is from this frame to the next; `None` when it does not exist then.
    #[must_use]
    pub fn body_at(&self, body: BodyId, frame: Frame) -> Option<&Arc<Body>> {
        self.definitions.body(body, frame)
    }

    /// The bodies that are stored at a frame, in the order of their ids; none when the frame is not stored.
    pub fn bodies_at(&self, frame: Frame) -> impl Iterator<Item = BodyId> {
        self.tables.get(frame).into_iter().flat_map(|table| table.iter().map(|(body, _)| body))
    }

    /// The body at a time (seconds since frame 0): exactly the stored state at a frame; between two of them interpolated towards where the
    /// step leads, so that what a command does to a body is seen at the command's frame and not before; past the last one that is
    /// known, and before the oldest that is kept, held. `None` where the body does not exist, or `seconds` is no number.
    ///
    /// Lengths of frames are `f32`: the time of a frame is [`Frame::seconds`], which `n / 60.0` misses by a hair.
    #[must_use]
    pub fn sample(&self, body: BodyId, seconds: f64) -> Option<Sample> {
        if seconds.is_nan() {
            return None;
        }
        self.sample_at(body, &self.look_at(seconds))
    }

    /// All bodies at a time, in the order of their ids. `samples` is emptied first and keeps its memory.
    pub fn sample_all(&self, seconds: f64, samples: &mut Vec<(BodyId, Sample)>) {
        samples.clear();
        let look = self.look_at(seconds);
        self.for_each_shown(look.moment, |body| {
            samples.extend(self.sample_at(body, &look).map(|sample| (body, sample)));
        });
    }

    /// Calls `visit` with the bodies of which there may be something to show at a moment, in the order of their ids.
    pub(crate) fn for_each_shown(&self, moment: Moment, visit: impl FnMut(BodyId)) {
        let frame = moment.frame.min(self.horizon());
        if self.doubtful.is_empty() {
            return self.bodies_at(frame).for_each(visit);
        }
        // A body that waits to be recomputed may be gone at this frame already, and still be shown as it was.
        let mut bodies: Vec<BodyId> = self.bodies_at(frame).collect();
        bodies.extend(self.doubtful.iter().map(|doubt| doubt.body));
        bodies.sort_unstable();
        bodies.dedup();
        bodies.into_iter().for_each(visit);
    }

    /// The fewest states that a body has stored ahead of a display time (seconds) and that are known to be true.
    #[must_use]
    pub fn queue_min(&self, seconds: f64) -> u64 {
        let shortest = self.doubtful.iter().map(|doubt| doubt.known_to).min();
        shortest.unwrap_or_else(|| self.horizon()).since(self.moment(seconds).frame)
    }

    /// The most states that a body has stored ahead of a display time (seconds) and that are known to be true.
    #[must_use]
    pub fn queue_max(&self, seconds: f64) -> u64 {
        // Bodies that wait to be recomputed have fewer; when all of them wait, the longest counts.
        let last = self.horizon();
        let waiting = self.bodies_at(last).all(|body| self.known_to(body) < last);
        let longest = self.doubtful.iter().map(|doubt| doubt.known_to).max().filter(|_| waiting);
        longest.unwrap_or(last).since(self.moment(seconds).frame)
    }

    pub(crate) fn moment(&self, seconds: f64) -> Moment {
        let frames = (seconds / f64::from(self.frame_seconds())).max(self.oldest().0 as f64);
        // A time that was computed from a frame means that frame (dissertation, algorithm 1: epsilon).
        let nearest = frames.round();
        if (frames - nearest).abs() <= SAME_FRAME * nearest.max(1.0) {
            return Moment { frame: Frame(nearest as u64), part: 0.0 };
        }
        let frame = frames.floor();
        Moment { frame: Frame(frame as u64), part: (frames - frame) as f32 }
    }

    /// The last frame that a display at a time (seconds) has reached; at least the oldest.
    pub(crate) fn frame_by(&self, seconds: f64) -> Frame {
        self.moment(seconds).frame
    }

    /// Whether a time is before all that is kept.
    fn moment_before(&self, seconds: f64) -> bool {
        let oldest_s = self.oldest().seconds(self.frame_seconds());
        seconds < oldest_s - SAME_FRAME * oldest_s.max(1.0)
    }

    /// What all samples of a time have in common.
    pub(crate) fn look_at(&self, seconds: f64) -> Look<'_> {
        let moment = self.moment(seconds);
        let next = moment.frame.next();
        Look {
            moment,
            here: self.tables.get(moment.frame),
            next: self.tables.get(next),
            commanded: self.effects.get(&next).map(AsRef::as_ref),
            environment: self.definitions.environment(moment.frame),
            forgotten: self.moment_before(seconds),
        }
    }

    fn doubt(&self, body: BodyId) -> Option<&Doubt> {
        if self.doubtful.is_empty() {
            return None;
        }
        let found = self.doubtful.binary_search_by_key(&body, |doubt| doubt.body);
        found.ok().map(|index| &self.doubtful[index])
    }

    /// The last frame at which a body is known to be true. Bodies that wait for others may still come out otherwise: beyond
    /// [`valid_to`](Snapshot::valid_to) this is what is known by now.
    #[must_use]
    pub fn known_to(&self, body: BodyId) -> Frame {
        self.doubt(body).map_or_else(|| self.horizon(), |doubt| doubt.known_to)
    }

    fn sample_at(&self, id: BodyId, look: &Look) -> Option<Sample> {
        let (body, state, certainty) = self.shown(id, look)?;
        Some(sample_of(body, &state, certainty))
    }

    /// What a body is at a time, the state that it is shown in, and how sure that is.
    pub(crate) fn shown(&self, id: BodyId, look: &Look) -> Option<(&Body, BodyState, Certainty)> {
        let doubt = self.doubt(id);
        let known_to = doubt.map_or_else(|| self.horizon(), |doubt| doubt.known_to);
        let arrives = doubt.is_some_and(|doubt| doubt.arrives);
        let Moment { frame, part } = look.moment;
        if frame > known_to || (frame == known_to && part > 0.0 && !arrives) {
            return self.shown_late(id, look.moment, known_to);
        }
        let body = self.definitions.body(id, frame)?;
        let state = look.here?.get(id)?;
        let beyond = frame > self.valid_to || (frame == self.valid_to && part > 0.0);
        let certainty = match (look.forgotten, beyond) {
            (true, _) => Certainty::Held,
            (_, true) => Certainty::Presumed,
            _ => Certainty::Exact,
        };
        let next = look.arrival(id).filter(|_| part > 0.0);
        Some(match next {
            Some(next) if !stays(state, next) => {
                (body, sample::between((state, next), part, body, &look.environment), certainty)
            }
            _ => (body, *state, certainty),
        })
    }

    /// A body after the last frame at which it is known.
    fn shown_late(
        &self,
        id: BodyId,
        moment: Moment,
        known_to: Frame,
    ) -> Option<(&Body, BodyState, Certainty)> {
        let body = self.definitions.body(id, known_to)?;
        let state = self.state(id, known_to)?;
        if known_to == self.horizon() {
            return Some((body, *state, Certainty::Held));
        }
        let late = moment.frame.since(known_to) as f32 + moment.part;
        let shown = sample::beyond(state, late.min(EXTRAPOLATED_FRAMES), self.frame_seconds());
        let certainty = if late <= EXTRAPOLATED_FRAMES { Certainty::Extrapolated } else { Certainty::Held };
        Some((body, shown, certainty))
    }
}

/// A time, and what is stored around it.
pub(crate) struct Look<'a> {
    pub(crate) moment: Moment,
    pub(crate) here: Option<&'a Arc<FrameTable>>,
    pub(crate) next: Option<&'a Arc<FrameTable>>,
    /// What the commands of the next frame did.
    commanded: Option<&'a FrameEffects>,
    pub(crate) environment: Environment,
    /// Whether the time is before all that is kept: the oldest states are shown in its place.
    forgotten: bool,
}

impl<'a> Look<'a> {
    /// Where the step leads a body, before the commands of the next frame: nothing that is shown before that frame depends on those.
    pub(crate) fn arrival(&self, body: BodyId) -> Option<&'a BodyState> {
        let commanded = self.commanded.and_then(|effects| effects.get(&body)?.arrived.as_ref());
        commanded.or_else(|| self.next?.get(body))
    }
}

/// Whether a body is the same at both frames, however long it has been at rest. Mostly they are the same memory.
fn stays(state: &BodyState, next: &BodyState) -> bool {
    std::ptr::eq(state, next) || BodyState { rest: state.rest, ..*next }.same_bits(state)
}

/// A time, as a frame and a part of the next (0 to 1).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    pub(crate) frame: Frame,
    pub(crate) part: f32,
}

fn sample_of(body: &Body, state: &BodyState, certainty: Certainty) -> Sample {
    Sample {
        pose: body.own_pose(state),
        velocity: state.velocity,
        angular_velocity: state.angular_velocity,
        certainty,
    }
}
