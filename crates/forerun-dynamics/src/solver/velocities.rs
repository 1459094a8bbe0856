//! Velocities: springs and the gyroscopic term, once a frame; gravity, forces and torques follow in every substep.

use forerun_geometry::Vec3;

use super::bodies::{Bodies, Scale};
use super::flight::spin_halfway;
use super::spring::pull;
use crate::{BodyKind, Member};

/// Writes the mass-scaled velocities that the contacts start from. Returns the angular velocities in the world, for the positions.
pub(crate) fn integrate_velocities(members: &[Member], bodies: &mut Bodies, seconds: f32) -> Vec<Vec3> {
    (members.iter().enumerate())
        .map(|(i, member)| {
            let state = &member.state;
            let (velocity, angular_velocity) = match member.body.kind {
                BodyKind::Fixed => return Vec3::ZERO,
                BodyKind::Kinematic => (state.velocity, state.angular_velocity),
                BodyKind::Dynamic => {
                    let (velocity, spin) = pull(member.body, state, seconds);
                    (velocity, spin_halfway(member.body, state, spin, seconds))
                }
            };
            bodies.velocities[i] = Scale::of(member).to_row(velocity, angular_velocity);
            angular_velocity
        })
        .collect()
}
