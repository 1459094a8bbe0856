//! Culling and look-ups: from the points of a direction to candidates for contact.

use super::Candidate;
use super::directions::{Direction, Points};
use super::points::RoundPoint;
use crate::Vec3;
use crate::sdf::Samples;
use crate::sdf::lanes::{Lanes, Lanes3, WIDTH};

/// Gradients shorter than this (squared) say nothing: they come from the middle of thin parts.
const GRADIENT_SQUARED_MIN: f32 = 0.01;

/// Two surfaces that touch face each other, at edges and corners too: this is the largest cosine between the normal of
/// a point and the gradient there, with some to spare for facets. It keeps a point that has come through the side of
/// an edge, or past the middle of a thin part, from being pushed out on the wrong side.
const FACING_MAX: f32 = 0.2;

/// Appends the points of the direction that are near the surface, or will be at the end of the step.
pub(super) fn find(direction: &Direction, index: usize, candidates: &mut Vec<Candidate>) {
    match &direction.points {
        Points::Mesh(samples) => direction.find_sharp(samples, index, candidates),
        Points::Sharp(samples) => direction.find_sharp(samples, index, candidates),
        Points::Round(balls) => {
            for chunk in balls.chunks(WIDTH) {
                direction.find_round(chunk, index, candidates);
            }
        }
    }
}

impl Direction<'_> {
    fn find_sharp(&self, samples: &Samples, index: usize, candidates: &mut Vec<Candidate>) {
        samples.visit(
            |spheres| self.near(spheres.centre.transformed(&self.axes, self.origin), spheres.radius),
            |points, normals, meant| {
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
                let facing = normal.dot(normals.transformed(&self.axes, Vec3::ZERO));
                found &= facing.below(Lanes::splat(FACING_MAX)).bits();
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

    /// At most eight balls.
    fn find_round(&self, balls: &[RoundPoint], index: usize, candidates: &mut Vec<Candidate>) {
        let (mut centres, mut radii) = (Lanes3::ZERO, Lanes::splat(f32::NEG_INFINITY));
        for (i, ball) in balls.iter().enumerate() {
            centres.set_lane(i, self.axes * ball.centre + self.origin);
            radii.0[i] = ball.radius;
        }
        let mut near = self.near(centres, radii);
        let mut guess = None;
        while near != 0 {
            let i = near.trailing_zeros() as usize;
            near &= near - 1;
            let ball = RoundPoint { centre: centres.lane(i), radius: radii.0[i] };
            // The field is exact only near the surface, and the surface of the ball may be far from its centre.
            let (distance, gradient) = self.surface.exact(ball.centre, self.skin.as_ref(), &mut guess);
            let motion = self.drift + self.spin.cross(ball.centre);
            let separation = distance - ball.radius;
            let closing = gradient.dot(motion).min(0.0);
            let meant = separation < self.margin && separation + closing < self.near;
            if meant && gradient.length_squared() > GRADIENT_SQUARED_MIN {
                candidates.push(self.candidate(ball, gradient.normalize(), distance, index));
            }
        }
    }

    /// The bits of the balls (in the field's frame) that may hold points that count.
    #[inline(always)]
    fn near(&self, centres: Lanes3, radii: Lanes) -> u32 {
        // No point of a ball moves further than its centre, and what turning about the centre adds.
        let motion = self.motion_at(centres).length() + radii * self.spin.length();
        let near = (motion + Lanes::splat(self.near)).min(Lanes::splat(self.margin));
        (self.surface.lower_bound(centres) - radii).below(near).bits()
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
