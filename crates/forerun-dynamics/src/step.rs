//! The step of a closed group of bodies: contacts in, next states out.

use crate::narrow_phase::Contact;
use crate::{Body, BodyId, BodyKind, BodyState, Environment, Observer, Stage};

/// A body of a group, at the frame that is to be advanced.
#[derive(Clone, Copy, Debug)]
pub struct Member<'a> {
    /// Its name; members are sorted by it.
    pub id: BodyId,
    /// What it is.
    pub body: &'a Body,
    /// How it is.
    pub state: BodyState,
}

/// Bodies that touch nobody outside the group.
///
/// Whoever builds it promises: `members` are sorted by id; `pairs` are all pairs of members with overlapping swept bounds, one of them
/// dynamic, lower index first, sorted; `contacts` are what [`find_contacts`](crate::narrow_phase::find_contacts) gives for these pairs; and every
/// body with a contact to a dynamic member is a member.
#[derive(Clone, Copy, Debug)]
pub struct Group<'a> {
    /// The bodies.
    pub members: &'a [Member<'a>],
    /// Pairs of members that may meet in this frame.
    pub pairs: &'a [(u32, u32)],
    /// Where members touch.
    pub contacts: &'a [Contact],
}

/// What a step did. Degraded results are counted, not hidden.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepReport {
    /// Islands with at least one contact.
    pub islands: u32,
    /// Contacts (manifolds) solved.
    pub contacts: u32,
    /// Most slices that an island's frame was cut into; 1 when none was.
    pub slices_max: u32,
    /// Bodies whose next state was not finite: they were stopped where they were.
    pub quarantined: u32,
}

/// The states of the members one frame later, in the members' order.
#[must_use]
pub fn advance(
    group: &Group,
    environment: &Environment,
    observer: &mut dyn Observer,
) -> (Vec<BodyState>, StepReport) {
    let dt = environment.settings.frame_seconds;
    let next = group.members.iter().map(|m| fly(m.body, &m.state, environment, dt)).collect();
    observer.after(Stage::Positions);
    (next, StepReport { slices_max: 1, ..StepReport::default() })
}

fn fly(body: &Body, state: &BodyState, environment: &Environment, dt: f32) -> BodyState {
    if body.kind == BodyKind::Fixed {
        return *state;
    }
    let mut next = *state;
    if body.is_dynamic() {
        next.velocity += environment.gravity * (body.gravity_scale * dt);
    }
    next.position += (state.velocity + next.velocity) * (0.5 * dt);
    next.canonical()
}
