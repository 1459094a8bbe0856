//! Clip: what lies over a face, and how high.

use super::reduce::Reducer;
use super::{ContactPoint, Manifold};
use crate::Vec3;

/// A reference polygon or disc is this much larger than it is, so that flush faces meet in spite of rounding. Metres.
const FLUSH: f32 = 1.0e-5;

/// A face to clip against, and the frame in its plane.
pub(super) struct Face {
    /// Origin of the frame, in the plane.
    pub(super) point: Vec3,
    /// Outward unit normal.
    pub(super) normal: Vec3,
    pub(super) u: Vec3,
    pub(super) v: Vec3,
    pub(super) boundary: Boundary,
}

/// The outline of a face in its own frame.
pub(super) enum Boundary {
    /// Convex, counter-clockwise.
    Polygon(Vec<[f32; 2]>),
    /// About the frame's origin.
    Disc { radius: f32 },
}

/// A point over a face: x and y in its plane, and its height above it. Metres.
#[derive(Clone, Copy)]
struct Over {
    x: f32,
    y: f32,
    height: f32,
}

impl Over {
    fn towards(self, other: Over, part: f32) -> Over {
        Over {
            x: self.x + (other.x - self.x) * part,
            y: self.y + (other.y - self.y) * part,
            height: self.height + (other.height - self.height) * part,
        }
    }
}

/// Contact between a face and what `lowest` lists: a convex polygon or a segment of something that ends `radius`
/// further down. Up to four points with the face's normal.
pub(super) fn face_manifold(face: &Face, lowest: &[Vec3], radius: f32, margin: f32) -> Option<Manifold> {
    let over: Vec<Over> = lowest
        .iter()
        .map(|&point| {
            let arm = point - face.point;
            Over { x: arm.dot(face.u), y: arm.dot(face.v), height: arm.dot(face.normal) }
        })
        .collect();
    let mut reducer = Reducer::new(face.point, face.u, face.v);
    let mut offer = |over: Over| {
        let separation = over.height - radius;
        if separation < margin {
            let position = face.point + face.u * over.x + face.v * over.y + face.normal * (separation * 0.5);
            reducer.offer(ContactPoint { position, normal: face.normal, separation });
        }
    };
    // A polygon closes; a segment is one edge.
    let edges = if over.len() > 2 { over.len() } else { 1 };
    for k in 0..edges {
        let (from, to) = (over[k], over[(k + 1) % over.len()]);
        if let Some((enter, leave)) = face.boundary.clip(from, to) {
            offer(from.towards(to, enter));
            if leave < 1.0 || edges == 1 {
                offer(from.towards(to, leave));
            }
        }
    }
    if let Some(plane) = Plane::through(&over) {
        face.boundary.for_each_corner(|x, y| {
            if is_inside(&over, plane.turn, x, y) {
                offer(Over { x, y, height: plane.height(x, y) });
            }
        });
    }
    reducer.finish()
}

impl Boundary {
    /// The part of a segment that is inside, as parameters from 0 to 1; none if all is outside.
    fn clip(&self, from: Over, to: Over) -> Option<(f32, f32)> {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        match self {
            Boundary::Polygon(corners) => {
                let (mut enter, mut leave) = (0.0_f32, 1.0_f32);
                for (k, &[x, y]) in corners.iter().enumerate() {
                    let [next_x, next_y] = corners[(k + 1) % corners.len()];
                    let (ex, ey) = (next_x - x, next_y - y);
                    let length = (ex * ex + ey * ey).sqrt();
                    if length < 1.0e-12 {
                        continue;
                    }
                    // Distance inside of this side, at the start and per unit of the parameter.
                    let start = (ex * (from.y - y) - ey * (from.x - x)) / length + FLUSH;
                    let rate = (ex * dy - ey * dx) / length;
                    if rate.abs() < 1.0e-9 {
                        if start < 0.0 {
                            return None;
                        }
                    } else if rate > 0.0 {
                        enter = enter.max(-start / rate);
                    } else {
                        leave = leave.min(-start / rate);
                    }
                }
                (enter <= leave).then_some((enter, leave))
            }
            Boundary::Disc { radius } => {
                let reach = radius + FLUSH;
                let a = dx * dx + dy * dy;
                let b = from.x * dx + from.y * dy;
                let c = from.x * from.x + from.y * from.y - reach * reach;
                if a < 1.0e-18 {
                    return (c <= 0.0).then_some((0.0, 1.0));
                }
                let square = b * b - a * c;
                if square < 0.0 {
                    return None;
                }
                let root = square.sqrt();
                let (enter, leave) = (((-b - root) / a).max(0.0), ((-b + root) / a).min(1.0));
                (enter <= leave).then_some((enter, leave))
            }
        }
    }

    /// The corners of a polygon; eight points of a rim.
    fn for_each_corner(&self, mut visit: impl FnMut(f32, f32)) {
        match self {
            Boundary::Polygon(corners) => corners.iter().for_each(|&[x, y]| visit(x, y)),
            Boundary::Disc { radius } => {
                let d = radius * std::f32::consts::FRAC_1_SQRT_2;
                let r = *radius;
                for (x, y) in [(d, d), (-d, d), (-d, -d), (d, -d), (r, 0.0), (0.0, r), (-r, 0.0), (0.0, -r)] {
                    visit(x, y);
                }
            }
        }
    }
}

/// The plane of an incident polygon, as height over the face.
struct Plane {
    middle: Over,
    slope_x: f32,
    slope_y: f32,
    /// 1 if the polygon runs counter-clockwise over the face, else -1.
    turn: f32,
}

impl Plane {
    /// None for a segment, and for a polygon that is seen from its edge.
    fn through(over: &[Over]) -> Option<Plane> {
        if over.len() < 3 {
            return None;
        }
        let part = 1.0 / over.len() as f32;
        let mut middle = Over { x: 0.0, y: 0.0, height: 0.0 };
        for point in over {
            middle.x += point.x * part;
            middle.y += point.y * part;
            middle.height += point.height * part;
        }
        // Newell's normal: the sum of the cross products of neighbours, about the middle.
        let (mut nx, mut ny, mut nz) = (0.0_f32, 0.0_f32, 0.0_f32);
        for (k, p) in over.iter().enumerate() {
            let q = over[(k + 1) % over.len()];
            let (px, py, ph) = (p.x - middle.x, p.y - middle.y, p.height - middle.height);
            let (qx, qy, qh) = (q.x - middle.x, q.y - middle.y, q.height - middle.height);
            nx += py * qh - ph * qy;
            ny += ph * qx - px * qh;
            nz += px * qy - py * qx;
        }
        // Steeper than 89 degrees: the height under a corner would be noise.
        if nz * nz < 3.0e-4 * (nx * nx + ny * ny) || nz == 0.0 {
            return None;
        }
        let turn = if nz < 0.0 { -1.0 } else { 1.0 };
        Some(Plane { middle, slope_x: -nx / nz, slope_y: -ny / nz, turn })
    }

    fn height(&self, x: f32, y: f32) -> f32 {
        self.middle.height + self.slope_x * (x - self.middle.x) + self.slope_y * (y - self.middle.y)
    }
}

/// Whether a point of the face's plane is under a polygon.
fn is_inside(over: &[Over], turn: f32, x: f32, y: f32) -> bool {
    over.iter().enumerate().all(|(k, p)| {
        let q = over[(k + 1) % over.len()];
        let (ex, ey) = (q.x - p.x, q.y - p.y);
        let inside = (ex * (y - p.y) - ey * (x - p.x)) * turn;
        inside >= -FLUSH * (ex * ex + ey * ey).sqrt()
    })
}
