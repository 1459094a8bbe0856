//! Rest: who has come to rest, and who goes on.
//!
//! Rest is part of the state. A body that was quiet for `rest_frames` frames keeps its pose and no velocity, and is still solved: when its support
//! goes, it moves. One more than `rest_frames` says that the whole island was so for a frame: a fixpoint that need not be solved.
//!
//! Quiet is a body that rattles in its place. One that goes on its way, however slowly, is not, and nor is what it takes along. What rocks in its place
//! seems to go on its way for a frame or two of each swing: that takes back a few of its quiet frames, and not all.

use forerun_geometry::{Quat, Shape, Vec3};

use super::batch::{ContactList, Ends};
use super::islands::Islands;
use crate::scratch::fill;
use crate::{BodyState, Environment, Member};

/// Who hardly overlaps comes to rest so many times sooner: the others are still being pushed out.
const SHALLOW_REST: u32 = 4;

/// A body that overlaps deeper than this part of its half thickness does not come to rest, however little that is.
const REST_PART: f32 = 0.1;
/// But one that overlaps by less than so many times what is allowed does: nobody pushes it on.
const ROOM: f32 = 1.5;
/// A body that is farther than this from all others has nothing to rest on. Metres.
const REST_TOUCH_M: f32 = 0.001;

/// What the end of a frame needs to know about one body.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ending {
    /// Deepest overlap with anybody at the start of the frame. Metres.
    pub(crate) overlap: f32,
    /// Whether it touches anybody, and is not only about to.
    pub(crate) touches: bool,
    /// Whether it overlaps too deep to come to rest, or touches one that does: there must be room to push it out.
    pub(crate) crammed: bool,
    /// Whether it overlaps too deep to come to rest.
    deep: bool,
}

/// A body that goes on its way faster than this part of `rest_speed` is not quiet.
const DRIFT_PART: f32 = 0.1;
/// The same for balls and capsules: nothing in the step brakes their rolling, and slower than this what resists it in nature stops one within seconds.
const ROLL_PART: f32 = 0.4;
/// A body may turn so much faster than `rest_speed` while it is pushed out of overlaps on all sides, and a ball that others hold.
const TURNS: f32 = 2.0;
/// What goes on its way changes its velocity by less than this part of it in a frame: uniform acceleration does after eight frames.
const UNSTEADY: f32 = 0.125;

/// So many quiet frames are taken back by one in which a body seems to go on its way: what does so in more than every third frame does not come to rest. A
/// ring that leans on another rocks by 0.1 mm, three times a second, and the middle of each swing is steady; taken back altogether it never rests.
const SETBACK: u32 = 2;

/// What the end of a frame needs to know of its contacts, and of who drives whom.
pub(crate) struct Resting<'a> {
    pub(crate) members: &'a [Member<'a>],
    pub(crate) contacts: ContactList<'a>,
    /// By contact: its smallest separation at the start. Metres.
    pub(crate) deepest: &'a [f32],
    pub(crate) islands: &'a Islands,
    /// By island: whether a moving kinematic body touches it.
    pub(crate) driven: &'a [bool],
    pub(crate) environment: &'a Environment,
}

/// Memory for [`Resting::settle`].
#[derive(Debug, Default)]
pub(crate) struct RestScratch {
    /// By body.
    drifting: Vec<bool>,
    carried: Vec<bool>,
    /// By island.
    fixpoint: Vec<bool>,
}

impl Resting<'_> {
    /// Bodies that touch at the start of the frame, by contact, with its number.
    fn touching(&self) -> impl Iterator<Item = (usize, &Ends)> {
        self.contacts.ends.iter().enumerate().filter(|(k, _)| self.deepest[*k] < REST_TOUCH_M)
    }

    /// What contacts tell of the bodies at the end of a frame.
    pub(crate) fn find_endings(&self, endings: &mut Vec<Ending>) {
        fill(endings, self.members.len(), Ending::default());
        let settings = &self.environment.settings;
        if settings.rest_frames() == 0 {
            return;
        }
        for (k, e) in self.touching() {
            for ending in [e.first, e.second] {
                let ending = &mut endings[ending as usize];
                ending.overlap = ending.overlap.max(-self.deepest[k]);
                ending.touches = true;
            }
        }
        let mut any = false;
        for (member, ending) in self.members.iter().zip(endings.iter_mut()) {
            let body = member.body;
            let room = ROOM * settings.overlap_allowed_m;
            let most = settings.rest_overlap_m.min(room.max(REST_PART * body.half_thickness));
            ending.deep = body.is_dynamic() && ending.overlap > most;
            any |= ending.deep;
        }
        if !any {
            return;
        }
        for (_, e) in self.touching() {
            let (first, second) = (e.first as usize, e.second as usize);
            let crammed = endings[first].deep || endings[second].deep;
            endings[first].crammed |= crammed;
            endings[second].crammed |= crammed;
        }
    }

    /// Counts the quiet frames of each body, and stops those that have come to rest.
    pub(crate) fn settle(&self, next: &mut [BodyState], endings: &[Ending], scratch: &mut RestScratch) {
        let full = self.environment.settings.rest_frames();
        if full == 0 {
            next.iter_mut().for_each(|state| state.rest = 0);
            return;
        }
        self.find_carried(next, scratch);
        let RestScratch { carried, fixpoint, .. } = scratch;
        fill(fixpoint, self.islands.count() + 1, true);
        for (i, member) in self.members.iter().enumerate() {
            if !member.body.is_dynamic() {
                continue;
            }
            let held = endings[i].touches && !self.driven[self.islands.root(i)];
            next[i].rest = match going(member, &next[i], self.environment) {
                // What a moving body carries or pushes goes with it, however slowly.
                Going::InPlace if held && !carried[i] => counted(member, &endings[i], self.environment),
                Going::InPlace | Going::OnItsWay if held => set_back(member, full),
                _ => 0,
            };
            if next[i].rest < full || member.state.rest < full {
                fixpoint[self.islands.root(i)] = false;
            }
        }
        for (i, member) in self.members.iter().enumerate() {
            if member.body.is_dynamic() && next[i].rest == full {
                let rest = if fixpoint[self.islands.root(i)] { full + 1 } else { full };
                let pose = member.state;
                next[i] = BodyState { velocity: Vec3::ZERO, angular_velocity: Vec3::ZERO, rest, ..pose };
            }
        }
    }

    /// Finds the bodies that one which goes on its way takes along where they touch.
    fn find_carried(&self, next: &[BodyState], RestScratch { drifting, carried, .. }: &mut RestScratch) {
        let drifts = |(m, next): (&Member, &BodyState)| {
            m.body.is_dynamic() && drifts(m, next, self.environment, FOLLOWS)
        };
        drifting.clear();
        drifting.extend(self.members.iter().zip(next).map(drifts));
        fill(carried, self.members.len(), false);
        if !drifting.contains(&true) {
            return;
        }
        let limit = DRIFT_PART * self.environment.settings.rest_speed;
        let limit2 = limit * limit;
        for (k, e) in self.touching() {
            for (mover, other) in
                [(e.first as usize, e.second as usize), (e.second as usize, e.first as usize)]
            {
                if drifting[mover] && self.members[other].body.is_dynamic() {
                    let point = self.contacts.manifold(k).points[0].position;
                    let (leads, follows) = (next[mover].velocity_at(point), next[other].velocity_at(point));
                    // A ball that rolls stands still where it touches.
                    let speed2 = leads.length_squared();
                    let along = (leads - follows).length_squared() < FOLLOWS * FOLLOWS * speed2;
                    carried[other] |= along && speed2 > limit2;
                }
            }
        }
    }
}

/// The rest counter of a body after one more quiet frame.
fn counted(member: &Member, ending: &Ending, environment: &Environment) -> u32 {
    let settings = &environment.settings;
    let full = settings.rest_frames();
    let counted = (member.state.rest + 1).min(full);
    let shallow = ending.overlap < 2.0 * settings.overlap_allowed_m;
    if ending.crammed {
        // Pushed on, even out of rest: a body between two frozen ones could not get out.
        counted.min(full - 1)
    } else if shallow && counted >= full.div_ceil(SHALLOW_REST) {
        full
    } else {
        counted
    }
}

/// What moves with another at the point where they touch, but for this part, is taken along; and it may slow the other by as much.
const FOLLOWS: f32 = 0.2;

/// The rest counter after a frame that was done in slices: quiet or not over the whole of it, and never at rest.
pub(crate) fn rest_after_slices(member: &Member, next: &BodyState, environment: &Environment) -> u32 {
    let full = environment.settings.rest_frames();
    if full == 0 || !member.body.is_dynamic() {
        return 0;
    }
    match going(member, next, environment) {
        Going::InPlace => (member.state.rest + 1).min(full - 1),
        Going::OnItsWay => set_back(member, full),
        Going::Fast => 0,
    }
}

/// The rest counter of a body that was quiet but for going on its way. One that was at rest has lost its support.
fn set_back(member: &Member, full: u32) -> u32 {
    let before = member.state.rest;
    if before < full { before.saturating_sub(SETBACK) } else { 0 }
}

/// How a body went through a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Going {
    /// Neither velocity nor change of pose shows.
    InPlace,
    /// They show only in the long run.
    OnItsWay,
    /// They show.
    Fast,
}

fn going(member: &Member, next: &BodyState, environment: &Environment) -> Going {
    if !slow(member, next, environment) {
        Going::Fast
    } else if drifts(member, next, environment, UNSTEADY) {
        Going::OnItsWay
    } else {
        Going::InPlace
    }
}

/// Whether neither velocity nor change of pose shows in a frame.
fn slow(member: &Member, next: &BodyState, environment: &Environment) -> bool {
    let (shift, turn) = pace(member, next, environment);
    let r2 = member.body.radius * member.body.radius;
    let limit2 = environment.settings.rest_speed * environment.settings.rest_speed;
    // A ball that others hold turns in its place, and that moves nothing.
    let spin2 = if matches!(member.body.shape, Shape::Sphere(_)) { TURNS * TURNS * limit2 } else { limit2 };
    next.velocity.length_squared() < limit2
        && next.angular_velocity.length_squared() * r2 < spin2
        && shift.length_squared() < limit2
        && turn.length_squared() * r2 < TURNS * TURNS * limit2
}

/// Whether the body goes on its way: it moved as its velocity said before, and says still, but for this part. What rattles does not.
fn drifts(member: &Member, next: &BodyState, environment: &Environment, unsteady: f32) -> bool {
    let (shift, turn) = pace(member, next, environment);
    let ball = matches!(member.body.shape, Shape::Sphere(_));
    let rolls = ball || matches!(member.body.shape, Shape::Capsule(_));
    let limit = environment.settings.rest_speed * if rolls { ROLL_PART } else { DRIFT_PART };
    let steady = |moved: Vec3, before: Vec3, after: Vec3, limit: f32| {
        let moved2 = moved.length_squared();
        let unsteady2 = unsteady * unsteady * moved2;
        moved2 > limit * limit
            && (moved - before).length_squared() < unsteady2
            && (moved - after).length_squared() < unsteady2
    };
    let state = &member.state;
    // The turning of a ball in its place moves nothing.
    steady(shift, state.velocity, next.velocity, limit)
        || !ball && steady(turn, state.angular_velocity, next.angular_velocity, limit / member.body.radius)
}

/// Mean velocity and angular velocity over the frame, from the change of pose.
fn pace(member: &Member, next: &BodyState, environment: &Environment) -> (Vec3, Vec3) {
    let per_second = 1.0 / environment.settings.frame_seconds;
    let shift = (next.position - member.state.position) * per_second;
    // The vector part is half the turn, for turns this small; the sign of a quaternion has no meaning.
    let turn: Quat = next.rotation * member.state.rotation.conjugate();
    let half = Vec3::new(turn.x, turn.y, turn.z) * if turn.w < 0.0 { -1.0 } else { 1.0 };
    (shift, half * (2.0 * per_second))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, BodyDef, BodyId};

    /// The rest counter after 300 frames, of each eleven of which a cube goes steadily on its way in so many and turns back in the others.
    fn count_after(steady: u32) -> u32 {
        let (body, mut state) = Body::new(&BodyDef::new(Shape::cuboid(Vec3::splat(0.5)).unwrap())).unwrap();
        let environment = Environment::default();
        let seconds = environment.settings.frame_seconds;
        for frame in 0..300 {
            let velocity = Vec3::X * 0.01;
            let mut next = state;
            state.velocity = if frame % 11 < steady { velocity } else { -velocity };
            (next.position, next.velocity) = (state.position + velocity * seconds, velocity);
            let member = Member { id: BodyId(0), body: &body, state };
            next.rest = rest_after_slices(&member, &next, &environment);
            state = next;
        }
        state.rest
    }

    #[test]
    fn what_rocks_is_told_from_what_goes_on_its_way() {
        let full = Environment::default().settings.rest_frames();
        assert!(count_after(0) > full - 11 && count_after(2) > full - 11);
        assert!(count_after(4) < 11 && count_after(11) == 0);
    }
}
