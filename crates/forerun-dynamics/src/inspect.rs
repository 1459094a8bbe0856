//! Inspect: what is inside one step: contacts with their impulses, levels, islands, slices, bounds, rest.
//!
//! The step is memoryless, so whoever wants to look into one that was done long ago, or will be, does it again with the same states. Nothing is
//! kept for that, and a step that nobody looks into does no more than it did.

use forerun_geometry::{Aabb, Vec3};

use crate::bounds::swept_bound;
use crate::close_up::CloseUp;
use crate::detection::Detection;
use crate::plan::Plan;
use crate::step::{Known, advance_islands};
use crate::{BodyId, Environment, Group, Member, StepScratch, Unobserved};

/// A point of a contact, when the frame (or slice) began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InspectedPoint {
    /// Where, in the world. Metres.
    pub position: Vec3,
    /// Unit normal, from the first body to the second.
    pub normal: Vec3,
    /// Distance along the normal; below 0 the bodies overlap. Metres.
    pub separation: f32,
    /// Impulse along the normal over the frame (or slice), bounces included. N s, 0 or more.
    pub impulse: f32,
}

impl InspectedPoint {
    pub(crate) const NONE: InspectedPoint =
        InspectedPoint { position: Vec3::ZERO, normal: Vec3::ZERO, separation: 0.0, impulse: 0.0 };
}

/// Two bodies that touch, or were looked at because they might in this frame: then nothing pushes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InspectedContact {
    /// The body with the lower id.
    pub first: BodyId,
    /// The other.
    pub second: BodyId,
    /// Which slice of the frame: each has contacts of its own, from the states at its beginning.
    pub slice: u32,
    /// Mean unit normal, from the first body to the second.
    pub normal: Vec3,
    /// Impulse of friction on the second body over the frame (or slice), in the world. N s.
    pub friction: Vec3,
    /// The points; the first `count` are meant.
    pub points: [InspectedPoint; 4],
    /// How many points there are, 1 to 4.
    pub count: u32,
}

impl InspectedContact {
    /// The points.
    #[must_use]
    pub fn points(&self) -> &[InspectedPoint] {
        &self.points[..(self.count as usize).min(self.points.len())]
    }

    /// Sum of the normal impulses of all points. N s.
    #[must_use]
    pub fn impulse(&self) -> f32 {
        self.points().iter().map(|point| point.impulse).sum()
    }
}

/// What a step finds out about a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InspectedBody {
    /// Which body.
    pub body: BodyId,
    /// Swept bound: where it may be during the frame. Not finite for a half space.
    pub bound: Aabb,
    /// Level in the contact graph when the frame began: 0 for bodies that do not yield, else one more than the lowest that it rests on. `None` where
    /// nothing supports it.
    pub level: Option<u32>,
    /// Its island: the lowest id of a dynamic body in it. `None` for bodies that do not yield: they are in no island, or in many.
    pub island: Option<BodyId>,
    /// Into how many slices the frame of its island is cut.
    pub slices: u32,
    /// Whether its island is at a fixpoint: the step leaves it as it is, without solving it.
    pub resting: bool,
}

/// Dynamic bodies that may push each other in this frame, directly or through others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InspectedIsland {
    /// Its name: the lowest id of a dynamic body in it.
    pub island: BodyId,
    /// How many dynamic bodies are in it.
    pub bodies: u32,
    /// How many contacts it has in the frame, or, where that is cut, in the slices together.
    pub contacts: u32,
    /// Into how many slices its frame is cut; 1 where it is not.
    pub slices: u32,
    /// Whether it is at a fixpoint: the step leaves it as it is, without solving it.
    pub resting: bool,
}

/// What is inside one step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inspection {
    /// All bodies, sorted by id.
    pub bodies: Vec<InspectedBody>,
    /// All islands, also those of a single body that touches nothing. Sorted by name.
    pub islands: Vec<InspectedIsland>,
    /// All contacts of islands, sorted by pair, then slice. Those of resting islands have the impulses that hold them up.
    pub contacts: Vec<InspectedContact>,
}

/// Does the step of some bodies (all that there are, sorted by id) and tells what is inside. Costs a whole step and more. Empty in an environment
/// that [`Environment::check`] refuses.
#[must_use]
pub fn inspect(members: &[Member], environment: &Environment) -> Inspection {
    if environment.check().is_err() {
        return Inspection::default();
    }
    let mut detection = Detection::default();
    detection.run(members, environment);
    let Detection { pairs, contacts, .. } = &detection;
    let mut plan = Plan::default();
    plan.make(&Group { members, pairs, contacts }, environment, &[]);
    let resting = plan.resting;
    // What is at a fixpoint is not solved. The last frame of rest that is solved has the same states, and so what holds them up; nothing but the fixpoint
    // reads the counter.
    let mut members = members.to_vec();
    for member in &mut members {
        member.state.rest = member.state.rest.min(environment.settings.rest_frames());
    }
    let mut close_up = CloseUp::default();
    let mut scratch = StepScratch::default();
    let known = Known { close_up: Some(&mut close_up), ..Known::default() };
    let group = Group { members: &members, pairs, contacts };
    let _ = advance_islands(&group, environment, &mut Unobserved, known, &mut scratch);
    let contacts = close_up.take_contacts();
    let bodies = bodies(&group, environment, &scratch, (&resting, &close_up.take_levels()));
    Inspection { islands: islands(&bodies, &contacts), bodies, contacts }
}

fn bodies(
    group: &Group,
    environment: &Environment,
    scratch: &StepScratch,
    (resting, levels): (&[bool], &[(BodyId, u32)]),
) -> Vec<InspectedBody> {
    let StepScratch { plan, slice_counts, .. } = scratch;
    let inspected = group.members.iter().enumerate().map(|(i, member)| {
        let Member { id, body, state } = *member;
        let yields = body.is_dynamic();
        let level = levels.binary_search_by_key(&id, |(body, _)| *body).ok().map(|at| levels[at].1);
        let (island, slices) = match plan.island_of[i] {
            Plan::NONE => (id, 1),
            island => (group.members[plan.members(island)[0] as usize].id, slice_counts[island as usize]),
        };
        InspectedBody {
            body: id,
            bound: swept_bound(body, &state, environment),
            level: if yields { level } else { Some(0) },
            island: yields.then_some(island),
            slices,
            resting: resting[i],
        }
    });
    inspected.collect()
}

fn islands(bodies: &[InspectedBody], contacts: &[InspectedContact]) -> Vec<InspectedIsland> {
    // An island is named after its first body, so the names come out sorted.
    let mut islands: Vec<InspectedIsland> = Vec::new();
    for body in bodies {
        let Some(island) = body.island else { continue };
        match islands.binary_search_by_key(&island, |island| island.island) {
            Ok(at) => islands[at].bodies += 1,
            Err(at) => {
                let InspectedBody { slices, resting, .. } = *body;
                islands.insert(at, InspectedIsland { island, bodies: 1, contacts: 0, slices, resting });
            }
        }
    }
    let island_of = |body: BodyId| {
        let at = bodies.binary_search_by_key(&body, |inspected| inspected.body).ok()?;
        bodies[at].island
    };
    for contact in contacts {
        let island = island_of(contact.first).or_else(|| island_of(contact.second));
        let at = island.and_then(|name| islands.binary_search_by_key(&name, |island| island.island).ok());
        if let Some(at) = at {
            islands[at].contacts += 1;
        }
    }
    islands
}
