//! Check: does a timeline that was edited equal a full simulation, bit for bit? For tests and the command line.
//!
//! The reference shares the step with the timeline, and nothing of what decides which bodies are computed: it computes all bodies
//! together in every frame.

use std::fmt;

use forerun_dynamics::{BodyDef, BodyId, BodyKind, BodyState, Environment, Material, Spring};
use forerun_geometry::{Pose, Quat, Vec3};

use crate::affected::Mutation;
use crate::frame_table::same_entry;
use crate::{Change, Command, CommandError, Frame, Progress, Timeline, TimelineError, TimelineSettings};

/// What is to be checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckSettings {
    /// How many random edits are made, one after the other.
    pub edits: u32,
    /// From which all that is random follows.
    pub seed: u64,
    /// How many frames are simulated.
    pub frames: u32,
    /// A rule left out, to show that the check notices.
    #[doc(hidden)]
    pub mutation: Mutation,
}

impl Default for CheckSettings {
    fn default() -> Self {
        CheckSettings { edits: 20, seed: 1, frames: 200, mutation: Mutation::None }
    }
}

/// A moment in a check: who has a clock may look at it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckMoment {
    /// An edit is about to be submitted.
    EditBegins,
    /// All frames are true again.
    EditEnds,
    /// The same edit is about to be submitted to the reference, which computes everything after it again.
    FullBegins,
    /// The reference is done.
    FullEnds,
}

/// A body and frame whose bits differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mismatch {
    /// The frame.
    pub frame: Frame,
    /// The body.
    pub body: BodyId,
    /// Its state in the timeline.
    pub found: Option<BodyState>,
    /// Its state in the full simulation.
    pub expected: Option<BodyState>,
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Mismatch { frame, body, found, expected } = self;
        write!(f, "{frame}, body {}: found {found:?}, a full run gives {expected:?}", body.0)
    }
}

/// What a check found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CheckReport {
    /// Body-frames whose bits differ from the full run, after each edit and at the end.
    pub mismatches: u64,
    /// The first of them.
    pub first_mismatch: Option<Mismatch>,
    /// Body-frames that the edits truly changed.
    pub affected: u64,
    /// Body-frames that were computed again for it.
    pub recomputed: u64,
    /// Body-frames that the full runs computed.
    pub full: u64,
}

/// Makes random edits on a timeline of the bodies and compares it with full simulations. Calls `at` at the moments of each edit.
///
/// # Errors
/// When the environment or a body is not possible, or a full run refuses a command that the timeline accepted: then nothing is shown.
pub fn check(
    bodies: &[BodyDef],
    environment: Environment,
    settings: &CheckSettings,
    at: &mut dyn FnMut(CheckMoment),
) -> Result<CheckReport, FullRunError> {
    let all = TimelineSettings { lookahead: settings.frames, past: settings.frames, area_m: None };
    let mut timeline = Timeline::new(bodies, environment, all).map_err(FullRunError::Start)?;
    timeline.mutate(settings.mutation);
    let mut reference = Timeline::new(bodies, environment, all).map_err(FullRunError::Start)?;
    reference.recompute_all();
    run(&mut timeline);
    run(&mut reference);

    let mut random = Random::new(settings.seed);
    let mut commands = Vec::new();
    let mut report = CheckReport::default();
    report.add(&timeline, &reference);
    for _ in 0..settings.edits {
        let frame = Frame(1 + random.below(u64::from(settings.frames.max(1))));
        let change = random_change(&mut timeline, frame, &mut random);
        let known = timeline.names();
        at(CheckMoment::EditBegins);
        let edited = timeline.change(frame, change.clone());
        run(&mut timeline);
        at(CheckMoment::EditEnds);
        // What is refused changed nothing, and the reference need not hear of it.
        let Ok(key) = edited else { continue };
        while reference.names() < known {
            reference.reserve_body();
        }
        at(CheckMoment::FullBegins);
        reference.submit(Command { key, change: change.clone() }).map_err(FullRunError::Command)?;
        run(&mut reference);
        at(CheckMoment::FullEnds);
        commands.push(Command { key, change });
        report.add(&timeline, &reference);
    }
    // The reference was edited too: compare with one that knew everything from the start.
    report.add_fresh(&timeline, full_run(bodies, commands, environment, settings.frames))?;
    let edits = timeline.stats().edits;
    (report.affected, report.recomputed) = (edits.affected, edits.recomputed);
    report.full = reference.stats().edits.recomputed;
    Ok(report)
}

impl CheckReport {
    fn add(&mut self, timeline: &Timeline, reference: &Timeline) {
        let (count, first) = mismatches(timeline, reference);
        self.mismatches += count;
        self.first_mismatch = self.first_mismatch.or(first);
    }

    /// A comparison that cannot be made is no agreement.
    fn add_fresh(
        &mut self,
        timeline: &Timeline,
        fresh: Result<Timeline, FullRunError>,
    ) -> Result<(), FullRunError> {
        self.add(timeline, &fresh?);
        Ok(())
    }
}

/// Why there is no full run.
#[derive(Clone, Debug, PartialEq)]
pub enum FullRunError {
    /// The environment or a body is not possible.
    Start(TimelineError),
    /// A command is refused.
    Command(CommandError),
}

impl fmt::Display for FullRunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FullRunError::Start(error) => write!(f, "{error}"),
            FullRunError::Command(error) => write!(f, "a full run refuses a command: {error}"),
        }
    }
}

impl std::error::Error for FullRunError {}

/// A full simulation to frame `frames` that knows all commands from the start and computes all bodies in every frame.
///
/// # Errors
/// When a body is not possible or a command is refused.
pub fn full_run(
    bodies: &[BodyDef],
    commands: impl IntoIterator<Item = Command>,
    environment: Environment,
    frames: u32,
) -> Result<Timeline, FullRunError> {
    let settings = TimelineSettings { lookahead: frames, past: frames, area_m: None };
    let mut timeline = Timeline::new(bodies, environment, settings).map_err(FullRunError::Start)?;
    timeline.recompute_all();
    // Commands may name bodies that later ones add.
    let mut commands: Vec<Command> = commands.into_iter().collect();
    commands.sort_by_key(|command| (!matches!(command.change, Change::Add { .. }), command.key));
    timeline.submit_all(commands).map_err(FullRunError::Command)?;
    run(&mut timeline);
    Ok(timeline)
}

/// How many body-frames differ in the frames that both have, and the first of them.
#[must_use]
pub fn mismatches(timeline: &Timeline, reference: &Timeline) -> (u64, Option<Mismatch>) {
    let mut count = 0;
    let mut first = None;
    let from = timeline.oldest().max(reference.oldest());
    let to = timeline.horizon().min(reference.horizon());
    for frame in (from.0..=to.0).map(Frame) {
        for body in timeline.table(frame).differences(reference.table(frame)) {
            let (found, expected) = (timeline.state(body, frame), reference.state(body, frame));
            debug_assert!(!same_entry(found, expected));
            count += 1;
            first =
                first.or(Some(Mismatch { frame, body, found: found.copied(), expected: expected.copied() }));
        }
    }
    (count, first)
}

impl Timeline {
    /// Does the step that leaves a frame once more, for all bodies together, and compares it with what is stored: the first body that
    /// differs. `None` when none does, or when the next frame is not known to be true.
    #[must_use]
    pub fn audit(&self, frame: Frame) -> Option<Mismatch> {
        if frame < self.oldest() || frame >= self.valid_to() {
            return None;
        }
        let mut again = self.clone();
        again.stale.entry(frame).or_default().everyone = true;
        let _ = again.advance();
        let next = frame.next();
        let body = *self.table(next).differences(again.table(next)).first()?;
        let (found, expected) = (self.state(body, next), again.state(body, next));
        Some(Mismatch { frame: next, body, found: found.copied(), expected: expected.copied() })
    }
}

fn run(timeline: &mut Timeline) {
    while timeline.advance() != Progress::Idle {}
}

/// A small generator of random numbers (splitmix64, Steele et al. 2014). For tests: nothing in the physics is random.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A generator; all its numbers follow from the seed.
    #[must_use]
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from 0 to below `end`; 0 when that is 0.
    pub fn below(&mut self, end: u64) -> u64 {
        self.bits() % end.max(1)
    }

    /// A number from -1 to 1.
    pub fn signed(&mut self) -> f32 {
        // 24 bits fit an f32 exactly.
        (self.bits() >> 40) as f32 / 8_388_608.0 - 1.0
    }

    /// A vector in the cube from -1 to 1.
    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// A random change of a body, of a size that suits it, as it is stored at a frame (or the last one, if that is earlier). Reserves
/// names for bodies to be added.
pub fn random_change(timeline: &mut Timeline, frame: Frame, random: &mut Random) -> Change {
    let stored = frame.min(timeline.horizon());
    let bodies = timeline.bodies_at(stored);
    let pick = bodies.get(random.below(bodies.len() as u64) as usize).copied();
    let looked_up = pick.and_then(|body| {
        let state = *timeline.state(body, stored)?;
        Some((body, state, timeline.body_at(body, stored)?.clone()))
    });
    // Nobody is there: gravity is all that can change.
    let Some((body, state, what)) = looked_up else {
        return Change::SetGravity { gravity: random.vector() * 10.0 };
    };
    let size = if what.radius.is_finite() { what.radius.min(2.0) } else { 1.0 };
    let mass = if what.inverse_mass > 0.0 { 1.0 / what.inverse_mass } else { 1.0 };
    let pose = what.own_pose(&state);
    match random.below(100) {
        0..20 => Change::Push {
            body,
            impulse: random.vector() * (3.0 * mass),
            at_point: (random.below(2) == 0).then(|| state.position + random.vector() * size),
        },
        20..32 => match timeline.definitions.def(body).filter(|_| what.is_dynamic()).cloned() {
            Some(def) => {
                let above = Pose { position: pose.position + random.vector() * (3.0 * size), ..pose };
                let def = BodyDef { pose: above, velocity: random.vector(), ..BodyDef::clone(&def) };
                Change::Add { body: timeline.reserve_body(), def: Box::new(def) }
            }
            None => Change::Release { body },
        },
        32..42 => Change::Remove { body },
        42..52 => {
            let moved = pose.position + random.vector() * (2.0 * size);
            let (v, w) = (random.vector(), random.signed());
            let turned = Quat::from_xyzw(v.x, v.y, v.z, w + 2.0).normalize();
            Change::Move { body, pose: Pose { position: moved, rotation: turned } }
        }
        // An edit that changes nothing, at most the body's rest.
        52..57 => Change::Push { body, impulse: Vec3::ZERO, at_point: None },
        57..65 => Change::SetVelocity {
            body,
            velocity: random.vector() * 3.0,
            angular_velocity: random.vector() * 3.0,
        },
        65..73 => Change::Hold {
            body,
            spring: Spring {
                anchor: random.vector() * (0.5 * size),
                target: pose.position + random.vector() * (2.0 * size),
                frequency_hz: 1.5,
                damping_ratio: 0.7,
            },
        },
        73..77 => Change::Release { body },
        77..83 => {
            let friction = 0.5 + 0.5 * random.signed();
            Change::SetMaterial { body, material: Material::new(friction, 0.0) }
        }
        83..88 => Change::SetForce { body, force: random.vector() * (4.0 * mass), torque: Vec3::ZERO },
        88..93 => Change::SetGravityScale { body, scale: random.signed() },
        93..98 => {
            let kinds = [BodyKind::Dynamic, BodyKind::Fixed, BodyKind::Kinematic];
            Change::SetKind { body, kind: kinds[random.below(3) as usize] }
        }
        _ => Change::SetGravity { gravity: Vec3::new(0.0, -9.81, 0.0) + random.vector() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CommandKey;
    use forerun_geometry::shape::{Shape, Sphere};

    #[test]
    fn a_full_run_that_refuses_a_command_is_an_error_and_no_agreement() {
        let bodies = [BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 }))];
        let timeline = full_run(&bodies, [], Environment::default(), 5).unwrap();
        let key = CommandKey { frame: Frame(2), source: 0, sequence: 0 };
        let unknown = Command { key, change: Change::Release { body: BodyId(9) } };
        let mut report = CheckReport::default();
        let refused = full_run(&bodies, [unknown], Environment::default(), 5);
        assert_eq!(
            report.add_fresh(&timeline, refused),
            Err(FullRunError::Command(CommandError::UnknownBody(BodyId(9))))
        );
        // The same with a run that fell differently is seen.
        let push = Change::Push { body: BodyId(0), impulse: Vec3::X, at_point: None };
        let pushed = full_run(&bodies, [Command { key, change: push }], Environment::default(), 5);
        report.add_fresh(&timeline, pushed).unwrap();
        assert_eq!(report.mismatches, 4);
    }
}
