//! Editor: random changes, as a user, others in a network, and those who think better of it would make them.
//!
//! Changes are of a size that keeps the scene a scene for hours: bodies are pushed, thrown, held and let go, put elsewhere nearby, added
//! and removed again. `forerun check` has the extreme ones.

use std::collections::VecDeque;

use forerun::dynamics::Spring;
use forerun::timeline::Sample;
use forerun::timeline::check::Random;
use forerun::{
    BodyDef, BodyId, Change, Command, CommandKey, Cuboid, Decoupled, DriverError, Frame, Material, Picture,
    Pose, Shape, Vec3,
};
use serde::Serialize;

/// Bodies that are added before they are removed again.
const ADDED_MAX: usize = 30;
/// Commands that may be thought better of.
const REMEMBERED: usize = 32;
/// A command that acted longer ago is not thought better of. Frames: well within what is kept, so that no command is forgotten while it is.
const RECENT_MAX: u64 = 300;
/// How late a command comes from the network, at most. Frames.
const LATE_MAX: u64 = 60;
/// How far ahead a command is given, at most. Frames.
const AHEAD_MAX: u64 = 200;

/// How many orders there were of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Edits {
    pub(crate) local: u64,
    pub(crate) late: u64,
    pub(crate) ahead: u64,
    pub(crate) retracted: u64,
    pub(crate) replaced: u64,
    pub(crate) undone: u64,
    pub(crate) redone: u64,
    /// Commands of a drag.
    pub(crate) dragged: u64,
    /// Orders that found the queue full.
    pub(crate) queue_full: u64,
}

impl Edits {
    /// Orders that took something back, or did it again.
    pub(super) fn taken_back(&self) -> u64 {
        self.retracted + self.replaced + self.undone + self.redone
    }
}

/// Makes edits.
#[derive(Debug)]
pub(super) struct Editor {
    pub(super) edits: Edits,
    random: Random,
    added: VecDeque<BodyId>,
    held: VecDeque<BodyId>,
    recent: VecDeque<CommandKey>,
    sent: u64,
    /// Who is dragged, and from where.
    dragged: Option<(BodyId, Vec3)>,
}

/// What the editor did, where a witness has to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Done {
    /// Nothing that needs to be known.
    Something,
    /// A body is elsewhere from a frame on.
    Moved(BodyId, Frame),
    /// The local user gave a body another velocity.
    Pushed(BodyId),
}

impl Editor {
    pub(super) fn new(seed: u64) -> Editor {
        Editor {
            edits: Edits::default(),
            random: Random::new(seed),
            added: VecDeque::new(),
            held: VecDeque::new(),
            recent: VecDeque::new(),
            sent: 0,
            dragged: None,
        }
    }

    /// Whether an event that comes so often per second falls into a picture of this length.
    pub(super) fn falls(&mut self, per_second: f64, seconds: f64) -> bool {
        let chance = (per_second * seconds * 4_294_967_296.0) as u64;
        self.random.below(1 << 32) < chance
    }

    /// One order at random. A full queue is counted, not an error: the next picture brings another.
    pub(super) fn edit(
        &mut self,
        driver: &mut Decoupled,
        picture: &Picture,
        samples: &[(BodyId, Sample)],
    ) -> Result<Done, DriverError> {
        match self.order(driver, picture, samples) {
            Err(DriverError::QueueFull) => {
                self.edits.queue_full += 1;
                Ok(Done::Something)
            }
            done => done,
        }
    }

    /// One more command of a drag that goes round in circles; the body that is dragged.
    pub(super) fn drag(
        &mut self,
        driver: &mut Decoupled,
        picture: &Picture,
        samples: &[(BodyId, Sample)],
    ) -> Result<Option<BodyId>, DriverError> {
        if self.dragged.is_none() {
            let picked = self.pick(picture, samples);
            self.dragged = picked.map(|(body, sample)| (body, sample.pose.position));
        }
        let Some((body, centre)) = self.dragged else { return Ok(None) };
        let (sine, cosine) = (2.0 * picture.real_s).sin_cos();
        let target = centre + Vec3::new(sine as f32, 1.5, cosine as f32);
        let spring = Spring { anchor: Vec3::ZERO, target, frequency_hz: 4.0, damping_ratio: 1.0 };
        match driver.change(Change::Hold { body, spring }) {
            Ok(_) => self.edits.dragged += 1,
            Err(DriverError::QueueFull) => self.edits.queue_full += 1,
            Err(error) => return Err(error),
        }
        Ok(Some(body))
    }

    fn order(
        &mut self,
        driver: &mut Decoupled,
        picture: &Picture,
        samples: &[(BodyId, Sample)],
    ) -> Result<Done, DriverError> {
        let roll = self.random.below(100);
        let remembered = self.random.below(self.recent.len() as u64) as usize;
        let still = |key: &CommandKey| key.frame.plus(RECENT_MAX) > picture.frame;
        let recent = self.recent.get(remembered).copied().filter(still);
        match (roll, recent) {
            (0..6, Some(_)) => {
                self.edits.undone += 1;
                driver.undo().map(|()| Done::Something)
            }
            (6..10, Some(_)) => {
                self.edits.redone += 1;
                driver.redo().map(|()| Done::Something)
            }
            (10..18, Some(key)) => {
                self.edits.retracted += 1;
                driver.retract(key).map(|()| Done::Something)
            }
            (18..22, Some(key)) => {
                let Some(change) = self.pushed(picture, samples) else { return Ok(Done::Something) };
                self.edits.replaced += 1;
                driver.replace(key, change).map(|()| Done::Something)
            }
            _ => self.command(driver, picture, samples),
        }
    }

    /// A command: by the local user, late from the network, or for later.
    fn command(
        &mut self,
        driver: &mut Decoupled,
        picture: &Picture,
        samples: &[(BodyId, Sample)],
    ) -> Result<Done, DriverError> {
        let Some(change) = self.change(driver, picture, samples) else { return Ok(Done::Something) };
        let moved = if let Change::Move { body, .. } = &change { Some(*body) } else { None };
        let pushed = if let Change::Push { body, .. } = &change { Some(*body) } else { None };
        let displayed = picture.frame;
        let frame = match self.random.below(10) {
            0..6 => None,
            6..9 => Some(displayed.minus(self.random.below(LATE_MAX))),
            _ => Some(displayed.plus(2 + self.random.below(AHEAD_MAX))),
        };
        let key = match frame {
            None => {
                self.edits.local += 1;
                driver.change(change)?
            }
            Some(frame) => {
                self.edits.late += u64::from(frame <= displayed);
                self.edits.ahead += u64::from(frame > displayed);
                let frame = frame.max(Frame(1));
                let source = 1 + self.random.below(3) as u32;
                let key = CommandKey { frame, source, sequence: self.sent };
                driver.submit(Command { key, change })?;
                key
            }
        };
        self.sent += 1;
        self.recent.push_back(key);
        if self.recent.len() > REMEMBERED {
            self.recent.pop_front();
        }
        Ok(match (moved, pushed) {
            (Some(body), _) => Done::Moved(body, key.frame),
            (_, Some(body)) if frame.is_none() => Done::Pushed(body),
            _ => Done::Something,
        })
    }

    fn change(
        &mut self,
        driver: &mut Decoupled,
        picture: &Picture,
        samples: &[(BodyId, Sample)],
    ) -> Option<Change> {
        match self.random.below(20) {
            0 | 1 if self.added.len() < ADDED_MAX => {
                let near = self.pick(picture, samples)?.1.pose.position;
                let position = near + self.random.vector() * 2.0 + Vec3::Y * 6.0;
                // A box: a ball would roll for ever, and cost memory in every frame.
                let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.25) });
                let def = BodyDef::new(shape).at(position);
                let body = driver.reserve_body();
                self.added.push_back(body);
                Some(Change::Add { body, def: Box::new(def) })
            }
            0..3 => Some(Change::Remove { body: self.added.pop_front()? }),
            3 | 4 => {
                let (body, sample) = self.pick(picture, samples)?;
                let position = sample.pose.position + self.random.vector() * 0.5 + Vec3::Y * 1.5;
                Some(Change::Move { body, pose: Pose { position, ..sample.pose } })
            }
            5 | 6 => {
                let (body, sample) = self.pick(picture, samples)?;
                let target = sample.pose.position + self.random.vector() + Vec3::Y * 2.0;
                self.held.push_back(body);
                let spring = Spring { anchor: Vec3::ZERO, target, frequency_hz: 3.0, damping_ratio: 1.0 };
                Some(Change::Hold { body, spring })
            }
            7..10 => Some(Change::Release { body: self.held.pop_front()? }),
            10 => {
                let (body, _) = self.pick(picture, samples)?;
                let friction = 0.4 + 0.3 * self.random.signed();
                let material = Material { friction, static_friction: friction, restitution: 0.1 };
                Some(Change::SetMaterial { body, material })
            }
            11 | 12 => {
                let (body, _) = self.pick(picture, samples)?;
                let velocity = self.random.vector() * 3.0;
                Some(Change::SetVelocity { body, velocity, angular_velocity: self.random.vector() })
            }
            _ => self.pushed(picture, samples),
        }
    }

    /// A push that gives a body up to 3 m/s.
    fn pushed(&mut self, picture: &Picture, samples: &[(BodyId, Sample)]) -> Option<Change> {
        let (body, sample) = self.pick(picture, samples)?;
        let mass = 1.0 / picture.snapshot.body_at(body, picture.frame)?.inverse_mass;
        let at_point = Some(sample.pose.position + self.random.vector() * 0.2);
        Some(Change::Push { body, impulse: self.random.vector() * (3.0 * mass), at_point })
    }

    /// A body that moves when it is pushed.
    fn pick(&mut self, picture: &Picture, samples: &[(BodyId, Sample)]) -> Option<(BodyId, Sample)> {
        let dynamic = |body: BodyId| {
            picture.snapshot.body_at(body, picture.frame).is_some_and(|body| body.is_dynamic())
        };
        let tries = (0..8).map(|_| self.random.below(samples.len() as u64) as usize);
        tries.filter_map(|index| samples.get(index).copied()).find(|(body, _)| dynamic(*body))
    }
}
