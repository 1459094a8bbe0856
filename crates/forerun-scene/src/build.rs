//! From entries of a scene file to values of the engine. The entries have been checked before.

use std::cell::RefCell;
use std::collections::BTreeMap;

use forerun_dynamics::{Body, BodyDef, BodyError, Mass, Material};
use forerun_geometry::shape::ShapeError;
use forerun_geometry::{Pose, Quat, Shape, Vec3};

use crate::body::BodyEntry;
use crate::error::{Fault, Step, Within};
use crate::mesh::MeshEntry;
use crate::mesh_baking::BakeSite;
use crate::rotation::RotationEntry;
use crate::shape::{HullEntry, PartEntry, ShapeEntry};

/// Density of a body that gives neither density nor mass. kg/m³.
const DENSITY: f32 = 1000.0;

/// Shapes that bodies share: meshes by their names, hulls by their points. A thousand equal rocks are one rock in memory.
#[derive(Debug, Default)]
pub(crate) struct Shapes {
    meshes: BTreeMap<String, Shape>,
    /// Those that were built so far, by the bits of their points.
    hulls: RefCell<BTreeMap<Vec<[u32; 3]>, Shape>>,
}

impl Shapes {
    /// `meshes` has the shape of every mesh that a body may name.
    pub(crate) fn new(meshes: BTreeMap<String, Shape>) -> Self {
        Shapes { meshes, hulls: RefCell::default() }
    }

    fn hull(&self, entry: &HullEntry) -> Result<Shape, ShapeError> {
        let key: Vec<[u32; 3]> = entry.points.iter().map(|point| point.map(f32::to_bits)).collect();
        if let Some(known) = self.hulls.borrow().get(&key) {
            return Ok(known.clone());
        }
        let points: Vec<Vec3> = entry.points.iter().copied().map(Vec3::from_array).collect();
        let hull = Shape::hull(&points)?;
        self.hulls.borrow_mut().insert(key, hull.clone());
        Ok(hull)
    }
}

/// The definition of a body.
pub(crate) fn build_body(entry: &BodyEntry, shapes: &Shapes) -> Result<BodyDef, Fault> {
    let def = BodyDef {
        shape: build_shape(&entry.shape, shapes).in_field("shape")?,
        pose: pose(entry.position, entry.rotation)?,
        velocity: Vec3::from_array(entry.velocity),
        angular_velocity: Vec3::from_array(entry.angular_velocity),
        kind: entry.kind.into(),
        material: material(entry.friction, entry.static_friction, entry.restitution),
        mass: mass(entry)?,
        gravity_scale: entry.gravity_scale.unwrap_or(1.0),
        force: Vec3::from_array(entry.force),
        torque: Vec3::from_array(entry.torque),
    };
    // The engine has the last word, here where the line of the body is still known.
    Body::new(&def).map_err(|BodyError { field, message }| {
        Fault::new(message, "change the body or its shape").under(Step::Field(field.to_owned()))
    })?;
    Ok(def)
}

/// A surface, with the defaults of a body for what is not given.
pub(crate) fn material(
    friction: Option<f32>,
    static_friction: Option<f32>,
    restitution: Option<f32>,
) -> Material {
    let default = Material::default();
    let friction = friction.unwrap_or(default.friction);
    Material {
        friction,
        static_friction: static_friction.unwrap_or(friction),
        restitution: restitution.unwrap_or(default.restitution),
    }
}

fn mass(entry: &BodyEntry) -> Result<Mass, Fault> {
    Ok(match (entry.mass, entry.inertia) {
        (None, _) => Mass::Density(entry.density.unwrap_or(DENSITY)),
        (Some(mass), None) => Mass::Total(mass),
        (Some(mass), Some(inertia)) => Mass::Given {
            mass,
            centre: Vec3::from_array(entry.centre_of_mass.unwrap_or_default()),
            inertia: Vec3::from_array(inertia),
            principal_rotation: rotation(entry.inertia_rotation).in_field("inertia_rotation")?,
        },
    })
}

fn pose(position: [f32; 3], turned: Option<RotationEntry>) -> Result<Pose, Fault> {
    Ok(Pose::new(Vec3::from_array(position), rotation(turned).in_field("rotation")?))
}

fn rotation(entry: Option<RotationEntry>) -> Result<Quat, Fault> {
    entry.map_or(Ok(Quat::IDENTITY), RotationEntry::to_quat)
}

/// The shape of a mesh.
pub(crate) fn build_mesh(entry: &MeshEntry, site: &BakeSite<'_>) -> Result<Shape, Fault> {
    Ok(entry.build(site)?.into())
}

fn build_shape(entry: &ShapeEntry, shapes: &Shapes) -> Result<Shape, Fault> {
    let made = |shape: Result<Shape, ShapeError>, field| {
        let fault = |error: ShapeError| Fault::new(error.message, "change the numbers of the shape");
        shape.map_err(fault).in_field(field)
    };
    match entry {
        ShapeEntry::Sphere(s) => made(Shape::sphere(s.radius), "sphere"),
        ShapeEntry::Box(b) => made(Shape::cuboid(Vec3::from_array(b.half_extents)), "box"),
        ShapeEntry::Capsule(c) => made(Shape::capsule(c.half_height, c.radius), "capsule"),
        ShapeEntry::Cylinder(c) => made(Shape::cylinder(c.half_height, c.radius), "cylinder"),
        ShapeEntry::Hull(hull) => made(shapes.hull(hull), "hull"),
        ShapeEntry::HalfSpace => Ok(Shape::half_space()),
        ShapeEntry::Compound(parts) => {
            let parts: Result<Vec<_>, Fault> =
                parts.iter().enumerate().map(|(i, part)| build_part(part, shapes).in_item(i)).collect();
            made(Shape::compound(parts.in_field("compound")?), "compound")
        }
        ShapeEntry::Mesh(name) => shapes.meshes.get(name).cloned().ok_or_else(|| {
            Fault::new(format!("there is no mesh \"{name}\""), format!("add [meshes.{name}]"))
        }),
    }
}

fn build_part(part: &PartEntry, shapes: &Shapes) -> Result<(Pose, Shape), Fault> {
    Ok((pose(part.position, part.rotation)?, build_shape(&part.shape, shapes).in_field("shape")?))
}
