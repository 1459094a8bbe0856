//! Passing: whether a speculative contact would stop what would in truth go by.
//!
//! A contact found ahead of touching holds the bodies apart along its normal. A body that flies past a corner crosses
//! the plane through that corner without ever touching it; a contact there would be a ghost.

use super::gjk::{self, Distance};
use super::solid::Solid;
use super::{ContactPoint, Manifold, Motion, Placed};
use crate::Shape;

/// Nearer than this, whatever approaches is taken to touch: it costs nothing to be careful, and what rests is not asked
/// every frame. Metres.
const NEAR: f32 = 5.0e-3;

/// Bodies that pass each other at less than this touch. Metres.
const GRAZE: f32 = 1.0e-3;

/// Conservative advances; each closes most of the remaining gap.
const ADVANCES_MAX: usize = 24;

/// Whether the two convex shapes, moving as they are about to, pass each other without touching although the manifold
/// would stop them. Turning counts as far as it moves the point that would be stopped first.
pub(super) fn passes_by(first: &Placed, second: &Placed, manifold: &Manifold) -> bool {
    let still = first.motion == Motion::default() && second.motion == Motion::default();
    let endless = matches!(first.shape, Shape::HalfSpace) || matches!(second.shape, Shape::HalfSpace);
    if still || endless || manifold.deepest() < NEAR {
        return false;
    }
    let closing = |point: &ContactPoint| {
        let relative = second.motion.of(point.position) - first.motion.of(point.position);
        (relative, -relative.dot(point.normal) - point.separation)
    };
    let mut soonest = closing(&manifold.points[0]);
    for point in &manifold.points()[1..] {
        let other = closing(point);
        if other.1 > soonest.1 {
            soonest = other;
        }
    }
    let (relative, overlap) = soonest;
    if overlap <= 0.0 {
        // It stops nobody, and whoever comes next frame is seen then.
        return false;
    }
    let origin = first.pose.position;
    let (Some(a), Some(mut b)) =
        (Solid::new(first.shape, &first.pose, origin), Solid::new(second.shape, &second.pose, origin))
    else {
        return false;
    };
    let start = b.centre();
    let mut part = 0.0_f32;
    for _ in 0..ADVANCES_MAX {
        b.place(start + relative * part);
        let Distance::Apart(witness) = gjk::distance(&a, &b, f32::INFINITY) else { return false };
        let gap = witness.separation as f32 - a.radius - b.radius;
        if gap < GRAZE {
            return false;
        }
        let speed = -relative.dot(witness.normal.as_vec3());
        // Apart along a fixed normal, and not getting nearer along it; or not before the frame ends.
        if speed <= 0.0 || part + gap / speed > 1.0 {
            return true;
        }
        part += gap / speed;
    }
    false
}
