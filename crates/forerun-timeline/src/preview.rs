//! Preview: what would happen if. Changes are tried on a fork, and what comes out is told as poses.

use std::collections::BTreeSet;

use forerun_dynamics::BodyId;
use forerun_geometry::Pose;

use crate::tables::Tables;
use crate::{Change, CommandError, Frame, Progress, Timeline};

/// No preview goes further than this. Frames.
const FRAMES_MAX: u32 = 6000;

/// No preview tells of more bodies.
const BODIES_MAX: usize = 128;

/// Nor of more poses: some 2 MB.
const POSES_MAX: u64 = 65_536;

/// Names that a preview may make known at most: those that others have been given, and the timeline has not heard of.
const NAMES_MAX: usize = 65_536;

/// What would happen if some changes were made.
#[derive(Clone, Debug, PartialEq)]
pub struct Preview {
    /// Where the changes act, as commands do: after the oldest frame.
    pub frame: Frame,
    /// The changes, in the order in which they act. A body that is added may have any free name.
    pub changes: Vec<Change>,
    /// How many frames to look ahead from there. At most 6000.
    pub frames: u32,
    /// Of whom to tell; empty for all that come out otherwise than now. At most 128 are told of, and of at most 65 536 poses: first those that the
    /// changes are made to, then those with the lowest ids.
    pub bodies: Vec<BodyId>,
}

/// Where a body would be, frame by frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Trail {
    /// Which body.
    pub body: BodyId,
    /// The frame of the first pose.
    pub from: Frame,
    /// Its pose at that frame and those that follow, as long as it is there.
    pub poses: Vec<Pose>,
}

/// What would happen.
#[derive(Clone, Debug, PartialEq)]
pub struct Previewed {
    /// Where the changes act.
    pub frame: Frame,
    /// The last frame of which is told; before the one that was asked for where time or memory was short.
    pub to: Frame,
    /// Where the bodies would be, from the frame before the changes on. Sorted by body.
    pub trails: Vec<Trail>,
}

/// A preview on its way, frame by frame.
#[derive(Debug)]
pub struct PreviewRun {
    timeline: Timeline,
    /// What there would be without the changes.
    now: Tables,
    preview: Preview,
    end: Frame,
}

impl PreviewRun {
    /// Makes the changes on a timeline of one's own: a [fork](Timeline::fork).
    ///
    /// # Errors
    /// When a change is not possible.
    pub fn new(mut fork: Timeline, preview: Preview) -> Result<PreviewRun, CommandError> {
        let now = fork.tables.clone();
        for change in &preview.changes {
            if let Change::Add { body, .. } = change {
                let missing = (body.0 as usize).saturating_sub(fork.names());
                for _ in 0..if missing <= NAMES_MAX { missing } else { 0 } {
                    fork.reserve_body();
                }
            }
            fork.change(preview.frame, change.clone())?;
        }
        let end = preview.frame.plus(u64::from(preview.frames.min(FRAMES_MAX)));
        let reach = u32::try_from(end.since(fork.display())).unwrap_or(u32::MAX);
        fork.set_lookahead(reach.max(fork.settings().lookahead));
        Ok(PreviewRun { timeline: fork, now, preview, end })
    }

    /// Computes one frame; whether there is more to do.
    pub fn advance(&mut self) -> bool {
        let more = self.timeline.valid_to() < self.end;
        more && self.timeline.advance() != Progress::Idle && self.timeline.valid_to() < self.end
    }

    /// What would happen, as far as it is known.
    #[must_use]
    pub fn so_far(&self) -> Previewed {
        let from = self.preview.frame.minus(1);
        let to = self.timeline.valid_to().min(self.end).max(from);
        let bodies = match &self.preview.bodies[..] {
            [] => self.changed(to),
            named => named.iter().copied().collect(),
        };
        let room = (POSES_MAX / (to.since(from) + 1)).clamp(1, BODIES_MAX as u64) as usize;
        let trails = self.told_of(&bodies, room).into_iter().filter_map(|body| self.trail(body, (from, to)));
        Previewed { frame: self.preview.frame, to, trails: trails.collect() }
    }

    /// So many of some bodies.
    fn told_of(&self, bodies: &BTreeSet<BodyId>, room: usize) -> BTreeSet<BodyId> {
        let mut told = BTreeSet::new();
        let named = self.preview.changes.iter().filter_map(Change::body).filter(|body| bodies.contains(body));
        for body in named.chain(bodies.iter().copied()) {
            if told.len() == room {
                break;
            }
            told.insert(body);
        }
        told
    }

    /// The bodies that the changes are made to, and those that come out otherwise up to a frame, as far as it is known how they would without them.
    fn changed(&self, to: Frame) -> BTreeSet<BodyId> {
        let mut bodies: BTreeSet<BodyId> = self.preview.changes.iter().filter_map(Change::body).collect();
        for frame in (self.preview.frame.0..=to.min(self.now.horizon()).0).map(Frame) {
            if let (Some(now), Some(then)) = (self.now.get(frame), self.timeline.tables.get(frame)) {
                bodies.extend(then.differences(now));
            }
        }
        bodies
    }

    fn trail(&self, body: BodyId, (from, to): (Frame, Frame)) -> Option<Trail> {
        let pose = |frame: Frame| {
            let there = self.timeline.body_at(body, frame).zip(self.timeline.state(body, frame));
            there.map(|(body, state)| body.own_pose(state))
        };
        let from = (from.0..=to.0).map(Frame).find(|frame| pose(*frame).is_some())?;
        let poses = (from.0..=to.0).map(Frame).map_while(pose).collect();
        Some(Trail { body, from, poses })
    }
}
