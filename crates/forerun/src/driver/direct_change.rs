//! Direct change: a user's change on a world without a timeline, as the traditional model applies it between two steps.

use std::fmt;

use forerun_dynamics::World;
use forerun_timeline::{Change, CommandError};

use super::coupled::Cast;
use crate::BodyId;

/// Why a world cannot be changed so.
#[derive(Clone, Debug, PartialEq)]
pub enum ChangeError {
    /// There is no such body.
    UnknownBody(BodyId),
    /// A number of the change, or the body to be added, is not possible.
    Refused(CommandError),
    /// A plain world does not change the kind of a body.
    NeedsTimeline(&'static str),
}

impl fmt::Display for ChangeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ChangeError::UnknownBody(body) => write!(f, "there is no body {}", body.0),
            ChangeError::Refused(error) => write!(f, "{error}"),
            ChangeError::NeedsTimeline(what) => {
                write!(f, "the coupled driver cannot {what}: use the decoupled one")
            }
        }
    }
}

impl std::error::Error for ChangeError {}

/// Does the change at once. A body to be added has to take the next free name.
pub(super) fn apply(world: &mut World, cast: &mut Cast, change: &Change) -> Result<(), ChangeError> {
    let place_of = |body: BodyId| cast.place(body).ok_or(ChangeError::UnknownBody(body));
    match change {
        Change::Add { body, def } => {
            if *body != cast.coming_body() {
                return Err(ChangeError::UnknownBody(*body));
            }
            world.add(def).map_err(CommandError::Body).map_err(ChangeError::Refused)?;
            cast.add(def);
        }
        Change::Remove { body } => {
            let place = place_of(*body)?;
            world.remove(BodyId(place as u32));
            cast.remove(place);
        }
        Change::SetKind { .. } => return Err(ChangeError::NeedsTimeline("change the kind of a body")),
        Change::SetGravity { gravity } => {
            change.check_numbers().map_err(ChangeError::Refused)?;
            world.environment.gravity = *gravity;
            cast.forget_still();
        }
        Change::Move { body, .. }
        | Change::Push { body, .. }
        | Change::SetVelocity { body, .. }
        | Change::Hold { body, .. }
        | Change::Release { body }
        | Change::SetMaterial { body, .. }
        | Change::SetForce { body, .. }
        | Change::SetGravityScale { body, .. }
        | Change::SetMass { body, .. } => {
            change_body(world, (*body, place_of(*body)?), change)?;
            cast.forget_still();
        }
    }
    // Who rests on the changed body, or is now in its way, is not found out here: all wake, and those who may rest again soon.
    world.states_mut().iter_mut().for_each(|state| state.rest = 0);
    Ok(())
}

fn change_body(world: &mut World, (id, place): (BodyId, usize), change: &Change) -> Result<(), ChangeError> {
    let Some((body, state)) = world.bodies().get(place).zip(world.states().get(place)) else {
        return Err(ChangeError::UnknownBody(id));
    };
    let (body, state) = change.applied_to(body, state).map_err(ChangeError::Refused)?;
    world.bodies_mut()[place] = body;
    world.states_mut()[place] = state;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::Unobserved;
    use crate::{BodyDef, Cuboid, Environment, Pose, Shape, Vec3};

    fn apply(world: &mut World, change: &Change) -> Result<(), ChangeError> {
        let mut cast = Cast::of(world);
        super::apply(world, &mut cast, change)
    }

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
    fn what_rested_on_a_body_falls_when_that_is_moved_away() {
        let mut world = World::default();
        world.environment.settings.rest_seconds = 0.1;
        let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
        world.add(&BodyDef::fixed(Shape::HalfSpace)).expect("the ground");
        for y in [0.5, 1.5] {
            world.add(&BodyDef::new(cube.clone()).at(Vec3::Y * y)).expect("a plain cube");
        }
        let steps = |world: &mut World, count: u32| {
            for _ in 0..count {
                world.step(&mut Unobserved);
            }
        };
        steps(&mut world, 120);
        assert!(world.states()[2].rest > world.environment.settings.rest_frames(), "{:?}", world.states());
        let pose = Pose { position: Vec3::new(9.0, 0.5, 0.0), ..Pose::IDENTITY };
        assert_eq!(apply(&mut world, &Change::Move { body: BodyId(1), pose }), Ok(()));
        steps(&mut world, 20);
        assert!(world.states()[2].position.y < 1.3, "{:?}", world.states()[2]);
    }

    #[test]
    fn what_a_world_cannot_do_is_refused_and_changes_nothing() {
        let mut world = world();
        let before = world.states().to_vec();
        for change in [
            Change::Remove { body: BodyId(7) },
            Change::SetKind { body: BodyId(0), kind: crate::BodyKind::Fixed },
            Change::Release { body: BodyId(7) },
            Change::SetGravity { gravity: Vec3::NAN },
            Change::Push { body: BodyId(0), impulse: Vec3::X * f32::INFINITY, at_point: None },
            Change::Push { body: BodyId(0), impulse: Vec3::Y * 3e38, at_point: Some(Vec3::X * 1e9) },
        ] {
            assert!(apply(&mut world, &change).is_err());
        }
        assert_eq!(world.states(), before);
        assert_eq!(world.environment, Environment::default());
    }
}
