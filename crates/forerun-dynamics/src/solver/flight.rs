//! Flight: bodies that touch nothing in this frame. No solver, no substeps: the parabola exactly.

use forerun_geometry::Vec3;

use super::rotation::{angular_momentum, is_isotropic, spun, times_inverse_inertia, turned};
use super::spring::pull;
use crate::{Body, BodyKind, BodyState, Environment};

/// The state of a body without contacts, `seconds` later.
#[must_use]
pub(crate) fn fly(body: &Body, state: &BodyState, environment: &Environment, seconds: f32) -> BodyState {
    let mut next = *state;
    match body.kind {
        BodyKind::Fixed => return *state,
        BodyKind::Kinematic => {
            next.position += state.velocity * seconds;
            next.rotation = turned(state.rotation, state.angular_velocity * seconds);
        }
        BodyKind::Dynamic => {
            if stays(body, state, environment) {
                return BodyState { rest: 0, ..*state };
            }
            let (velocity, angular_velocity) = pull(body, state, seconds);
            let acceleration = body.acceleration(environment);
            next.velocity = velocity + acceleration * seconds;
            next.position += (velocity + next.velocity) * (0.5 * seconds);
            let half = twisted(body, state, angular_velocity, 0.5 * seconds);
            let (rotation, spin) = spun(state.rotation, half, body.inverse_inertia, seconds);
            next.rotation = rotation;
            next.angular_velocity = twisted(body, &next, spin, 0.5 * seconds);
        }
    }
    BodyState { rest: 0, ..next }.canonical()
}

/// Whether nothing moves the body: it keeps its bits.
fn stays(body: &Body, state: &BodyState, environment: &Environment) -> bool {
    let still = state.velocity == Vec3::ZERO && state.angular_velocity == Vec3::ZERO;
    let acceleration = body.acceleration(environment);
    still && acceleration == Vec3::ZERO && body.torque == Vec3::ZERO && body.spring.is_none()
}

/// The angular velocity after the external torque has acted for `seconds`.
fn twisted(body: &Body, state: &BodyState, angular_velocity: Vec3, seconds: f32) -> Vec3 {
    if body.torque == Vec3::ZERO {
        return angular_velocity;
    }
    let axes = state.pose().axes();
    angular_velocity + times_inverse_inertia(&axes, body.inverse_inertia, body.torque * seconds)
}

/// The angular velocity that a spinning body has half a step on, its angular momentum kept: what its contacts should see.
#[must_use]
pub(crate) fn spin_halfway(body: &Body, state: &BodyState, angular_velocity: Vec3, seconds: f32) -> Vec3 {
    if is_isotropic(body.inverse_inertia) || angular_velocity == Vec3::ZERO {
        return angular_velocity;
    }
    let momentum = angular_momentum(&state.pose().axes(), body.inverse_inertia, angular_velocity);
    let middle = turned(state.rotation, angular_velocity * (0.5 * seconds));
    times_inverse_inertia(&forerun_geometry::Mat3::from_quat(middle), body.inverse_inertia, momentum)
}
