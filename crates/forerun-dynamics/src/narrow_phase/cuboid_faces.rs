//! Box against box: the manifold of two faces. The incident face is cut to the reference face, and four points are kept.

use forerun_geometry::{ContactPoint, Manifold, Vec3};

use super::Contact;
use super::cuboids::{Axes, Box8, TIE_M};
use crate::lanes::{LANES, LaneMask, Lanes, V8};

/// A point of the incident face in the reference face's frame.
#[derive(Clone, Copy)]
struct Candidate<F> {
    u: F,
    v: F,
    separation: F,
    /// 1 where it counts, else 0.
    valid: F,
}

impl<F: Lanes> Candidate<F> {
    #[inline(always)]
    fn none() -> Self {
        let zero = F::zero();
        Candidate { u: zero, v: zero, separation: zero, valid: zero }
    }
}

/// The face manifolds of eight pairs.
pub(super) struct Clipped {
    normal: [[f32; LANES]; 3],
    points: [[[f32; LANES]; 3]; 4],
    separation: [[f32; LANES]; 4],
    valid: [[f32; LANES]; 4],
}

impl Clipped {
    /// Appends the contact of one pair; its own normal is that of all its points.
    #[inline(always)]
    pub(super) fn push_lane(&self, lane: usize, (first, second): (u32, u32), out: &mut Vec<Contact>) {
        let normal = Vec3::new(self.normal[0][lane], self.normal[1][lane], self.normal[2][lane]);
        let blank = ContactPoint { position: Vec3::ZERO, normal, separation: 0.0 };
        let manifold = Manifold { normal, points: [blank; 4], count: 0 };
        // Filled where it stays.
        out.push(Contact { first, second, manifold });
        let Some(Contact { manifold, .. }) = out.last_mut() else { return };
        let mut count = 0;
        for k in 0..4 {
            if self.valid[k][lane] > 0.5 {
                let p = &self.points[k];
                manifold.points[count].position = Vec3::new(p[0][lane], p[1][lane], p[2][lane]);
                manifold.points[count].separation = self.separation[k][lane];
                count += 1;
            }
        }
        manifold.count = count as u32;
        if count == 0 {
            out.pop();
        }
    }
}

#[inline(always)]
pub(super) fn pick<F: Lanes>(first: F::Mask, second: F::Mask, of: [F; 3]) -> F {
    first.select(of[0], second.select(of[1], of[2]))
}

#[inline(always)]
pub(super) fn pick_v<F: Lanes>(first: F::Mask, second: F::Mask, of: [V8<F>; 3]) -> V8<F> {
    first.select_v(of[0], second.select_v(of[1], of[2]))
}

/// The reference face with its two tangent directions, and the incident face as centre and half diagonals.
struct Faces<F: Lanes> {
    /// Centre of the reference box.
    origin: V8<F>,
    normal: V8<F>,
    u: V8<F>,
    v: V8<F>,
    half_n: F,
    half_u: F,
    half_v: F,
    /// Incident face: centre and the two half edges, each as (u, v, height above the reference face).
    centre: [F; 3],
    p: [F; 3],
    q: [F; 3],
    on_second: F::Mask,
}

#[inline(always)]
fn along_each<F: Lanes>(x: V8<F>, axes: &[V8<F>; 3]) -> [F; 3] {
    [x.dot(axes[0]), x.dot(axes[1]), x.dot(axes[2])]
}

#[inline(always)]
fn choose_faces<F: Lanes>(a: &Box8<F>, b: &Box8<F>, axes: &Axes<F>) -> Faces<F> {
    let on_second = axes.face.gt(F::splat(2.5));
    let k = on_second.select(axes.face - F::splat(3.0), axes.face);
    let between = on_second.select_v(-axes.between, axes.between);
    let mut reference = [V8::zero(); 3];
    let mut incident = [V8::zero(); 3];
    let mut rh = [F::zero(); 3];
    let mut ih = [F::zero(); 3];
    for i in 0..3 {
        reference[i] = on_second.select_v(b.axes[i], a.axes[i]);
        incident[i] = on_second.select_v(a.axes[i], b.axes[i]);
        rh[i] = on_second.select(b.half[i], a.half[i]);
        ih[i] = on_second.select(a.half[i], b.half[i]);
    }
    let (k0, k1) = (k.lt(F::splat(0.5)), k.lt(F::splat(1.5)));
    let axis = pick_v(k0, k1, reference);
    let u = pick_v(k0, k1, [reference[1], reference[2], reference[0]]);
    let v = pick_v(k0, k1, [reference[2], reference[0], reference[1]]);
    let half_n = pick(k0, k1, rh);
    let normal = axis.dot(between).lt(F::zero()).select_v(-axis, axis);

    // Incident face: the one that looks most against the normal.
    let e = [normal.dot(incident[0]), normal.dot(incident[1]), normal.dot(incident[2])];
    let ae = [e[0].abs(), e[1].abs(), e[2].abs()];
    let (j0, j1) = (ae[1].le(ae[0]) & ae[2].le(ae[0]), ae[2].le(ae[1]));
    let out = pick_v(j0, j1, incident);
    let out_sign = pick(j0, j1, e).lt(F::zero()).select(F::one(), -F::one());
    let centre = between + out * (pick(j0, j1, ih) * out_sign);
    let p = pick_v(j0, j1, [incident[1], incident[2], incident[0]]) * pick(j0, j1, [ih[1], ih[2], ih[0]]);
    let q = pick_v(j0, j1, [incident[2], incident[0], incident[1]]) * pick(j0, j1, [ih[2], ih[0], ih[1]]);
    let frame = [u, v, normal];
    let mut c = along_each(centre, &frame);
    c[2] -= half_n;
    Faces {
        origin: on_second.select_v(b.centre, a.centre),
        normal,
        u,
        v,
        half_n,
        half_u: pick(k0, k1, [rh[1], rh[2], rh[0]]),
        half_v: pick(k0, k1, [rh[2], rh[0], rh[1]]),
        centre: c,
        p: along_each(p, &frame),
        q: along_each(q, &frame),
        on_second,
    }
}

impl<F: Lanes> Faces<F> {
    /// A corner of the incident face: (u, v, height).
    #[inline(always)]
    fn corner(&self, along_p: f32, along_q: f32) -> [F; 3] {
        let mut x = [F::zero(); 3];
        for k in 0..3 {
            x[k] = self.centre[k] + self.p[k] * F::splat(along_p) + self.q[k] * F::splat(along_q);
        }
        x
    }
}

impl<F: Lanes> Candidate<F> {
    /// The point at parameter `t` from `start` along `d`.
    #[inline(always)]
    fn along(start: [F; 3], d: [F; 3], t: F, valid: F) -> Self {
        Candidate { u: start[0] + d[0] * t, v: start[1] + d[1] * t, separation: start[2] + d[2] * t, valid }
    }
}

/// The four edges of the incident face cut to the reference rectangle (Liang-Barsky): two ends each.
#[inline(always)]
fn clip_edges<F: Lanes>(f: &Faces<F>, out: &mut [Candidate<F>; 12]) {
    let corners = [f.corner(-1.0, -1.0), f.corner(1.0, -1.0), f.corner(1.0, 1.0), f.corner(-1.0, 1.0)];
    for k in 0..4 {
        let (start, end) = (corners[k], corners[(k + 1) % 4]);
        let d = [end[0] - start[0], end[1] - start[1], end[2] - start[2]];
        let (mut enter, mut leave, mut outside) = (F::zero(), F::one(), F::one().lt(F::zero()));
        for (x, dx, half) in [(start[0], d[0], f.half_u), (start[1], d[1], f.half_v)] {
            let parallel = dx.abs().lt(F::splat(1e-6));
            let inverse = F::one() / parallel.select(F::one(), dx);
            let (t1, t2) = ((-half - x) * inverse, (half - x) * inverse);
            outside = outside | (parallel & x.abs().gt(half));
            enter = parallel.select(enter, enter.max(t1.min(t2)));
            leave = parallel.select(leave, leave.min(t1.max(t2)));
        }
        let valid = outside.select(F::zero(), enter.le(leave).select(F::one(), F::zero()));
        out[k] = Candidate::along(start, d, enter, valid);
        // An uncut end is the next edge's start.
        let cut = leave.lt(F::one()).select(valid, F::zero());
        out[4 + k] = Candidate::along(start, d, leave, cut);
    }
}

const DIAGONALS: [(f32, f32); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];

/// The corners of the reference rectangle that lie inside the incident face.
#[inline(always)]
fn reference_corners<F: Lanes>(f: &Faces<F>, out: &mut [Candidate<F>; 12]) {
    let det = f.p[0] * f.q[1] - f.p[1] * f.q[0];
    let regular = det.abs().gt(F::splat(1e-9));
    let inverse = F::one() / regular.select(det, F::one());
    for (k, (su, sv)) in DIAGONALS.into_iter().enumerate() {
        let (u, v) = (f.half_u * F::splat(su), f.half_v * F::splat(sv));
        let (eu, ev) = (u - f.centre[0], v - f.centre[1]);
        let alpha = (eu * f.q[1] - ev * f.q[0]) * inverse;
        let beta = (f.p[0] * ev - f.p[1] * eu) * inverse;
        let inside = regular & alpha.abs().le(F::one()) & beta.abs().le(F::one());
        let separation = f.centre[2] + alpha * f.p[2] + beta * f.q[2];
        out[8 + k] = Candidate { u, v, separation, valid: inside.select(F::one(), F::zero()) };
    }
}

/// The four directions in which the extreme points are kept: half a degree off the diagonals, or a box turned by 45 degrees on another would
/// lose a corner to a tie.
const EXTREMES: [(f32, f32); 4] = [(-0.99, -1.01), (1.01, -0.99), (0.99, 1.01), (-1.01, 0.99)];

/// Keeps of twelve candidates the extreme one along each diagonal, the deeper the better.
#[inline(always)]
pub(super) fn clip_faces<F: Lanes>(a: &Box8<F>, b: &Box8<F>, axes: &Axes<F>, margin: F) -> Clipped {
    let f = choose_faces(a, b, axes);
    let mut candidates = [Candidate::none(); 12];
    clip_edges(&f, &mut candidates);
    reference_corners(&f, &mut candidates);
    let mut chosen = [Candidate::none(); 4];
    let mut chosen_index = [F::zero(); 4];
    for (k, (su, sv)) in EXTREMES.into_iter().enumerate() {
        let (mut best_score, mut best, mut best_index) = (F::splat(-1e30), Candidate::none(), F::splat(-1.0));
        for (index, c) in candidates.iter().enumerate() {
            let usable = c.valid.gt(F::splat(0.5)) & c.separation.lt(margin);
            let score = c.u * F::splat(su) + c.v * F::splat(sv) - c.separation;
            let better = usable & score.gt(best_score + F::splat(TIE_M));
            best_score = better.select(score, best_score);
            best = Candidate {
                u: better.select(c.u, best.u),
                v: better.select(c.v, best.v),
                separation: better.select(c.separation, best.separation),
                valid: better.select(F::one(), best.valid),
            };
            best_index = better.select(F::splat(index as f32), best_index);
        }
        for &earlier in &chosen_index[..k] {
            let duplicate = (best_index - earlier).abs().lt(F::splat(0.5));
            best.valid = duplicate.select(F::zero(), best.valid);
        }
        chosen[k] = best;
        chosen_index[k] = best_index;
    }
    let normal = f.on_second.select_v(-f.normal, f.normal);
    let mut clipped = Clipped {
        normal: [normal.x.to_array(), normal.y.to_array(), normal.z.to_array()],
        points: [[[0.0; LANES]; 3]; 4],
        separation: [[0.0; LANES]; 4],
        valid: [[0.0; LANES]; 4],
    };
    for (k, c) in chosen.iter().enumerate() {
        let height = f.half_n + c.separation * F::splat(0.5);
        let p = f.origin + f.u * c.u + f.v * c.v + f.normal * height;
        clipped.points[k] = [p.x.to_array(), p.y.to_array(), p.z.to_array()];
        clipped.separation[k] = c.separation.to_array();
        clipped.valid[k] = c.valid.to_array();
    }
    clipped
}
