//! Culling and look-ups: from the points of a direction to candidates for contact.

use super::Candidate;
use super::directions::{Direction, Points};
use super::points::RoundPoint;
use crate::Vec3;
use crate::sdf::Samples;
use crate::sdf::lanes::{Lanes, Lanes3, WIDTH};

/// Gradients shorter than this (squared) say nothing: they come from the middle of thin parts.
const GRADIENT_SQUARED_MIN: f32 = 0.01;

/// Appends the points of the direction that are near the surface, or will be at the end of the step.
pub(super) fn find(direction: &Direction, index: usize, candidates: &mut Vec<Candidate>) {
    match &direction.points {
        Points::Mesh(samples) => direction.find_sharp(samples, index, candidates),
        Points::Sharp(samples) => direction.find_sharp(samples, index, candidates),
        Points::Round(points) => {
            for point in points {
                candidates.extend(direction.find_round(point, index));
            }
        }
    }
}

impl Direction<'_> {
    fn find_sharp(&self, samples: &Samples, index: usize, candidates: &mut Vec<Candidate>) {
        let turn = self.spin.length();
        samples.visit(
            |spheres| {
                let centre = spheres.centre.transformed(&self.axes, self.origin);
                // No point of the sphere moves further than its centre, and what turning about the centre adds.
                let motion = self.motion_at(centre).length() + spheres.radius * turn;
                let near = (motion + Lanes::splat(self.near)).min(Lanes::splat(self.margin));
                (self.surface.lower_bound(centre) - spheres.radius).below(near).bits()
            },
            |points, meant| {
                let points = points.transformed(&self.axes, self.origin);
                let (distance, gradient) = self.surface.look_up(points);
                let mut found = meant & distance.below(Lanes::splat(self.margin)).bits();
                if found == 0 {
                    return;
                }
                let length_squared = gradient.dot(gradient);
                let normal = gradient.normalized();
                let closing = normal.dot(self.motion_at(points)).min(Lanes::ZERO);
                found &= (distance + closing).below(Lanes::splat(self.near)).bits();
                found &= Lanes::splat(GRADIENT_SQUARED_MIN).below(length_squared).bits();
                while found != 0 {
                    let i = found.trailing_zeros() as usize;
                    found &= found - 1;
                    debug_assert!(i < WIDTH, "a bit beyond the lanes");
                    let point = RoundPoint { centre: points.lane(i), radius: 0.0 };
                    candidates.push(self.candidate(point, normal.lane(i), distance.0[i], index));
                }
            },
        );
    }

    fn find_round(&self, point: &RoundPoint, index: usize) -> Option<Candidate> {
        let centre = self.axes * point.centre + self.origin;
        let motion = self.drift + self.spin.cross(centre);
        // The field is exact only near the surface, and the surface of the ball may be far from its centre.
        let (distance, gradient) = self.surface.exact(centre, self.skin.as_ref());
        let separation = distance - point.radius;
        let near = separation < self.margin && separation + gradient.dot(motion).min(0.0) < self.near;
        let meant = near && gradient.length_squared() > GRADIENT_SQUARED_MIN;
        let point = RoundPoint { centre, radius: point.radius };
        meant.then(|| self.candidate(point, gradient.normalize(), distance, index))
    }

    #[inline(always)]
    fn motion_at(&self, points: Lanes3) -> Lanes3 {
        let (w, p) = (self.spin, points);
        let spun = Lanes3 { x: p.z * w.y - p.y * w.z, y: p.x * w.z - p.z * w.x, z: p.y * w.x - p.x * w.y };
        spun.plus(Lanes3::splat(self.drift))
    }

    /// The candidate of a point (of the field's frame), with the distance of its centre and the gradient there.
    pub(super) fn candidate(
        &self,
        point: RoundPoint,
        normal: Vec3,
        distance: f32,
        index: usize,
    ) -> Candidate {
        let midpoint = point.centre - normal * (0.5 * (point.radius + distance));
        Candidate {
            point: point.centre,
            radius: point.radius,
            position: self.field_axes * midpoint + self.field_pose.position,
            normal: self.field_axes * normal * self.sign,
            separation: distance - point.radius,
            direction: index,
        }
    }
}
