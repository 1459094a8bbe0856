//! Sweep: one pass of sequential impulses over the blocks, in level order (Gauss-Seidel).
//!
//! What the rows of one contact do to each other is known beforehand, so that the bodies are read once, and pushed once by all rows together.

use std::cell::Cell;

use super::blocks::{Block, BlocksOf, Detail, DetailsOf, Friction};
use super::collisions::Ahead;
use super::points::{Kind, Point, Relative, sum, weighted};
use super::sides::Sides;
use crate::lanes::{LaneMask, Lanes, Portable, Row, V8, dispatched, recast, recast_mut};

/// Faster than anything approaches. m/s
const FREE_APPROACH: f32 = 1e6;

dispatched! {
    /// One sweep over all blocks. A gap may close within the substep but not more; overlap is left to the shock propagation.
    pub(crate) fn sweep<K: Kind>(blocks: &mut [Block<Portable, K>], velocities: &[Cell<Row>]) => sweep_lanes
}

/// What limits the friction of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Law {
    /// What presses (Coulomb).
    Coulomb,
    /// The same cone, but friction that wants more than it has presses the bodies together: as if they could slide only by parting. Sweeps by this
    /// law come to the one least kinetic energy, which is none wherever any forces within the cones keep the bodies in place (Anitescu 2006); by
    /// Coulomb's they may end with an arch that slips, though it could stand.
    Cone,
}

dispatched! {
    /// A sweep down and one up, so that the two together are symmetric. Gaps as in [`sweep`].
    pub(crate) fn sweep_both_ways<K: Kind>(
        blocks: &mut [Block<Portable, K>],
        velocities: &[Cell<Row>],
        law: Law,
    ) => both_ways_lanes
}

dispatched! {
    /// The last sweep of a substep, after the bodies have moved: finds anew how fast each point may approach.
    ///
    /// Where there are bounces, an open point of a contact that may bounce is left alone when it approaches faster than what rests: the next
    /// substep's collision is to see it.
    pub(crate) fn relax<K: Kind>(
        blocks: &mut [Block<Portable, K>],
        details: &[Detail<Portable>],
        velocities: &[Cell<Row>],
        ahead: &Ahead,
        least_gap: &mut f32,
    ) => relax_lanes
}

#[inline(always)]
fn sweep_lanes<F: Lanes, K: Kind>(blocks: &mut [Block<Portable, K>], velocities: &[Cell<Row>]) {
    for block in recast_mut::<F, BlocksOf<K>>(blocks) {
        let mut v = Sides::gather(block, velocities);
        let allowed = block.allowed;
        solve(block, &mut v, &allowed, Law::Coulomb);
        v.scatter(block, velocities);
    }
}

#[inline(always)]
fn both_ways_lanes<F: Lanes, K: Kind>(blocks: &mut [Block<Portable, K>], velocities: &[Cell<Row>], law: Law) {
    let blocks = recast_mut::<F, BlocksOf<K>>(blocks);
    let count = blocks.len();
    for k in 0..2 * count {
        let block = &mut blocks[if k < count { count - 1 - k } else { k - count }];
        let mut v = Sides::gather(block, velocities);
        let allowed = block.allowed;
        solve(block, &mut v, &allowed, law);
        v.scatter(block, velocities);
    }
}

#[inline(always)]
fn relax_lanes<F: Lanes, K: Kind>(
    blocks: &mut [Block<Portable, K>],
    details: &[Detail<Portable>],
    velocities: &[Cell<Row>],
    ahead: &Ahead,
    least_gap: &mut f32,
) {
    let blocks = recast_mut::<F, BlocksOf<K>>(blocks);
    let per_second = F::splat(1.0 / ahead.substep_seconds);
    let mut least = F::splat(f32::MAX);
    for (block, detail) in blocks.iter_mut().zip(recast::<F, DetailsOf>(details)) {
        if ahead.carries {
            block.first.offset = turned(block.first.offset, detail.carries[0]);
            block.second.offset = turned(block.second.offset, detail.carries[1]);
        }
        let mut v = Sides::gather(block, velocities);
        let moved = Sides::gather_still(block, ahead.displacements).relative(block);
        for q in 0..4 {
            let gap = detail.separation[q] + block.points[q].speed(&moved);
            block.allowed[q] = gap.max(F::zero()) * per_second;
            least = block.is_point(q).select(gap, least).min(least);
        }
        let mut allowed = block.allowed;
        if ahead.bounces {
            spare(block, detail, &v, ahead, &mut allowed);
        }
        solve(block, &mut v, &allowed, Law::Coulomb);
        v.scatter(block, velocities);
    }
    for gap in least.to_array() {
        *least_gap = least_gap.min(gap);
    }
}

/// The arm of a contact after a substep. Where nothing turns it keeps its bits, whoever shares the batch.
#[inline(always)]
fn turned<F: Lanes>(offset: V8<F>, carry: V8<F>) -> V8<F> {
    let (turned, zero) = (offset + carry, F::zero());
    V8 {
        x: carry.x.abs().gt(zero).select(turned.x, offset.x),
        y: carry.y.abs().gt(zero).select(turned.y, offset.y),
        z: carry.z.abs().gt(zero).select(turned.z, offset.z),
    }
}

/// Lets the open points of contacts that may bounce approach as they will, if they are faster than what rests.
#[inline(always)]
fn spare<F: Lanes, K: Kind>(
    block: &Block<F, K>,
    detail: &Detail<F>,
    v: &Sides<F>,
    ahead: &Ahead,
    allowed: &mut [F; 4],
) {
    let bounces = detail.restitution.gt(F::zero());
    if !bounces.any() {
        return;
    }
    let relative = v.relative(block);
    let kick = Sides::gather_still(block, ahead.kicks).relative(block);
    for q in 0..4 {
        let point = &block.points[q];
        let fall = (-point.speed(&kick)).max(F::zero()) * F::splat(ahead.substeps);
        let open = allowed[q].gt(F::zero()) & block.impulses[q].le(F::zero()) & bounces;
        let fast = point.speed(&relative).lt(-fall);
        allowed[q] = (open & fast).select(F::splat(FREE_APPROACH), allowed[q]);
    }
}

/// All points together, then one by one, then friction. Normals before friction: the other order keeps a sliding block flatter, and lets rough
/// pyramids of sixty rows drift by a third of a metre (measured).
#[inline(always)]
fn solve<F: Lanes, K: Kind>(block: &mut Block<F, K>, v: &mut Sides<F>, allowed: &[F; 4], law: Law) {
    let relative = v.relative(block);
    let mut closing = [F::zero(); 4];
    for q in 0..4 {
        closing[q] = block.points[q].speed(&relative) + allowed[q];
    }
    let before = block.impulses;
    together(block, &mut closing);
    one_by_one(block, &mut closing);

    let mut changes = [F::zero(); 4];
    for q in 0..4 {
        changes[q] = block.impulses[q] - before[q];
    }
    let mut slip = self::slip(block, &relative, &changes);
    let mut sum = self::sum(&block.impulses);
    if law == Law::Cone {
        let share = wedge(block, &slip, sum);
        for q in 0..4 {
            let share = block.is_point(q).select(share, F::zero());
            block.impulses[q] += share;
            changes[q] += share;
        }
        slip = self::slip(block, &relative, &changes);
        sum = self::sum(&block.impulses);
    }
    let rubbed = friction(&block.friction, &slip, sum, &block.friction.impulses);
    let old = block.friction.impulses;
    let mut push = Point::push(&block.points, &changes);
    push.rub([rubbed[0] - old[0], rubbed[1] - old[1]], rubbed[2] - old[2]);
    block.friction.impulses = rubbed;
    v.push(block, &push);
}

/// By how much all points alike are to be pressed because the friction lacks it, up to where more would cost more energy than the friction takes.
#[inline(always)]
fn wedge<F: Lanes, K: Kind>(block: &Block<F, K>, slip: &[F; 3], sum: F) -> F {
    let rows = &block.friction;
    let [k11, k12, k22] = rows.inverse_k;
    let old = &rows.impulses;
    let (x, y) = (old[0] - (k11 * slip[0] + k12 * slip[1]), old[1] - (k12 * slip[0] + k22 * slip[1]));
    let lacking = ((x * x + y * y).sqrt() - sum * rows.kinetic_coefficient).max(F::zero());
    let mut count = F::zero();
    for q in 0..4 {
        count += block.is_point(q).select(F::one(), F::zero());
    }
    // Least s² / 2 g + (lacking - c s)² / 2 k, with g the gain of the mean row and k that of the friction.
    let (c, k) = (rows.kinetic_coefficient * count, F::splat(0.5) * (k11 + k22));
    let share = block.mean_gain * c * lacking / (k + block.mean_gain * c * c).max(F::splat(1e-20));
    sum.gt(F::zero()).select(share, F::zero())
}

/// How a contact slips along its tangents and twists about its normal, after such impulses at its points.
#[inline(always)]
pub(crate) fn slip<F: Lanes, K: Kind>(
    block: &Block<F, K>,
    relative: &Relative<F>,
    impulses: &[F; 4],
) -> [F; 3] {
    let [x, y, twist] = &block.friction.drag;
    [
        relative.linear.x + weighted(x, impulses),
        relative.linear.y + weighted(y, impulses),
        relative.angular.z + weighted(twist, impulses),
    ]
}

/// The mean of the points as one row: the same impulse at each, down to none at the least loaded. Converges faster than the points alone.
#[inline(always)]
fn together<F: Lanes, K: Kind>(block: &mut Block<F, K>, closing: &mut [F; 4]) {
    let (mut own, mut least) = ([F::zero(); 4], [F::zero(); 4]);
    for q in 0..4 {
        let is_point = block.is_point(q);
        own[q] = is_point.select(closing[q], F::zero());
        least[q] = is_point.select(block.impulses[q], F::splat(1e30));
    }
    let least = least[0].min(least[1]).min(least[2].min(least[3]));
    let share = (-(block.mean_gain * sum(&own))).max(-least);
    for q in 0..4 {
        block.impulses[q] += block.is_point(q).select(share, F::zero());
        closing[q] += block.row_sums[q] * share;
    }
}

/// Each point in turn, down to no impulse.
#[inline(always)]
fn one_by_one<F: Lanes, K: Kind>(block: &mut Block<F, K>, closing: &mut [F; 4]) {
    for q in 0..4 {
        let old = block.impulses[q];
        let impulse = (old - block.inverse_k[q] * closing[q]).max(F::zero());
        block.impulses[q] = impulse;
        for p in q + 1..4 {
            closing[p] += block.coupling[coupling(p, q)] * (impulse - old);
        }
    }
}

/// Where [`Block::coupling`] has the effect of two different points on each other.
#[inline(always)]
pub(crate) fn coupling(p: usize, q: usize) -> usize {
    let (low, high) = if p < q { (p, q) } else { (q, p) };
    high * (high - 1) / 2 + low
}

/// Friction of a contact that slips so along its tangents and about its normal, whose normal impulses sum to `sum`: a circular cone for the tangents,
/// its own limit for the twist.
#[inline(always)]
pub(crate) fn friction<F: Lanes>(rows: &Friction<F>, slip: &[F; 3], sum: F, old: &[F; 3]) -> [F; 3] {
    let [k11, k12, k22] = rows.inverse_k;
    let (x, y) = (old[0] - (k11 * slip[0] + k12 * slip[1]), old[1] - (k12 * slip[0] + k22 * slip[1]));
    let length = (x * x + y * y).sqrt();
    let (sticks, slides) = (sum * rows.static_coefficient, sum * rows.kinetic_coefficient);
    let scale = sticks.lt(length).select(slides / length.max(F::splat(1e-20)), F::one());
    // Where nothing presses nothing rubs, also where the squares above are too small for a number: a contact that does not collide must not
    // notice that another one in its block does.
    let presses = sum.gt(F::zero());
    let limit = slides * rows.radius;
    let spin = (old[2] - rows.twist_inverse_k * slip[2]).max(-limit).min(limit);
    [presses.select(x * scale, F::zero()), presses.select(y * scale, F::zero()), spin]
}
