//! Bodies: what does not change from frame to frame unless a command says so.

use forerun_geometry::{Pose, Shape, Vec3};

use crate::{BodyDef, BodyError, BodyState, Environment, Mass};

/// Name of a body. Never used again after the body is removed; the order of ids is the canonical order of bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyId(pub u32);

/// How a body moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyKind {
    /// Moved by forces, impulses and contacts.
    Dynamic,
    /// Stays where it is.
    Fixed,
    /// Moves at its own velocity; nothing pushes it.
    Kinematic,
}

/// What a surface does in contact. Of two materials the friction is the geometric mean and the restitution the larger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Coefficient of kinetic friction, 0 or more. Default 0.5.
    pub friction: f32,
    /// Coefficient of static friction, at least `friction`. Default the same as `friction`.
    pub static_friction: f32,
    /// Coefficient of restitution, 0 to 1. Default 0.
    pub restitution: f32,
}

impl Material {
    /// A material with the same static and kinetic friction.
    #[must_use]
    pub const fn new(friction: f32, restitution: f32) -> Self {
        Material { friction, static_friction: friction, restitution }
    }
}

impl Default for Material {
    fn default() -> Self {
        Material::new(0.5, 0.0)
    }
}

/// A damped spring that pulls a point of a body to a point of the world: a hand that holds or drags.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// The held point in the body's own frame (that of its definition). Metres.
    pub anchor: Vec3,
    /// Where it is pulled to, in the world. Metres.
    pub target: Vec3,
    /// Natural frequency of the body on the spring. Hz, above 0.
    pub frequency_hz: f32,
    /// Damping ratio: 1 is critical. 0 or more.
    pub damping_ratio: f32,
}

/// A body as the step sees it: principal frame, inverse masses.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// The shape.
    pub shape: Shape,
    /// The body's own frame (that of its shape and definition) in the principal frame of its states.
    pub frame: Pose,
    /// How it moves.
    pub kind: BodyKind,
    /// Surface.
    pub material: Material,
    /// 1/kg; 0 unless dynamic.
    pub inverse_mass: f32,
    /// 1/(kg m²) along the principal axes; 0 unless dynamic.
    pub inverse_inertia: Vec3,
    /// Factor on gravity.
    pub gravity_scale: f32,
    /// Constant external force at the centre of mass. N.
    pub force: Vec3,
    /// Constant external torque. N m.
    pub torque: Vec3,
    /// The spring that holds the body, if any.
    pub spring: Option<Spring>,
    /// Distance from the centre of mass to the farthest point of the shape. Metres; infinite for half-spaces.
    pub radius: f32,
    /// Half the smallest thickness of the shape. Metres.
    pub half_thickness: f32,
}

impl Body {
    /// The body and its first state.
    ///
    /// # Errors
    /// When a number of the definition is not finite or out of its range, or the shape bounds no volume (an open mesh, a half-space) and the
    /// body is dynamic.
    pub fn new(def: &BodyDef) -> Result<(Body, BodyState), BodyError> {
        def.check()?;
        let (mass, centre, inertia, principal) = match def.mass {
            Mass::Given { mass, centre, inertia, principal_rotation } => {
                (mass, centre, inertia, principal_rotation)
            }
            Mass::Density(density) => {
                let m = def.shape.mass_properties(density);
                (m.mass, m.centre, m.principal_inertia, m.principal_rotation)
            }
            Mass::Total(total) => {
                let m = def.shape.mass_properties(1.0);
                let scale = if m.mass > 0.0 { total / m.mass } else { 0.0 };
                (total, m.centre, m.principal_inertia * scale, m.principal_rotation)
            }
        };
        let dynamic = def.kind == BodyKind::Dynamic;
        // The inverses too: a mass of 1e-39 kg is above 0 and has none.
        let heavy = mass > 0.0 && mass.is_finite() && (1.0 / mass).is_finite();
        let spins = inertia.min_element() > 0.0 && inertia.is_finite() && inertia.recip().is_finite();
        if dynamic && !(heavy && spins) {
            return Err(BodyError {
                field: "shape",
                message: format!(
                    "a dynamic body needs a mass and inertia above 0, this has {mass} kg and {inertia} kg m²"
                ),
            });
        }
        let principal_frame = Pose::new(centre, principal);
        let body = Body {
            frame: principal_frame.inverse(),
            kind: def.kind,
            material: def.material,
            inverse_mass: if dynamic { 1.0 / mass } else { 0.0 },
            inverse_inertia: if dynamic { inertia.recip() } else { Vec3::ZERO },
            gravity_scale: def.gravity_scale,
            force: def.force,
            torque: def.torque,
            spring: None,
            radius: def.shape.radius_about(centre),
            half_thickness: def.shape.half_thickness(),
            shape: def.shape.clone(),
        };
        let state = body.state_at(&def.pose, def.velocity, def.angular_velocity);
        Ok((body, state))
    }

    /// The state of the body when its own frame is at `pose`, moving as given, not at rest.
    #[must_use]
    pub fn state_at(&self, pose: &Pose, velocity: Vec3, angular_velocity: Vec3) -> BodyState {
        let principal = *pose * self.frame.inverse();
        let (velocity, angular_velocity) = if self.kind == BodyKind::Fixed {
            (Vec3::ZERO, Vec3::ZERO)
        } else {
            (velocity, angular_velocity)
        };
        BodyState {
            position: principal.position,
            rotation: principal.rotation.normalize(),
            velocity,
            angular_velocity,
            rest: 0,
        }
        .canonical()
    }

    /// Where the body's own frame is in a state.
    #[must_use]
    pub fn own_pose(&self, state: &BodyState) -> Pose {
        state.pose() * self.frame
    }

    /// Acceleration of the centre of mass by gravity and the external force. m/s²
    #[must_use]
    pub fn acceleration(&self, environment: &Environment) -> Vec3 {
        environment.gravity * self.gravity_scale + self.force * self.inverse_mass
    }

    /// Whether forces and contacts move it.
    #[must_use]
    pub fn is_dynamic(&self) -> bool {
        self.kind == BodyKind::Dynamic
    }
}
