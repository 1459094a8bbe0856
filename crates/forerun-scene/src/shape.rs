//! Shapes as a scene file has them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::body::is_zero;
use crate::error::{Fault, Within};
use crate::mesh::MeshEntry;
use crate::range;
use crate::rotation::RotationEntry;

/// A shape in a scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShapeEntry {
    /// A ball about the origin.
    Sphere(SphereEntry),
    /// A box about the origin.
    Box(BoxEntry),
    /// All points within a radius of a segment along y.
    Capsule(CapsuleEntry),
    /// A solid cylinder along y.
    Cylinder(CylinderEntry),
    /// The convex hull of points.
    Hull(HullEntry),
    /// Everything at or below y = 0 of the body's own frame: the ground. Not for dynamic bodies.
    HalfSpace,
    /// Several convex shapes held rigidly together.
    Compound(Vec<PartEntry>),
    /// A closed triangle mesh, convex or not, by its name in `meshes`.
    Mesh(String),
}

/// A ball about the origin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereEntry {
    /// Metres, above 0.
    pub radius: f32,
}

/// A box about the origin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoxEntry {
    /// Half the size along x, y, z. Metres, above 0.
    pub half_extents: [f32; 3],
}

/// All points within a radius of a segment along y.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CapsuleEntry {
    /// Half the length of the segment. Metres, 0 or more.
    pub half_height: f32,
    /// Metres, above 0.
    pub radius: f32,
}

/// A solid cylinder about the origin, along y.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CylinderEntry {
    /// Half the height. Metres, above 0.
    pub half_height: f32,
    /// Metres, above 0.
    pub radius: f32,
}

/// The convex hull of points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HullEntry {
    /// 4 points or more, not all in one plane. Metres.
    pub points: Vec<[f32; 3]>,
}

/// A part of a compound.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartEntry {
    /// A convex shape: not a half-space, compound or mesh.
    pub shape: ShapeEntry,
    /// Where it is in the compound. Metres. Default the origin.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub position: [f32; 3],
    /// How it is turned in the compound. Default not at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<RotationEntry>,
}

impl ShapeEntry {
    pub(crate) fn check(&self, meshes: &BTreeMap<String, MeshEntry>) -> Result<(), Fault> {
        match self {
            ShapeEntry::Sphere(s) => range::above_zero(s.radius, "radius").in_field("sphere"),
            ShapeEntry::Box(b) => range::vector_above_zero(b.half_extents, "half_extents").in_field("box"),
            ShapeEntry::Capsule(c) => range::zero_or_more(c.half_height, "half_height")
                .and_then(|()| range::above_zero(c.radius, "radius"))
                .in_field("capsule"),
            ShapeEntry::Cylinder(c) => range::above_zero(c.half_height, "half_height")
                .and_then(|()| range::above_zero(c.radius, "radius"))
                .in_field("cylinder"),
            ShapeEntry::Hull(hull) => check_points(&hull.points).in_field("points").in_field("hull"),
            ShapeEntry::HalfSpace => Ok(()),
            ShapeEntry::Compound(parts) => check_parts(parts, meshes).in_field("compound"),
            ShapeEntry::Mesh(name) => {
                if meshes.contains_key(name) {
                    return Ok(());
                }
                let message = format!("there is no mesh \"{name}\"; the scene has {}", list(meshes.keys()));
                Err(Fault::new(message, format!("add [meshes.{name}] or name another"))).in_field("mesh")
            }
        }
    }

    fn is_convex_solid(&self) -> bool {
        !matches!(self, ShapeEntry::HalfSpace | ShapeEntry::Compound(_) | ShapeEntry::Mesh(_))
    }
}

fn check_points(points: &[[f32; 3]]) -> Result<(), Fault> {
    for (i, point) in points.iter().enumerate() {
        for (axis, x) in point.iter().enumerate() {
            if !x.is_finite() {
                let fault =
                    Fault::new(format!("must be a finite number, is {x}"), "write a length in metres");
                return Err(fault).in_item(axis).in_item(i);
            }
        }
    }
    if points.len() < 4 {
        let message = format!("a hull needs 4 points or more, this has {}", points.len());
        return Err(Fault::new(message, "add points that are not all in one plane"));
    }
    Ok(())
}

fn check_parts(parts: &[PartEntry], meshes: &BTreeMap<String, MeshEntry>) -> Result<(), Fault> {
    if parts.is_empty() {
        return Err(Fault::new("a compound needs a part", "add { shape = ..., position = [x, y, z] }"));
    }
    for (i, part) in parts.iter().enumerate() {
        if !part.shape.is_convex_solid() {
            let fault = Fault::new(
                "a part is a sphere, box, capsule, cylinder or hull",
                "give a mesh or half_space a body of its own; put the parts of a compound into this one",
            );
            return Err(fault).in_field("shape").in_item(i);
        }
        part.shape.check(meshes).in_field("shape").in_item(i)?;
        range::vector(part.position, "position").in_item(i)?;
        if let Some(rotation) = part.rotation {
            rotation.to_quat().in_field("rotation").in_item(i)?;
        }
    }
    Ok(())
}

/// Names for a message: `a, b and c`.
pub(crate) fn list<'a>(names: impl Iterator<Item = &'a String>) -> String {
    let names: Vec<&str> = names.map(String::as_str).collect();
    match names.split_last() {
        None => "none".to_owned(),
        Some((last, [])) => (*last).to_owned(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
    }
}
