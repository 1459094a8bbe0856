//! Culling and look-ups: from the points of a direction to candidates for contact.

use forerun_lanes::{LANES, LaneMask, Lanes, Portable, V8, dispatched};

use super::TOUCH_PART;
use super::candidates::{Block, Candidates};
use super::directions::{Direction, Points};
use super::points::RoundPoint;
use super::ridges::Crossings;
use super::sharp::Answer;
use crate::Vec3;
use crate::sdf::eight::{normalized, of_vectors, splat, transformed};
use crate::sdf::primitive::{LookUp, Surface};
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
pub(super) struct Eight<F> {
    pub(super) points: V8<F>,
    pub(super) outwards: V8<F>,
    /// See [`Sample::facing_max`](crate::sdf::Sample::facing_max).
    pub(super) facing_max: F,
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

impl<F: Lanes> Answers<F> {
    /// Puts what is known of crossings in the place of what the surface says.
    #[inline(always)]
    fn put(&mut self, crossings: &Crossings) {
        let known = F::Mask::from_bits(crossings.known);
        self.distance = known.select(F::from_array(crossings.distance.to_array()), self.distance);
        self.normal = known.select_v(crossings.normal.form(), self.normal);
        self.doubtful &= !crossings.known;
    }
}

/// What is asked about eight points, and what the surface says to them at first.
pub(super) struct Query<'a, F> {
    /// Distances and gradients.
    pub(super) told: (F, V8<F>),
    /// The bits of the points that are meant.
    pub(super) meant: u32,
    /// The bits of those that are to be doubted.
    pub(super) doubted: u32,
    /// What is known better of crossings of edges.
    pub(super) crossings: Option<&'a Crossings>,
}

/// Appends the points of the direction that are near the surface, or will be at the end of the step.
pub(super) fn find(direction: &Direction, candidates: &mut Candidates) {
    match (direction.points, &direction.surface) {
        // Fields have a form of their own: they are what most is looked up in.
        (Points::Sharp(samples), Surface::Field(field)) => find_sharp(direction, *field, samples, candidates),
        (Points::Sharp(samples), surface) => find_sharp(direction, surface, samples, candidates),
        (Points::Round(balls), _) => {
            for chunk in balls.chunks(LANES) {
                find_round(direction, chunk, candidates);
            }
        }
    }
}

dispatched! {
    fn find_sharp<S: LookUp>(
        direction: &Direction,
        surface: &S,
        samples: &Samples,
        candidates: &mut Candidates,
    ) => find_sharp_lanes
}

#[inline(always)]
fn find_sharp_lanes<F: Lanes, S: LookUp>(
    direction: &Direction,
    surface: &S,
    samples: &Samples,
    candidates: &mut Candidates,
) {
    let Candidates { blocks, leaves, nodes, .. } = candidates;
    cull::<F, S>(direction, surface, samples, (nodes, leaves));
    for &leaf in &*leaves {
        let (leaf, meant) = samples.leaf(leaf as usize);
        let points = transformed::<F>(leaf.points.form(), &direction.axes, direction.origin);
        let limit = direction.margin + direction.blur_depth;
        let Some(told) = surface.look_up_near(points, meant, limit) else { continue };
        let outwards = transformed(leaf.normals.form(), &direction.axes, Vec3::ZERO);
        let eight = Eight { points, outwards, facing_max: F::from_array(leaf.facing_max.to_array()) };
        direction.find_eight(surface, &eight, &Query { told, meant, doubted: 0, crossings: None }, blocks);
    }
}

/// Fills the second list with the leaves that may hold points that count, by way of the first.
#[inline(always)]
fn cull<F: Lanes, S: LookUp>(
    direction: &Direction,
    surface: &S,
    samples: &Samples,
    (nodes, leaves): (&mut Vec<u32>, &mut Vec<u32>),
) {
    nodes.clear();
    if samples.node_spheres().is_empty() {
        nodes.extend(0..samples.leaf_spheres().len() as u32);
    }
    for (block, spheres) in samples.node_spheres().iter().enumerate() {
        push_bits(block, direction.near::<F, S>(surface, spheres), nodes);
    }
    leaves.clear();
    for &node in &*nodes {
        let spheres = &samples.leaf_spheres()[node as usize];
        push_bits(node as usize, direction.near::<F, S>(surface, spheres), leaves);
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
    /// Appends those of eight points that are meant and near, crossings of edges as they say themselves.
    #[inline(always)]
    pub(super) fn find_eight<F: Lanes, S: LookUp>(
        &self,
        surface: &S,
        eight: &Eight<F>,
        query: &Query<F>,
        blocks: &mut Vec<Block>,
    ) {
        let answer = self.sharpened(eight.points, query.told, query.meant);
        let mut there = self.judge(eight, answer, V8::zero(), query.meant);
        there.doubtful |= query.doubted & there.found;
        if let Some(crossings) = query.crossings {
            there.put(crossings);
        }
        if there.doubtful != 0 && self.inset > 0.0 {
            // Further inside their own surface the face that the points have come through is the nearest one even for
            // the corners of a box that stands exactly on another of the same size.
            let back = eight.outwards * F::splat(self.inset);
            let answer = self.answer_inside(surface, eight, back, there.doubtful);
            let mut inside = self.judge(eight, answer, back, there.doubtful);
            // Better than an answer that is good enough is only one without doubt.
            inside.found &= !inside.doubtful | !there.found;
            there.found &= !inside.found;
            self.push(eight, &inside, 0, blocks);
        }
        let rough = if self.blur.is_some() { 0 } else { there.found };
        self.push(eight, &there, rough, blocks);
    }

    /// What is to be made of the answers of the field to some of eight points, given `back` (metres) from them. The answers are carried
    /// to the points along the normals found.
    #[inline(always)]
    fn judge<F: Lanes>(&self, eight: &Eight<F>, answer: Answer<F>, back: V8<F>, asked: u32) -> Answers<F> {
        let Answer { distance, gradient, beside } = answer;
        let normal = normalized(gradient);
        let distance = distance + normal.dot(back);
        let facing = normal.dot(eight.outwards);
        let near = distance.lt(F::splat(self.margin));
        let mut found =
            facing.lt(eight.facing_max) & F::splat(GRADIENT_SQUARED_MIN).lt(gradient.dot(gradient));
        if !self.is_slow() {
            let closing = self.closing_at(eight.points, normal);
            found = found & (distance + closing).lt(F::splat(self.near));
        }
        let well = facing.lt(F::splat(FACING_WELL)).bits();
        let doubtful =
            (near & distance.lt(F::splat(TOUCH_PART * self.near))).bits() & asked & (beside | !well);
        Answers { distance, normal, found: (near & found).bits() & asked, doubtful }
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
            rough &= !flat.bits();
        }
        let found = F::Mask::from_bits(answers.found);
        let midpoint = eight.points - normal * (F::splat(0.5) * answers.distance);
        let left = found.select(answers.distance, F::splat(f32::INFINITY));
        let in_world = transformed(normal, &self.field_axes, Vec3::ZERO) * F::splat(self.sign());
        blocks.push(Block {
            point: eight.points.form(),
            position: transformed(midpoint, &self.field_axes, self.field_position).form(),
            normal: in_world.form(),
            separation: Portable::from_array(answers.distance.to_array()),
            left: Portable::from_array(left.to_array()),
            rough,
            way: self.way,
        });
    }

    /// The bits of the spheres that may hold points that count.
    #[inline(always)]
    pub(super) fn near<F: Lanes, S: LookUp>(&self, surface: &S, spheres: &Spheres) -> u32 {
        let radii = F::from_array(spheres.radius.to_array());
        let centres = transformed(spheres.centre.form::<F>(), &self.axes, self.origin);
        let (middles, way) = if self.is_slow() { (centres, F::zero()) } else { self.swept(centres, radii) };
        let reach = radii + way + F::splat(self.near + self.blur_depth);
        surface.lower_bound(middles).lt(reach).bits()
    }

    /// Where the middles of balls are halfway, and how far the balls may be from there. Metres.
    ///
    /// Either body may be stopped by others: seen from the surface, a ball ends up anywhere in the parallelogram of its own motion and, backwards,
    /// that of the surface.
    #[inline(always)]
    fn swept<F: Lanes>(&self, centres: V8<F>, radii: F) -> (V8<F>, F) {
        let (goes, comes) = (self.goes.at(centres), self.comes.at(centres));
        let (relative, sum) = (goes - comes, goes + comes);
        let diagonal = relative.dot(relative).max(sum.dot(sum)).sqrt();
        let turned = radii * F::splat(self.goes.turn() + self.comes.turn());
        (centres + relative * F::splat(0.5), diagonal * F::splat(0.5) + turned)
    }

    /// How near to the surface points of balls must be to count. Metres.
    #[inline(always)]
    pub(super) fn reach<F: Lanes>(&self, centres: V8<F>, radii: F) -> F {
        let motion = self.goes.at_most(centres, radii) + self.comes.at_most(centres, radii);
        (motion + F::splat(self.near)).min(F::splat(self.margin))
    }

    /// How much nearer points may come to the surface, or it to them: 0 or less. Metres.
    ///
    /// Not only by their relative motion: of two bodies that fall together one may be stopped, and the other comes on.
    #[inline(always)]
    fn closing_at<F: Lanes>(&self, points: V8<F>, normals: V8<F>) -> F {
        let (goes, comes) = (self.goes.at(points), self.comes.at(points));
        let relative = goes - comes;
        let (away, along) = (-normals.dot(comes), normals.dot(goes));
        let closing =
            along.min(F::zero()) + away.min(F::zero()) - relative.dot(relative) * F::splat(self.bend);
        // No nearer than both together go.
        closing.max(-(goes.length() + comes.length()))
    }

    /// The normal in the world of a point with the given gradient, and the point half of `way` (metres) against the gradient from it.
    #[inline]
    pub(super) fn placed_in_world(&self, point: Vec3, gradient: Vec3, way: f32) -> (Vec3, Vec3) {
        let midpoint = point - gradient * (0.5 * way);
        let position = self.field_axes * midpoint + self.field_position;
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
    let mut near = direction.near::<Portable, _>(&direction.surface, &spheres);
    let (mut points, mut normals, mut positions) = (centres, [Vec3::ZERO; LANES], [Vec3::ZERO; LANES]);
    let (mut separations, mut found) = ([f32::INFINITY; LANES], false);
    let mut guess = None;
    while near != 0 {
        let i = near.trailing_zeros() as usize;
        near &= near - 1;
        let centre = direction.axes * centres[i] + direction.origin;
        // The field is exact only near the surface, and the surface of the ball may be far from its centre.
        let (distance, gradient) = direction.surface.exact(centre, direction.skin.as_ref(), &mut guess);
        let separation = distance - radii[i];
        let closing = direction.closing_at::<Portable>(splat(centre), splat(gradient)).to_array()[0];
        let meant = separation < direction.margin && separation + closing < direction.near;
        if meant && gradient.length_squared() > GRADIENT_SQUARED_MIN {
            let normal = gradient.normalize();
            points[i] = centre;
            (normals[i], positions[i]) = direction.placed_in_world(centre, normal, radii[i] + distance);
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
