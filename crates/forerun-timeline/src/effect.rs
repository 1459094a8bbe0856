//! Effect: what a command does to one body, as pure functions of the command, the body and its state.

use std::sync::Arc;

use forerun_dynamics::{Body, BodyDef, BodyKind, BodyState};
use forerun_geometry::Vec3;

use crate::command::Change;

/// The command did nothing: the body is not there, or it cannot become what is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Ignored;

/// The body after a change; `def` is how it was made. `None` where it does not exist.
pub(crate) fn body_after(
    body: Option<&Arc<Body>>,
    change: &Change,
    def: Option<&BodyDef>,
) -> Result<Option<Arc<Body>>, Ignored> {
    if let Change::Add { def, .. } = change {
        let made = if body.is_none() { Body::new(def).ok() } else { None };
        return made.map(|(body, _)| Some(Arc::new(body))).ok_or(Ignored);
    }
    let body = body.ok_or(Ignored)?;
    let mut next = Body::clone(body);
    match change {
        Change::Remove { .. } => return Ok(None),
        Change::Hold { spring, .. } => next.spring = Some(*spring),
        Change::Release { .. } => next.spring = None,
        Change::SetMaterial { material, .. } => next.material = *material,
        Change::SetForce { force, torque, .. } => (next.force, next.torque) = (*force, *torque),
        Change::SetGravityScale { scale, .. } => next.gravity_scale = *scale,
        Change::SetKind { kind, .. } => {
            let def = BodyDef { kind: *kind, ..def.ok_or(Ignored)?.clone() };
            let (made, _) = Body::new(&def).map_err(|_| Ignored)?;
            next.kind = made.kind;
            next.inverse_mass = made.inverse_mass;
            next.inverse_inertia = made.inverse_inertia;
        }
        Change::Add { .. }
        | Change::Move { .. }
        | Change::Push { .. }
        | Change::SetVelocity { .. }
        | Change::SetGravity { .. } => return Ok(Some(Arc::clone(body))),
    }
    Ok(Some(Arc::new(next)))
}

/// The state of a body after a change; `body` is what [`body_after`] gave.
pub(crate) fn state_after(body: &Body, state: &BodyState, change: &Change) -> Result<BodyState, Ignored> {
    let mut next = *state;
    match change {
        Change::Move { pose, .. } => next = body.state_at(pose, state.velocity, state.angular_velocity),
        Change::Push { impulse, at_point, .. } => {
            next.velocity += *impulse * body.inverse_mass;
            if let Some(point) = at_point {
                let moment = (*point - state.position).cross(*impulse);
                let local = state.rotation.conjugate() * moment;
                next.angular_velocity += state.rotation * (local * body.inverse_inertia);
            }
        }
        Change::SetVelocity { velocity, angular_velocity, .. } if body.kind != BodyKind::Fixed => {
            next.velocity = *velocity;
            next.angular_velocity = *angular_velocity;
        }
        Change::SetKind { kind: BodyKind::Fixed, .. } => {
            next.velocity = Vec3::ZERO;
            next.angular_velocity = Vec3::ZERO;
        }
        _ => {}
    }
    next.rest = 0;
    let next = next.canonical();
    // Finite numbers can still make an impulse that is not.
    if next.is_finite() { Ok(next) } else { Err(Ignored) }
}
