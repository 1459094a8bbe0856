//! Capsule: two of them, and what any two segments have to do with each other.

use super::{ContactPoint, Manifold, any_perpendicular, unit_or};
use crate::shape::Capsule;
use crate::{Pose, Vec3};

/// Segments that enclose an angle with a smaller sine than this touch in two points. About 6 degrees.
const NEARLY_PARALLEL: f32 = 0.1;

/// Where nearly parallel segments cross is a third point if it is nearer than both ends by this. Metres.
const CROSSING: f32 = 1.0e-4;

/// A segment with everything within `radius` of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rod {
    /// Its two ends. Metres.
    pub(super) ends: [Vec3; 2],
    /// Radius, 0 or more. Metres.
    pub(super) radius: f32,
}

/// Two capsules: one point, two if they are nearly parallel, three if they are nearly parallel and cross.
pub(super) fn capsule_capsule(
    first: &Capsule,
    first_pose: &Pose,
    second: &Capsule,
    second_pose: &Pose,
    margin: f32,
) -> Option<Manifold> {
    // Relative to the first capsule's centre: far from the world's origin the midpoints would lose digits.
    let origin = first_pose.position;
    let a = Rod::new(Vec3::ZERO, first_pose.rotation * Vec3::new(0.0, first.half_height, 0.0), first.radius);
    let arm = second_pose.rotation * Vec3::new(0.0, second.half_height, 0.0);
    let b = Rod::new(second_pose.position - origin, arm, second.radius);
    let fallback = any_perpendicular(first_pose.rotation * Vec3::Y);
    let fallback = unit_or((first_pose.rotation * Vec3::Y).cross(second_pose.rotation * Vec3::Y), fallback);
    rod_rod(&a, &b, fallback, margin).map(|manifold| manifold.moved(origin))
}

/// Two rods. `fallback` is the normal where their segments meet.
pub(super) fn rod_rod(a: &Rod, b: &Rod, fallback: Vec3, margin: f32) -> Option<Manifold> {
    let (on_a, on_b) = nearest_of_segments(a.ends, b.ends);
    let nearest = a.touch(b, (on_a, on_b), fallback);
    let mut points = [nearest; 3];
    let mut count = 0;
    if let Some(ends) = parallel_ends(a, b, NEARLY_PARALLEL) {
        let ends = ends.map(|pair| a.touch(b, pair, nearest.normal));
        if nearest.separation < ends[0].separation.min(ends[1].separation) - CROSSING {
            count = 1;
        }
        points[count..count + 2].copy_from_slice(&ends);
        count += 2;
    } else {
        count = 1;
    }
    let mut kept = 0;
    for k in 0..count {
        if points[k].separation < margin {
            points[kept] = points[k];
            kept += 1;
        }
    }
    Manifold::from_points(&points[..kept])
}

impl Rod {
    /// A rod about `centre` that reaches `arm` to both sides.
    pub(super) fn new(centre: Vec3, arm: Vec3, radius: f32) -> Self {
        Rod { ends: [centre - arm, centre + arm], radius }
    }

    fn touch(&self, other: &Rod, (on_a, on_b): (Vec3, Vec3), fallback: Vec3) -> ContactPoint {
        let gap = on_b - on_a;
        let length = gap.length();
        let normal = if length > 1.0e-6 { gap / length } else { fallback };
        let distance = gap.dot(normal);
        let position = (on_a + on_b + normal * (self.radius - other.radius)) * 0.5;
        ContactPoint { position, normal, separation: distance - self.radius - other.radius }
    }
}

impl Manifold {
    /// The same manifold, `by` further.
    pub(super) fn moved(mut self, by: Vec3) -> Self {
        for point in &mut self.points[..self.count as usize] {
            point.position += by;
        }
        self
    }
}

/// The ends of the stretch along which two nearly parallel segments face each other, on each of the two; none if they
/// enclose an angle of that sine or more, or the stretch has no length.
pub(super) fn parallel_ends(a: &Rod, b: &Rod, sine: f32) -> Option<[(Vec3, Vec3); 2]> {
    let (along_a, along_b) = (a.ends[1] - a.ends[0], b.ends[1] - b.ends[0]);
    let (square_a, square_b) = (along_a.length_squared(), along_b.length_squared());
    let cross = along_a.cross(along_b).length_squared();
    if cross >= sine * sine * square_a * square_b {
        return None;
    }
    let place = |point: Vec3| (point - a.ends[0]).dot(along_a) / square_a;
    let (p, q) = (place(b.ends[0]), place(b.ends[1]));
    let (from, to) = (p.min(q).max(0.0), p.max(q).min(1.0));
    // Shorter than a millimetre (or a thousandth): one point says it all.
    if (to - from) * square_a.sqrt() < 1.0e-3 || to - from < 1.0e-3 {
        return None;
    }
    Some([from, to].map(|t| {
        let on_a = a.ends[0] + along_a * t;
        let on_b = nearest_on_segment(on_a, b.ends);
        (nearest_on_segment(on_b, a.ends), on_b)
    }))
}

/// The point of a segment that is nearest to `point`.
pub(super) fn nearest_on_segment(point: Vec3, ends: [Vec3; 2]) -> Vec3 {
    let along = ends[1] - ends[0];
    let square = along.length_squared();
    if square < 1.0e-20 {
        return ends[0];
    }
    ends[0] + along * ((point - ends[0]).dot(along) / square).clamp(0.0, 1.0)
}

/// The nearest points of two segments, one on each (Ericson, Real-Time Collision Detection, section 5.1.9). Of
/// parallel segments the middle of the stretch along which they face each other.
pub(super) fn nearest_of_segments(a: [Vec3; 2], b: [Vec3; 2]) -> (Vec3, Vec3) {
    let (along_a, along_b, between) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (aa, bb, ab) = (along_a.length_squared(), along_b.length_squared(), along_a.dot(along_b));
    if aa < 1.0e-20 {
        return (a[0], nearest_on_segment(a[0], b));
    }
    if bb < 1.0e-20 {
        return (nearest_on_segment(b[0], a), b[0]);
    }
    let (c, f) = (along_a.dot(between), along_b.dot(between));
    // aa bb - ab² loses its digits where the segments are nearly parallel; the cross product does not.
    let det = along_a.cross(along_b).length_squared();
    let s = if det > 1.0e-8 * aa * bb {
        ((ab * f - c * bb) / det).clamp(0.0, 1.0)
    } else {
        let (p, q) = (-c / aa, (ab - c) / aa);
        0.5 * (p.min(q).clamp(0.0, 1.0) + p.max(q).clamp(0.0, 1.0))
    };
    let t = ((ab * s + f) / bb).clamp(0.0, 1.0);
    let s = ((ab * t - c) / aa).clamp(0.0, 1.0);
    (a[0] + along_a * s, b[0] + along_b * t)
}
