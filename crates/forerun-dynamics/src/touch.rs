//! Touch: who pushed whom during a frame, where, and how hard. Told where it is asked for; nothing of it is read by the step.

use forerun_geometry::Vec3;

use crate::solver::{Batch, Ends};
use crate::{BodyId, Member};

/// Bodies that start the frame no farther apart than this touch, whether they push each other or not. Metres.
const TOUCHING_M: f32 = 0.001;

/// Less is no weight for a mean. N s.
const WEIGHT_MIN: f32 = 1e-20;

/// Two bodies that touched during a frame: they pushed each other, or were at most a millimetre apart when it began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The body with the lower id.
    pub first: BodyId,
    /// The other.
    pub second: BodyId,
    /// Sum of the normal impulses over the frame, bounces included. N s, 0 or more. A body of mass m at rest on the ground has m g times
    /// the length of the frame.
    pub impulse: f32,
    /// How fast the two came together where they pushed each other, when the frame (or slice) began: the most of all points. m/s, 0 or more.
    /// What lies or slides has next to none, whatever its weight: this is what makes a noise.
    pub speed: f32,
    /// Where, in the world, when the frame (or slice) began: the mean of the contact points, by impulse. Metres.
    pub point: Vec3,
    /// Mean unit normal from the first body to the second, by impulse.
    pub normal: Vec3,
}

impl Touch {
    /// Whether two touches are the same, bit for bit.
    #[must_use]
    pub fn same_bits(&self, other: &Touch) -> bool {
        let bits = |t: &Touch| {
            let (p, n) = (t.point, t.normal);
            [t.impulse, t.speed, p.x, p.y, p.z, n.x, n.y, n.z].map(f32::to_bits)
        };
        (self.first, self.second) == (other.first, other.second) && bits(self) == bits(other)
    }
}

/// What a step tells about touches.
#[derive(Clone, Debug, Default)]
pub struct Touches {
    /// One a pair of bodies, sorted by pair. A step done in slices counts all of them.
    pub list: Vec<Touch>,
    /// By member: whether its island is at a fixpoint and was not solved. Then it touches whom it touched in the frame before, with the same
    /// impulse, and is not in the list.
    pub resting: Vec<bool>,
}

/// What one contact did in one frame or slice.
#[derive(Clone, Copy, Debug)]
struct Push {
    touch: Touch,
    island: u32,
    /// Means times impulse, to be divided once all is added up.
    point_sum: Vec3,
    normal_sum: Vec3,
}

/// Notes of what contacts did, islands and slices apart.
#[derive(Debug, Default)]
pub(crate) struct Ledger {
    pushes: Vec<Push>,
}

impl Ledger {
    /// Notes the contacts of a solved batch. `island_of` says which island a contact belongs to.
    pub(crate) fn note(&mut self, batch: &Batch, island_of: impl Fn(&Ends) -> u32) {
        for (k, (contact, impulses)) in batch.ends.iter().zip(&batch.impulses).enumerate() {
            let manifold = batch.contacts().manifold(k);
            let points = manifold.points();
            let [first, second] = [contact.first, contact.second].map(|i| &batch.members[i as usize]);
            let (mut impulse, mut speed) = (0.0, 0.0);
            let (mut point_sum, mut normal_sum, mut middle) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
            for (point, pushed) in points.iter().zip(impulses) {
                impulse += pushed;
                point_sum += point.position * *pushed;
                normal_sum += point.normal * *pushed;
                middle += point.position;
                if *pushed > 0.0 {
                    let velocity = |member: &Member| member.state.velocity_at(point.position);
                    let closing = (velocity(first) - velocity(second)).dot(point.normal);
                    // Spelled out: which zero `max` gives differs by platform.
                    speed = if closing > speed { closing } else { speed };
                }
            }
            if impulse > 0.0 || manifold.deepest() <= TOUCHING_M {
                let point = middle / points.len() as f32;
                let normal = manifold.normal;
                let touch = Touch { first: first.id, second: second.id, impulse, speed, point, normal };
                self.pushes.push(Push { touch, island: island_of(contact), point_sum, normal_sum });
            }
        }
    }

    /// Takes over the notes of a run, but for the islands that are done again (sorted).
    pub(crate) fn keep(&mut self, run: Ledger, done_again: &[u32]) {
        let kept = run.pushes.into_iter().filter(|push| done_again.binary_search(&push.island).is_err());
        self.pushes.extend(kept);
    }

    /// One touch a pair.
    pub(crate) fn touches(mut self) -> Vec<Touch> {
        // Stable: the slices of a pair add up in their order.
        self.pushes.sort_by_key(|push| (push.touch.first, push.touch.second));
        let same_pair =
            |a: &Push, b: &Push| (a.touch.first, a.touch.second) == (b.touch.first, b.touch.second);
        self.pushes.chunk_by(same_pair).map(merged).collect()
    }
}

/// The pushes (one or more) between two bodies as one touch.
fn merged(pushes: &[Push]) -> Touch {
    let mut touch = pushes[0].touch;
    let (mut impulse, mut point, mut normal) = (0.0, Vec3::ZERO, Vec3::ZERO);
    for push in pushes {
        impulse += push.touch.impulse;
        touch.speed = touch.speed.max(push.touch.speed);
        point += push.point_sum;
        normal += push.normal_sum;
    }
    // Where nothing pushes, or more than numbers hold, the middle of the first manifold serves.
    if impulse > WEIGHT_MIN && point.is_finite() && normal.is_finite() {
        touch.point = point / impulse;
        let length = normal.length();
        if length > 1e-6 * impulse && length.is_finite() {
            touch.normal = normal / length;
        }
    }
    touch.speed = touch.speed.min(f32::MAX);
    touch.impulse = if impulse.is_finite() { impulse } else { f32::MAX };
    // -0 made +0, so that equal touches have equal bits.
    touch.point += Vec3::ZERO;
    touch.normal += Vec3::ZERO;
    touch
}
