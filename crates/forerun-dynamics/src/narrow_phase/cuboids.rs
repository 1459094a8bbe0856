//! Box against box, eight pairs at a time: separating axes, then face clipping, without branches.
//!
//! Faces are preferred to edges and the first box's faces to the second's by fixed lengths. This takes the place of the hysteresis
//! that other engines keep from step to step: a stack at rest gets the same manifold in every step.

use forerun_geometry::{ContactPoint, Manifold, Pose, Vec3};

use crate::lanes::{LANES, LaneMask, Lanes, Row, V8, dispatched};

/// An edge-edge axis must separate by this much more than the best face. Metres.
const FACE_PREFERENCE_M: f32 = 4e-3;
/// A face of the second box must separate by this much more than the best of the first. Metres.
const FIRST_BOX_PREFERENCE_M: f32 = 1e-3;
/// Of candidates that are equal up to this, the earlier one wins. Metres.
const TIE_M: f32 = 1e-5;

/// Boxes in the form that the lanes gather: centre and half extents, and two of the axes.
#[derive(Debug, Default)]
pub(super) struct Boxes {
    centres: Vec<Row>,
    axes: Vec<Row>,
}

/// A pair of boxes to be tested.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxPair {
    /// Where in the list of all pairs it stands.
    pub(super) slot: u32,
    pub(super) first: u32,
    pub(super) second: u32,
    pub(super) margin: f32,
}

impl Boxes {
    /// Adds a box and returns its index.
    pub(super) fn push(&mut self, half_extents: Vec3, pose: &Pose) -> u32 {
        let (p, h, m) = (pose.position, half_extents, pose.axes());
        let (u, v) = (m.x_axis, m.y_axis);
        self.centres.push(Row([p.x, p.y, p.z, h.x, h.y, h.z, 0.0, 0.0]));
        self.axes.push(Row([u.x, u.y, u.z, v.x, v.y, v.z, 0.0, 0.0]));
        self.centres.len() as u32 - 1
    }
}

/// Eight boxes.
struct Box8<F: Lanes> {
    centre: V8<F>,
    half: [F; 3],
    axes: [V8<F>; 3],
}

impl<F: Lanes> Box8<F> {
    #[inline(always)]
    fn gather(boxes: &Boxes, index: &[u32; LANES]) -> Self {
        let c = F::gather(&boxes.centres, index);
        let a = F::gather(&boxes.axes, index);
        let (u, v) = (V8 { x: a[0], y: a[1], z: a[2] }, V8 { x: a[3], y: a[4], z: a[5] });
        Box8 { centre: V8 { x: c[0], y: c[1], z: c[2] }, half: [c[3], c[4], c[5]], axes: [u, v, u.cross(v)] }
    }
}

dispatched! {
    /// Appends the manifold of every pair that comes nearer than its margin, with the pair's slot, in the pairs' order.
    pub(super) fn cuboid_manifolds(
        boxes: &Boxes,
        pairs: &[BoxPair],
        out: &mut Vec<(u32, Manifold)>,
    ) => cuboid_lanes
}

#[inline(always)]
fn cuboid_lanes<F: Lanes>(boxes: &Boxes, pairs: &[BoxPair], out: &mut Vec<(u32, Manifold)>) {
    for chunk in pairs.chunks(LANES) {
        let mut first = [chunk[0].first; LANES];
        let mut second = [chunk[0].second; LANES];
        let mut margin = [f32::MIN; LANES];
        for (lane, pair) in chunk.iter().enumerate() {
            first[lane] = pair.first;
            second[lane] = pair.second;
            margin[lane] = pair.margin;
        }
        let (a, b) = (Box8::gather(boxes, &first), Box8::gather(boxes, &second));
        manifolds_of_eight(&a, &b, F::from_array(margin), chunk, out);
    }
}

#[inline(always)]
fn manifolds_of_eight<F: Lanes>(
    a: &Box8<F>,
    b: &Box8<F>,
    margin: F,
    chunk: &[BoxPair],
    out: &mut Vec<(u32, Manifold)>,
) {
    let axes = separating_axes(a, b);
    let near = axes.separation.lt(margin).bits();
    if near == 0 {
        return;
    }
    let by_edge = axes.use_edge.bits();
    let clipped = clip_faces(a, b, &axes, margin);
    for (lane, pair) in chunk.iter().enumerate() {
        if near >> lane & 1 == 0 {
            continue;
        }
        let manifold = if by_edge >> lane & 1 == 1 {
            edge_manifold(&lane_box(a, lane), &lane_box(b, lane), axes.edge.to_array()[lane] as usize)
        } else {
            clipped.lane(lane)
        };
        if manifold.count > 0 {
            out.push((pair.slot, manifold));
        }
    }
}

/// The axis of least overlap per lane.
struct Axes<F: Lanes> {
    /// 0 to 2: a face of the first box; 3 to 5: of the second.
    face: F,
    /// `3 i + j`: edge direction `i` of the first with `j` of the second.
    edge: F,
    use_edge: F::Mask,
    separation: F,
    /// From the first centre to the second.
    between: V8<F>,
}

#[inline(always)]
fn separating_axes<F: Lanes>(a: &Box8<F>, b: &Box8<F>) -> Axes<F> {
    let between = b.centre - a.centre;
    let ta = a.axes.map(|axis| between.dot(axis));
    let tb = b.axes.map(|axis| between.dot(axis));
    let mut c = [[F::zero(); 3]; 3];
    let mut ac = [[F::zero(); 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            c[i][j] = a.axes[i].dot(b.axes[j]);
            ac[i][j] = c[i][j].abs();
        }
    }
    let mut faces = [F::zero(); 6];
    for i in 0..3 {
        faces[i] =
            ta[i].abs() - (a.half[i] + b.half[0] * ac[i][0] + b.half[1] * ac[i][1] + b.half[2] * ac[i][2]);
        faces[3 + i] =
            tb[i].abs() - (b.half[i] + a.half[0] * ac[0][i] + a.half[1] * ac[1][i] + a.half[2] * ac[2][i]);
    }
    let (mut face_separation, mut face) = (faces[0], F::zero());
    for (k, &separation) in faces.iter().enumerate().skip(1) {
        let lead = if k == 3 { FIRST_BOX_PREFERENCE_M } else { TIE_M };
        let better = separation.gt(face_separation + F::splat(lead));
        face_separation = better.select(separation, face_separation);
        face = better.select(F::splat(k as f32), face);
    }
    let never = F::splat(-1e30);
    let (mut edge_separation, mut edge) = (never, F::zero());
    for i in 0..3 {
        for j in 0..3 {
            let (i1, i2, j1, j2) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            // |axis_i x axis_j|² ; nearly parallel edges say nothing that the faces have not said.
            let sine2 = F::one() - c[i][j] * c[i][j];
            let crossing = sine2.gt(F::splat(0.01));
            let inverse = F::one() / crossing.select(sine2, F::one()).sqrt();
            let distance = (ta[i2] * c[i1][j] - ta[i1] * c[i2][j]).abs();
            let reach = a.half[i1] * ac[i2][j]
                + a.half[i2] * ac[i1][j]
                + b.half[j1] * ac[i][j2]
                + b.half[j2] * ac[i][j1];
            let separation = crossing.select((distance - reach) * inverse, never);
            let better = separation.gt(edge_separation + F::splat(TIE_M));
            edge_separation = better.select(separation, edge_separation);
            edge = better.select(F::splat((3 * i + j) as f32), edge);
        }
    }
    let use_edge = edge_separation.gt(face_separation + F::splat(FACE_PREFERENCE_M));
    Axes { face, edge, use_edge, separation: face_separation.max(edge_separation), between }
}

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
struct Clipped {
    normal: [[f32; LANES]; 3],
    points: [[[f32; LANES]; 3]; 4],
    separation: [[f32; LANES]; 4],
    valid: [[f32; LANES]; 4],
}

impl Clipped {
    #[inline(always)]
    fn lane(&self, lane: usize) -> Manifold {
        let normal = Vec3::new(self.normal[0][lane], self.normal[1][lane], self.normal[2][lane]);
        let mut points = [ContactPoint { position: Vec3::ZERO, normal, separation: 0.0 }; 4];
        let mut count = 0;
        for k in 0..4 {
            if self.valid[k][lane] > 0.5 {
                let p = &self.points[k];
                points[count].position = Vec3::new(p[0][lane], p[1][lane], p[2][lane]);
                points[count].separation = self.separation[k][lane];
                count += 1;
            }
        }
        Manifold { normal, points, count: count as u32 }
    }
}

#[inline(always)]
fn pick<F: Lanes>(first: F::Mask, second: F::Mask, of: [F; 3]) -> F {
    first.select(of[0], second.select(of[1], of[2]))
}

#[inline(always)]
fn pick_v<F: Lanes>(first: F::Mask, second: F::Mask, of: [V8<F>; 3]) -> V8<F> {
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
    let e = incident.map(|i| normal.dot(i));
    let ae = e.map(F::abs);
    let (j0, j1) = (ae[1].le(ae[0]) & ae[2].le(ae[0]), ae[2].le(ae[1]));
    let out = pick_v(j0, j1, incident);
    let out_sign = pick(j0, j1, e).lt(F::zero()).select(F::one(), -F::one());
    let centre = between + out * (pick(j0, j1, ih) * out_sign);
    let p = pick_v(j0, j1, [incident[1], incident[2], incident[0]]) * pick(j0, j1, [ih[1], ih[2], ih[0]]);
    let q = pick_v(j0, j1, [incident[2], incident[0], incident[1]]) * pick(j0, j1, [ih[2], ih[0], ih[1]]);
    let seen = |x: V8<F>| [x.dot(u), x.dot(v), x.dot(normal)];
    let mut c = seen(centre);
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
        p: seen(p),
        q: seen(q),
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

/// Keeps of twelve candidates the extreme one along each diagonal, the deeper the better.
#[inline(always)]
fn clip_faces<F: Lanes>(a: &Box8<F>, b: &Box8<F>, axes: &Axes<F>, margin: F) -> Clipped {
    let f = choose_faces(a, b, axes);
    let mut candidates = [Candidate::none(); 12];
    clip_edges(&f, &mut candidates);
    reference_corners(&f, &mut candidates);
    let mut chosen = [Candidate::none(); 4];
    let mut chosen_index = [F::zero(); 4];
    for (k, (su, sv)) in DIAGONALS.into_iter().enumerate() {
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
    let points = chosen.map(|c| {
        let height = f.half_n + c.separation * F::splat(0.5);
        let p = f.origin + f.u * c.u + f.v * c.v + f.normal * height;
        [p.x, p.y, p.z].map(F::to_array)
    });
    Clipped {
        normal: [normal.x, normal.y, normal.z].map(F::to_array),
        points,
        separation: chosen.map(|c| c.separation.to_array()),
        valid: chosen.map(|c| c.valid.to_array()),
    }
}

/// One box, for the edge case that lanes do not pay for.
struct LaneBox {
    centre: Vec3,
    half: [f32; 3],
    axes: [Vec3; 3],
}

fn lane_box<F: Lanes>(b: &Box8<F>, lane: usize) -> LaneBox {
    let v = |x: &V8<F>| Vec3::new(x.x.to_array()[lane], x.y.to_array()[lane], x.z.to_array()[lane]);
    LaneBox {
        centre: v(&b.centre),
        half: b.half.map(|h| h.to_array()[lane]),
        axes: [v(&b.axes[0]), v(&b.axes[1]), v(&b.axes[2])],
    }
}

/// The nearest points of the two edges.
fn edge_manifold(a: &LaneBox, b: &LaneBox, edge: usize) -> Manifold {
    let (i, j) = (edge / 3, edge % 3);
    let cross = a.axes[i].cross(b.axes[j]);
    let mut normal = cross * (1.0 / cross.length());
    if normal.dot(b.centre - a.centre) < 0.0 {
        normal = -normal;
    }
    let (mut on_a, mut on_b) = (a.centre, b.centre);
    for k in 0..3 {
        if k != i {
            on_a += a.axes[k] * if a.axes[k].dot(normal) > 0.0 { a.half[k] } else { -a.half[k] };
        }
        if k != j {
            on_b += b.axes[k] * if b.axes[k].dot(normal) > 0.0 { -b.half[k] } else { b.half[k] };
        }
    }
    let r = on_b - on_a;
    let cosine = a.axes[i].dot(b.axes[j]);
    let (ra, rb) = (r.dot(a.axes[i]), r.dot(b.axes[j]));
    let inverse = 1.0 / (1.0 - cosine * cosine);
    let s = ((ra - cosine * rb) * inverse).clamp(-a.half[i], a.half[i]);
    let t = ((cosine * ra - rb) * inverse).clamp(-b.half[j], b.half[j]);
    let (pa, pb) = (on_a + a.axes[i] * s, on_b + b.axes[j] * t);
    let point = ContactPoint { position: (pa + pb) * 0.5, normal, separation: (pb - pa).dot(normal) };
    Manifold { normal, points: [point; 4], count: 1 }
}
