//! Body definition: how a body is made, and what of it is possible.

use std::fmt;

use forerun_geometry::{Pose, Quat, Shape, Vec3};

use crate::{BodyKind, Material};

/// How a body is made. `BodyDef::new(shape)` gives a dynamic body at the origin, at rest, of density 1000.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyDef {
    /// The shape, in the body's own frame.
    pub shape: Shape,
    /// Where the body's own frame is at first.
    pub pose: Pose,
    /// Velocity of the centre of mass. m/s.
    pub velocity: Vec3,
    /// Angular velocity in the world. rad/s.
    pub angular_velocity: Vec3,
    /// How it moves.
    pub kind: BodyKind,
    /// Surface.
    pub material: Material,
    /// Mass.
    pub mass: Mass,
    /// Factor on gravity for this body. Default 1.
    pub gravity_scale: f32,
    /// Constant external force at the centre of mass, in the world. N.
    pub force: Vec3,
    /// Constant external torque, in the world. N m.
    pub torque: Vec3,
}

/// How heavy a body is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mass {
    /// From the volume of the shape. kg/m³, above 0.
    Density(f32),
    /// A total mass spread evenly over the shape. kg, above 0.
    Total(f32),
    /// Given in full: mass (kg), centre of mass and moments about it along the body's own axes (kg m²).
    Given {
        /// Mass. kg, above 0.
        mass: f32,
        /// Centre of mass in the body's own frame. Metres.
        centre: Vec3,
        /// Principal moments about the centre of mass. kg m², above 0.
        inertia: Vec3,
        /// Rotation from the principal axes to the body's own frame.
        principal_rotation: Quat,
    },
}

impl BodyDef {
    /// A dynamic body of density 1000 kg/m³ at the origin, at rest.
    #[must_use]
    pub fn new(shape: Shape) -> Self {
        BodyDef {
            shape,
            pose: Pose::IDENTITY,
            velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
            kind: BodyKind::Dynamic,
            material: Material::default(),
            mass: Mass::Density(1000.0),
            gravity_scale: 1.0,
            force: Vec3::ZERO,
            torque: Vec3::ZERO,
        }
    }

    /// A body that stays where it is.
    #[must_use]
    pub fn fixed(shape: Shape) -> Self {
        BodyDef { kind: BodyKind::Fixed, ..BodyDef::new(shape) }
    }

    /// The same at a position (metres).
    #[must_use]
    pub fn at(mut self, position: Vec3) -> Self {
        self.pose.position = position;
        self
    }

    /// Whether such a body can be made.
    ///
    /// # Errors
    /// The first number that is not finite or out of its range; a shape without an inside where the body is dynamic.
    pub(crate) fn check(&self) -> Result<(), BodyError> {
        let fail = |field, message: String| Err(BodyError { field, message });
        let vectors = [
            ("position", self.pose.position),
            ("velocity", self.velocity),
            ("angular_velocity", self.angular_velocity),
            ("force", self.force),
            ("torque", self.torque),
        ];
        for (field, v) in vectors {
            if !v.is_finite() {
                return fail(field, format!("must be finite numbers, is {v}"));
            }
        }
        let q = self.pose.rotation;
        if !is_unit(q) {
            return fail("rotation", format!("must be a unit quaternion (x, y, z, w), is {q}"));
        }
        validate_shape(self)?;
        let m = self.material;
        if !(m.friction >= 0.0 && m.friction.is_finite()) {
            return fail("friction", format!("must be 0 or more, is {}", m.friction));
        }
        if !(m.static_friction >= m.friction && m.static_friction.is_finite()) {
            return fail(
                "static_friction",
                format!("must be at least friction ({}), is {}", m.friction, m.static_friction),
            );
        }
        if !(0.0..=1.0).contains(&m.restitution) {
            return fail("restitution", format!("must be from 0 to 1, is {}", m.restitution));
        }
        if !self.gravity_scale.is_finite() {
            return fail("gravity_scale", format!("must be a finite number, is {}", self.gravity_scale));
        }
        let (field, mass) = match self.mass {
            Mass::Density(x) => ("density", x),
            Mass::Total(x) | Mass::Given { mass: x, .. } => ("mass", x),
        };
        if !(mass > 0.0 && mass.is_finite()) {
            return fail(field, format!("must be above 0, is {mass}"));
        }
        if let Mass::Given { centre, principal_rotation: q, .. } = self.mass {
            if !centre.is_finite() {
                return fail("centre", format!("must be finite numbers, is {centre}"));
            }
            if !is_unit(q) {
                return fail("principal_rotation", format!("must be a unit quaternion (x, y, z, w), is {q}"));
            }
        }
        Ok(())
    }
}

/// Why a body cannot be made.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyError {
    /// The field at fault, as in [`BodyDef`].
    pub field: &'static str,
    /// What is wrong and what is allowed.
    pub message: String,
}

impl fmt::Display for BodyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.field, self.message)
    }
}

impl std::error::Error for BodyError {}

fn is_unit(q: Quat) -> bool {
    q.is_finite() && (q.length_squared() - 1.0).abs() < 1e-3
}

/// Lengths of shapes that were not made by a constructor, and whether a dynamic body has an inside that can be pushed out of others, whatever
/// mass it is said to have.
fn validate_shape(def: &BodyDef) -> Result<(), BodyError> {
    let made = match &def.shape {
        Shape::Sphere(s) => Shape::sphere(s.radius),
        Shape::Cuboid(s) => Shape::cuboid(s.half_extents),
        Shape::Capsule(s) => Shape::capsule(s.half_height, s.radius),
        Shape::Cylinder(s) => Shape::cylinder(s.half_height, s.radius),
        Shape::Hull(_) | Shape::HalfSpace | Shape::Compound(_) | Shape::Mesh(_) => Ok(Shape::HalfSpace),
    };
    made.map_err(|error| BodyError { field: error.field, message: error.message })?;
    if def.kind == BodyKind::Dynamic && !def.shape.has_volume() {
        let message = "an open mesh or half-space bounds no volume: such a body must be fixed or kinematic";
        return Err(BodyError { field: "shape", message: message.to_owned() });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use forerun_geometry::shape::{Mesh, Sphere};

    use super::*;
    use crate::Body;

    fn open_mesh() -> Shape {
        Mesh::open(vec![Vec3::ZERO, Vec3::Z, Vec3::X], vec![[0, 1, 2]]).unwrap().into()
    }

    #[test]
    fn what_bounds_no_volume_is_never_dynamic_whatever_its_mass() {
        let given = Mass::Given {
            mass: 1.0,
            centre: Vec3::ZERO,
            inertia: Vec3::ONE,
            principal_rotation: Quat::IDENTITY,
        };
        for shape in [open_mesh(), Shape::HalfSpace] {
            for mass in [given, Mass::Density(1000.0), Mass::Total(1.0)] {
                let dynamic = BodyDef { mass, ..BodyDef::new(shape.clone()) };
                let error = Body::new(&dynamic).unwrap_err().to_string();
                assert!(error.starts_with("shape: an open mesh or half-space"), "{error}");
                let kinematic = BodyDef { kind: BodyKind::Kinematic, ..dynamic };
                assert!(Body::new(&kinematic).is_ok());
            }
        }
    }

    #[test]
    fn numbers_out_of_range_are_named() {
        let refused = |change: fn(&mut BodyDef), field: &str| {
            let mut def = BodyDef::new(Shape::Sphere(Sphere { radius: 1.0 }));
            assert!(Body::new(&def).is_ok());
            change(&mut def);
            assert_eq!(Body::new(&def).unwrap_err().field, field);
        };
        let given = |centre, principal_rotation| Mass::Given {
            mass: 1.0,
            centre,
            inertia: Vec3::ONE,
            principal_rotation,
        };
        refused(|d| d.shape = Shape::Sphere(Sphere { radius: -1.0 }), "radius");
        refused(|d| d.velocity.x = f32::INFINITY, "velocity");
        refused(|d| d.pose.rotation = Quat::from_xyzw(0.0, 0.0, 0.0, 2.0), "rotation");
        refused(|d| d.material.restitution = 1.5, "restitution");
        refused(|d| d.mass = Mass::Total(f32::NAN), "mass");
        let mut def = BodyDef::new(Shape::Sphere(Sphere { radius: 1.0 }));
        def.mass = given(Vec3::NAN, Quat::IDENTITY);
        assert_eq!(Body::new(&def).unwrap_err().field, "centre");
        def.mass = given(Vec3::ZERO, Quat::from_xyzw(0.0, 0.0, 0.0, f32::NAN));
        assert_eq!(Body::new(&def).unwrap_err().field, "principal_rotation");
    }
}
