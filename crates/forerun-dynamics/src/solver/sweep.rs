//! Sweep: one pass of sequential impulses over the blocks, in level order (Gauss-Seidel).

use super::blocks::{Block, Contacts, PointRow};
use super::collisions::Moving;
use crate::lanes::{
    LaneMask, Lanes, Portable, Row, Twist8, V8, dispatched, gather_twist, recast, scatter_twist,
};

/// The two bodies of eight contacts, with the impulses applied so far.
pub(crate) struct Sides<F> {
    pub(crate) first: Twist8<F>,
    pub(crate) second: Twist8<F>,
}

/// A row of the Jacobian: one direction at one point.
#[derive(Clone, Copy)]
pub(crate) struct Jacobian<F> {
    pub(crate) direction: V8<F>,
    pub(crate) first: V8<F>,
    pub(crate) second: V8<F>,
}

impl<F: Lanes> PointRow<F> {
    #[inline(always)]
    pub(crate) fn jacobian(&self) -> Jacobian<F> {
        Jacobian { direction: self.normal, first: self.first, second: self.second }
    }
}

impl<F: Lanes> Block<F> {
    #[inline(always)]
    pub(crate) fn centre_jacobian(&self) -> Jacobian<F> {
        Jacobian { direction: self.centre.normal, first: self.centre.first, second: self.centre.second }
    }

    #[inline(always)]
    pub(crate) fn tangent_jacobian(&self, i: usize) -> Jacobian<F> {
        let f = &self.friction;
        Jacobian { direction: f.tangents[i], first: f.first[i], second: f.second[i] }
    }

    /// 0 in every component: the twist has no linear part.
    #[inline(always)]
    pub(crate) fn twist_jacobian(&self) -> Jacobian<F> {
        let f = &self.friction;
        Jacobian { direction: V8::zero(), first: f.twist_first, second: f.twist_second }
    }
}

impl<F: Lanes> Sides<F> {
    #[inline(always)]
    pub(crate) fn gather(block: &Block<F>, rows: &[Row]) -> Self {
        Sides { first: gather_twist(rows, &block.first), second: gather_twist(rows, &block.second) }
    }

    #[inline(always)]
    pub(crate) fn scatter(&self, block: &Block<F>, rows: &mut [Row]) {
        scatter_twist(rows, &block.first_out, &self.first);
        scatter_twist(rows, &block.second_out, &self.second);
    }

    /// How fast the second side moves away from the first along a row.
    #[inline(always)]
    pub(crate) fn along(&self, block: &Block<F>, row: &Jacobian<F>) -> F {
        row.direction.dot(self.second.linear) * block.second_scale
            - row.direction.dot(self.first.linear) * block.first_scale
            + row.second.dot(self.second.angular)
            - row.first.dot(self.first.angular)
    }

    /// Applies an impulse along a row, scaled by each side's factor.
    #[inline(always)]
    pub(crate) fn push(&mut self, block: &Block<F>, row: &Jacobian<F>, impulses: (F, F)) {
        let (on_first, on_second) = impulses;
        self.first.linear = self.first.linear - row.direction * (block.first_scale * on_first);
        self.first.angular = self.first.angular - row.first * on_first;
        self.second.linear = self.second.linear + row.direction * (block.second_scale * on_second);
        self.second.angular = self.second.angular + row.second * on_second;
    }

    /// Applies an impulse along a row to the sides that impulses move.
    #[inline(always)]
    pub(crate) fn apply(&mut self, block: &Block<F>, row: &Jacobian<F>, impulse: F) {
        self.push(block, row, (impulse * block.first_answers, impulse * block.second_answers));
    }
}

/// Faster than anything approaches. m/s
const FREE_APPROACH: f32 = 1e6;

dispatched! {
    /// One sweep over all blocks. A gap may close within the substep but not more; overlap is left to the shock propagation.
    pub(crate) fn sweep(
        blocks: &mut [Block<Portable>],
        velocities: &mut [Row],
        displacements: &[Row],
        substep_seconds: f32,
    ) => solve_lanes
}

dispatched! {
    /// The last sweep of a substep, after the bodies have moved.
    ///
    /// Where there are bounces, an open point of a contact that may bounce is left alone when it approaches faster than what rests: the next
    /// substep's collision is to see it.
    pub(crate) fn relax(blocks: &mut [Block<Portable>], moving: &mut Moving, bounces: bool) => relax_lanes
}

#[inline(always)]
fn solve_lanes<F: Lanes>(
    blocks: &mut [Block<Portable>],
    velocities: &mut [Row],
    displacements: &[Row],
    substep_seconds: f32,
) {
    let blocks = recast::<F, Contacts>(blocks);
    let per_second = F::splat(1.0 / substep_seconds);
    for block in blocks {
        let mut v = Sides::gather(block, velocities);
        let moved = Sides::gather(block, displacements);
        let allowed = allowed(block, &moved, per_second);
        let sum = normals(block, &mut v, &allowed);
        friction(block, &mut v, sum);
        v.scatter(block, velocities);
    }
}

#[inline(always)]
fn relax_lanes<F: Lanes>(blocks: &mut [Block<Portable>], moving: &mut Moving, bounces: bool) {
    let blocks = recast::<F, Contacts>(blocks);
    let per_second = F::splat(1.0 / moving.substep_seconds);
    for block in blocks {
        let mut v = Sides::gather(block, moving.velocities);
        let moved = Sides::gather(block, moving.displacements);
        let mut allowed = allowed(block, &moved, per_second);
        if bounces {
            let kick = Sides::gather(block, moving.kicks);
            spare(block, &v, &kick, &mut allowed, F::splat(moving.substeps));
        }
        let sum = normals(block, &mut v, &allowed);
        friction(block, &mut v, sum);
        v.scatter(block, moving.velocities);
    }
}

/// How fast each point may approach: so that its gap closes and no more.
#[inline(always)]
fn allowed<F: Lanes>(block: &Block<F>, moved: &Sides<F>, per_second: F) -> [F; 4] {
    let mut allowed = [F::zero(); 4];
    for q in 0..4 {
        let point = &block.points[q];
        let gap = point.separation + moved.along(block, &point.jacobian());
        allowed[q] = gap.max(F::zero()) * per_second;
    }
    allowed
}

/// Lets the open points of contacts that may bounce approach as they will, if they are faster than what rests.
#[inline(always)]
fn spare<F: Lanes>(block: &Block<F>, v: &Sides<F>, kick: &Sides<F>, allowed: &mut [F; 4], substeps: F) {
    for q in 0..4 {
        let point = &block.points[q];
        let row = point.jacobian();
        let fall = (-kick.along(block, &row)).max(F::zero()) * substeps;
        let open = allowed[q].gt(F::zero()) & point.impulse.le(F::zero()) & block.restitution.gt(F::zero());
        let fast = v.along(block, &row).lt(-fall);
        allowed[q] = (open & fast).select(F::splat(FREE_APPROACH), allowed[q]);
    }
}

/// Centre row, then the points. Normals before friction: the other order keeps a sliding block flatter, and lets rough pyramids of sixty
/// rows drift by a third of a metre (measured). Returns the sum of the normal impulses.
#[inline(always)]
fn normals<F: Lanes>(block: &mut Block<F>, v: &mut Sides<F>, allowed: &[F; 4]) -> F {
    let (mut allowed_sum, mut least) = (F::zero(), F::splat(1e30));
    for q in 0..4 {
        let point = &block.points[q];
        let is_point = point.inverse_k.gt(F::zero());
        allowed_sum += is_point.select(allowed[q], F::zero());
        least = is_point.select(least.min(point.impulse), least);
    }
    let row = block.centre_jacobian();
    let centre = &block.centre;
    let approach = v.along(block, &row) + allowed_sum * centre.inverse_count;
    let share = (-(centre.inverse_k * approach) * centre.inverse_count).max(-least);
    let has_points = centre.inverse_count.gt(F::zero());
    let share = has_points.select(share, F::zero());
    let mut count = F::zero();
    for point in &mut block.points {
        let is_point = point.inverse_k.gt(F::zero());
        point.impulse = is_point.select(point.impulse + share, point.impulse);
        count += is_point.select(F::one(), F::zero());
    }
    v.apply(block, &row, share * count);

    let mut sum = F::zero();
    for q in 0..4 {
        let point = block.points[q];
        let row = point.jacobian();
        let wanted = point.impulse - point.inverse_k * (v.along(block, &row) + allowed[q]);
        let impulse = wanted.max(F::zero());
        block.points[q].impulse = impulse;
        sum += impulse;
        v.apply(block, &row, impulse - point.impulse);
    }
    sum
}

/// Friction of a contact whose normal impulses sum to `sum`: a circular cone for the tangents, its own limit for the twist.
#[inline(always)]
pub(crate) fn friction<F: Lanes>(block: &mut Block<F>, v: &mut Sides<F>, sum: F) {
    let (t1, t2, twist) = (block.tangent_jacobian(0), block.tangent_jacobian(1), block.twist_jacobian());
    let f = &block.friction;
    let (v1, v2) = (v.along(block, &t1), v.along(block, &t2));
    let [k11, k12, k22] = f.inverse_k;
    let (x, y) = (f.impulses[0] - (k11 * v1 + k12 * v2), f.impulses[1] - (k12 * v1 + k22 * v2));
    let length = (x * x + y * y).sqrt();
    let (sticks, slides) = (sum * f.static_coefficient, sum * f.kinetic_coefficient);
    let scale = sticks.lt(length).select(slides / length.max(F::splat(1e-20)), F::one());
    // Where nothing presses nothing rubs, also where the squares above are too small for a number: a contact that does not collide must not
    // notice that another one in its block does.
    let scale = sum.gt(F::zero()).select(scale, F::zero());
    let (x, y) = (x * scale, y * scale);
    let (dx, dy) = (x - f.impulses[0], y - f.impulses[1]);

    let spin = f.twist_impulse - f.twist_inverse_k * v.along(block, &twist);
    let limit = slides * f.radius;
    let spin = spin.max(-limit).min(limit);
    let dspin = spin - f.twist_impulse;
    block.friction.impulses = [x, y];
    block.friction.twist_impulse = spin;
    v.apply(block, &t1, dx);
    v.apply(block, &t2, dy);
    v.apply(block, &twist, dspin);
}
