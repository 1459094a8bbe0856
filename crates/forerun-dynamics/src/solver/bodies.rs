//! Bodies of a batch in mass-scaled coordinates.
//!
//! A velocity is stored as `u = (v / sqrt(1/m), sqrt(I) Rᵀ ω)`, so that kinetic energy is `|u|² / 2`, and a contact row needs
//! neither masses nor inertia tensors: its Jacobian serves both to read velocities and to apply impulses.

use forerun_geometry::{Mat3, Vec3};

use crate::lanes::Row;
use crate::{BodyKind, Environment, Member};

/// The moving quantities of a batch, one row a body, one more for a dummy that pads the lanes, and where they are written one that nobody reads.
#[derive(Debug, Default)]
pub(crate) struct Bodies {
    /// Centre of mass (3), square root of the inverse mass, of the inverse inertia (3), 1 if impulses move the body.
    pub(crate) centres: Vec<Row>,
    /// First and second principal axis in the world (3 + 3).
    pub(crate) axes: Vec<Row>,
    /// Mass-scaled velocity.
    pub(crate) velocities: Vec<Row>,
    /// Mass-scaled displacement since the start of the frame.
    pub(crate) displacements: Vec<Row>,
    /// Mass-scaled change of velocity by gravity, forces and torques in a substep.
    pub(crate) kicks: Vec<Row>,
    /// Velocities of the running substep before any impulse.
    pub(crate) free: Vec<Row>,
    /// What impulses did to the velocities in the last substep.
    pub(crate) pushes: Vec<Row>,
    /// Static and kinetic friction, restitution, half thickness, inverse mass.
    pub(crate) surfaces: Vec<Row>,
}

/// Scale factors of one body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    pub(crate) linear: f32,
    pub(crate) angular: Vec3,
    pub(crate) axes: Mat3,
}

impl Scale {
    /// Kinematic bodies have a scale of 1, so that their velocity can be read; fixed ones of 0.
    pub(crate) fn of(member: &Member) -> Scale {
        let body = member.body;
        let axes = member.state.pose().axes();
        match body.kind {
            BodyKind::Dynamic => {
                let i = body.inverse_inertia;
                let angular = Vec3::new(i.x.sqrt(), i.y.sqrt(), i.z.sqrt());
                Scale { linear: body.inverse_mass.sqrt(), angular, axes }
            }
            BodyKind::Kinematic => Scale { linear: 1.0, angular: Vec3::ONE, axes },
            BodyKind::Fixed => Scale { linear: 0.0, angular: Vec3::ZERO, axes },
        }
    }

    /// World velocity and angular velocity to a row. Zero for fixed bodies.
    pub(crate) fn to_row(self, velocity: Vec3, angular_velocity: Vec3) -> Row {
        if self.linear == 0.0 {
            return Row::default();
        }
        let v = velocity / self.linear;
        let w = (self.axes.transpose() * angular_velocity) / self.angular;
        Row([v.x, v.y, v.z, w.x, w.y, w.z, 0.0, 0.0])
    }

    /// A row in the world: velocity and angular velocity, or displacement and rotation vector.
    pub(crate) fn world_of(self, row: &Row) -> (Vec3, Vec3) {
        let r = &row.0;
        let linear = Vec3::new(r[0], r[1], r[2]) * self.linear;
        let angular = self.axes * (Vec3::new(r[3], r[4], r[5]) * self.angular);
        (linear, angular)
    }
}

impl Bodies {
    /// The rows of all members; velocities are filled in by the stage that integrates them.
    pub(crate) fn gather(members: &[Member], environment: &Environment) -> Bodies {
        let n = members.len();
        let h = environment.settings.frame_seconds / environment.settings.substeps as f32;
        let mut bodies = Bodies {
            centres: Vec::with_capacity(n + 2),
            axes: Vec::with_capacity(n + 2),
            velocities: vec![Row::default(); n + 2],
            displacements: vec![Row::default(); n + 2],
            kicks: Vec::with_capacity(n + 2),
            free: vec![Row::default(); n + 2],
            pushes: vec![Row::default(); n + 2],
            surfaces: Vec::with_capacity(n + 2),
        };
        for member in members {
            let scale = Scale::of(member);
            let (p, s, i, m) = (member.state.position, scale.linear, scale.angular, scale.axes);
            let answers = if member.body.is_dynamic() { 1.0 } else { 0.0 };
            bodies.centres.push(Row([p.x, p.y, p.z, s, i.x, i.y, i.z, answers]));
            let (a, b) = (m.x_axis, m.y_axis);
            bodies.axes.push(Row([a.x, a.y, a.z, b.x, b.y, b.z, 0.0, 0.0]));
            bodies.kicks.push(Row(acceleration(member, scale, environment).0.map(|x| x * h)));
            let (b, m) = (member.body, member.body.material);
            bodies.surfaces.push(Row([
                m.static_friction,
                m.friction,
                m.restitution,
                b.half_thickness,
                b.inverse_mass,
                0.0,
                0.0,
                0.0,
            ]));
        }
        for _ in 0..2 {
            bodies.centres.push(Row::default());
            bodies.axes.push(Row([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]));
            bodies.kicks.push(Row::default());
            bodies.surfaces.push(Row::default());
        }
        bodies
    }
}

fn acceleration(member: &Member, scale: Scale, environment: &Environment) -> Row {
    let body = member.body;
    if !body.is_dynamic() {
        return Row::default();
    }
    let linear = body.acceleration(environment);
    // sqrt(I) Rᵀ I⁻¹ τ = I^(-1/2) Rᵀ τ
    let v = linear / scale.linear;
    let w = (scale.axes.transpose() * body.torque) * scale.angular;
    Row([v.x, v.y, v.z, w.x, w.y, w.z, 0.0, 0.0])
}
