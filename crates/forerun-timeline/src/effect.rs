//! Effect: what a command does to one body, as pure functions of the command, the body and its state.

use std::sync::Arc;

use forerun_dynamics::{Body, BodyDef, BodyKind, BodyState, Material, Spring};
use forerun_geometry::Vec3;

use crate::command::{Change, CommandError};

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
    match change {
        Change::Remove { .. } => Ok(None),
        Change::SetKind { kind, .. } => {
            let def = BodyDef { kind: *kind, ..def.ok_or(Ignored)?.clone() };
            let (made, _) = Body::new(&def).map_err(|_| Ignored)?;
            Ok(Some(Arc::new(Body {
                kind: made.kind,
                inverse_mass: made.inverse_mass,
                inverse_inertia: made.inverse_inertia,
                ..Body::clone(body)
            })))
        }
        Change::SetMass { mass, .. } => {
            let def = BodyDef { kind: BodyKind::Dynamic, ..def.ok_or(Ignored)?.clone() };
            let (made, _) = Body::new(&def).map_err(|_| Ignored)?;
            weighed(body, &made, 1.0 / mass).map(Arc::new).map(Some)
        }
        // The same memory, so that a look at the pointer tells that nothing changed.
        Change::Move { .. }
        | Change::Push { .. }
        | Change::SetVelocity { .. }
        | Change::SetGravity { .. } => Ok(Some(Arc::clone(body))),
        _ => Ok(Some(Arc::new(with_properties(body, change)))),
    }
}

/// The body with another inverse mass (1/kg), spread as it is in one that was made of the same definition. Always reckoned from that one: the result does not
/// depend on what the mass was before.
pub(crate) fn weighed(body: &Body, made: &Body, inverse_mass: f32) -> Result<Body, Ignored> {
    let inverse_inertia = made.inverse_inertia * (inverse_mass / made.inverse_mass);
    let possible = inverse_inertia.is_finite() && inverse_inertia.min_element() > 0.0;
    if body.kind != BodyKind::Dynamic || !possible {
        return Err(Ignored);
    }
    Ok(Body { inverse_mass, inverse_inertia, ..body.clone() })
}

/// The body with what a change sets: spring, material, force, factor on gravity.
fn with_properties(body: &Body, change: &Change) -> Body {
    let mut next = body.clone();
    match change {
        // Adding +0 makes -0 positive: numbers that are equal have equal bits, so that equal bodies can stand for each other.
        Change::Hold { spring, .. } => {
            let Spring { anchor, target, frequency_hz, damping_ratio } = *spring;
            next.spring = Some(Spring {
                anchor: anchor + Vec3::ZERO,
                target: target + Vec3::ZERO,
                frequency_hz,
                damping_ratio: damping_ratio + 0.0,
            });
        }
        Change::Release { .. } => next.spring = None,
        Change::SetMaterial { material, .. } => {
            let Material { friction, static_friction, restitution } = *material;
            next.material = Material {
                friction: friction + 0.0,
                static_friction: static_friction + 0.0,
                restitution: restitution + 0.0,
            };
        }
        Change::SetForce { force, torque, .. } => {
            (next.force, next.torque) = (*force + Vec3::ZERO, *torque + Vec3::ZERO);
        }
        Change::SetGravityScale { scale, .. } => next.gravity_scale = *scale + 0.0,
        Change::Add { .. }
        | Change::Remove { .. }
        | Change::Move { .. }
        | Change::Push { .. }
        | Change::SetVelocity { .. }
        | Change::SetMass { .. }
        | Change::SetKind { .. }
        | Change::SetGravity { .. } => {}
    }
    next
}

impl Change {
    /// A body and its state after the change, for who keeps no timeline. Nothing is different after `Add`, `Remove`, `SetKind` and
    /// `SetGravity`: they are not about the properties of one body that is there.
    ///
    /// # Errors
    /// When a number of the change is out of its range, one of the new state would not be finite, or a body that is not dynamic is to get a mass.
    pub fn applied_to(&self, body: &Body, state: &BodyState) -> Result<(Body, BodyState), CommandError> {
        self.check_numbers()?;
        if matches!(
            self,
            Change::Add { .. } | Change::Remove { .. } | Change::SetKind { .. } | Change::SetGravity { .. }
        ) {
            return Ok((body.clone(), *state));
        }
        let body = match self {
            Change::SetMass { mass, .. } => {
                weighed(body, body, 1.0 / mass).map_err(|Ignored| CommandError::Number {
                    field: "mass",
                    message: "is not for a body that is fixed or kinematic: make it dynamic first".to_owned(),
                })?
            }
            _ => with_properties(body, self),
        };
        let state = state_after(&body, state, self).map_err(|Ignored| CommandError::Number {
            field: "change",
            message: "is so large that the state would not be finite".to_owned(),
        })?;
        Ok((body, state))
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use forerun_dynamics::BodyId;
    use forerun_geometry::shape::{Cuboid, Shape};

    fn rod() -> (Arc<Body>, BodyState) {
        let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::new(1.0, 0.1, 0.1) });
        let (body, state) = Body::new(&BodyDef::new(shape).at(Vec3::new(3.0, 0.0, 0.0))).unwrap();
        (Arc::new(body), state)
    }

    #[test]
    fn an_off_centre_push_turns_a_rod_as_the_formula_says() {
        let (body, state) = rod();
        let impulse = Vec3::new(0.0, 5.0, 0.0);
        let change = Change::Push { body: BodyId(0), impulse, at_point: Some(Vec3::new(4.0, 0.0, 0.0)) };
        let next = state_after(&body, &state, &change).unwrap();
        // v = J/m, w = L J / I about z with I = m (1^2 + 0.1^2) / 3.
        let mass = 1000.0 * 8.0 * 0.01;
        assert!((next.velocity.y - 5.0 / mass).abs() < 1e-6);
        let expected = 5.0 / (mass * 1.01 / 3.0);
        assert!((next.angular_velocity.z - expected).abs() < 1e-5, "{}", next.angular_velocity);
        assert!(next.angular_velocity.x.abs() + next.angular_velocity.y.abs() < 1e-6);
    }

    #[test]
    fn another_mass_is_spread_as_the_one_before() {
        let (body, _) = rod();
        let def = BodyDef::new(body.shape.clone());
        let set = |body: &Arc<Body>, mass: f32| {
            body_after(Some(body), &Change::SetMass { body: BodyId(0), mass }, Some(&def))
        };
        let heavy = set(&body, 300.0).unwrap().unwrap();
        // I about z = m (1^2 + 0.1^2) / 3, about x = m (0.1^2 + 0.1^2) / 3.
        assert!((heavy.inverse_mass * 300.0 - 1.0).abs() < 1e-6);
        let inertia = Vec3::new(2.0, 101.0, 101.0);
        assert!((heavy.inverse_inertia * inertia - Vec3::ONE).length() < 1e-4, "{}", heavy.inverse_inertia);
        // However it came there, and back to the bits of the beginning.
        let light = set(&heavy, 7.0).unwrap().unwrap();
        assert_eq!(set(&light, 300.0).unwrap().unwrap(), heavy);
        assert_eq!(weighed(&light, &body, body.inverse_mass).as_ref(), Ok(&*body));
        // What does not move freely has none.
        let fixed = Arc::new(Body { kind: BodyKind::Fixed, ..Body::clone(&body) });
        assert_eq!(set(&fixed, 5.0), Err(Ignored));
        let (state, change) = (rod().1, Change::SetMass { body: BodyId(0), mass: 5.0 });
        let refused = change.applied_to(&fixed, &state).unwrap_err().to_string();
        assert!(refused.contains("make it dynamic first"), "{refused}");
        assert!((change.applied_to(&body, &state).unwrap().0.inverse_mass - 0.2).abs() < 1e-9);
    }

    #[test]
    fn what_is_not_there_ignores_commands() {
        let (body, state) = rod();
        let id = BodyId(0);
        assert_eq!(body_after(None, &Change::Release { body: id }, None), Err(Ignored));
        assert_eq!(body_after(Some(&body), &Change::Remove { body: id }, None), Ok(None));
        let add = Change::Add { body: id, def: Box::new(BodyDef::new(body.shape.clone())) };
        assert_eq!(body_after(Some(&body), &add, None), Err(Ignored));
        let push = Change::Push { body: id, impulse: Vec3::splat(3e38), at_point: Some(Vec3::splat(1e9)) };
        assert_eq!(state_after(&body, &state, &push), Err(Ignored));
    }
}
