//! Positions: new poses from the displacements, angular momentum carried over.

use forerun_geometry::{Mat3, Vec3};

use super::bodies::{Bodies, Scale};
use super::flight::fly;
use super::rest::Ending;
use super::rotation::{angular_momentum, is_isotropic, times_inverse_inertia, turned};
use super::spring::pull;
use crate::{BodyState, Environment, Member};

/// The state that a body has moved to, whether it was at rest or not.
pub(crate) fn moved(
    member: &Member,
    bodies: &Bodies,
    i: usize,
    ending: &Ending,
    environment: &Environment,
) -> BodyState {
    if !member.body.is_dynamic() {
        return fly(member.body, &member.state, environment, environment.settings.frame_seconds);
    }
    let scale = Scale::of(member);
    let (velocity, spin) = scale.world_of(&bodies.velocities[i]);
    let (shift, rotation) = scale.world_of(&bodies.displacements[i]);
    let turned_to = turned(member.state.rotation, rotation);
    let seconds = environment.settings.frame_seconds;
    let spins = (ending.spin, spin);
    let angular_velocity = carried(member, &scale.axes, spins, Mat3::from_quat(turned_to), seconds);
    BodyState {
        position: member.state.position + shift,
        rotation: turned_to,
        velocity,
        angular_velocity,
        rest: member.state.rest,
    }
    .canonical()
}

/// The angular velocity at the end of the frame: the momentum of the start, spring included, plus what contacts and torques added, in the new
/// orientation.
fn carried(member: &Member, axes: &Mat3, (start, end): (Vec3, Vec3), turned: Mat3, seconds: f32) -> Vec3 {
    let inverse_inertia = member.body.inverse_inertia;
    if is_isotropic(inverse_inertia) {
        return end;
    }
    let (_, pulled) = pull(member.body, &member.state, seconds);
    let before = angular_momentum(axes, inverse_inertia, pulled);
    let added = angular_momentum(axes, inverse_inertia, end - start);
    times_inverse_inertia(&turned, inverse_inertia, before + added)
}
