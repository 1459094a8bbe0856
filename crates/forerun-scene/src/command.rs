//! Commands: what happens to a scene while it runs, in values of the engine.

use std::collections::BTreeMap;

use forerun_dynamics::{BodyDef, BodyKind, Material, Spring};
use forerun_geometry::{Pose, Quat, Vec3};

use crate::build::{Shapes, build_body, material};
use crate::command_entry::{BodyRef, CommandEntry};
use crate::error::{Fault, Within};
use crate::scene::Scene;

/// A command in values of the engine, with its frame.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedCommand {
    /// The frame whose state it changes. 1 or more: the state at frame 0 is what the bodies say.
    pub frame: u64,
    /// What happens.
    pub command: SceneCommand,
}

/// What a scene can do to its bodies. Bodies are numbered as in the file: first all of `bodies`, then those added by commands, in
/// the order in which the commands are written.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneCommand {
    /// A new body comes in.
    Add {
        /// Its number.
        body: u32,
        /// What it is.
        def: Box<BodyDef>,
    },
    /// A body goes away.
    Remove {
        /// Its number.
        body: u32,
    },
    /// A body is put elsewhere, with the velocity that it has.
    Move {
        /// Its number.
        body: u32,
        /// Where its own frame is put.
        pose: Pose,
    },
    /// A body is struck.
    Push {
        /// Its number.
        body: u32,
        /// N s.
        impulse: Vec3,
        /// Where, in the world (metres); at the centre of mass if none.
        point: Option<Vec3>,
    },
    /// A body moves at another velocity from now on.
    SetVelocity {
        /// Its number.
        body: u32,
        /// m/s.
        velocity: Vec3,
        /// rad/s, in the world.
        angular_velocity: Vec3,
    },
    /// A body's constant force and torque change.
    SetForce {
        /// Its number.
        body: u32,
        /// N, in the world.
        force: Vec3,
        /// N m, in the world.
        torque: Vec3,
    },
    /// A body's surface changes.
    SetMaterial {
        /// Its number.
        body: u32,
        /// The new surface.
        material: Material,
    },
    /// A body falls faster or slower, or up, from now on.
    SetGravityScale {
        /// Its number.
        body: u32,
        /// The factor on gravity.
        scale: f32,
    },
    /// A dynamic body gets another mass, spread as the one before.
    SetMass {
        /// Its number.
        body: u32,
        /// kg.
        mass: f32,
    },
    /// A body moves in another way from now on.
    SetKind {
        /// Its number.
        body: u32,
        /// The new way.
        kind: BodyKind,
    },
    /// A hand takes hold of a body, or drags it elsewhere.
    Hold {
        /// Its number.
        body: u32,
        /// The pull.
        spring: Spring,
    },
    /// The hand lets go.
    Release {
        /// Its number.
        body: u32,
    },
    /// Gravity changes.
    SetGravity {
        /// m/s².
        gravity: Vec3,
    },
}

/// The bodies of a scene by number and name, and from which frame on they are there.
pub(crate) struct Roster<'a> {
    since: Vec<u64>,
    numbers: BTreeMap<&'a str, u32>,
}

impl<'a> Roster<'a> {
    /// Numbers all bodies; two of one name are a fault.
    pub(crate) fn new(scene: &'a Scene) -> Result<Roster<'a>, Fault> {
        let mut roster = Roster { since: Vec::new(), numbers: BTreeMap::new() };
        for (i, body) in scene.bodies.iter().enumerate() {
            roster.enter(body.name.as_deref(), 0).in_field("name").in_item(i).in_field("bodies")?;
        }
        for (i, command) in scene.commands.iter().enumerate() {
            if let Some(body) = &command.add {
                let added = roster.enter(body.name.as_deref(), command.frame_in(scene));
                added.in_field("name").in_field("add").in_item(i).in_field("commands")?;
            }
        }
        Ok(roster)
    }

    fn enter(&mut self, name: Option<&'a str>, since: u64) -> Result<(), Fault> {
        let number = self.since.len() as u32;
        self.since.push(since);
        let Some(name) = name else { return Ok(()) };
        match self.numbers.insert(name, number) {
            None => Ok(()),
            Some(first) => Err(Fault::new(
                format!("two bodies are called \"{name}\": number {first} and number {number}"),
                "give each a name of its own",
            )),
        }
    }

    /// The number of a body that is there at a frame.
    fn find(&self, body: &BodyRef, frame: u64) -> Result<u32, Fault> {
        let number = match body {
            BodyRef::Number(number) => Some(*number).filter(|n| (*n as usize) < self.since.len()),
            BodyRef::Name(name) => self.numbers.get(name.as_str()).copied(),
        };
        let Some(number) = number else {
            let (what, remedy) = match body {
                BodyRef::Name(name) => (format!("called \"{name}\""), "give that name to a body"),
                BodyRef::Number(number) => (format!("with number {number}"), "bodies are numbered from 0"),
            };
            let message = format!("there is no body {what}; the scene has {} bodies", self.since.len());
            return Err(Fault::new(message, remedy));
        };
        let since = self.since[number as usize];
        if frame < since {
            let message = format!("the body is added at frame {since}, this is frame {frame}");
            return Err(Fault::new(message, "let the command come at or after the body's own"));
        }
        Ok(number)
    }

    /// That the body which a command names exists when it comes.
    pub(crate) fn check(&self, command: &CommandEntry, scene: &Scene) -> Result<(), Fault> {
        let Some((path, body)) = command.target() else { return Ok(()) };
        let mut found = self.find(body, command.frame_in(scene)).map(|_| ());
        for field in path.iter().rev() {
            found = found.in_field(field);
        }
        found
    }

    /// A command in values of the engine. `added` counts the bodies that commands have added so far.
    pub(crate) fn build(
        &self,
        entry: &CommandEntry,
        (scene, shapes): (&Scene, &Shapes),
        added: &mut u32,
    ) -> Result<TimedCommand, Fault> {
        let frame = entry.frame_in(scene);
        let find = |body: &BodyRef| self.find(body, frame);
        let command = if let Some(new) = &entry.add {
            let body = scene.bodies.len() as u32 + *added;
            *added += 1;
            SceneCommand::Add { body, def: Box::new(build_body(new, shapes).in_field("add")?) }
        } else if let Some(body) = &entry.remove {
            SceneCommand::Remove { body: find(body)? }
        } else if let Some(to) = &entry.move_to {
            let rotation = to.rotation.map_or(Ok(Quat::IDENTITY), |r| r.to_quat())?;
            let pose = Pose::new(Vec3::from_array(to.position), rotation);
            SceneCommand::Move { body: find(&to.body)?, pose }
        } else if let Some(push) = &entry.push {
            SceneCommand::Push {
                body: find(&push.body)?,
                impulse: Vec3::from_array(push.impulse),
                point: push.point.map(Vec3::from_array),
            }
        } else if let Some(new) = &entry.set_velocity {
            SceneCommand::SetVelocity {
                body: find(&new.body)?,
                velocity: Vec3::from_array(new.velocity),
                angular_velocity: Vec3::from_array(new.angular_velocity),
            }
        } else if let Some(new) = &entry.set_force {
            let (force, torque) = (Vec3::from_array(new.force), Vec3::from_array(new.torque));
            SceneCommand::SetForce { body: find(&new.body)?, force, torque }
        } else if let Some(new) = &entry.set_material {
            let material = material(new.friction, new.static_friction, new.restitution);
            SceneCommand::SetMaterial { body: find(&new.body)?, material }
        } else if let Some(new) = &entry.set_gravity_scale {
            SceneCommand::SetGravityScale { body: find(&new.body)?, scale: new.scale }
        } else if let Some(new) = &entry.set_mass {
            SceneCommand::SetMass { body: find(&new.body)?, mass: new.mass }
        } else if let Some(new) = &entry.set_kind {
            SceneCommand::SetKind { body: find(&new.body)?, kind: new.kind.into() }
        } else if let Some(hold) = &entry.hold {
            let spring = Spring {
                anchor: Vec3::from_array(hold.anchor),
                target: Vec3::from_array(hold.target),
                frequency_hz: hold.frequency_hz,
                damping_ratio: hold.damping_ratio,
            };
            SceneCommand::Hold { body: find(&hold.body)?, spring }
        } else if let Some(body) = &entry.release {
            SceneCommand::Release { body: find(body)? }
        } else {
            // The check before has made sure that there is an action, and this is the last one.
            SceneCommand::SetGravity { gravity: Vec3::from_array(entry.set_gravity.unwrap_or_default()) }
        };
        Ok(TimedCommand { frame, command })
    }
}
