//! Prepare: from manifolds to rows. Jacobians in mass-scaled coordinates, effective masses, first guess of the impulses.

use forerun_geometry::Vec3;

use super::blocks::{Block, BlocksOf, Detail, DetailsOf, Impulses};
use super::bodies::Bodies;
use super::ends::{End, EndPair, along};
use super::manifolds::{Manifolds, Source};
use super::points::{Kind, Point, Push};
use super::sweep::coupling;
use crate::lanes::{LaneMask, Lanes, Portable, V8, dispatched, recast_mut};

const TINY: f32 = 1e-12;
/// Points this much higher than the lowest have no part in the friction. Metres.
const NEAR_M: f32 = 0.002;
/// Below this rise a contact has no vertical share to speak of.
const RISE_MIN: f32 = 0.2;

/// What all blocks have in common.
#[derive(Clone, Copy)]
pub(crate) struct Common {
    pub(crate) up: Vec3,
    pub(crate) shock_yield: f32,
    pub(crate) substep_seconds: f32,
}

dispatched! {
    /// Fills the rows of blocks whose indices are set.
    pub(crate) fn prepare<K: Kind>(
        blocks: &mut [Block<Portable, K>],
        details: &mut [Detail<Portable>],
        bodies: &Bodies,
        source: &Source,
        common: &Common,
    ) => prepare_lanes
}

#[inline(always)]
fn prepare_lanes<F: Lanes, K: Kind>(
    blocks: &mut [Block<Portable, K>],
    details: &mut [Detail<Portable>],
    bodies: &Bodies,
    source: &Source,
    common: &Common,
) {
    let blocks = recast_mut::<F, BlocksOf<K>>(blocks);
    for (block, detail) in blocks.iter_mut().zip(recast_mut::<F, DetailsOf>(details)) {
        let manifolds = Manifolds::gather::<K>(detail, source);
        let ends = EndPair {
            first: End::gather(bodies, &block.first_row, common.substep_seconds),
            second: End::gather(bodies, &block.second_row, common.substep_seconds),
        };
        let surface = ends.surface();
        detail.first_answers = ends.first.answers;
        detail.second_answers = ends.second.answers;
        detail.restitution = surface.restitution;
        detail.separation = manifolds.separation;
        ends.share_yield(detail, &manifolds, F::splat(common.shock_yield));
        let middle = Middle::of(&manifolds);
        fill_places(block, &manifolds, &ends, &middle);
        let axes = block.axes();
        let (first, second) = (&ends.first, &ends.second);
        detail.carries = [first.carry(second, middle.place, &axes), second.carry(first, middle.place, &axes)];
        let pairs = Pairs::of(block, &ends);
        fill_points(block, detail, &manifolds, &pairs, F::splat(1.0 / common.substep_seconds));
        fill_friction(block, &pairs);
        block.friction.static_coefficient = surface.static_friction;
        block.friction.kinetic_coefficient = surface.friction;
        block.friction.radius = middle.radius.max(surface.patch);
        guess(block, detail, &manifolds, &middle, common.up);
    }
}

/// The middle of the points that lie lowest: where friction acts.
struct Middle<F> {
    place: V8<F>,
    /// Mean distance of the points from it.
    radius: F,
}

impl<F: Lanes> Middle<F> {
    #[inline(always)]
    fn of(manifolds: &Manifolds<F>) -> Self {
        let mut least = F::splat(1e30);
        for q in 0..4 {
            let is_point = manifolds.valid[q].gt(F::zero());
            least = is_point.select(manifolds.separation[q], least).min(least);
        }
        // How much of the friction each point answers for.
        let mut near = [F::zero(); 4];
        let (mut place, mut total) = (V8::zero(), F::splat(TINY));
        for q in 0..4 {
            let above = (manifolds.separation[q] - least) * F::splat(1.0 / NEAR_M);
            near[q] = manifolds.valid[q] * (F::one() - above).max(F::zero());
            place = place + manifolds.positions[q] * near[q];
            total += near[q];
        }
        let share = F::one() / total;
        let place = place * share;
        let mut radius = F::zero();
        for q in 0..4 {
            radius += near[q] * (manifolds.positions[q] - place).length();
        }
        Middle { place, radius: radius * share }
    }
}

/// Axes, sides and points.
#[inline(always)]
fn fill_places<F: Lanes, K: Kind>(
    block: &mut Block<F, K>,
    manifolds: &Manifolds<F>,
    ends: &EndPair<F>,
    middle: &Middle<F>,
) {
    let normal = manifolds.normal;
    let steep = normal.x.abs().gt(F::splat(0.577_35));
    let across = steep.select_v(
        V8 { x: normal.y, y: -normal.x, z: F::zero() },
        V8 { x: F::zero(), y: normal.z, z: -normal.y },
    );
    block.normal = normal;
    block.tangent = across * (F::one() / across.length().max(F::splat(1e-15)));
    let axes = block.axes();
    block.first = ends.first.side(&ends.second, middle.place, &axes);
    block.second = ends.second.side(&ends.first, middle.place, &axes);
    for q in 0..4 {
        let is_point = manifolds.valid[q].gt(F::zero());
        let place = is_point.select_v(along(&axes, manifolds.positions[q] - middle.place), V8::zero());
        let normal = if K::NORMALS { along(&axes, manifolds.normals[q]) } else { V8::zero() };
        block.points[q] = K::Point::new(place, normal);
    }
}

/// What an impulse along one row does to the speed along another.
struct Pairs<F> {
    answers: [F; 2],
    /// Of the two sides together.
    linear: F,
    /// By side and point, and by side and row of friction: two tangents, twist.
    arms: [[V8<F>; 4]; 2],
    friction: [[V8<F>; 3]; 2],
}

impl<F: Lanes> Pairs<F> {
    #[inline(always)]
    fn of<K: Kind>(block: &Block<F, K>, ends: &EndPair<F>) -> Self {
        let answers = [ends.first.answers, ends.second.answers];
        let (sa, sb) = (ends.first.scale, ends.second.scale);
        let linear = answers[0] * (sa * sa) + answers[1] * (sb * sb);
        let mut arms = [[V8::zero(); 4]; 2];
        let mut friction = [[V8::zero(); 3]; 2];
        for s in 0..2 {
            let side = if s == 0 { &block.first } else { &block.second };
            for q in 0..4 {
                arms[s][q] = block.points[q].arm(side);
            }
            let mut tangent = [Push::none(); 2];
            tangent[0].force.x = F::one();
            tangent[1].force.y = F::one();
            friction[s] = [side.arm(&tangent[0]), side.arm(&tangent[1]), side.turns[2]];
        }
        Pairs { answers, linear, arms, friction }
    }

    #[inline(always)]
    fn angular(&self, first: (V8<F>, V8<F>), second: (V8<F>, V8<F>)) -> F {
        self.answers[0] * first.0.dot(first.1) + self.answers[1] * second.0.dot(second.1)
    }
}

#[inline(always)]
fn fill_points<F: Lanes, K: Kind>(
    block: &mut Block<F, K>,
    detail: &mut Detail<F>,
    manifolds: &Manifolds<F>,
    pairs: &Pairs<F>,
    per_second: F,
) {
    let (mut count, mut all) = (F::zero(), F::splat(TINY));
    let mut row_sums = [F::zero(); 4];
    let [a, b] = &pairs.arms;
    for p in 0..4 {
        let valid = manifolds.valid[p];
        for q in 0..p {
            let cosine =
                if K::NORMALS { block.points[p].normal().dot(block.points[q].normal()) } else { F::one() };
            let k = pairs.linear * cosine + pairs.angular((a[p], a[q]), (b[p], b[q]));
            block.coupling[coupling(p, q)] = k;
            row_sums[p] += k * manifolds.valid[q];
            row_sums[q] += k * valid;
        }
        let own = pairs.linear + pairs.angular((a[p], a[p]), (b[p], b[p])) + F::splat(TINY);
        row_sums[p] += own * valid;
        block.inverse_k[p] = valid / own;
        block.impulses[p] = manifolds.total[p];
        block.allowed[p] = manifolds.separation[p].max(F::zero()) * per_second;
        count += valid;
        let [f, g] = &pairs.friction;
        let normal = block.points[p].normal();
        for k in 0..3 {
            let linear = if K::NORMALS && k < 2 {
                pairs.linear * if k == 0 { normal.x } else { normal.y }
            } else {
                F::zero()
            };
            block.friction.drag[k][p] = linear + pairs.angular((f[k], a[p]), (g[k], b[p]));
        }
    }
    for p in 0..4 {
        all += row_sums[p] * manifolds.valid[p];
    }
    block.row_sums = row_sums;
    let has_points = count.gt(F::zero());
    block.mean_gain = has_points.select(F::one() / all, F::zero());
    detail.inverse_count = F::one() / count.max(F::one());
}

#[inline(always)]
fn fill_friction<F: Lanes, K: Kind>(block: &mut Block<F, K>, pairs: &Pairs<F>) {
    let [f, g] = &pairs.friction;
    let k11 = pairs.linear + pairs.angular((f[0], f[0]), (g[0], g[0])) + F::splat(TINY);
    let k22 = pairs.linear + pairs.angular((f[1], f[1]), (g[1], g[1])) + F::splat(TINY);
    let k12 = pairs.angular((f[0], f[1]), (g[0], g[1]));
    let inverse = F::one() / (k11 * k22 - k12 * k12 + F::splat(1e-20));
    block.friction.inverse_k = [k22 * inverse, -k12 * inverse, k11 * inverse];
    block.friction.twist_inverse_k = F::one() / (pairs.angular((f[2], f[2]), (g[2], g[2])) + F::splat(TINY));
}

/// Both first guesses of the impulses: all that the contacts carry, and the part of it that is momentum.
#[inline(always)]
fn guess<F: Lanes, K: Kind>(
    block: &mut Block<F, K>,
    detail: &mut Detail<F>,
    manifolds: &Manifolds<F>,
    middle: &Middle<F>,
    up: Vec3,
) {
    let up = V8 { x: F::splat(up.x), y: F::splat(up.y), z: F::splat(up.z) };
    let all = friction_of::<F, K>(block, manifolds, middle, up, &manifolds.total);
    block.friction.impulses = all;
    let mut points = [F::zero(); 4];
    let mut most = F::zero();
    for q in 0..4 {
        points[q] = manifolds.total[q] - manifolds.weight[q];
        most = most.max(points[q].abs());
    }
    let mut friction = [F::zero(); 3];
    if most.gt(F::zero()).any() {
        let still = friction_of::<F, K>(block, manifolds, middle, up, &manifolds.weight);
        for k in 0..3 {
            friction[k] = all[k] - still[k];
        }
    }
    detail.momentum = Impulses { points, friction };
}

/// The friction (two tangents, twist) that makes normal impulses add up to vertical forces, within the cone, at the loaded centre.
#[inline(always)]
fn friction_of<F: Lanes, K: Kind>(
    block: &Block<F, K>,
    manifolds: &Manifolds<F>,
    middle: &Middle<F>,
    up: V8<F>,
    impulses: &[F; 4],
) -> [F; 3] {
    let [t1, t2, n] = block.axes();
    let (mut sum, mut tangential, mut loaded) = (F::zero(), V8::zero(), V8::zero());
    for q in 0..4 {
        let n = if K::NORMALS { manifolds.normals[q] } else { n };
        let rise = n.dot(up);
        let rises = rise.abs().gt(F::splat(RISE_MIN));
        let per_impulse = rises.select(F::one() / rises.select(rise, F::one()), rise);
        tangential = tangential + (up * per_impulse - n) * impulses[q];
        loaded = loaded + manifolds.positions[q] * impulses[q];
        sum += impulses[q];
    }
    let slides = manifolds.slide.dot(manifolds.slide).gt(F::splat(0.5));
    let limit = sum * block.friction.kinetic_coefficient;
    let tangential = slides.select_v(manifolds.slide * limit, tangential);
    let (x, y) = (tangential.dot(t1), tangential.dot(t2));
    let length = (x * x + y * y).sqrt();
    let scale = limit.lt(length).select(limit / length.max(F::splat(1e-20)), F::one());
    let (x, y) = (x * scale, y * scale);
    let offset = loaded * (F::one() / sum.max(F::splat(TINY))) - middle.place;
    let force = t1 * x + t2 * y;
    let twist = sum.gt(F::zero()).select(offset.cross(force).dot(n), F::zero());
    [x, y, twist]
}
