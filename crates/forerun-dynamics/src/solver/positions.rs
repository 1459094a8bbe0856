//! Positions: new poses from the displacements, angular momentum carried over, and rest.

use forerun_geometry::{Mat3, Vec3};

use super::bodies::{Bodies, Scale};
use super::flight::fly;
use super::islands::Islands;
use super::rotation::{angular_momentum, is_isotropic, times_inverse_inertia, turned};
use super::spring::pull;
use crate::{BodyState, Environment, Member};

/// Who hardly overlaps comes to rest so many times sooner: the others are still being pushed out.
const SHALLOW_REST: u32 = 4;

/// A body that overlaps deeper than this part of its half thickness does not come to rest, however little that is.
const REST_PART: f32 = 0.1;
/// A body that is farther than this from all others has nothing to rest on. Metres.
pub(crate) const REST_TOUCH_M: f32 = 0.001;

/// What the end of a frame needs to know about one body besides its rows.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ending {
    /// The angular velocity with which the contacts started. rad/s
    pub(crate) spin: Vec3,
    /// Deepest overlap with anybody at the start of the frame. Metres.
    pub(crate) overlap: f32,
    /// Whether it touches anybody, and is not only about to.
    pub(crate) touches: bool,
}

/// The islands of a batch, and which of them a moving kinematic body touches (by root).
pub(crate) struct IslandsAt<'a> {
    pub(crate) islands: &'a Islands,
    pub(crate) driven: &'a [bool],
}

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

/// Rest is part of the state. A body that was quiet for `rest_frames` frames keeps its pose and no velocity, and is still solved: when its support
/// goes, it moves. One more than `rest_frames` says that the whole island was so for a frame: a fixpoint that need not be solved.
pub(crate) fn settle(
    members: &[Member],
    next: &mut [BodyState],
    endings: &[Ending],
    at: &IslandsAt,
    environment: &Environment,
) {
    let settings = &environment.settings;
    if settings.rest_frames() == 0 {
        next.iter_mut().for_each(|state| state.rest = 0);
        return;
    }
    let full = settings.rest_frames();
    let islands = at.islands;
    let mut fixpoint = vec![true; members.len()];
    for (i, member) in members.iter().enumerate() {
        if !member.body.is_dynamic() {
            continue;
        }
        // What a moving body carries or pushes goes with it, however slowly.
        let held = endings[i].touches && !at.driven[islands.root(i)];
        let calm = held && quiet(member, &next[i], environment);
        let before = member.state.rest.min(full);
        let overlap = endings[i].overlap;
        let shallow = overlap < 2.0 * settings.overlap_allowed_m;
        let counted = (before + 1).min(full);
        next[i].rest = if !calm {
            0
        } else if overlap > settings.rest_overlap_m.min(REST_PART * member.body.half_thickness) {
            // Pushed on, even out of rest: a body between two frozen ones could not get out.
            counted.min(full - 1)
        } else if shallow && counted >= full.div_ceil(SHALLOW_REST) {
            full
        } else {
            counted
        };
        if next[i].rest < full || before < full {
            fixpoint[islands.root(i)] = false;
        }
    }
    for (i, member) in members.iter().enumerate() {
        if member.body.is_dynamic() && next[i].rest == full {
            let rest = if fixpoint[islands.root(i)] { full + 1 } else { full };
            let pose = member.state;
            next[i] = BodyState { velocity: Vec3::ZERO, angular_velocity: Vec3::ZERO, rest, ..pose };
        }
    }
}

/// The rest counter after a frame that was done in slices: quiet or not over the whole of it, and never at rest.
pub(crate) fn rest_after_slices(member: &Member, next: &BodyState, environment: &Environment) -> u32 {
    let full = environment.settings.rest_frames();
    let calm = full > 0 && member.body.is_dynamic() && quiet(member, next, environment);
    if calm { (member.state.rest + 1).min(full - 1) } else { 0 }
}

/// Whether neither velocity nor change of pose shows.
fn quiet(member: &Member, next: &BodyState, environment: &Environment) -> bool {
    let settings = &environment.settings;
    let r2 = member.body.radius * member.body.radius;
    let per_second = 1.0 / settings.frame_seconds;
    let shift = (next.position - member.state.position) * per_second;
    // |q' - q| is half the angle of the turn; the sign of a quaternion has no meaning.
    let (a, b) = (next.rotation, member.state.rotation);
    let difference = if a.dot(b) < 0.0 { a + b } else { a - b };
    let turn2 = 4.0 * difference.length_squared() * per_second * per_second;
    let limit2 = settings.rest_speed * settings.rest_speed;
    next.velocity.length_squared() < limit2
        && next.angular_velocity.length_squared() * r2 < limit2
        && shift.length_squared() < limit2
        && turn2 * r2 < limit2
}
