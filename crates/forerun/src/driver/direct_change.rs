//! Direct change: a user's change on a world without a timeline, as the traditional model applies it between two steps.

use std::fmt;

use forerun_dynamics::{Body, BodyError, BodyState, World};
use forerun_timeline::Change;

use crate::{BodyId, Vec3};

/// Why a world cannot be changed so.
#[derive(Clone, Debug, PartialEq)]
pub enum ChangeError {
    /// There is no such body.
    UnknownBody(BodyId),
    /// The body to be added is not possible.
    Body(BodyError),
    /// A plain world neither removes bodies nor changes their kind.
    NeedsTimeline(&'static str),
}

impl fmt::Display for ChangeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ChangeError::UnknownBody(body) => write!(f, "there is no body {}", body.0),
            ChangeError::Body(error) => write!(f, "{error}"),
            ChangeError::NeedsTimeline(what) => {
                write!(f, "the coupled driver cannot {what}: use the decoupled one")
            }
        }
    }
}

impl std::error::Error for ChangeError {}

/// Does the change at once. A body to be added has to take the next free name.
pub(super) fn apply(world: &mut World, change: &Change) -> Result<(), ChangeError> {
    match change {
        Change::Add { body, def } => {
            if body.0 as usize != world.bodies().len() {
                return Err(ChangeError::UnknownBody(*body));
            }
            world.add(def).map(|_| ()).map_err(ChangeError::Body)
        }
        Change::Remove { .. } => Err(ChangeError::NeedsTimeline("remove a body")),
        Change::SetKind { .. } => Err(ChangeError::NeedsTimeline("change the kind of a body")),
        Change::SetGravity { gravity } => {
            world.environment.gravity = *gravity;
            world.states_mut().iter_mut().for_each(|state| state.rest = 0);
            Ok(())
        }
        Change::Move { body, .. }
        | Change::Push { body, .. }
        | Change::SetVelocity { body, .. }
        | Change::Hold { body, .. }
        | Change::Release { body }
        | Change::SetMaterial { body, .. }
        | Change::SetForce { body, .. }
        | Change::SetGravityScale { body, .. } => change_body(world, *body, change),
    }
}

fn change_body(world: &mut World, id: BodyId, change: &Change) -> Result<(), ChangeError> {
    let place = id.0 as usize;
    let Some(mut state) = world.states().get(place).copied() else {
        return Err(ChangeError::UnknownBody(id));
    };
    let body = &mut world.bodies_mut()[place];
    match change {
        Change::Move { pose, .. } => {
            state = body.state_at(pose, state.velocity, state.angular_velocity);
        }
        Change::Push { impulse, at_point, .. } => push(body, &mut state, *impulse, *at_point),
        Change::SetVelocity { velocity, angular_velocity, .. } => {
            state = body.state_at(&body.own_pose(&state), *velocity, *angular_velocity);
        }
        Change::Hold { spring, .. } => body.spring = Some(*spring),
        Change::Release { .. } => body.spring = None,
        Change::SetMaterial { material, .. } => body.material = *material,
        Change::SetForce { force, torque, .. } => (body.force, body.torque) = (*force, *torque),
        Change::SetGravityScale { scale, .. } => body.gravity_scale = *scale,
        Change::Add { .. } | Change::Remove { .. } | Change::SetKind { .. } | Change::SetGravity { .. } => {}
    }
    state.rest = 0;
    world.states_mut()[place] = state.canonical();
    Ok(())
}

/// An impulse J at a point r from the centre: v += J/m, w += I⁻¹ (r × J). Bodies that nothing moves have inverse masses of 0.
fn push(body: &Body, state: &mut BodyState, impulse: Vec3, at_point: Option<Vec3>) {
    state.velocity += impulse * body.inverse_mass;
    if let Some(point) = at_point {
        let torque = (point - state.position).cross(impulse);
        let local = state.rotation.conjugate() * torque;
        state.angular_velocity += state.rotation * (local * body.inverse_inertia);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BodyDef, Cuboid, Environment, Shape};

    fn world() -> World {
        let mut world = World::new(Environment::default());
        let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
        world.add(&BodyDef::new(cube).at(Vec3::Y)).expect("a plain cube");
        world
    }

    #[test]
    fn a_push_off_centre_moves_and_turns_as_the_formula_says() {
        let mut world = world();
        let at_point = Some(Vec3::new(0.5, 1.0, 0.0));
        let change = Change::Push { body: BodyId(0), impulse: Vec3::new(0.0, 600.0, 0.0), at_point };
        assert_eq!(apply(&mut world, &change), Ok(()));
        let state = world.states()[0];
        // m = 1000 kg, I = 1000/6 kg m²; r × J = 0.5 * 600 about z
        assert!((state.velocity - Vec3::Y * 0.6).length() < 1e-6);
        assert!((state.angular_velocity - Vec3::Z * 1.8).length() < 1e-5);
    }

    #[test]
    fn what_a_world_cannot_do_is_refused_and_changes_nothing() {
        let mut world = world();
        let before = world.states().to_vec();
        for change in [Change::Remove { body: BodyId(0) }, Change::Release { body: BodyId(7) }] {
            assert!(apply(&mut world, &change).is_err());
        }
        assert_eq!(world.states(), before);
    }
}
