//! Carried contacts: from slice to slice, looked for again only where two bodies have moved against each other.
//!
//! A hit at one end of a heap has the whole heap go through its frame in slices. Most of it hardly moves: there contacts stay where they are on the bodies,
//! and only their separations change, as they do from substep to substep.

use forerun_geometry::Vec3;

use crate::bounds::Prospect;
use crate::narrow_phase::{Contact, NarrowPhase, Outlook};
use crate::solver::is_mesh;
use crate::{BodyState, Environment, Member};

/// Contacts hold while the pair moves by no more than this part of the contact margin, ...
const MARGIN_PART: f32 = 0.5;
/// ... but never while it moves by more than this part of the thinner body's half thickness.
const THICKNESS_PART: f32 = 0.25;
/// Those of a mesh, which cost more to find: while the pair moves by no more than this part of half the thickness so far if they were found for the
/// whole frame, no farther than the contact margin if for a slice.
const MESH_THICKNESS_PART: f32 = 0.2;

/// The contacts of some pairs of bodies.
#[derive(Debug, Default)]
pub(crate) struct Carried {
    /// Pairs of members, sorted.
    pairs: Vec<(u32, u32)>,
    /// By pair: how far the two may still move against each other before contacts are looked for again. Metres.
    rooms: Vec<f32>,
    /// In the order of the pairs.
    pub(crate) contacts: Vec<Contact>,
}

impl Carried {
    /// Contacts that were found for these pairs, in their order, at the start of the frame, whose environment this is.
    pub(crate) fn new(
        pairs: Vec<(u32, u32)>,
        contacts: Vec<Contact>,
        members: &[Member],
        environment: &Environment,
    ) -> Carried {
        let prospects = Prospects::new(members, environment);
        let rooms = pairs.iter().map(|pair| prospects.room(*pair, f32::INFINITY)).collect();
        Carried { pairs, rooms, contacts }
    }

    /// Looks again for contacts of all pairs that will have moved too far at the end of the slice. `environment` is that of the slice.
    pub(crate) fn look(&mut self, members: &[Member], environment: &Environment) {
        let prospects = Prospects::new(members, environment);
        let mut stale = Vec::new();
        for (&pair, room) in self.pairs.iter().zip(&mut self.rooms) {
            let way = prospects.way(pair);
            // Not "above": what is not a number is looked at again.
            let covered = way <= *room;
            if !covered {
                *room = prospects.room(pair, environment.settings.contact_margin_m);
                stale.push(pair);
            }
        }
        let mut fresh = Vec::new();
        let bodies = Outlook { members, prospects: &prospects.of, environment };
        NarrowPhase::default().find_contacts(&bodies, &stale, &mut fresh);
        self.contacts.retain(|c| stale.binary_search(&(c.first, c.second)).is_err());
        self.contacts.append(&mut fresh);
        // Stable: the contacts of a pair stay in their order.
        self.contacts.sort_by_key(|c| (c.first, c.second));
    }

    /// Takes the contacts along with the bodies, from the states of the members to `next`.
    pub(crate) fn follow(&mut self, members: &[Member], next: &[BodyState]) {
        let moves: Vec<Move> = members.iter().zip(next).map(|(m, next)| Move::new(m, next)).collect();
        for (&(i, j), room) in self.pairs.iter().zip(&mut self.rooms) {
            let (a, b) = (&moves[i as usize], &moves[j as usize]);
            *room -= (a.shift - b.shift).length() + a.sway + b.sway;
        }
        for contact in &mut self.contacts {
            let of = |i: u32| (&members[i as usize].state, &next[i as usize]);
            let (first, second) = (of(contact.first), of(contact.second));
            let manifold = &mut contact.manifold;
            for point in &mut manifold.points[..manifold.count as usize] {
                let (a, b) = (moved(first, point.position), moved(second, point.position));
                point.separation += point.normal.dot(b - a);
                point.position = 0.5 * (a + b);
            }
        }
    }
}

/// How a body went through a slice.
#[derive(Clone, Copy, Debug)]
struct Move {
    shift: Vec3,
    /// How far its surface may have moved by rotation. Metres.
    sway: f32,
}

impl Move {
    fn new(member: &Member, next: &BodyState) -> Move {
        let shift = next.position - member.state.position;
        let turn = next.rotation * member.state.rotation.conjugate();
        let sine = Vec3::new(turn.x, turn.y, turn.z).length();
        // What has not turned has not by rounding either: a body without bounds would sway without end.
        let turned = next.rotation != member.state.rotation;
        let sway = if turned && sine > 0.0 { 2.0 * sine * member.body.radius } else { 0.0 };
        Move { shift, sway }
    }
}

/// Where a point of a body is after a move.
fn moved((before, after): (&BodyState, &BodyState), point: Vec3) -> Vec3 {
    let local = before.rotation.conjugate() * (point - before.position);
    after.position + after.rotation * local
}

/// How the members are expected to go through a frame or slice.
struct Prospects<'a> {
    members: &'a [Member<'a>],
    of: Vec<Prospect>,
    contact_margin_m: f32,
}

impl<'a> Prospects<'a> {
    fn new(members: &'a [Member<'a>], environment: &Environment) -> Prospects<'a> {
        let of = members.iter().map(|m| Prospect::new(m.body, &m.state, environment)).collect();
        Prospects { members, of, contact_margin_m: environment.settings.contact_margin_m }
    }

    /// How far the bodies of a pair are expected to move against each other. Metres.
    fn way(&self, (i, j): (u32, u32)) -> f32 {
        let (a, b) = (&self.of[i as usize], &self.of[j as usize]);
        (a.motion.linear - b.motion.linear).length() + a.sway_m + b.sway_m
    }

    /// How far they may move, in whatever direction, while contacts hold; of a mesh no farther than `mesh_most`. Metres.
    fn room(&self, (i, j): (u32, u32), mesh_most: f32) -> f32 {
        let bodies = [i, j].map(|i| self.members[i as usize].body);
        let thickness = bodies[0].half_thickness.min(bodies[1].half_thickness);
        if bodies.iter().any(|body| is_mesh(&body.shape)) {
            (MESH_THICKNESS_PART * thickness).min(mesh_most)
        } else {
            (MARGIN_PART * self.contact_margin_m).min(THICKNESS_PART * thickness)
        }
    }
}

#[cfg(test)]
mod tests {
    use forerun_geometry::shape::{Shape, Sphere};

    use super::*;
    use crate::narrow_phase::find_contacts;
    use crate::{Body, BodyDef, BodyId};

    /// Level ground, and a ball of 1 m that touches it.
    fn bodies() -> [(Body, BodyState); 2] {
        let ball = BodyDef::new(Shape::Sphere(Sphere { radius: 1.0 })).at(Vec3::Y);
        [BodyDef::fixed(Shape::half_space()), ball].map(|def| Body::new(&def).unwrap())
    }

    fn members(bodies: &[(Body, BodyState); 2]) -> Vec<Member<'_>> {
        let ids = (0..).map(BodyId);
        ids.zip(bodies).map(|(id, (body, state))| Member { id, body, state: *state }).collect()
    }

    /// The contact of the two after the ball has moved, with its separation made 1 mm larger than it was found; and looked for again, or not.
    fn after_move(shift: Vec3) -> Contact {
        let bodies = bodies();
        let mut members = members(&bodies);
        let environment = Environment::default();
        let mut contacts = find_contacts(&members, &[(0, 1)], &environment);
        contacts[0].manifold.points[0].separation += 0.001;
        let mut carried = Carried::new(vec![(0, 1)], contacts, &members, &environment);
        let mut next: Vec<BodyState> = members.iter().map(|member| member.state).collect();
        next[1].position += shift;
        carried.follow(&members, &next);
        members[1].state = next[1];
        carried.look(&members, &environment);
        assert_eq!(carried.contacts.len(), 1);
        carried.contacts[0]
    }

    #[test]
    fn separations_follow_the_bodies() {
        let point = after_move(Vec3::new(0.004, 0.002, 0.0)).manifold.points[0];
        assert!((point.separation - 0.003).abs() < 1e-6, "{point:?}");
        assert!((point.position - Vec3::new(0.002, 0.001, 0.0)).length() < 1e-6, "{point:?}");
    }

    #[test]
    fn who_has_moved_far_is_looked_at_again() {
        let point = after_move(Vec3::new(0.5, 0.002, 0.0)).manifold.points[0];
        assert!((point.separation - 0.002).abs() < 1e-6, "{point:?}");
        assert!((point.position - Vec3::new(0.5, 0.001, 0.0)).length() < 1e-3, "{point:?}");
    }
}
