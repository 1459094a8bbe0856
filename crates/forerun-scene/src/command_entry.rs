//! Commands as a scene file has them: when, and what.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::Visitor;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::body::{BodyEntry, KindEntry, check_surface, is_zero};
use crate::error::{Fault, Within};
use crate::mesh::MeshEntry;
use crate::range;
use crate::rotation::RotationEntry;

/// A command in a scene file: a `frame` or a time in `seconds`, and exactly one action.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CommandEntry {
    /// The frame whose state it changes; the step that leaves the frame sees the change. 1 or more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<u64>,
    /// The same as a time: the nearest frame is taken, and at least frame 1. Seconds, 0 or more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f32>,
    /// A new body comes in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub add: Option<Box<BodyEntry>>,
    /// A body goes away.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remove: Option<BodyRef>,
    /// A body is put elsewhere.
    #[serde(default, rename = "move", skip_serializing_if = "Option::is_none")]
    pub move_to: Option<MoveEntry>,
    /// A body is struck.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub push: Option<PushEntry>,
    /// A body's velocity changes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set_velocity: Option<VelocityEntry>,
    /// A body's constant force and torque change.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set_force: Option<ForceEntry>,
    /// A body's surface changes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set_material: Option<MaterialEntry>,
    /// A body's factor on gravity changes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set_gravity_scale: Option<GravityScaleEntry>,
    /// A dynamic body gets another mass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set_mass: Option<MassEntry>,
    /// A body moves in another way from now on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set_kind: Option<SetKindEntry>,
    /// A hand takes hold of a body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hold: Option<HoldEntry>,
    /// The hand lets go.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub release: Option<BodyRef>,
    /// Gravity from now on. m/s².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set_gravity: Option<[f32; 3]>,
}

/// Which body: its name, or its number in the file from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BodyRef {
    /// By name.
    Name(String),
    /// By number.
    Number(u32),
}

/// `move`: where a body is put.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MoveEntry {
    /// The body.
    pub body: BodyRef,
    /// Metres.
    pub position: [f32; 3],
    /// Default not turned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<RotationEntry>,
}

/// `push`: an impulse.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PushEntry {
    /// The body.
    pub body: BodyRef,
    /// N s.
    pub impulse: [f32; 3],
    /// Where, in the world. Metres. Default at the centre of mass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point: Option<[f32; 3]>,
}

/// `set_velocity`: what is left out becomes 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VelocityEntry {
    /// The body.
    pub body: BodyRef,
    /// m/s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub velocity: [f32; 3],
    /// rad/s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub angular_velocity: [f32; 3],
}

/// `set_force`: what is left out becomes 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceEntry {
    /// The body.
    pub body: BodyRef,
    /// N.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub force: [f32; 3],
    /// N m.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub torque: [f32; 3],
}

/// `set_material`: what is left out takes the default of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialEntry {
    /// The body.
    pub body: BodyRef,
    /// As of a body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<f32>,
    /// As of a body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub static_friction: Option<f32>,
    /// As of a body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub restitution: Option<f32>,
}

/// `set_gravity_scale`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GravityScaleEntry {
    /// The body.
    pub body: BodyRef,
    /// The factor: 0 to float, below 0 to fall up.
    pub scale: f32,
}

/// `set_mass`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MassEntry {
    /// The body.
    pub body: BodyRef,
    /// kg, from 1e-12 to 1e12; it is spread as the mass before.
    pub mass: f32,
}

/// `set_kind`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SetKindEntry {
    /// The body.
    pub body: BodyRef,
    /// How it moves from now on.
    pub kind: KindEntry,
}

/// `hold`: a damped spring between a point of a body and a point of the world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HoldEntry {
    /// The body.
    pub body: BodyRef,
    /// The held point in the body's own frame. Metres. Default its origin.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub anchor: [f32; 3],
    /// Where it is pulled to, in the world. Metres.
    pub target: [f32; 3],
    /// Hz, above 0 and at most 10 000. Default 5.
    #[serde(default = "default_frequency")]
    pub frequency_hz: f32,
    /// 1 is critical. 0 to 10 000, default 1.
    #[serde(default = "default_damping")]
    pub damping_ratio: f32,
}

/// Largest frequency (Hz) and damping ratio of a spring, as a timeline accepts them.
const SPRING_MAX: f32 = 1e4;

/// Least and largest mass (kg) that a command gives, as a timeline accepts them.
const MASSES: (f32, f32) = (1e-12, 1e12);

fn default_frequency() -> f32 {
    5.0
}

fn default_damping() -> f32 {
    1.0
}

impl CommandEntry {
    /// The body that the command names, and the field that names it. None for `add` and `set_gravity`.
    pub(crate) fn target(&self) -> Option<(&'static [&'static str], &BodyRef)> {
        macro_rules! body_of {
            ($($field:ident),*) => {
                $(if let Some(entry) = &self.$field {
                    return Some((&[stringify!($field), "body"], &entry.body));
                })*
            };
        }
        if let Some(body) = &self.remove {
            return Some((&["remove"], body));
        }
        if let Some(body) = &self.release {
            return Some((&["release"], body));
        }
        if let Some(entry) = &self.move_to {
            return Some((&["move", "body"], &entry.body));
        }
        body_of!(push, set_velocity, set_force, set_material, set_gravity_scale, set_mass, set_kind, hold);
        None
    }

    /// Everything but whether the body that is named exists.
    pub(crate) fn check(&self, meshes: &BTreeMap<String, MeshEntry>) -> Result<(), Fault> {
        self.check_when()?;
        self.check_one_action()?;
        if let Some(body) = &self.add {
            body.check(meshes).in_field("add")?;
        }
        if let Some(entry) = &self.move_to {
            entry.check().in_field("move")?;
        }
        if let Some(entry) = &self.push {
            range::vector(entry.impulse, "impulse").in_field("push")?;
            range::vector(entry.point.unwrap_or_default(), "point").in_field("push")?;
        }
        if let Some(entry) = &self.set_velocity {
            range::vector(entry.velocity, "velocity").in_field("set_velocity")?;
            range::vector(entry.angular_velocity, "angular_velocity").in_field("set_velocity")?;
        }
        if let Some(entry) = &self.set_force {
            range::vector(entry.force, "force").in_field("set_force")?;
            range::vector(entry.torque, "torque").in_field("set_force")?;
        }
        if let Some(entry) = &self.set_material {
            check_surface(entry.friction, entry.static_friction, entry.restitution)
                .in_field("set_material")?;
        }
        if let Some(entry) = &self.set_gravity_scale {
            range::finite(entry.scale, "scale").in_field("set_gravity_scale")?;
        }
        if let Some(entry) = &self.set_mass {
            range::between(entry.mass, MASSES, "mass").in_field("set_mass")?;
        }
        if let Some(entry) = &self.hold {
            entry.check().in_field("hold")?;
        }
        range::vector(self.set_gravity.unwrap_or_default(), "set_gravity")
    }

    fn check_when(&self) -> Result<(), Fault> {
        match (self.frame, self.seconds) {
            (Some(0), None) => {
                let remedy = "let the bodies say how it is at frame 0";
                Err(Fault::new("must be 1 or more, is 0", remedy)).in_field("frame")
            }
            (Some(_), None) => Ok(()),
            (None, Some(seconds)) => range::zero_or_more(seconds, "seconds"),
            (None, None) => {
                Err(Fault::new("a command needs a `frame` or a time in `seconds`", "add seconds = 1.0"))
            }
            (Some(_), Some(_)) => {
                Err(Fault::new("a command has a `frame` or `seconds`, this has both", "remove one"))
                    .in_field("seconds")
            }
        }
    }

    fn check_one_action(&self) -> Result<(), Fault> {
        let given = [
            ("add", self.add.is_some()),
            ("remove", self.remove.is_some()),
            ("move", self.move_to.is_some()),
            ("push", self.push.is_some()),
            ("set_velocity", self.set_velocity.is_some()),
            ("set_force", self.set_force.is_some()),
            ("set_material", self.set_material.is_some()),
            ("set_gravity_scale", self.set_gravity_scale.is_some()),
            ("set_mass", self.set_mass.is_some()),
            ("set_kind", self.set_kind.is_some()),
            ("hold", self.hold.is_some()),
            ("release", self.release.is_some()),
            ("set_gravity", self.set_gravity.is_some()),
        ];
        let named: Vec<&str> = given.iter().filter(|(_, is)| *is).map(|(name, _)| *name).collect();
        match named.as_slice() {
            [_] => Ok(()),
            [] => Err(Fault::new(
                format!("a command needs an action: one of {}", given.map(|(name, _)| name).join(", ")),
                "for example push = { body = 0, impulse = [0, 0, 1] }",
            )),
            [_, second, ..] => Err(Fault::new(
                format!("a command has one action, this has {}", named.join(" and ")),
                "write each action as a command of its own",
            ))
            .in_field(second),
        }
    }
}

impl MoveEntry {
    fn check(&self) -> Result<(), Fault> {
        range::vector(self.position, "position")?;
        match self.rotation {
            Some(rotation) => rotation.to_quat().map(|_| ()).in_field("rotation"),
            None => Ok(()),
        }
    }
}

impl HoldEntry {
    fn check(&self) -> Result<(), Fault> {
        range::vector(self.anchor, "anchor")?;
        range::vector(self.target, "target")?;
        range::above_zero_to(self.frequency_hz, SPRING_MAX, "frequency_hz")?;
        range::between(self.damping_ratio, (0.0, SPRING_MAX), "damping_ratio")
    }
}

impl Serialize for BodyRef {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            BodyRef::Name(name) => name.serialize(serializer),
            BodyRef::Number(number) => number.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for BodyRef {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct RefVisitor;
        impl Visitor<'_> for RefVisitor {
            type Value = BodyRef;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("the name of a body or its number from 0")
            }

            fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<BodyRef, E> {
                Ok(BodyRef::Name(name.to_owned()))
            }

            fn visit_i64<E: serde::de::Error>(self, number: i64) -> Result<BodyRef, E> {
                let wrong = |_| E::invalid_value(serde::de::Unexpected::Signed(number), &self);
                u32::try_from(number).map(BodyRef::Number).map_err(wrong)
            }

            fn visit_u64<E: serde::de::Error>(self, number: u64) -> Result<BodyRef, E> {
                let wrong = |_| E::invalid_value(serde::de::Unexpected::Unsigned(number), &self);
                u32::try_from(number).map(BodyRef::Number).map_err(wrong)
            }
        }
        deserializer.deserialize_any(RefVisitor)
    }
}
