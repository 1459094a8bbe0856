//! Orders: definitions, commands and orders as they are in a file, and back.

use forerun_dynamics::{BodyDef, BodyId, BodyKind, Mass, Material, Spring};
use forerun_geometry::{Quat, Shape, Vec3};
use forerun_timeline::{Change, Command, CommandKey, Frame, Order};
use serde::{Deserialize, Serialize};

use super::large_shapes::{
    LargeShape, PoseValue, ShapeValue, StoredShapes, Three, pose_of, pose_value, shape_of,
};

/// How a body is made. What most bodies have in common is left out: no rotation, velocities, forces; a factor on gravity of 1.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct DefValue {
    shape: ShapeValue,
    position: Three,
    rotation: Option<[f32; 4]>,
    /// Velocity, angular velocity.
    velocities: Option<(Three, Three)>,
    kind: KindValue,
    material: Three,
    mass: MassValue,
    gravity_scale: Option<f32>,
    /// Force, torque.
    forces: Option<(Three, Three)>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) enum KindValue {
    Dynamic,
    Fixed,
    Kinematic,
}

#[derive(Debug, Serialize, Deserialize)]
enum MassValue {
    Density(f32),
    Total(f32),
    Given { mass: f32, centre: Three, inertia: Three, principal_rotation: [f32; 4] },
}

/// Anchor, target, frequency, damping ratio.
pub(crate) type SpringValue = (Three, Three, f32, f32);

/// When a command acts, who sent it, and what it does.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct CommandValue {
    key: KeyValue,
    change: ChangeValue,
}

/// Frame, source, sequence number.
pub(crate) type KeyValue = (u64, u32, u64);

/// As [`Change`]; the first number is the body.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) enum ChangeValue {
    Add(u32, Box<DefValue>),
    Remove(u32),
    Move(u32, PoseValue),
    Push(u32, Three, Option<Three>),
    SetVelocity(u32, Three, Three),
    Hold(u32, SpringValue),
    Release(u32),
    SetMaterial(u32, Three),
    SetForce(u32, Three, Three),
    SetGravityScale(u32, f32),
    SetKind(u32, KindValue),
    SetGravity(Three),
    SetMass(u32, f32),
}

/// As [`Order`].
#[derive(Debug, Serialize, Deserialize)]
pub(crate) enum OrderValue {
    Submit(CommandValue),
    Retract(KeyValue),
    Replace(CommandValue),
    Undo,
    Redo,
}

/// From the engine to the file. What has to be stored before goes to `new`.
pub(crate) struct ToFile<'a> {
    pub(crate) stored: &'a mut StoredShapes,
    pub(crate) new: &'a mut Vec<LargeShape>,
}

impl ToFile<'_> {
    pub(crate) fn def(&mut self, def: &BodyDef) -> DefValue {
        DefValue {
            shape: self.stored.value(&def.shape, self.new),
            position: def.pose.position.to_array(),
            rotation: unless(def.pose.rotation.to_array(), NO_ROTATION, bits_of),
            velocities: unless(two(def.velocity, def.angular_velocity), NOTHING, bits_of_two),
            kind: kind_value(def.kind),
            material: material_value(&def.material),
            mass: match def.mass {
                Mass::Density(density) => MassValue::Density(density),
                Mass::Total(mass) => MassValue::Total(mass),
                Mass::Given { mass, centre, inertia, principal_rotation } => MassValue::Given {
                    mass,
                    centre: centre.to_array(),
                    inertia: inertia.to_array(),
                    principal_rotation: principal_rotation.to_array(),
                },
            },
            gravity_scale: unless(def.gravity_scale, 1.0, |scale| scale.to_bits()),
            forces: unless(two(def.force, def.torque), NOTHING, bits_of_two),
        }
    }

    pub(crate) fn command(&mut self, command: &Command) -> CommandValue {
        self.command_of(&command.key, &command.change)
    }

    pub(crate) fn command_of(&mut self, key: &CommandKey, change: &Change) -> CommandValue {
        CommandValue { key: key_value(key), change: self.change(change) }
    }

    pub(crate) fn order(&mut self, order: &Order) -> OrderValue {
        match order {
            Order::Submit(command) => OrderValue::Submit(self.command(command)),
            Order::Retract(key) => OrderValue::Retract(key_value(key)),
            Order::Replace(command) => OrderValue::Replace(self.command(command)),
            Order::Undo => OrderValue::Undo,
            Order::Redo => OrderValue::Redo,
        }
    }

    pub(crate) fn change(&mut self, change: &Change) -> ChangeValue {
        match change {
            Change::Add { body, def } => ChangeValue::Add(body.0, Box::new(self.def(def))),
            Change::Remove { body } => ChangeValue::Remove(body.0),
            Change::Move { body, pose } => ChangeValue::Move(body.0, pose_value(pose)),
            Change::Push { body, impulse, at_point } => {
                ChangeValue::Push(body.0, impulse.to_array(), at_point.map(|point| point.to_array()))
            }
            Change::SetVelocity { body, velocity, angular_velocity } => {
                ChangeValue::SetVelocity(body.0, velocity.to_array(), angular_velocity.to_array())
            }
            Change::Hold { body, spring } => ChangeValue::Hold(body.0, spring_value(spring)),
            Change::Release { body } => ChangeValue::Release(body.0),
            Change::SetMaterial { body, material } => {
                ChangeValue::SetMaterial(body.0, material_value(material))
            }
            Change::SetForce { body, force, torque } => {
                ChangeValue::SetForce(body.0, force.to_array(), torque.to_array())
            }
            Change::SetGravityScale { body, scale } => ChangeValue::SetGravityScale(body.0, *scale),
            Change::SetKind { body, kind } => ChangeValue::SetKind(body.0, kind_value(*kind)),
            Change::SetGravity { gravity } => ChangeValue::SetGravity(gravity.to_array()),
            Change::SetMass { body, mass } => ChangeValue::SetMass(body.0, *mass),
        }
    }
}

/// The definition of a value; `stored` are the shapes so far.
pub(crate) fn def_of(value: DefValue, stored: &[Shape]) -> Result<BodyDef, String> {
    let (velocity, angular_velocity) = value.velocities.unwrap_or(NOTHING);
    let (force, torque) = value.forces.unwrap_or(NOTHING);
    Ok(BodyDef {
        shape: shape_of(value.shape, stored)?,
        pose: pose_of((value.position, value.rotation.unwrap_or(NO_ROTATION))),
        velocity: Vec3::from_array(velocity),
        angular_velocity: Vec3::from_array(angular_velocity),
        kind: kind_of(value.kind),
        material: material_of(value.material),
        mass: match value.mass {
            MassValue::Density(density) => Mass::Density(density),
            MassValue::Total(mass) => Mass::Total(mass),
            MassValue::Given { mass, centre, inertia, principal_rotation } => Mass::Given {
                mass,
                centre: Vec3::from_array(centre),
                inertia: Vec3::from_array(inertia),
                principal_rotation: Quat::from_array(principal_rotation),
            },
        },
        gravity_scale: value.gravity_scale.unwrap_or(1.0),
        force: Vec3::from_array(force),
        torque: Vec3::from_array(torque),
    })
}

const NO_ROTATION: [f32; 4] = [0.0, 0.0, 0.0, 1.0];
const NOTHING: (Three, Three) = ([0.0; 3], [0.0; 3]);

fn two(a: Vec3, b: Vec3) -> (Three, Three) {
    (a.to_array(), b.to_array())
}

/// A value, where its bits are not those of the one that is left out.
fn unless<T, B: PartialEq>(value: T, left_out: T, bits: impl Fn(&T) -> B) -> Option<T> {
    (bits(&value) != bits(&left_out)).then_some(value)
}

fn bits_of<const N: usize>(numbers: &[f32; N]) -> [u32; N] {
    numbers.map(f32::to_bits)
}

fn bits_of_two((a, b): &(Three, Three)) -> ([u32; 3], [u32; 3]) {
    (bits_of(a), bits_of(b))
}

pub(crate) fn command_of(value: CommandValue, stored: &[Shape]) -> Result<Command, String> {
    Ok(Command { key: key_of(value.key), change: change_of(value.change, stored)? })
}

pub(crate) fn order_of(value: OrderValue, stored: &[Shape]) -> Result<Order, String> {
    Ok(match value {
        OrderValue::Submit(command) => Order::Submit(command_of(command, stored)?),
        OrderValue::Retract(key) => Order::Retract(key_of(key)),
        OrderValue::Replace(command) => Order::Replace(command_of(command, stored)?),
        OrderValue::Undo => Order::Undo,
        OrderValue::Redo => Order::Redo,
    })
}

pub(crate) fn change_of(value: ChangeValue, stored: &[Shape]) -> Result<Change, String> {
    let three = Vec3::from_array;
    Ok(match value {
        ChangeValue::Add(body, def) => {
            Change::Add { body: BodyId(body), def: Box::new(def_of(*def, stored)?) }
        }
        ChangeValue::Remove(body) => Change::Remove { body: BodyId(body) },
        ChangeValue::Move(body, pose) => Change::Move { body: BodyId(body), pose: pose_of(pose) },
        ChangeValue::Push(body, impulse, point) => {
            Change::Push { body: BodyId(body), impulse: three(impulse), at_point: point.map(three) }
        }
        ChangeValue::SetVelocity(body, velocity, spin) => Change::SetVelocity {
            body: BodyId(body),
            velocity: three(velocity),
            angular_velocity: three(spin),
        },
        ChangeValue::Hold(body, spring) => Change::Hold { body: BodyId(body), spring: spring_of(spring) },
        ChangeValue::Release(body) => Change::Release { body: BodyId(body) },
        ChangeValue::SetMaterial(body, material) => {
            Change::SetMaterial { body: BodyId(body), material: material_of(material) }
        }
        ChangeValue::SetForce(body, force, torque) => {
            Change::SetForce { body: BodyId(body), force: three(force), torque: three(torque) }
        }
        ChangeValue::SetGravityScale(body, scale) => Change::SetGravityScale { body: BodyId(body), scale },
        ChangeValue::SetKind(body, kind) => Change::SetKind { body: BodyId(body), kind: kind_of(kind) },
        ChangeValue::SetGravity(gravity) => Change::SetGravity { gravity: three(gravity) },
        ChangeValue::SetMass(body, mass) => Change::SetMass { body: BodyId(body), mass },
    })
}

pub(crate) fn key_value(key: &CommandKey) -> KeyValue {
    (key.frame.0, key.source, key.sequence)
}

pub(crate) fn key_of((frame, source, sequence): KeyValue) -> CommandKey {
    CommandKey { frame: Frame(frame), source, sequence }
}

pub(crate) fn kind_value(kind: BodyKind) -> KindValue {
    match kind {
        BodyKind::Dynamic => KindValue::Dynamic,
        BodyKind::Fixed => KindValue::Fixed,
        BodyKind::Kinematic => KindValue::Kinematic,
    }
}

pub(crate) fn kind_of(kind: KindValue) -> BodyKind {
    match kind {
        KindValue::Dynamic => BodyKind::Dynamic,
        KindValue::Fixed => BodyKind::Fixed,
        KindValue::Kinematic => BodyKind::Kinematic,
    }
}

pub(crate) fn material_value(material: &Material) -> Three {
    [material.friction, material.static_friction, material.restitution]
}

pub(crate) fn material_of([friction, static_friction, restitution]: Three) -> Material {
    Material { friction, static_friction, restitution }
}

pub(crate) fn spring_value(spring: &Spring) -> SpringValue {
    (spring.anchor.to_array(), spring.target.to_array(), spring.frequency_hz, spring.damping_ratio)
}

pub(crate) fn spring_of((anchor, target, frequency_hz, damping_ratio): SpringValue) -> Spring {
    Spring { anchor: Vec3::from_array(anchor), target: Vec3::from_array(target), frequency_hz, damping_ratio }
}
