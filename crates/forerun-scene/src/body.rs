//! Bodies as a scene file has them.

use std::collections::BTreeMap;

use forerun_dynamics::BodyKind;
use serde::{Deserialize, Serialize};

use crate::error::{Fault, Within};
use crate::mesh::MeshEntry;
use crate::range;
use crate::rotation::RotationEntry;
use crate::shape::ShapeEntry;

/// A body in a scene file. Every field but `shape` may be left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyEntry {
    /// A name for commands and messages. No two bodies share one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The shape, in the body's own frame.
    pub shape: ShapeEntry,
    /// Where the body's own frame is at first. Metres. Default the origin.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub position: [f32; 3],
    /// How the body's own frame is turned at first. Default not at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<RotationEntry>,
    /// Velocity of the centre of mass. m/s. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub velocity: [f32; 3],
    /// Angular velocity, in the world. rad/s. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub angular_velocity: [f32; 3],
    /// How it moves. Default dynamic.
    #[serde(default, skip_serializing_if = "KindEntry::is_default")]
    pub kind: KindEntry,
    /// Coefficient of kinetic friction, 0 or more. Default 0.5.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<f32>,
    /// Coefficient of static friction, at least `friction`. Default the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub static_friction: Option<f32>,
    /// Coefficient of restitution, 0 to 1. Default 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub restitution: Option<f32>,
    /// Density, kg/m³, above 0. Default 1000 if there is no `mass`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f32>,
    /// Mass instead of density. kg, above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<f32>,
    /// Centre of mass in the body's own frame, with `mass` and `inertia`. Metres. Default the origin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre_of_mass: Option<[f32; 3]>,
    /// Moments of inertia about the centre of mass along the principal axes, with `mass`. kg m², above 0. Default from the shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia: Option<[f32; 3]>,
    /// Rotation from the principal axes to the body's own frame, with `inertia`. Default none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia_rotation: Option<RotationEntry>,
    /// Factor on gravity. Default 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity_scale: Option<f32>,
    /// Constant force at the centre of mass, in the world. N. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub force: [f32; 3],
    /// Constant torque, in the world. N m. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub torque: [f32; 3],
}

/// How a body moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum KindEntry {
    /// By forces, impulses and contacts.
    #[default]
    Dynamic,
    /// Not at all.
    Fixed,
    /// At its own velocity; nothing pushes it.
    Kinematic,
}

// Compared as bits: -0 is written out, so that a scene comes back exactly.
pub(crate) fn is_zero(v: &[f32; 3]) -> bool {
    v.iter().all(|x| x.to_bits() == 0)
}

impl KindEntry {
    fn is_default(&self) -> bool {
        *self == KindEntry::Dynamic
    }
}

impl From<KindEntry> for BodyKind {
    fn from(kind: KindEntry) -> BodyKind {
        match kind {
            KindEntry::Dynamic => BodyKind::Dynamic,
            KindEntry::Fixed => BodyKind::Fixed,
            KindEntry::Kinematic => BodyKind::Kinematic,
        }
    }
}

impl BodyEntry {
    /// A dynamic body at the origin, at rest, of density 1000 kg/m³.
    #[must_use]
    pub fn new(shape: ShapeEntry) -> BodyEntry {
        BodyEntry {
            name: None,
            shape,
            position: [0.0; 3],
            rotation: None,
            velocity: [0.0; 3],
            angular_velocity: [0.0; 3],
            kind: KindEntry::Dynamic,
            friction: None,
            static_friction: None,
            restitution: None,
            density: None,
            mass: None,
            centre_of_mass: None,
            inertia: None,
            inertia_rotation: None,
            gravity_scale: None,
            force: [0.0; 3],
            torque: [0.0; 3],
        }
    }

    pub(crate) fn check(&self, meshes: &BTreeMap<String, MeshEntry>) -> Result<(), Fault> {
        if let Some(name) = &self.name {
            range::name(name, "name")?;
        }
        self.shape.check(meshes).in_field("shape")?;
        if self.shape == ShapeEntry::HalfSpace && self.kind == KindEntry::Dynamic {
            let fault = Fault::new("a half_space is never dynamic", "add kind = \"fixed\" to the body");
            return Err(fault).in_field("shape");
        }
        if let ShapeEntry::Mesh(mesh) = &self.shape
            && self.kind == KindEntry::Dynamic
            && meshes[mesh].open
        {
            let fault =
                Fault::new("an open mesh is never dynamic", "add kind = \"fixed\", or close the mesh");
            return Err(fault).in_field("shape");
        }
        range::vector(self.position, "position")?;
        if let Some(rotation) = self.rotation {
            rotation.to_quat().in_field("rotation")?;
        }
        range::vector(self.velocity, "velocity")?;
        range::vector(self.angular_velocity, "angular_velocity")?;
        check_surface(self.friction, self.static_friction, self.restitution)?;
        self.check_mass()?;
        range::finite(self.gravity_scale.unwrap_or(1.0), "gravity_scale")?;
        range::vector(self.force, "force")?;
        range::vector(self.torque, "torque")
    }

    fn check_mass(&self) -> Result<(), Fault> {
        range::above_zero(self.density.unwrap_or(1.0), "density")?;
        range::above_zero(self.mass.unwrap_or(1.0), "mass")?;
        if self.density.is_some() && self.mass.is_some() {
            let fault = Fault::new("a body has a density or a mass, this has both", "remove one of the two");
            return Err(fault).in_field("mass");
        }
        if let Some(inertia) = self.inertia {
            range::vector_above_zero(inertia, "inertia")?;
            if self.mass.is_none() {
                return Err(Fault::new("needs `mass` beside it", "add the mass in kg")).in_field("inertia");
            }
        }
        let needs_inertia = Fault::new("needs `inertia` beside it", "add three moments of inertia in kg m²");
        if let Some(centre) = self.centre_of_mass {
            range::vector(centre, "centre_of_mass")?;
            if self.inertia.is_none() {
                return Err(needs_inertia).in_field("centre_of_mass");
            }
        }
        if let Some(rotation) = self.inertia_rotation {
            rotation.to_quat().in_field("inertia_rotation")?;
            if self.inertia.is_none() {
                return Err(needs_inertia).in_field("inertia_rotation");
            }
        }
        Ok(())
    }
}

/// Friction and restitution, of a body or of a command.
pub(crate) fn check_surface(
    friction: Option<f32>,
    static_friction: Option<f32>,
    restitution: Option<f32>,
) -> Result<(), Fault> {
    let kinetic = friction.unwrap_or(forerun_dynamics::Material::default().friction);
    range::zero_or_more(kinetic, "friction")?;
    if let Some(static_friction) = static_friction {
        range::zero_or_more(static_friction, "static_friction")?;
        if static_friction < kinetic {
            let message = format!("must be at least friction ({kinetic}), is {static_friction}");
            return Err(Fault::new(message, "raise it, or lower friction")).in_field("static_friction");
        }
    }
    range::between(restitution.unwrap_or(0.0), (0.0, 1.0), "restitution")
}
