//! Culling and look-ups: from the points of a direction to candidates for contact.

use super::Candidate;
use super::directions::{Direction, Points};
use super::points::RoundPoint;
use super::sharp::Answer;
use crate::Vec3;
use crate::sdf::lanes::{Lanes, Lanes3, WIDTH};
use crate::sdf::primitive::Surface;
use crate::sdf::{Sample, Samples};

/// Gradients shorter than this (squared) say nothing: they come from the middle of thin parts.
const GRADIENT_SQUARED_MIN: f32 = 0.01;

/// The corners of boxes face what they stand on with a cosine of -0.58, edges and smooth surfaces better. Points that
/// face the surface less well are asked again.
const FACING_WELL: f32 = -0.45;

/// Points whose surroundings have the same normal, but for rounding, are inside a plane.
const FLAT_MAX: f32 = Sample::FLAT + 1e-5;

/// They are if they are inside the surface, or this close to it. Metres.
const BESIDE: f32 = 0.005;

/// Points with their outward normals, in the field's frame.
pub(super) struct Eight {
    pub(super) points: Lanes3,
    pub(super) outwards: Lanes3,
    /// See [`Sample::facing_max`](crate::sdf::Sample::facing_max).
    pub(super) facing_max: Lanes,
}

/// What the field says to them.
pub(super) struct Answers {
    pub(super) distance: Lanes,
    pub(super) normal: Lanes3,
    /// The bits of the points that are candidates.
    pub(super) found: u32,
    /// The bits of those near or inside the surface that do not face it well, or are next to its edges.
    doubtful: u32,
    /// Where it was asked; see [`Direction::meet`].
    inset: f32,
}

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
            |[points, normals], facing_max, meant| {
                let eight = Eight {
                    points: points.transformed(&self.axes, self.origin),
                    outwards: normals.transformed(&self.axes, Vec3::ZERO),
                    facing_max: *facing_max,
                };
                self.find_eight(&eight, [meant, 0], index, candidates);
            },
        );
    }

    /// Appends those of eight points that are meant and near; the second bits are those of points that are to be doubted.
    #[inline(always)]
    pub(super) fn find_eight(
        &self,
        eight: &Eight,
        [meant, doubted]: [u32; 2],
        index: usize,
        candidates: &mut Vec<Candidate>,
    ) {
        let mut there = self.meet(eight, 0.0, meant);
        there.doubtful |= doubted & there.found;
        if there.doubtful != 0 && self.inset > 0.0 {
            let mut inside = self.meet(eight, self.inset, there.doubtful);
            // Better than an answer that is good enough is only one without doubt.
            inside.found &= !inside.doubtful | !there.found;
            there.found &= !inside.found;
            self.push(eight, &inside, index, candidates);
        }
        self.push(eight, &there, index, candidates);
    }

    /// What the field says to some of eight points, asked `inset` metres further inside their own surface.
    ///
    /// There the face that the points have come through is the nearest one even for the corners of a box that stands
    /// exactly on another of the same size. The answer is carried back to the points along the normal found.
    #[inline(always)]
    pub(super) fn meet(&self, eight: &Eight, inset: f32, asked: u32) -> Answers {
        let back = eight.outwards.scaled(Lanes::splat(inset));
        let Answer { distance, gradient, beside } = if inset > 0.0 {
            self.answer_inside(eight, back, asked)
        } else {
            self.answer(eight.points, asked)
        };
        let normal = gradient.normalized();
        let distance = distance + normal.dot(back);
        let near = asked & distance.below(Lanes::splat(self.margin)).bits();
        if near == 0 {
            return Answers { distance, normal, found: 0, doubtful: 0, inset };
        }
        let closing = normal.dot(self.motion_at(eight.points)).min(Lanes::ZERO);
        let facing = normal.dot(eight.outwards);
        let found = near
            & facing.below(eight.facing_max).bits()
            & (distance + closing).below(Lanes::splat(self.near)).bits()
            & Lanes::splat(GRADIENT_SQUARED_MIN).below(gradient.dot(gradient)).bits();
        let doubtful = near
            & distance.below(Lanes::splat(BESIDE)).bits()
            & (beside | !facing.below(Lanes::splat(FACING_WELL)).bits());
        Answers { distance, normal, found, doubtful, inset }
    }

    #[inline(always)]
    pub(super) fn push(
        &self,
        eight: &Eight,
        answers: &Answers,
        index: usize,
        candidates: &mut Vec<Candidate>,
    ) {
        let mut found = answers.found;
        while found != 0 {
            let i = found.trailing_zeros() as usize;
            found &= found - 1;
            let ball = RoundPoint { centre: eight.points.lane(i), radius: 0.0 };
            // What lies on a plane is pushed off it at a right angle, whatever interpolation says of its rim.
            let flat = matches!(self.surface, Surface::Field(_)) && eight.facing_max.0[i] <= FLAT_MAX;
            let normal = if flat { -eight.outwards.lane(i) } else { answers.normal.lane(i) };
            let candidate = self.candidate(ball, normal, answers.distance.0[i], index);
            candidates
                .push(Candidate { rough: answers.inset == 0.0 && !flat && self.blur.is_none(), ..candidate });
        }
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
    pub(super) fn near(&self, centres: Lanes3, radii: Lanes) -> u32 {
        let near = self.reach(centres, radii) + Lanes::splat(self.blur_depth);
        (self.surface.lower_bound(centres) - radii).below(near).bits()
    }

    /// How near to the surface points of balls must be to count. Metres.
    #[inline(always)]
    pub(super) fn reach(&self, centres: Lanes3, radii: Lanes) -> Lanes {
        // No point of a ball moves further than its centre, and what turning about the centre adds.
        let motion = self.motion_at(centres).length() + radii * self.spin.length();
        (motion + Lanes::splat(self.near)).min(Lanes::splat(self.margin))
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
            rough: false,
            position: self.field_axes * midpoint + self.field_pose.position,
            normal: self.field_axes * normal * self.sign,
            separation: distance - point.radius,
            direction: index,
        }
    }
}
