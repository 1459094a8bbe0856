//! Commands: every change from outside, as a value with a frame on it.
//!
//! Promise: what a command does depends on the command and the body's state alone. Commands of one frame act in the order of
//! their keys, so the order in which they arrive never matters.

use std::fmt;

use forerun_dynamics::{BodyDef, BodyError, BodyId, BodyKind, Material, Spring};
use forerun_geometry::{Pose, Vec3};

use crate::Frame;

/// Largest frequency (Hz) and damping ratio of a spring. It is stiffer than any frame can show, and its square is far from what an f32 holds.
const SPRING_MAX: f32 = 1e4;

/// Least and largest mass that a command gives: far from where its inverse is no number. kg.
const MASSES: (f32, f32) = (1e-12, 1e12);

/// When a command acts and, within its frame, after which others. The order of keys is the order in which commands act.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CommandKey {
    /// The command changes the state stored at this frame; the step that leaves the frame sees the change.
    pub frame: Frame,
    /// Who sent it: 0 is the local user.
    pub source: u32,
    /// The sender's own count. No two commands of one source and frame share it.
    pub sequence: u64,
}

/// A change and when it acts.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// When it acts, who sent it.
    pub key: CommandKey,
    /// What it does.
    pub change: Change,
}

/// What a command does. Every change of a body ends its rest, and that of the bodies in its reach.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// A new body appears.
    Add {
        /// Its name, from [`Timeline::reserve_body`](crate::Timeline::reserve_body). Never used again.
        body: BodyId,
        /// What it is and where.
        def: Box<BodyDef>,
    },
    /// The body is gone from this frame on.
    Remove {
        /// Which body.
        body: BodyId,
    },
    /// The body is put elsewhere; it keeps its velocities.
    Move {
        /// Which body.
        body: BodyId,
        /// Where its own frame is put.
        pose: Pose,
    },
    /// An impulse acts on a dynamic body.
    Push {
        /// Which body.
        body: BodyId,
        /// The impulse, in the world. N s.
        impulse: Vec3,
        /// Where it acts, in the world (metres); `None` for the centre of mass.
        at_point: Option<Vec3>,
    },
    /// The body moves with these velocities; a kinematic body keeps them. A fixed body stays.
    SetVelocity {
        /// Which body.
        body: BodyId,
        /// Velocity of the centre of mass. m/s.
        velocity: Vec3,
        /// Angular velocity in the world. rad/s.
        angular_velocity: Vec3,
    },
    /// A spring holds or drags the body, in place of the one before.
    Hold {
        /// Which body.
        body: BodyId,
        /// The spring: above 0 and at most 10 000 Hz, damping ratio 0 to 10 000.
        spring: Spring,
    },
    /// No spring holds the body any more.
    Release {
        /// Which body.
        body: BodyId,
    },
    /// Another surface.
    SetMaterial {
        /// Which body.
        body: BodyId,
        /// The surface.
        material: Material,
    },
    /// Another constant external force and torque.
    SetForce {
        /// Which body.
        body: BodyId,
        /// Force at the centre of mass, in the world. N.
        force: Vec3,
        /// Torque, in the world. N m.
        torque: Vec3,
    },
    /// Another factor on gravity for one body.
    SetGravityScale {
        /// Which body.
        body: BodyId,
        /// The factor.
        scale: f32,
    },
    /// A dynamic body becomes heavier or lighter throughout: its moments of inertia change by the same factor. One that is fixed or kinematic then has no
    /// mass, and stays as it is.
    SetMass {
        /// Which body.
        body: BodyId,
        /// The mass. kg, from 1e-12 to 1e12.
        mass: f32,
    },
    /// The body becomes dynamic, fixed or kinematic. Its mass is the one that it was made with.
    SetKind {
        /// Which body.
        body: BodyId,
        /// How it moves from now on.
        kind: BodyKind,
    },
    /// Another gravity for all bodies.
    SetGravity {
        /// Acceleration of free fall. m/s².
        gravity: Vec3,
    },
}

impl Change {
    /// The body that is changed; `None` when all are.
    #[must_use]
    pub fn body(&self) -> Option<BodyId> {
        match self {
            Change::Add { body, .. }
            | Change::Remove { body }
            | Change::Move { body, .. }
            | Change::Push { body, .. }
            | Change::SetVelocity { body, .. }
            | Change::Hold { body, .. }
            | Change::Release { body }
            | Change::SetMaterial { body, .. }
            | Change::SetForce { body, .. }
            | Change::SetGravityScale { body, .. }
            | Change::SetMass { body, .. }
            | Change::SetKind { body, .. } => Some(*body),
            Change::SetGravity { .. } => None,
        }
    }

    /// Whether the numbers of the change are possible; definitions of bodies are checked where bodies are made.
    ///
    /// # Errors
    /// The first number that is not finite or out of its range.
    pub fn check_numbers(&self) -> Result<(), CommandError> {
        match self {
            Change::Add { .. } | Change::Remove { .. } | Change::Release { .. } | Change::SetKind { .. } => {
                Ok(())
            }
            Change::Move { pose, .. } => {
                check_vector("pose.position", pose.position)?;
                let q = pose.rotation;
                let unit = q.is_finite() && (q.length_squared() - 1.0).abs() < 1e-3;
                check("pose.rotation", unit, || format!("must be a unit quaternion (x, y, z, w), is {q}"))
            }
            Change::Push { impulse, at_point, .. } => {
                check_vector("impulse", *impulse)?;
                at_point.map_or(Ok(()), |point| check_vector("at_point", point))
            }
            Change::SetVelocity { velocity, angular_velocity, .. } => {
                check_vector("velocity", *velocity)?;
                check_vector("angular_velocity", *angular_velocity)
            }
            Change::Hold { spring, .. } => {
                check_vector("spring.anchor", spring.anchor)?;
                check_vector("spring.target", spring.target)?;
                let Spring { frequency_hz, damping_ratio, .. } = *spring;
                check("spring.frequency_hz", frequency_hz > 0.0 && frequency_hz <= SPRING_MAX, || {
                    format!("must be above 0 and at most {SPRING_MAX} Hz, is {frequency_hz}")
                })?;
                check("spring.damping_ratio", (0.0..=SPRING_MAX).contains(&damping_ratio), || {
                    format!("must be from 0 to {SPRING_MAX}, is {damping_ratio}")
                })
            }
            Change::SetMaterial { material, .. } => check_material(material),
            Change::SetForce { force, torque, .. } => {
                check_vector("force", *force)?;
                check_vector("torque", *torque)
            }
            Change::SetGravityScale { scale, .. } => {
                check("scale", scale.is_finite(), || format!("must be a finite number, is {scale}"))
            }
            Change::SetMass { mass, .. } => check("mass", (MASSES.0..=MASSES.1).contains(mass), || {
                format!("must be from {:e} to {:e} kg, is {mass}", MASSES.0, MASSES.1)
            }),
            Change::SetGravity { gravity } => check_vector("gravity", *gravity),
        }
    }
}

fn check_material(material: &Material) -> Result<(), CommandError> {
    let Material { friction, static_friction, restitution } = *material;
    check("material.friction", friction >= 0.0 && friction.is_finite(), || {
        format!("must be 0 or more, is {friction}")
    })?;
    check("material.static_friction", static_friction >= friction && static_friction.is_finite(), || {
        format!("must be at least friction ({friction}), is {static_friction}")
    })?;
    check("material.restitution", (0.0..=1.0).contains(&restitution), || {
        format!("must be from 0 to 1, is {restitution}")
    })
}

fn check_vector(field: &'static str, vector: Vec3) -> Result<(), CommandError> {
    check(field, vector.is_finite(), || format!("must be finite numbers, is {vector}"))
}

fn check(field: &'static str, fine: bool, message: impl FnOnce() -> String) -> Result<(), CommandError> {
    if fine { Ok(()) } else { Err(CommandError::Number { field, message: message() }) }
}

/// Why a command is refused. Nothing changed.
#[derive(Clone, Debug, PartialEq)]
pub enum CommandError {
    /// Its frame is no longer kept, or is the oldest that is: give it a later frame.
    TooOld {
        /// The frame of the command.
        frame: Frame,
        /// The oldest frame kept; commands act after it.
        oldest: Frame,
    },
    /// A command of the same frame, source and sequence number was accepted before.
    DuplicateKey(CommandKey),
    /// No command of that key is kept.
    UnknownCommand(CommandKey),
    /// No order of the local user is left that could be undone.
    NothingToUndo,
    /// Nothing was undone that could be done again.
    NothingToRedo,
    /// No such body was reserved or added.
    UnknownBody(BodyId),
    /// A body of that name exists or existed: names are not used again.
    BodyExists(BodyId),
    /// The body to be added, or made of another kind, is not possible.
    Body(BodyError),
    /// A number is not finite or out of its range.
    Number {
        /// The field at fault, as in [`Change`].
        field: &'static str,
        /// What is wrong and what is allowed.
        message: String,
    },
}

impl fmt::Display for CommandError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CommandError::TooOld { frame, oldest } => {
                write!(f, "{frame} is too old: commands act after {oldest}, the oldest that is kept")
            }
            CommandError::DuplicateKey(key) => write!(
                f,
                "source {} already sent a command with sequence number {} for {}: count on",
                key.source, key.sequence, key.frame
            ),
            CommandError::UnknownCommand(key) => write!(
                f,
                "there is no command of source {} with sequence number {} for {}: it was never accepted, was taken back, or is too old",
                key.source, key.sequence, key.frame
            ),
            CommandError::NothingToUndo => write!(f, "there is nothing to undo in the frames that are kept"),
            CommandError::NothingToRedo => write!(f, "there is nothing to redo: only what was undone last"),
            CommandError::UnknownBody(body) => {
                write!(f, "body {} is unknown: reserve its name with reserve_body first", body.0)
            }
            CommandError::BodyExists(body) => {
                write!(f, "body {} was added before: reserve a new name with reserve_body", body.0)
            }
            CommandError::Body(error) => write!(f, "{error}"),
            CommandError::Number { field, message } => write!(f, "{field}: {message}"),
        }
    }
}

impl std::error::Error for CommandError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_that_are_none_are_refused() {
        let refused = |mass: f32| {
            let checked = Change::SetMass { body: BodyId(0), mass }.check_numbers();
            checked.map_err(|error| error.to_string()).err()
        };
        assert_eq!((refused(1e-12), refused(1e12)), (None, None));
        for bad in [0.0, -0.0, -1.0, 1e-20, 1e13, f32::INFINITY, f32::NAN] {
            assert_eq!(refused(bad), Some(format!("mass: must be from 1e-12 to 1e12 kg, is {bad}")));
        }
    }

    #[test]
    fn springs_that_no_frame_could_follow_are_refused() {
        let refused = |frequency_hz: f32, damping_ratio: f32| {
            let spring = Spring { anchor: Vec3::ZERO, target: Vec3::ZERO, frequency_hz, damping_ratio };
            let checked = Change::Hold { body: BodyId(0), spring }.check_numbers();
            checked.map_err(|error| error.to_string()).err()
        };
        assert_eq!(refused(1e4, 1e4), None);
        assert_eq!(refused(1e-20, 0.0), None);
        let frequency = "spring.frequency_hz: must be above 0 and at most 10000 Hz, is ";
        for bad in [0.0, -1.0, 10_001.0, 1e20, f32::INFINITY, f32::NAN] {
            assert_eq!(refused(bad, 1.0), Some(format!("{frequency}{bad}")));
        }
        let damping = "spring.damping_ratio: must be from 0 to 10000, is ";
        for bad in [-1.0, 1e20, f32::INFINITY, f32::NAN] {
            assert_eq!(refused(5.0, bad), Some(format!("{damping}{bad}")));
        }
    }
}
