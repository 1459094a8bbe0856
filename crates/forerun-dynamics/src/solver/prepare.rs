//! Prepare: from manifolds to rows. Jacobians in mass-scaled coordinates, effective masses, first guess of the impulses.

use forerun_geometry::Vec3;

use super::batch::ContactList;
use super::blocks::{Block, CentreRow, Contacts, FrictionRows, NO_CONTACT, PointRow};
use super::bodies::Bodies;
use super::load::Load;
use crate::lanes::{LANES, LaneMask, Lanes, Portable, V8, dispatched, recast};
use crate::{Material, Member};

const TINY: f32 = 1e-12;
/// Points this much higher than the lowest have no part in the friction. Metres.
const NEAR_M: f32 = 0.002;
/// A point contact twists as if it were a patch of this part of the thinner body's half thickness: a ball that spins in its place comes to stand. (A ball of
/// 0.2 m at 10 rad/s needs 16 s with friction 0.5; rolling is not hindered.)
const PATCH_PART: f32 = 0.01;
/// Below this rise a contact has no vertical share to speak of.
const RISE_MIN: f32 = 0.2;

/// What the rows are made from.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) members: &'a [Member<'a>],
    pub(crate) contacts: ContactList<'a>,
    pub(crate) loads: &'a [Load],
    pub(crate) levels: &'a [u32],
    pub(crate) up: Vec3,
    pub(crate) shock_yield: f32,
}

/// Eight contacts as plain arrays.
struct Arrays {
    normal: [[f32; LANES]; 3],
    positions: [[[f32; LANES]; 3]; 4],
    normals: [[[f32; LANES]; 3]; 4],
    separation: [[f32; LANES]; 4],
    valid: [[f32; LANES]; 4],
    total: [[f32; LANES]; 4],
    weight: [[f32; LANES]; 4],
    yields: [[f32; LANES]; 2],
    friction: [[f32; LANES]; 2],
    patch: [f32; LANES],
    restitution: [f32; LANES],
    slide: [[f32; LANES]; 3],
}

dispatched! {
    /// Fills the rows of blocks whose indices are set.
    pub(crate) fn prepare(blocks: &mut [Block<Portable>], bodies: &Bodies, source: &Source) => prepare_lanes
}

#[inline(always)]
fn prepare_lanes<F: Lanes>(blocks: &mut [Block<Portable>], bodies: &Bodies, source: &Source) {
    let blocks = recast::<F, Contacts>(blocks);
    for block in blocks {
        let lanes = load_lanes(block, source);
        fill(block, &lanes, bodies, source.up);
    }
}

#[inline(always)]
fn load_lanes<F>(block: &Block<F>, source: &Source) -> Arrays {
    let z = [0.0; LANES];
    let mut lanes = Arrays {
        normal: [z, [1.0; LANES], z],
        positions: [[z; 3]; 4],
        normals: [[z, [1.0; LANES], z]; 4],
        separation: [[1e6; LANES]; 4],
        valid: [z; 4],
        total: [z; 4],
        weight: [z; 4],
        yields: [[1.0; LANES]; 2],
        friction: [z; 2],
        patch: z,
        restitution: z,
        slide: [z; 3],
    };
    for lane in 0..LANES {
        let k = block.source[lane];
        if k == NO_CONTACT {
            continue;
        }
        let contact = &source.contacts.ends[k as usize];
        let m = source.contacts.manifold(k as usize);
        for (axis, value) in m.normal.to_array().into_iter().enumerate() {
            lanes.normal[axis][lane] = value;
        }
        for p in 0..m.count as usize {
            let point = &m.points[p];
            for axis in 0..3 {
                lanes.positions[p][axis][lane] = point.position[axis];
                lanes.normals[p][axis][lane] = point.normal[axis];
            }
            lanes.separation[p][lane] = point.separation;
            lanes.valid[p][lane] = 1.0;
            lanes.total[p][lane] = source.loads[k as usize].total[p];
            lanes.weight[p][lane] = source.loads[k as usize].weight[p];
        }
        for (axis, value) in source.loads[k as usize].slide.to_array().into_iter().enumerate() {
            lanes.slide[axis][lane] = value;
        }
        let (first, second) = (contact.first as usize, contact.second as usize);
        let material = combine(&source.members[first].body.material, &source.members[second].body.material);
        lanes.friction[0][lane] = material.static_friction;
        lanes.friction[1][lane] = material.friction;
        let thickness = |i: usize| source.members[i].body.half_thickness;
        lanes.patch[lane] = PATCH_PART * thickness(first).min(thickness(second));
        lanes.restitution[lane] = material.restitution;
        // What lies below moves less than its mass says, and never more than what lies above.
        let (low, high) = (source.levels[first], source.levels[second]);
        let inverse = [source.members[first].body.inverse_mass, source.members[second].body.inverse_mass];
        if low < high {
            lanes.yields[0][lane] = source.shock_yield * lighter_share(inverse[1], inverse[0]);
        } else if high < low {
            lanes.yields[1][lane] = source.shock_yield * lighter_share(inverse[0], inverse[1]);
        }
    }
    lanes
}

/// 1, or less where the lower body is the lighter one: the ratio of the inverse masses.
fn lighter_share(above: f32, below: f32) -> f32 {
    if above < below { above / below } else { 1.0 }
}

/// Friction is the geometric mean, restitution the larger of the two.
pub(crate) fn combine(a: &Material, b: &Material) -> Material {
    Material {
        friction: (a.friction * b.friction).sqrt(),
        static_friction: (a.static_friction * b.static_friction).sqrt(),
        restitution: if a.restitution > b.restitution { a.restitution } else { b.restitution },
    }
}

/// Reads a side's body: the arm of a point becomes a mass-scaled angular Jacobian.
struct Side<F> {
    position: V8<F>,
    axes: [V8<F>; 3],
    inertia: V8<F>,
    scale: F,
    answers: F,
}

impl<F: Lanes> Side<F> {
    #[inline(always)]
    fn gather(bodies: &Bodies, index: &[u32; LANES]) -> Self {
        let c = F::gather(&bodies.centres, index);
        let a = F::gather(&bodies.axes, index);
        let (u, v) = (V8 { x: a[0], y: a[1], z: a[2] }, V8 { x: a[3], y: a[4], z: a[5] });
        Side {
            position: V8 { x: c[0], y: c[1], z: c[2] },
            axes: [u, v, u.cross(v)],
            scale: c[3],
            inertia: V8 { x: c[4], y: c[5], z: c[6] },
            answers: c[7],
        }
    }

    /// I^(-1/2) Rᵀ w
    #[inline(always)]
    fn scaled(&self, w: V8<F>) -> V8<F> {
        V8 { x: self.axes[0].dot(w), y: self.axes[1].dot(w), z: self.axes[2].dot(w) }.times(self.inertia)
    }

    #[inline(always)]
    fn arm(&self, point: V8<F>, direction: V8<F>) -> V8<F> {
        self.scaled((point - self.position).cross(direction))
    }

    /// The part of J Jᵀ that this side answers for.
    #[inline(always)]
    fn k(&self, direction2: F, arm: V8<F>) -> F {
        self.answers * (self.scale * self.scale * direction2 + arm.dot(arm))
    }
}

#[inline(always)]
fn fill<F: Lanes>(block: &mut Block<F>, lanes: &Arrays, bodies: &Bodies, up: Vec3) {
    let (a, b) = (Side::<F>::gather(bodies, &block.first), Side::<F>::gather(bodies, &block.second));
    block.first_scale = a.scale;
    block.second_scale = b.scale;
    block.first_answers = a.answers;
    block.second_answers = b.answers;
    block.first_yields = F::from_array(lanes.yields[0]);
    block.second_yields = F::from_array(lanes.yields[1]);
    block.restitution = F::from_array(lanes.restitution);

    let mut count = F::zero();
    let (mut mean, mut mean_normal, mut mean_a, mut mean_b) =
        (V8::zero(), V8::zero(), V8::zero(), V8::zero());
    let mut positions = [V8::zero(); 4];
    for q in 0..4 {
        positions[q] = V8::from_arrays(lanes.positions[q]);
    }
    for q in 0..4 {
        let valid = F::from_array(lanes.valid[q]);
        let normal = V8::from_arrays(lanes.normals[q]);
        let (first, second) = (a.arm(positions[q], normal), b.arm(positions[q], normal));
        let k = a.k(F::one(), first) + b.k(F::one(), second) + F::splat(TINY);
        block.points[q] = PointRow {
            normal,
            first,
            second,
            inverse_k: valid / k,
            separation: F::from_array(lanes.separation[q]),
            impulse: F::from_array(lanes.total[q]),
        };
        count += valid;
        mean = mean + positions[q] * valid;
        mean_normal = mean_normal + normal * valid;
        mean_a = mean_a + first * valid;
        mean_b = mean_b + second * valid;
    }
    let inverse_count = F::one() / count.max(F::one());
    let (normal, first, second) =
        (mean_normal * inverse_count, mean_a * inverse_count, mean_b * inverse_count);
    let length2 = normal.dot(normal);
    let k = a.k(length2, first) + b.k(length2, second) + F::splat(TINY);
    block.centre = CentreRow { normal, first, second, inverse_k: F::one() / k, inverse_count };
    let near = nearness(lanes);
    let (mut centre, mut total) = (V8::zero(), F::splat(TINY));
    for q in 0..4 {
        let weight = F::from_array(near[q]);
        centre = centre + positions[q] * weight;
        total += weight;
    }
    let centre = centre * (F::one() / total);
    let normal = V8::from_arrays(lanes.normal);
    fill_friction(&mut block.friction, &a, &b, normal, centre);
    block.friction.static_coefficient = F::from_array(lanes.friction[0]);
    block.friction.kinetic_coefficient = F::from_array(lanes.friction[1]);
    let mut radius = F::zero();
    for q in 0..4 {
        radius += F::from_array(near[q]) * (positions[q] - centre).length();
    }
    block.friction.radius = (radius / total).max(F::from_array(lanes.patch));
    guess_friction(block, lanes, &positions, centre, up);
}

/// How much of the friction each point answers for: 1 for the lowest, 0 for those that are further than [`NEAR_M`] above it.
#[inline(always)]
fn nearness(lanes: &Arrays) -> [[f32; LANES]; 4] {
    let mut near = [[0.0; LANES]; 4];
    for lane in 0..LANES {
        let least = (0..4).fold(f32::INFINITY, |least, q| least.min(lanes.separation[q][lane]));
        for q in 0..4 {
            let above = lanes.separation[q][lane] - least;
            near[q][lane] = lanes.valid[q][lane] * (1.0 - above / NEAR_M).max(0.0);
        }
    }
    near
}

#[inline(always)]
fn fill_friction<F: Lanes>(
    rows: &mut FrictionRows<F>,
    a: &Side<F>,
    b: &Side<F>,
    normal: V8<F>,
    centre: V8<F>,
) {
    let steep = normal.x.abs().gt(F::splat(0.577_35));
    let across = steep.select_v(
        V8 { x: normal.y, y: -normal.x, z: F::zero() },
        V8 { x: F::zero(), y: normal.z, z: -normal.y },
    );
    let t1 = across * (F::one() / across.length().max(F::splat(1e-15)));
    let t2 = normal.cross(t1);
    rows.tangents = [t1, t2];
    rows.first = [a.arm(centre, t1), a.arm(centre, t2)];
    rows.second = [b.arm(centre, t1), b.arm(centre, t2)];
    let k11 = a.k(F::one(), rows.first[0]) + b.k(F::one(), rows.second[0]);
    let k22 = a.k(F::one(), rows.first[1]) + b.k(F::one(), rows.second[1]);
    let k12 = a.answers * rows.first[0].dot(rows.first[1]) + b.answers * rows.second[0].dot(rows.second[1]);
    let inverse = F::one() / (k11 * k22 - k12 * k12 + F::splat(1e-20));
    rows.inverse_k = [k22 * inverse, -k12 * inverse, k11 * inverse];
    rows.twist_first = a.scaled(normal);
    rows.twist_second = b.scaled(normal);
    let k = a.k(F::zero(), rows.twist_first) + b.k(F::zero(), rows.twist_second) + F::splat(TINY);
    rows.twist_inverse_k = F::one() / k;
}

/// Both first guesses of the friction: for all that the contacts carry, and the part of it that is momentum.
#[inline(always)]
fn guess_friction<F: Lanes>(
    block: &mut Block<F>,
    lanes: &Arrays,
    positions: &[V8<F>; 4],
    centre: V8<F>,
    up: Vec3,
) {
    let up = V8 { x: F::splat(up.x), y: F::splat(up.y), z: F::splat(up.z) };
    let place = Place {
        positions,
        centre,
        normal: V8::from_arrays(lanes.normal),
        up,
        slide: V8::from_arrays(lanes.slide),
    };
    let mut total = [F::zero(); 4];
    let mut weight = [F::zero(); 4];
    for q in 0..4 {
        total[q] = F::from_array(lanes.total[q]);
        weight[q] = F::from_array(lanes.weight[q]);
        block.momentum.points[q] = total[q] - weight[q];
    }
    let all = place.friction_of(block, &total);
    let still = place.friction_of(block, &weight);
    block.momentum.tangents = [all[0] - still[0], all[1] - still[1]];
    block.momentum.twist = all[2] - still[2];
    block.friction.impulses = [all[0], all[1]];
    block.friction.twist_impulse = all[2];
}

/// Where the guessed impulses act.
struct Place<'a, F> {
    positions: &'a [V8<F>; 4],
    centre: V8<F>,
    normal: V8<F>,
    up: V8<F>,
    /// Which way friction pushes the second body, where the two slide; else zero.
    slide: V8<F>,
}

impl<F: Lanes> Place<'_, F> {
    /// The friction (two tangents, twist) that makes normal impulses add up to vertical forces, within the cone, at the loaded centre.
    #[inline(always)]
    fn friction_of(&self, block: &Block<F>, impulses: &[F; 4]) -> [F; 3] {
        let rows = &block.friction;
        let (mut sum, mut tangential, mut loaded) = (F::zero(), V8::zero(), V8::zero());
        for q in 0..4 {
            let n = block.points[q].normal;
            let rise = n.dot(self.up);
            let rises = rise.abs().gt(F::splat(RISE_MIN));
            let vertical = rises.select(impulses[q] / rises.select(rise, F::one()), impulses[q] * rise);
            tangential = tangential + self.up * vertical - n * impulses[q];
            loaded = loaded + self.positions[q] * impulses[q];
            sum += impulses[q];
        }
        let slides = self.slide.dot(self.slide).gt(F::splat(0.5));
        let tangential = slides.select_v(self.slide * (sum * rows.kinetic_coefficient), tangential);
        let (x, y) = (tangential.dot(rows.tangents[0]), tangential.dot(rows.tangents[1]));
        let length = (x * x + y * y).sqrt();
        let limit = sum * rows.kinetic_coefficient;
        let scale = limit.lt(length).select(limit / length.max(F::splat(1e-20)), F::one());
        let (x, y) = (x * scale, y * scale);
        let offset = loaded * (F::one() / sum.max(F::splat(TINY))) - self.centre;
        let force = rows.tangents[0] * x + rows.tangents[1] * y;
        let twist = sum.gt(F::zero()).select(offset.cross(force).dot(self.normal), F::zero());
        [x, y, twist]
    }
}
