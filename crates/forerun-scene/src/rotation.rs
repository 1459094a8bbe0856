//! Rotations as people write them: a quaternion, an axis and an angle, or a turn about the vertical.

use std::fmt;

use forerun_geometry::{Quat, Vec3};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::error::{Fault, Within};
use crate::range;

/// A rotation in a scene file. Positive angles turn counter-clockwise when the axis points at the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RotationEntry {
    /// `[x, y, z, w]`: a unit quaternion. Kept bit for bit if its length is 1 to within rounding.
    Quaternion([f32; 4]),
    /// `{ axis = [x, y, z], angle_degrees = a }`. The axis may have any length above 0.
    AxisAngle {
        /// Direction of the axis.
        axis: [f32; 3],
        /// Angle about it. Degrees.
        angle_degrees: f32,
    },
    /// `{ yaw_degrees = a }`: about the y axis, which points up. Degrees.
    Yaw(f32),
}

/// Length squared of a quaternion that is a unit quaternion up to rounding.
const ROUNDING: f32 = 1e-6;
/// Length that is taken for a unit quaternion written with few digits: it is made 1. Others are mistakes.
const FEW_DIGITS: f32 = 0.01;

impl RotationEntry {
    /// The rotation as a unit quaternion.
    pub(crate) fn to_quat(self) -> Result<Quat, Fault> {
        match self {
            RotationEntry::Quaternion(q) => unit_quaternion(q),
            RotationEntry::AxisAngle { axis, angle_degrees } => {
                range::vector(axis, "axis")?;
                range::finite(angle_degrees, "angle_degrees")?;
                let Some(axis) = Vec3::from_array(axis).try_normalize() else {
                    let fault = Fault::new(
                        "must be a direction, has no length",
                        "write for example [0, 1, 0] for a turn about the vertical",
                    );
                    return Err(fault).in_field("axis");
                };
                Ok(about(axis, angle_degrees))
            }
            RotationEntry::Yaw(degrees) => {
                range::finite(degrees, "yaw_degrees")?;
                Ok(about(Vec3::Y, degrees))
            }
        }
    }
}

fn unit_quaternion([x, y, z, w]: [f32; 4]) -> Result<Quat, Fault> {
    let q = Quat::from_xyzw(x, y, z, w);
    if !q.is_finite() {
        return Err(Fault::new(
            format!("must be four finite numbers x, y, z, w, is [{x}, {y}, {z}, {w}]"),
            "[0, 0, 0, 1] turns nothing",
        ));
    }
    if (q.length_squared() - 1.0).abs() <= ROUNDING {
        return Ok(q);
    }
    let length = q.length();
    if (length - 1.0).abs() <= FEW_DIGITS {
        return Ok(q.normalize());
    }
    let remedy = if length > 0.0 && length.is_finite() {
        let u = q / length;
        format!("of length 1 it is [{}, {}, {}, {}]", u.x, u.y, u.z, u.w)
    } else {
        "[0, 0, 0, 1] turns nothing".to_owned()
    };
    Err(Fault::new(format!("must be a unit quaternion x, y, z, w, has length {length}"), remedy))
}

/// A turn about a unit axis.
pub(crate) fn about(axis: Vec3, degrees: f32) -> Quat {
    let (sin, cos) = libm::sincosf(degrees * (std::f32::consts::PI / 360.0));
    Quat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos)
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Turn {
    #[serde(skip_serializing_if = "Option::is_none")]
    axis: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    angle_degrees: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    yaw_degrees: Option<f32>,
}

impl Serialize for RotationEntry {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            RotationEntry::Quaternion(q) => q.serialize(serializer),
            RotationEntry::AxisAngle { axis, angle_degrees } => {
                Turn { axis: Some(axis), angle_degrees: Some(angle_degrees), yaw_degrees: None }
                    .serialize(serializer)
            }
            RotationEntry::Yaw(degrees) => {
                Turn { axis: None, angle_degrees: None, yaw_degrees: Some(degrees) }.serialize(serializer)
            }
        }
    }
}

impl<'de> Deserialize<'de> for RotationEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(RotationVisitor)
    }
}

struct RotationVisitor;

impl<'de> Visitor<'de> for RotationVisitor {
    type Value = RotationEntry;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a quaternion [x, y, z, w], { axis, angle_degrees } or { yaw_degrees }")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<RotationEntry, A::Error> {
        <[f32; 4]>::deserialize(SeqAccessDeserializer::new(seq)).map(RotationEntry::Quaternion)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<RotationEntry, A::Error> {
        match Turn::deserialize(MapAccessDeserializer::new(map))? {
            Turn { axis: Some(axis), angle_degrees: Some(angle_degrees), yaw_degrees: None } => {
                Ok(RotationEntry::AxisAngle { axis, angle_degrees })
            }
            Turn { axis: None, angle_degrees: None, yaw_degrees: Some(degrees) } => {
                Ok(RotationEntry::Yaw(degrees))
            }
            _ => Err(serde::de::Error::custom(
                "a rotation has either `axis` and `angle_degrees`, or `yaw_degrees` alone",
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_angle_and_yaw_agree_and_turn_the_right_way() {
        let yaw = RotationEntry::Yaw(90.0).to_quat().unwrap();
        let same = RotationEntry::AxisAngle { axis: [0.0, 3.0, 0.0], angle_degrees: 90.0 }.to_quat().unwrap();
        assert!((yaw - same).length() < 1e-6);
        // Right-handed, y up: a quarter turn about y takes z to x.
        assert!((yaw * Vec3::Z - Vec3::X).length() < 1e-6);
    }

    #[test]
    fn a_unit_quaternion_keeps_its_bits_and_a_rounded_one_is_made_unit() {
        let q = about(Vec3::new(0.6, 0.0, 0.8), 77.0);
        let kept = RotationEntry::Quaternion(q.to_array()).to_quat().unwrap();
        assert_eq!(kept.to_array().map(f32::to_bits), q.to_array().map(f32::to_bits));
        let rounded = RotationEntry::Quaternion([0.0, 0.71, 0.0, 0.71]).to_quat().unwrap();
        assert!((rounded.length() - 1.0).abs() < 1e-6);
        assert!(RotationEntry::Quaternion([0.0, 1.0, 0.0, 1.0]).to_quat().is_err());
    }
}
