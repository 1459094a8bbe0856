//! Swept bounds: where a body may be during the next frame.
//!
//! Promise: a bound depends on the body, its state and the environment alone, never on what the solver then does, so that
//! "nobody else comes near" can be checked before anything is solved.

use forerun_geometry::{Aabb, Motion, Vec3};

use crate::solver::{pull, times_inverse_inertia};
use crate::{Body, BodyKind, BodyState, Environment};

/// How much further than its velocity says a body is expected to move.
const MOTION_FACTOR: f32 = 1.2;

/// Nobody looks farther ahead than this along an axis (metres), or so many radii of the body: else a velocity beyond all measure, given to all bodies of a
/// large scene, makes everybody a neighbour of everybody, and memory runs out. 20 m in a frame are 1200 m/s.
const REACH_MAX_M: f32 = 20.0;
const REACH_MAX_RADII: f32 = 16.0;

/// The box that holds the body during the whole frame, contact margin included. What goes farther than 20 m, or 16 of its radii, in a frame may leave it, and
/// pass through what lies beyond.
#[must_use]
pub fn swept_bound(body: &Body, state: &BodyState, environment: &Environment) -> Aabb {
    let now = body.shape.aabb(&body.own_pose(state));
    let reach = 0.5 * environment.settings.contact_margin_m + spin_reach(body, state, environment);
    let limit = Vec3::splat(REACH_MAX_M.max(REACH_MAX_RADII * body.radius));
    let step = (frame_motion(body, state, environment) * MOTION_FACTOR).clamp(-limit, limit);
    Aabb {
        min: now.min + step.min(Vec3::ZERO) - Vec3::splat(reach),
        max: now.max + step.max(Vec3::ZERO) + Vec3::splat(reach),
    }
}

/// Displacement of the centre of mass in the frame, if nothing is in the way. Metres.
#[must_use]
pub fn frame_motion(body: &Body, state: &BodyState, environment: &Environment) -> Vec3 {
    let dt = environment.settings.frame_seconds;
    match body.kind {
        BodyKind::Fixed => Vec3::ZERO,
        BodyKind::Kinematic => state.velocity * dt,
        BodyKind::Dynamic => {
            let (velocity, _) = pull(body, state, dt);
            (velocity + body.acceleration(environment) * dt) * dt
        }
    }
}

/// How far the surface may move by rotation in the frame. Metres.
fn spin_reach(body: &Body, state: &BodyState, environment: &Environment) -> f32 {
    if body.kind == BodyKind::Fixed || !body.radius.is_finite() {
        return 0.0;
    }
    // No more than a full turn's worth: every point stays within the radius of the centre of mass.
    let turn = frame_turn(body, state, environment).length() * MOTION_FACTOR;
    body.radius * turn.min(2.0)
}

/// Rotation vector in the frame, if nothing is in the way: springs and torques included. Radians.
fn frame_turn(body: &Body, state: &BodyState, environment: &Environment) -> Vec3 {
    let dt = environment.settings.frame_seconds;
    match body.kind {
        BodyKind::Fixed => Vec3::ZERO,
        BodyKind::Kinematic => state.angular_velocity * dt,
        BodyKind::Dynamic => {
            let (_, mut spin) = pull(body, state, dt);
            if body.torque != Vec3::ZERO {
                let axes = state.pose().axes();
                spin += times_inverse_inertia(&axes, body.inverse_inertia, body.torque * dt);
            }
            spin * dt
        }
    }
}

/// The expected motion as the narrow phase wants it.
#[must_use]
pub fn motion(body: &Body, state: &BodyState, environment: &Environment) -> Motion {
    let angular = frame_turn(body, state, environment);
    Motion { linear: frame_motion(body, state, environment), angular, about: state.position }
}

/// Contacts of a pair are found this far ahead. Metres.
#[must_use]
pub fn pair_margin(first: &(Motion, f32), second: &(Motion, f32), environment: &Environment) -> f32 {
    // Two bodies that fall together meet when the first of them is stopped: the faster one counts, not only the difference.
    let (a, b) = (first.0.linear, second.0.linear);
    let approach = (a - b).length().max(a.length()).max(b.length());
    let spin = |(motion, radius): &(Motion, f32)| {
        let turn = motion.angular.length().min(2.0);
        if turn > 0.0 { turn * radius } else { 0.0 }
    };
    environment.settings.contact_margin_m.max(MOTION_FACTOR * (approach + spin(first) + spin(second)))
}
