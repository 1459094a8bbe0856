//! Swept bounds: where a body may be during the next frame.
//!
//! Promise: a bound depends on the body, its state and the environment alone, never on what the solver then does, so that
//! "nobody else comes near" can be checked before anything is solved.

use forerun_geometry::{Aabb, Motion, Pose, Vec3};

use crate::halfway::Halfway;
use crate::solver::{pull, times_inverse_inertia};
use crate::{Body, BodyKind, BodyState, Environment};

/// How much further than its velocity says a body is expected to move.
pub(crate) const MOTION_FACTOR: f32 = forerun_geometry::contact::MOTION_AHEAD;

/// Nobody looks farther ahead than this along an axis (metres), or so many radii of the body: else a velocity beyond all measure, given to all bodies of a
/// large scene, makes everybody a neighbour of everybody, and memory runs out. 20 m in a frame are 1200 m/s.
const REACH_MAX_M: f32 = 20.0;
const REACH_MAX_RADII: f32 = 16.0;

/// How a body is expected to go through the frame if nothing is in the way: all that collision detection asks of its state.
#[derive(Clone, Copy, Debug)]
pub struct Prospect {
    /// Where its shape is looked at: halfway, if it moves.
    pub pose: Pose,
    /// How it is to get there from the start of the frame.
    pub halfway: Halfway,
    /// The motion that springs, forces, torques and its velocity give it.
    pub motion: Motion,
    /// How far its surface may move by rotation. Metres.
    pub sway_m: f32,
    /// Swept bound: the box that holds the body during the whole frame, contact margin included. What goes farther than 20 m, or 16 of its
    /// radii, in a frame may leave it, and pass through what lies beyond.
    pub bound: Aabb,
}

impl Prospect {
    /// Of a body in a state.
    #[must_use]
    pub fn new(body: &Body, state: &BodyState, environment: &Environment) -> Prospect {
        // Most shapes are about their centres of mass.
        let pose = if body.frame == Pose::IDENTITY { state.pose() } else { body.own_pose(state) };
        let now = body.shape.aabb(&pose);
        let margin = 0.5 * environment.settings.contact_margin_m;
        if body.kind == BodyKind::Fixed {
            let motion = Motion { linear: Vec3::ZERO, angular: Vec3::ZERO, about: state.position };
            let (min, max) = (now.min - Vec3::splat(margin), now.max + Vec3::splat(margin));
            return Prospect { pose, halfway: Halfway::NONE, motion, sway_m: 0.0, bound: Aabb { min, max } };
        }
        let motion = motion(body, state, environment);
        let turn = motion.angular.length();
        // No more than a full turn's worth: every point stays within the radius of the centre of mass.
        let spin = |turn: f32| if turn > 0.0 { body.radius * turn.min(2.0) } else { 0.0 };
        let reach = margin + if body.radius.is_finite() { spin(turn * MOTION_FACTOR) } else { 0.0 };
        let limit = Vec3::splat(REACH_MAX_M.max(REACH_MAX_RADII * body.radius));
        let step = (motion.linear * MOTION_FACTOR).clamp(-limit, limit);
        let bound = Aabb {
            min: now.min + step.min(Vec3::ZERO) - Vec3::splat(reach),
            max: now.max + step.max(Vec3::ZERO) + Vec3::splat(reach),
        };
        let halfway = Halfway::of(body, state, environment);
        let pose = if halfway.is_none() { pose } else { body.own_pose(&halfway.state(state)) };
        Prospect { pose, halfway, motion, sway_m: spin(turn), bound }
    }
}

/// The box that holds the body during the whole frame; see [`Prospect::bound`].
#[must_use]
pub fn swept_bound(body: &Body, state: &BodyState, environment: &Environment) -> Aabb {
    Prospect::new(body, state, environment).bound
}

/// Displacement and rotation in the frame, if nothing is in the way, of a body that is not fixed.
fn motion(body: &Body, state: &BodyState, environment: &Environment) -> Motion {
    let dt = environment.settings.frame_seconds;
    let (mut velocity, mut spin) = (state.velocity, state.angular_velocity);
    if body.kind == BodyKind::Dynamic {
        (velocity, spin) = pull(body, state, dt);
        velocity += body.acceleration(environment) * dt;
        if body.torque != Vec3::ZERO {
            let axes = state.pose().axes();
            spin += times_inverse_inertia(&axes, body.inverse_inertia, body.torque * dt);
        }
    }
    Motion { linear: velocity * dt, angular: spin * dt, about: state.position }
}

/// Contacts of a pair are found this far ahead. Metres.
#[must_use]
pub fn pair_margin(first: &Prospect, second: &Prospect, environment: &Environment) -> f32 {
    // Two bodies that fall together meet when the first of them is stopped: the faster one counts, not only the difference.
    let (a, b) = (first.motion.linear, second.motion.linear);
    let approach = (a - b).length().max(a.length()).max(b.length());
    environment.settings.contact_margin_m.max(MOTION_FACTOR * (approach + first.sway_m + second.sway_m))
}
