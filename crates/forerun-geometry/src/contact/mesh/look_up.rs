//! Culling and look-ups: from the points of a direction to candidates for contact.

use forerun_lanes::{LANES, LaneMask, Lanes, Portable, V8, dispatched};

use super::TOUCH_PART;
use super::candidates::{Block, Candidates};
use super::directions::{Direction, Points};
use super::points::RoundPoint;
use crate::Vec3;
use crate::sdf::eight::{normalized, of_vectors, splat, transformed};
use crate::sdf::primitive::Surface;
use crate::sdf::samples::Spheres;
use crate::sdf::{Sample, Samples};

/// Gradients shorter than this (squared) say nothing: they come from the middle of thin parts.
const GRADIENT_SQUARED_MIN: f32 = 0.01;

/// The corners of boxes face what they stand on with a cosine of -0.58, edges and smooth surfaces better. Points that
/// face the surface less well are asked again where they touch it.
const FACING_WELL: f32 = -0.45;

/// Points whose surroundings have the same normal, but for rounding, are inside a plane.
const FLAT_MAX: f32 = Sample::FLAT + 1e-5;

/// Points with their outward normals, in the field's frame.
struct Eight<F> {
    points: V8<F>,
    outwards: V8<F>,
    /// See [`Sample::facing_max`](crate::sdf::Sample::facing_max).
    facing_max: F,
}

/// What the field says to them.
struct Answers<F> {
    distance: F,
    normal: V8<F>,
    /// The bits of the points that are candidates.
    found: u32,
    /// The bits of those near or inside the surface that do not face it well.
    doubtful: u32,
}

/// Appends the points of the direction that are near the surface, or will be at the end of the step.
pub(super) fn find(direction: &Direction, candidates: &mut Candidates) {
    match direction.points {
        Points::Sharp(samples) => find_sharp(direction, samples, candidates),
        Points::Round(balls) => {
            for chunk in balls.chunks(LANES) {
                find_round(direction, chunk, candidates);
            }
        }
    }
}

dispatched! {
    fn find_sharp(direction: &Direction, samples: &Samples, candidates: &mut Candidates) => find_sharp_lanes
}

#[inline(always)]
fn find_sharp_lanes<F: Lanes>(direction: &Direction, samples: &Samples, candidates: &mut Candidates) {
    let Candidates { blocks, leaves, nodes } = candidates;
    cull::<F>(direction, samples, nodes, leaves);
    for &leaf in &*leaves {
        let (leaf, meant) = samples.leaf(leaf as usize);
        let eight = Eight::<F> {
            points: transformed(leaf.points.form(), &direction.axes, direction.origin),
            outwards: transformed(leaf.normals.form(), &direction.axes, Vec3::ZERO),
            facing_max: F::from_array(leaf.facing_max.to_array()),
        };
        let mut there = direction.meet(&eight, 0.0, meant);
        if there.doubtful != 0 && direction.inset > 0.0 {
            let mut inside = direction.meet(&eight, direction.inset, there.doubtful);
            // Better than an answer that is good enough is only one without doubt.
            inside.found &= !inside.doubtful | !there.found;
            there.found &= !inside.found;
            direction.push(&eight, &inside, 0, blocks);
        }
        direction.push(&eight, &there, there.found, blocks);
    }
}

/// Fills `leaves` with the leaves that may hold points that count.
#[inline(always)]
fn cull<F: Lanes>(direction: &Direction, samples: &Samples, nodes: &mut Vec<u32>, leaves: &mut Vec<u32>) {
    nodes.clear();
    if samples.node_spheres().is_empty() {
        nodes.extend(0..samples.leaf_spheres().len() as u32);
    }
    for (block, spheres) in samples.node_spheres().iter().enumerate() {
        push_bits(block, direction.near::<F>(spheres), nodes);
    }
    leaves.clear();
    for &node in &*nodes {
        push_bits(node as usize, direction.near::<F>(&samples.leaf_spheres()[node as usize]), leaves);
    }
}

/// Appends the numbers of those of a block of eight whose bits are set.
#[inline(always)]
fn push_bits(block: usize, mut bits: u32, list: &mut Vec<u32>) {
    while bits != 0 {
        list.push((block * LANES) as u32 + bits.trailing_zeros());
        bits &= bits - 1;
    }
}

impl Direction<'_> {
    /// What the field says to some of eight points, asked `inset` metres further inside their own surface.
    ///
    /// There the face that the points have come through is the nearest one even for the corners of a box that stands
    /// exactly on another of the same size. The answer is carried back to the points along the normal found.
    #[inline(always)]
    fn meet<F: Lanes>(&self, eight: &Eight<F>, inset: f32, asked: u32) -> Answers<F> {
        let back = eight.outwards * F::splat(inset);
        let (distance, gradient) = self.answer(eight.points - back, asked, inset);
        let normal = normalized(gradient);
        let distance = distance + normal.dot(back);
        let near = asked & distance.lt(F::splat(self.margin)).bits();
        if near == 0 {
            return Answers { distance, normal, found: 0, doubtful: 0 };
        }
        let closing = normal.dot(self.motion_at(eight.points)).min(F::zero());
        let facing = normal.dot(eight.outwards);
        let found = facing.lt(eight.facing_max)
            & (distance + closing).lt(F::splat(self.near))
            & F::splat(GRADIENT_SQUARED_MIN).lt(gradient.dot(gradient));
        let well = facing.lt(F::splat(FACING_WELL)).bits();
        let doubtful = near & distance.lt(F::splat(TOUCH_PART * self.near)).bits() & !well;
        Answers { distance, normal, found: near & found.bits(), doubtful }
    }

    /// Appends what was found; `rough`: the bits of those whose normal is that of the field at the point itself.
    #[inline(always)]
    fn push<F: Lanes>(&self, eight: &Eight<F>, answers: &Answers<F>, rough: u32, blocks: &mut Vec<Block>) {
        if answers.found == 0 {
            return;
        }
        let (mut normal, mut rough) = (answers.normal, rough);
        if matches!(self.surface, Surface::Field(_)) {
            // What lies on a plane is pushed off it at a right angle, whatever interpolation says of its rim.
            let flat = eight.facing_max.le(F::splat(FLAT_MAX));
            normal = flat.select_v(-eight.outwards, normal);
            rough &= if self.blur > 0.0 { 0 } else { !flat.bits() };
        }
        let found = F::Mask::from_bits(answers.found);
        let midpoint = eight.points - normal * (F::splat(0.5) * answers.distance);
        let left = found.select(answers.distance, F::splat(f32::INFINITY));
        let in_world = transformed(normal, &self.field_axes, Vec3::ZERO) * F::splat(self.sign());
        blocks.push(Block {
            point: eight.points.form(),
            position: transformed(midpoint, &self.field_axes, self.field_pose.position).form(),
            normal: in_world.form(),
            separation: Portable::from_array(answers.distance.to_array()),
            left: Portable::from_array(left.to_array()),
            rough,
            way: self.way,
        });
    }

    /// The bits of the spheres that may hold points that count.
    #[inline(always)]
    fn near<F: Lanes>(&self, spheres: &Spheres) -> u32 {
        let radii = F::from_array(spheres.radius.to_array());
        let centres = transformed(spheres.centre.form::<F>(), &self.axes, self.origin);
        let near = self.reach(centres, radii) + F::splat(self.blur);
        (self.surface.lower_bound(centres) - radii).lt(near).bits()
    }

    /// How near to the surface points of balls must be to count. Metres.
    #[inline(always)]
    pub(super) fn reach<F: Lanes>(&self, centres: V8<F>, radii: F) -> F {
        // No point of a ball moves further than its centre, and what turning about the centre adds.
        let motion = self.motion_at(centres).length() + radii * F::splat(self.spin.length());
        (motion + F::splat(self.near)).min(F::splat(self.margin))
    }

    #[inline(always)]
    fn motion_at<F: Lanes>(&self, points: V8<F>) -> V8<F> {
        splat::<F>(self.spin).cross(points) + splat(self.drift)
    }

    /// The normal in the world of a point with the given gradient, and the point half of `way` (metres) against the gradient from it.
    pub(super) fn to_world(&self, point: Vec3, gradient: Vec3, way: f32) -> (Vec3, Vec3) {
        let midpoint = point - gradient * (0.5 * way);
        let position = self.field_axes * midpoint + self.field_pose.position;
        (self.field_axes * gradient * self.sign(), position)
    }
}

/// At most eight balls.
fn find_round(direction: &Direction, balls: &[RoundPoint], candidates: &mut Candidates) {
    let (mut centres, mut radii) = ([Vec3::ZERO; LANES], [f32::NEG_INFINITY; LANES]);
    for (i, ball) in balls.iter().enumerate() {
        (centres[i], radii[i]) = (ball.centre, ball.radius);
    }
    let spheres = Spheres { centre: of_vectors(&centres), radius: Portable::from_array(radii) };
    let mut near = direction.near::<Portable>(&spheres);
    let (mut points, mut normals, mut positions) = (centres, [Vec3::ZERO; LANES], [Vec3::ZERO; LANES]);
    let (mut separations, mut found) = ([f32::INFINITY; LANES], false);
    let mut guess = None;
    while near != 0 {
        let i = near.trailing_zeros() as usize;
        near &= near - 1;
        let centre = direction.axes * centres[i] + direction.origin;
        // The field is exact only near the surface, and the surface of the ball may be far from its centre.
        let (distance, gradient) = direction.surface.exact(centre, direction.skin.as_ref(), &mut guess);
        let motion = direction.drift + direction.spin.cross(centre);
        let separation = distance - radii[i];
        let closing = gradient.dot(motion).min(0.0);
        let meant = separation < direction.margin && separation + closing < direction.near;
        if meant && gradient.length_squared() > GRADIENT_SQUARED_MIN {
            let normal = gradient.normalize();
            points[i] = centre;
            (normals[i], positions[i]) = direction.to_world(centre, normal, radii[i] + distance);
            separations[i] = separation;
            found = true;
        }
    }
    if found {
        candidates.blocks.push(Block {
            point: of_vectors(&points),
            position: of_vectors(&positions),
            normal: of_vectors(&normals),
            separation: Portable::from_array(separations),
            left: Portable::from_array(separations),
            rough: 0,
            way: direction.way,
        });
    }
}
