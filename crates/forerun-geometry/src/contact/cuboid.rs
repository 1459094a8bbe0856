//! Cuboid: two boxes, by the fifteen separating axes and a face clipped against a rectangle.
//!
//! This room is the reference for every faster version of the same kernel: only + - * / sqrt and comparisons, in the
//! order written here.
//!
//! 1. The separation along each of the six face normals and nine edge cross products (Gottschalk, Lin, Manocha, *OBBTree*,
//!    1996). The axis of largest separation wins; a face of the second box must beat the first's by
//!    [`SECOND_FACE_MARGIN`], an edge pair the best face by [`EDGE_MARGIN`], so that rounding cannot make the
//!    manifold flip between frames.
//! 2. Edge pair: one point, midway between the nearest points of the two edges.
//! 3. Face: the other box's most opposed face is clipped against the reference rectangle. Its edges give up to eight
//!    points, the rectangle's corners that lie on it up to four. Kept are the outermost in four directions.

use super::reduce::{DIAGONALS, TIE};
use super::{ContactPoint, Manifold};
use crate::shape::Cuboid;
use crate::{Pose, Vec3};

/// By how much the best face of the second box must beat that of the first. Metres.
const SECOND_FACE_MARGIN: f32 = 1.0e-3;

/// By how much an edge pair must beat the best face. Metres.
const EDGE_MARGIN: f32 = 4.0e-3;

/// Edges that enclose an angle with a smaller squared sine span no axis of their own.
const PARALLEL_SQUARED_SINE: f32 = 0.01;

/// A clipped edge that runs along a side of the rectangle, within this, never crosses it. Metres.
const ALONG_SIDE: f32 = 1.0e-6;

/// Face that is seen from its edge: twice the area of its shadow is below this. Square metres.
const NO_SHADOW: f32 = 1.0e-9;

/// A box ready for the kernel; the frame is the world's, the origin the first box's centre.
struct Block {
    centre: Vec3,
    axes: [Vec3; 3],
    half: [f32; 3],
}

/// What the fifteen axes say.
enum Axis {
    /// Normal `axis` of the first box.
    FirstFace { axis: usize },
    /// Normal `axis` of the second box.
    SecondFace { axis: usize },
    /// Edge direction `first` of the first box across edge direction `second` of the second.
    Edges { first: usize, second: usize },
}

/// The manifold of two boxes: up to four points, all with one normal, or none.
///
/// Boxes that are apart along the best axis, but do not face each other along it, have none.
#[must_use]
pub fn cuboid_cuboid(
    first: &Cuboid,
    first_pose: &Pose,
    second: &Cuboid,
    second_pose: &Pose,
    margin: f32,
) -> Option<Manifold> {
    let origin = first_pose.position;
    let a = Block::new(first, first_pose, origin);
    let b = Block::new(second, second_pose, origin);
    let (axis, separation) = best_axis(&a, &b);
    if separation >= margin {
        return None;
    }
    let manifold = match axis {
        Axis::FirstFace { axis } => face_manifold(&a, axis, &b, margin),
        Axis::SecondFace { axis } => face_manifold(&b, axis, &a, margin).map(Manifold::flipped),
        Axis::Edges { first, second } => edge_manifold(&a, first, &b, second),
    };
    manifold.map(|manifold| manifold.moved(origin))
}

impl Block {
    fn new(cuboid: &Cuboid, pose: &Pose, origin: Vec3) -> Self {
        let axes = pose.axes();
        Block {
            centre: pose.position - origin,
            axes: [axes.x_axis, axes.y_axis, axes.z_axis],
            half: cuboid.half_extents.to_array(),
        }
    }
}

/// The axis along which the boxes are farthest apart, preferences included, and how far. Metres.
fn best_axis(a: &Block, b: &Block) -> (Axis, f32) {
    let arm = b.centre - a.centre;
    let arm_a = a.axes.map(|axis| arm.dot(axis));
    let arm_b = b.axes.map(|axis| arm.dot(axis));
    let cosine = a.axes.map(|axis| b.axes.map(|other| axis.dot(other)));
    let shadow = cosine.map(|row| row.map(f32::abs));

    let mut face = f32::NEG_INFINITY;
    let mut best = Axis::FirstFace { axis: 0 };
    for i in 0..3 {
        let reach =
            a.half[i] + b.half[0] * shadow[i][0] + b.half[1] * shadow[i][1] + b.half[2] * shadow[i][2];
        let separation = arm_a[i].abs() - reach;
        if separation > face + TIE {
            (face, best) = (separation, Axis::FirstFace { axis: i });
        }
    }
    let mut to_beat = face + SECOND_FACE_MARGIN;
    for j in 0..3 {
        let reach =
            b.half[j] + a.half[0] * shadow[0][j] + a.half[1] * shadow[1][j] + a.half[2] * shadow[2][j];
        let separation = arm_b[j].abs() - reach;
        if separation > to_beat {
            (face, best) = (separation, Axis::SecondFace { axis: j });
            to_beat = separation + TIE;
        }
    }
    to_beat = face + EDGE_MARGIN;
    for i in 0..3 {
        let (i1, i2) = ((i + 1) % 3, (i + 2) % 3);
        for j in 0..3 {
            let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
            let squared_sine = 1.0 - cosine[i][j] * cosine[i][j];
            if squared_sine <= PARALLEL_SQUARED_SINE {
                continue;
            }
            let apart = (arm_a[i2] * cosine[i1][j] - arm_a[i1] * cosine[i2][j]).abs();
            let reach = a.half[i1] * shadow[i2][j]
                + a.half[i2] * shadow[i1][j]
                + b.half[j1] * shadow[i][j2]
                + b.half[j2] * shadow[i][j1];
            let separation = (apart - reach) / squared_sine.sqrt();
            if separation > to_beat {
                (face, best) = (separation, Axis::Edges { first: i, second: j });
                to_beat = separation + TIE;
            }
        }
    }
    (best, face)
}

/// Two edges that cross: the point midway between them.
fn edge_manifold(a: &Block, i: usize, b: &Block, j: usize) -> Option<Manifold> {
    let (edge_a, edge_b) = (a.axes[i], b.axes[j]);
    let across = edge_a.cross(edge_b);
    let across = across / across.length();
    let normal = if across.dot(b.centre - a.centre) < 0.0 { -across } else { across };
    let mut middle_a = a.centre;
    let mut middle_b = b.centre;
    for k in 0..3 {
        if k != i {
            let side = if a.axes[k].dot(normal) > 0.0 { a.half[k] } else { -a.half[k] };
            middle_a += a.axes[k] * side;
        }
        if k != j {
            let side = if b.axes[k].dot(normal) > 0.0 { -b.half[k] } else { b.half[k] };
            middle_b += b.axes[k] * side;
        }
    }
    let between = middle_b - middle_a;
    let cosine = edge_a.dot(edge_b);
    let squared_sine = 1.0 - cosine * cosine;
    let (along_a, along_b) = (between.dot(edge_a), between.dot(edge_b));
    let s = ((along_a - cosine * along_b) / squared_sine).clamp(-a.half[i], a.half[i]);
    let t = ((cosine * along_a - along_b) / squared_sine).clamp(-b.half[j], b.half[j]);
    let (on_a, on_b) = (middle_a + edge_a * s, middle_b + edge_b * t);
    let separation = (on_b - on_a).dot(normal);
    Manifold::from_points(&[ContactPoint { position: (on_a + on_b) * 0.5, normal, separation }])
}

/// A point over the reference rectangle: x and y in its plane, and its height above it. Metres.
#[derive(Clone, Copy, Debug, Default)]
struct Over {
    x: f32,
    y: f32,
    height: f32,
}

impl Over {
    fn plus(self, other: Over, times: f32) -> Over {
        Over {
            x: self.x + other.x * times,
            y: self.y + other.y * times,
            height: self.height + other.height * times,
        }
    }
}

/// The reference rectangle: a face of a box, and the frame that it spans.
struct Reference {
    centre: Vec3,
    normal: Vec3,
    u: Vec3,
    v: Vec3,
    half_u: f32,
    half_v: f32,
}

impl Reference {
    fn over(&self, vector: Vec3) -> Over {
        Over { x: vector.dot(self.u), y: vector.dot(self.v), height: vector.dot(self.normal) }
    }
}

/// The face of a box that is turned most against the reference normal: centre and two half edges.
struct Incident {
    centre: Over,
    p: Over,
    q: Over,
}

/// Face `axis` of `reference` that looks at `other`, against `other`. The normal points to `other`.
fn face_manifold(reference: &Block, axis: usize, other: &Block, margin: f32) -> Option<Manifold> {
    let arm = other.centre - reference.centre;
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    let outward = reference.axes[axis];
    let normal = if outward.dot(arm) < 0.0 { -outward } else { outward };
    let face = Reference {
        centre: reference.centre + normal * reference.half[axis],
        normal,
        u: reference.axes[next],
        v: reference.axes[last],
        half_u: reference.half[next],
        half_v: reference.half[last],
    };
    let incident = incident_face(&face, other);

    let mut candidates = [(Over::default(), false); 12];
    clip_edges(&face, &incident, &mut candidates);
    corners_under(&face, &incident, &mut candidates);
    keep_outermost(&face, &candidates, margin)
}

fn incident_face(face: &Reference, other: &Block) -> Incident {
    let cosine = other.axes.map(|axis| face.normal.dot(axis));
    let shadow = cosine.map(f32::abs);
    let k = if shadow[0] >= shadow[1] && shadow[0] >= shadow[2] {
        0
    } else if shadow[1] >= shadow[2] {
        1
    } else {
        2
    };
    let (next, last) = ((k + 1) % 3, (k + 2) % 3);
    let side = if cosine[k] < 0.0 { other.half[k] } else { -other.half[k] };
    Incident {
        centre: face.over(other.centre + other.axes[k] * side - face.centre),
        p: face.over(other.axes[next] * other.half[next]),
        q: face.over(other.axes[last] * other.half[last]),
    }
}

/// Candidates 0 to 7: where each edge of the incident face enters the rectangle's prism, and where it leaves before
/// its own end (which is the next edge's beginning).
fn clip_edges(face: &Reference, incident: &Incident, candidates: &mut [(Over, bool); 12]) {
    let Incident { centre, p, q } = *incident;
    let edges = [
        (centre.plus(p, -1.0).plus(q, -1.0), p, 2.0),
        (centre.plus(p, 1.0).plus(q, -1.0), q, 2.0),
        (centre.plus(p, 1.0).plus(q, 1.0), p, -2.0),
        (centre.plus(p, -1.0).plus(q, 1.0), q, -2.0),
    ];
    for (k, (from, half_edge, length)) in edges.into_iter().enumerate() {
        let edge = Over::default().plus(half_edge, length);
        let mut enter = 0.0_f32;
        let mut leave = 1.0_f32;
        let mut outside = false;
        for (start, step, half) in [(from.x, edge.x, face.half_u), (from.y, edge.y, face.half_v)] {
            if step.abs() < ALONG_SIDE {
                outside |= start.abs() > half;
                continue;
            }
            let (low, high) = ((-half - start) / step, (half - start) / step);
            enter = enter.max(low.min(high));
            leave = leave.min(low.max(high));
        }
        let crosses = !outside && enter <= leave;
        candidates[k] = (from.plus(edge, enter), crosses);
        candidates[4 + k] = (from.plus(edge, leave), crosses && leave < 1.0);
    }
}

/// Candidates 8 to 11: the rectangle's corners that lie over the incident face, at its height.
fn corners_under(face: &Reference, incident: &Incident, candidates: &mut [(Over, bool); 12]) {
    let Incident { centre, p, q } = *incident;
    let shadow = p.x * q.y - p.y * q.x;
    if shadow.abs() <= NO_SHADOW {
        return;
    }
    for (k, (u, v)) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].into_iter().enumerate() {
        let (x, y) = (face.half_u * u, face.half_v * v);
        let (dx, dy) = (x - centre.x, y - centre.y);
        let along_p = (dx * q.y - dy * q.x) / shadow;
        let along_q = (p.x * dy - p.y * dx) / shadow;
        let height = centre.height + p.height * along_p + q.height * along_q;
        candidates[8 + k] = (Over { x, y, height }, along_p.abs() <= 1.0 && along_q.abs() <= 1.0);
    }
}

/// Of all candidates nearer than the margin, the outermost in four directions, each once. Depth counts like distance.
fn keep_outermost(face: &Reference, candidates: &[(Over, bool); 12], margin: f32) -> Option<Manifold> {
    let mut chosen = [usize::MAX; 4];
    let mut points = [ContactPoint::FAR_APART; 4];
    let mut count = 0;
    for (k, (du, dv)) in DIAGONALS.into_iter().enumerate() {
        let mut best = f32::NEG_INFINITY;
        for (index, (over, valid)) in candidates.iter().enumerate() {
            let score = over.x * du + over.y * dv - over.height;
            if *valid && over.height < margin && score > best + TIE {
                best = score;
                chosen[k] = index;
            }
        }
        if chosen[k] == usize::MAX || chosen[..k].contains(&chosen[k]) {
            continue;
        }
        let Over { x, y, height } = candidates[chosen[k]].0;
        let position = face.centre + face.u * x + face.v * y + face.normal * (height * 0.5);
        points[count] = ContactPoint { position, normal: face.normal, separation: height };
        count += 1;
    }
    Manifold::from_points(&points[..count])
}
