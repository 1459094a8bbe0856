//! Box against box, eight pairs at a time: separating axes, then face clipping, without branches.
//!
//! Faces are preferred to edges and the first box's faces to the second's by fixed lengths. This takes the place of the hysteresis
//! that other engines keep from step to step: a stack at rest gets the same manifold in every step.

use forerun_geometry::{ContactPoint, Manifold, Shape, Vec3};

use super::cuboid_faces::clip_faces;
use super::{Contact, FAST, Outlook};
use crate::BodyKind;
use crate::bounds::MOTION_FACTOR;
use crate::lanes::{LANES, LaneMask, Lanes, Row, V8, dispatched};

/// An edge-edge axis must separate by this much more than the best face. Metres.
const FACE_PREFERENCE_M: f32 = 4e-3;
/// A face of the second box must separate by this much more than the best of the first. Metres.
const FIRST_BOX_PREFERENCE_M: f32 = 1e-3;
/// Of candidates that are equal up to this, the earlier one wins. Metres.
pub(super) const TIE_M: f32 = 1e-5;

/// What the lanes know of a member.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Cuboid,
    HalfSpace,
    Other,
}

/// Boxes and half-spaces in the form that the lanes gather, at the places of their members.
#[derive(Clone, Debug, Default)]
pub(super) struct Boxes {
    /// Centre, half extents, first two components of the displacement in the frame. Of a half-space: a point and its normal.
    pub(super) centres: Vec<Row>,
    /// Two of the axes, third component of the displacement, sway.
    axes: Vec<Row>,
    kinds: Vec<Kind>,
    pub(super) contact_margin_m: f32,
}

impl Boxes {
    /// Replaces all boxes.
    pub(super) fn fill(&mut self, bodies: &Outlook) {
        let Boxes { centres, axes, kinds, contact_margin_m } = self;
        *contact_margin_m = bodies.environment.settings.contact_margin_m;
        let count = bodies.members.len();
        centres.resize(count, Row::default());
        axes.resize(count, Row::default());
        kinds.clear();
        let rows = centres.iter_mut().zip(axes.iter_mut());
        for ((member, prospect), (centre, axes)) in bodies.members.iter().zip(bodies.prospects).zip(rows) {
            let p = prospect.pose.position;
            kinds.push(match &member.body.shape {
                Shape::Cuboid(cuboid) => {
                    let (h, l, m) = (cuboid.half_extents, prospect.motion.linear, prospect.pose.axes());
                    let (u, v) = (m.x_axis, m.y_axis);
                    centre.0 = [p.x, p.y, p.z, h.x, h.y, h.z, l.x, l.y];
                    axes.0 = [u.x, u.y, u.z, v.x, v.y, v.z, l.z, prospect.sway_m];
                    Kind::Cuboid
                }
                // One that moves is left to the general search.
                Shape::HalfSpace if member.body.kind == BodyKind::Fixed => {
                    let n = prospect.pose.axes().y_axis;
                    centre.0 = [p.x, p.y, p.z, n.x, n.y, n.z, 0.0, 0.0];
                    Kind::HalfSpace
                }
                _ => Kind::Other,
            });
        }
    }

    pub(super) fn kind(&self, member: u32) -> Kind {
        self.kinds[member as usize]
    }
}

/// Eight boxes.
pub(super) struct Box8<F: Lanes> {
    pub(super) centre: V8<F>,
    pub(super) half: [F; 3],
    pub(super) axes: [V8<F>; 3],
    /// Displacement in the frame.
    pub(super) linear: V8<F>,
    pub(super) sway: F,
}

impl<F: Lanes> Box8<F> {
    #[inline(always)]
    pub(super) fn gather(boxes: &Boxes, index: &[u32; LANES]) -> Self {
        let c = F::gather(&boxes.centres, index);
        let a = F::gather(&boxes.axes, index);
        let (u, v) = (V8 { x: a[0], y: a[1], z: a[2] }, V8 { x: a[3], y: a[4], z: a[5] });
        Box8 {
            centre: V8 { x: c[0], y: c[1], z: c[2] },
            half: [c[3], c[4], c[5]],
            axes: [u, v, u.cross(v)],
            linear: V8 { x: c[6], y: c[7], z: a[6] },
            sway: a[7],
        }
    }
}

dispatched! {
    /// Appends the contact of every pair of boxes that comes nearer than its margin, in the pairs' order; fast pairs go to `fast` instead.
    pub(super) fn cuboid_contacts(
        boxes: &Boxes,
        pairs: &[(u32, u32)],
        out: &mut Vec<Contact>,
        fast: &mut Vec<(u32, u32)>,
    ) => cuboid_lanes
}

#[inline(always)]
fn cuboid_lanes<F: Lanes>(
    boxes: &Boxes,
    pairs: &[(u32, u32)],
    out: &mut Vec<Contact>,
    fast: &mut Vec<(u32, u32)>,
) {
    let contact_margin = F::splat(boxes.contact_margin_m);
    for chunk in pairs.chunks(LANES) {
        let (mut first, mut second) = ([chunk[0].0; LANES], [chunk[0].1; LANES]);
        for (lane, pair) in chunk.iter().enumerate() {
            (first[lane], second[lane]) = *pair;
        }
        let (a, b) = (Box8::gather(boxes, &first), Box8::gather(boxes, &second));
        let margin = pair_margins(&a, &b, contact_margin);
        let here = (1 << chunk.len()) - 1;
        let quick = margin.gt(contact_margin * F::splat(FAST)).bits() & here;
        if quick != 0 {
            fast.extend(chunk.iter().enumerate().filter(|(lane, _)| quick >> lane & 1 == 1).map(|(_, p)| *p));
        }
        let wanted = here & !quick;
        if wanted != 0 {
            manifolds_of_eight::<F>((&a, &b), margin, (chunk, wanted), out);
        }
    }
}

/// [`pair_margin`](crate::bounds::pair_margin) of eight pairs.
#[inline(always)]
fn pair_margins<F: Lanes>(a: &Box8<F>, b: &Box8<F>, contact_margin: F) -> F {
    let between = a.linear - b.linear;
    let square = between.dot(between).max(a.linear.dot(a.linear)).max(b.linear.dot(b.linear));
    contact_margin.max((square.sqrt() + a.sway + b.sway) * F::splat(MOTION_FACTOR))
}

#[inline(always)]
fn manifolds_of_eight<F: Lanes>(
    (a, b): (&Box8<F>, &Box8<F>),
    margin: F,
    (pairs, wanted): (&[(u32, u32)], u32),
    out: &mut Vec<Contact>,
) {
    let axes = separating_axes(a, b);
    let near = axes.separation.lt(margin).bits() & wanted;
    if near == 0 {
        return;
    }
    let by_edge = axes.use_edge.bits();
    let clipped = clip_faces(a, b, &axes, margin);
    for (lane, &(first, second)) in pairs.iter().enumerate() {
        if near >> lane & 1 == 0 {
            continue;
        }
        if by_edge >> lane & 1 == 1 {
            let edge = axes.edge.to_array()[lane] as usize;
            let manifold = edge_manifold(&lane_box(a, lane), &lane_box(b, lane), edge);
            out.push(Contact { first, second, manifold });
        } else {
            clipped.push_lane(lane, (first, second), out);
        }
    }
}

/// The axis of least overlap per lane.
pub(super) struct Axes<F: Lanes> {
    /// 0 to 2: a face of the first box; 3 to 5: of the second.
    pub(super) face: F,
    /// `3 i + j`: edge direction `i` of the first with `j` of the second.
    edge: F,
    use_edge: F::Mask,
    separation: F,
    /// From the first centre to the second.
    pub(super) between: V8<F>,
}

#[inline(always)]
fn separating_axes<F: Lanes>(a: &Box8<F>, b: &Box8<F>) -> Axes<F> {
    let between = b.centre - a.centre;
    let ta = [between.dot(a.axes[0]), between.dot(a.axes[1]), between.dot(a.axes[2])];
    let tb = [between.dot(b.axes[0]), between.dot(b.axes[1]), between.dot(b.axes[2])];
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
    let s = ((ra - cosine * rb) * inverse).max(-a.half[i]).min(a.half[i]);
    let t = ((cosine * ra - rb) * inverse).max(-b.half[j]).min(b.half[j]);
    let (pa, pb) = (on_a + a.axes[i] * s, on_b + b.axes[j] * t);
    let point = ContactPoint { position: (pa + pb) * 0.5, normal, separation: (pb - pa).dot(normal) };
    Manifold { normal, points: [point; 4], count: 1 }
}
