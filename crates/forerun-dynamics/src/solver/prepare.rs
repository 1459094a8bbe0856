//! Prepare: from manifolds to rows. Jacobians in mass-scaled coordinates, effective masses, first guess of the impulses.

use forerun_geometry::Vec3;

use super::blocks::{Block, CentreRow, FrictionRows, Momentum, NO_CONTACT, PointRow};
use super::bodies::Bodies;
use super::load::Load;
use crate::lanes::{F8, LANES, V8, dispatched, gather};
use crate::narrow_phase::Contact;
use crate::{Material, Member};

const TINY: f32 = 1e-12;
/// Below this rise a contact has no vertical share to speak of.
const RISE_MIN: f32 = 0.2;

/// What the rows are made from.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) members: &'a [Member<'a>],
    pub(crate) contacts: &'a [Contact],
    pub(crate) loads: &'a [Load],
    pub(crate) levels: &'a [u32],
    pub(crate) up: Vec3,
    pub(crate) shock_yield: f32,
}

/// Eight contacts as plain arrays.
struct Lanes {
    normal: [[f32; LANES]; 3],
    positions: [[[f32; LANES]; 3]; 4],
    normals: [[[f32; LANES]; 3]; 4],
    separation: [[f32; LANES]; 4],
    valid: [[f32; LANES]; 4],
    total: [[f32; LANES]; 4],
    weight: [[f32; LANES]; 4],
    yields: [[f32; LANES]; 2],
    friction: [[f32; LANES]; 2],
    restitution: [f32; LANES],
}

dispatched! {
    /// Fills the rows of blocks whose indices are set.
    pub(crate) fn prepare(blocks: &mut [Block], bodies: &Bodies, source: &Source) {
        for block in blocks {
            let lanes = load_lanes(block, source);
            fill(block, &lanes, bodies, source.up);
        }
    }
}

#[inline(always)]
fn load_lanes(block: &Block, source: &Source) -> Lanes {
    let z = [0.0; LANES];
    let mut lanes = Lanes {
        normal: [z, [1.0; LANES], z],
        positions: [[z; 3]; 4],
        normals: [[z, [1.0; LANES], z]; 4],
        separation: [[1e6; LANES]; 4],
        valid: [z; 4],
        total: [z; 4],
        weight: [z; 4],
        yields: [[1.0; LANES]; 2],
        friction: [z; 2],
        restitution: z,
    };
    for lane in 0..LANES {
        let k = block.source[lane];
        if k == NO_CONTACT {
            continue;
        }
        let contact = &source.contacts[k as usize];
        let m = &contact.manifold;
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
        let (first, second) = (contact.first as usize, contact.second as usize);
        let material = combine(&source.members[first].body.material, &source.members[second].body.material);
        lanes.friction[0][lane] = material.static_friction;
        lanes.friction[1][lane] = material.friction;
        lanes.restitution[lane] = material.restitution;
        let (below, above) = (source.levels[first], source.levels[second]);
        if below < above {
            lanes.yields[0][lane] = source.shock_yield;
        } else if above < below {
            lanes.yields[1][lane] = source.shock_yield;
        }
    }
    lanes
}

/// Friction is the geometric mean, restitution the larger of the two.
fn combine(a: &Material, b: &Material) -> Material {
    Material {
        friction: (a.friction * b.friction).sqrt(),
        static_friction: (a.static_friction * b.static_friction).sqrt(),
        restitution: if a.restitution > b.restitution { a.restitution } else { b.restitution },
    }
}

/// Reads a side's body: the arm of a point becomes a mass-scaled angular Jacobian.
struct Side {
    position: V8,
    axes: [V8; 3],
    inertia: V8,
    scale: F8,
    answers: F8,
}

impl Side {
    #[inline(always)]
    fn gather(bodies: &Bodies, index: &[u32; LANES]) -> Side {
        let c = gather(&bodies.centres, index);
        let a = gather(&bodies.axes, index);
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
    fn scaled(&self, w: V8) -> V8 {
        V8 { x: self.axes[0].dot(w), y: self.axes[1].dot(w), z: self.axes[2].dot(w) }.times(self.inertia)
    }

    #[inline(always)]
    fn arm(&self, point: V8, direction: V8) -> V8 {
        self.scaled((point - self.position).cross(direction))
    }

    /// The part of J Jᵀ that this side answers for.
    #[inline(always)]
    fn k(&self, direction2: F8, arm: V8) -> F8 {
        self.answers * (self.scale * self.scale * direction2 + arm.dot(arm))
    }
}

#[inline(always)]
fn fill(block: &mut Block, lanes: &Lanes, bodies: &Bodies, up: Vec3) {
    let (a, b) = (Side::gather(bodies, &block.first), Side::gather(bodies, &block.second));
    block.first_scale = a.scale;
    block.second_scale = b.scale;
    block.first_answers = a.answers;
    block.second_answers = b.answers;
    block.first_yields = F8(lanes.yields[0]);
    block.second_yields = F8(lanes.yields[1]);
    block.restitution = F8(lanes.restitution);

    let mut count = F8::ZERO;
    let (mut mean, mut mean_normal, mut mean_a, mut mean_b) = (V8::ZERO, V8::ZERO, V8::ZERO, V8::ZERO);
    let positions = lanes.positions.map(V8::from_lanes);
    for q in 0..4 {
        let valid = F8(lanes.valid[q]);
        let normal = V8::from_lanes(lanes.normals[q]);
        let (first, second) = (a.arm(positions[q], normal), b.arm(positions[q], normal));
        let k = a.k(F8::ONE, first) + b.k(F8::ONE, second) + F8::splat(TINY);
        block.points[q] = PointRow {
            normal,
            first,
            second,
            inverse_k: valid / k,
            separation: F8(lanes.separation[q]),
            impulse: F8(lanes.total[q]),
        };
        count += valid;
        mean = mean + positions[q] * valid;
        mean_normal = mean_normal + normal * valid;
        mean_a = mean_a + first * valid;
        mean_b = mean_b + second * valid;
    }
    let inverse_count = F8::ONE / count.max(F8::ONE);
    let (normal, first, second) =
        (mean_normal * inverse_count, mean_a * inverse_count, mean_b * inverse_count);
    let length2 = normal.dot(normal);
    let k = a.k(length2, first) + b.k(length2, second) + F8::splat(TINY);
    block.centre = CentreRow { normal, first, second, inverse_k: F8::ONE / k, inverse_count };
    let centre = mean * inverse_count;
    let normal = V8::from_lanes(lanes.normal);
    fill_friction(&mut block.friction, &a, &b, normal, centre);
    block.friction.static_coefficient = F8(lanes.friction[0]);
    block.friction.kinetic_coefficient = F8(lanes.friction[1]);
    let mut radius = F8::ZERO;
    for q in 0..4 {
        radius += F8(lanes.valid[q]) * (positions[q] - centre).length();
    }
    block.friction.radius = radius * inverse_count;
    guess_friction(block, lanes, &positions, centre, up);
}

#[inline(always)]
fn fill_friction(rows: &mut FrictionRows, a: &Side, b: &Side, normal: V8, centre: V8) {
    let steep = normal.x.abs().gt(F8::splat(0.577_35));
    let across = steep.select_v(
        V8 { x: normal.y, y: -normal.x, z: F8::ZERO },
        V8 { x: F8::ZERO, y: normal.z, z: -normal.y },
    );
    let t1 = across * (F8::ONE / across.length().max(F8::splat(1e-15)));
    let t2 = normal.cross(t1);
    rows.tangents = [t1, t2];
    rows.first = [a.arm(centre, t1), a.arm(centre, t2)];
    rows.second = [b.arm(centre, t1), b.arm(centre, t2)];
    let k = |i: usize| a.k(F8::ONE, rows.first[i]) + b.k(F8::ONE, rows.second[i]);
    let (k11, k22) = (k(0), k(1));
    let k12 = a.answers * rows.first[0].dot(rows.first[1]) + b.answers * rows.second[0].dot(rows.second[1]);
    let inverse = F8::ONE / (k11 * k22 - k12 * k12 + F8::splat(1e-20));
    rows.inverse_k = [k22 * inverse, -k12 * inverse, k11 * inverse];
    rows.twist_first = a.scaled(normal);
    rows.twist_second = b.scaled(normal);
    let k = a.k(F8::ZERO, rows.twist_first) + b.k(F8::ZERO, rows.twist_second) + F8::splat(TINY);
    rows.twist_inverse_k = F8::ONE / k;
}

/// The friction that makes the guessed normal impulses add up to vertical forces, within the cone, at the loaded centre.
#[inline(always)]
fn guess_friction(block: &mut Block, lanes: &Lanes, positions: &[V8; 4], centre: V8, up: Vec3) {
    let up = V8 { x: F8::splat(up.x), y: F8::splat(up.y), z: F8::splat(up.z) };
    let normal = V8::from_lanes(lanes.normal);
    let rows = &block.friction;
    let guess = |impulses: [F8; 4]| {
        let (mut sum, mut tangential, mut loaded) = (F8::ZERO, V8::ZERO, V8::ZERO);
        for q in 0..4 {
            let n = block.points[q].normal;
            let rise = n.dot(up);
            let rises = rise.abs().gt(F8::splat(RISE_MIN));
            let vertical = rises.select(impulses[q] / rises.select(rise, F8::ONE), impulses[q] * rise);
            tangential = tangential + up * vertical - n * impulses[q];
            loaded = loaded + positions[q] * impulses[q];
            sum += impulses[q];
        }
        let (x, y) = (tangential.dot(rows.tangents[0]), tangential.dot(rows.tangents[1]));
        let length = (x * x + y * y).sqrt();
        let limit = sum * rows.kinetic_coefficient;
        let scale = limit.lt(length).select(limit / length.max(F8::splat(1e-20)), F8::ONE);
        let (x, y) = (x * scale, y * scale);
        let offset = loaded * (F8::ONE / sum.max(F8::splat(TINY))) - centre;
        let force = rows.tangents[0] * x + rows.tangents[1] * y;
        let twist = sum.gt(F8::ZERO).select(offset.cross(force).dot(normal), F8::ZERO);
        (x, y, twist)
    };
    let (total, weight) = (lanes.total.map(F8), lanes.weight.map(F8));
    let (x, y, twist) = guess(total);
    let (wx, wy, wtwist) = guess(weight);
    let mut points = [F8::ZERO; 4];
    for q in 0..4 {
        points[q] = total[q] - weight[q];
    }
    block.momentum = Momentum { points, tangents: [x - wx, y - wy], twist: twist - wtwist };
    block.friction.impulses = [x, y];
    block.friction.twist_impulse = twist;
}
