//! Boxes on a half-space, eight at a time: the corners of the face that looks most against the ground.
//!
//! No other corner is nearer to the ground than the one of these below it.

use forerun_geometry::{ContactPoint, Manifold, Vec3};

use super::Contact;
use super::cuboid_faces::{pick, pick_v};
use super::cuboids::{Box8, Boxes, Kind};
use crate::bounds::MOTION_FACTOR;
use crate::lanes::{LANES, LaneMask, Lanes, V8, dispatched};

/// The corners of the face in the order in which they are listed.
const CORNERS: [(f32, f32); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];

dispatched! {
    /// Appends the contact of every pair of a box and a half-space (in either order) that comes nearer than its margin, in the pairs' order.
    pub(super) fn ground_contacts(boxes: &Boxes, pairs: &[(u32, u32)], out: &mut Vec<Contact>) => ground_lanes
}

#[inline(always)]
fn ground_lanes<F: Lanes>(boxes: &Boxes, pairs: &[(u32, u32)], out: &mut Vec<Contact>) {
    for chunk in pairs.chunks(LANES) {
        let (mut ground, mut cuboid) = ([0; LANES], [0; LANES]);
        for lane in 0..LANES {
            let (first, second) = chunk[lane.min(chunk.len() - 1)];
            let ground_first = boxes.kind(first) == Kind::HalfSpace;
            (ground[lane], cuboid[lane]) = if ground_first { (first, second) } else { (second, first) };
        }
        let corners = lowest_corners::<F>(boxes, &ground, &cuboid);
        for (lane, &pair) in chunk.iter().enumerate() {
            corners.push_lane(lane, (pair, pair.0 == ground[lane]), out);
        }
    }
}

/// The lowest corners of eight boxes.
struct Corners {
    /// Out of the ground.
    normal: [[f32; LANES]; 3],
    /// Midway between corner and ground.
    points: [[[f32; LANES]; 3]; 4],
    separation: [[f32; LANES]; 4],
    /// By corner: the lanes in which it is near enough.
    near: [u32; 4],
}

#[inline(always)]
fn lowest_corners<F: Lanes>(boxes: &Boxes, ground: &[u32; LANES], cuboid: &[u32; LANES]) -> Corners {
    let g = F::gather(&boxes.centres, ground);
    let (point, normal) = (V8 { x: g[0], y: g[1], z: g[2] }, V8 { x: g[3], y: g[4], z: g[5] });
    let b = Box8::<F>::gather(boxes, cuboid);
    let margin = F::splat(boxes.contact_margin_m).max((b.linear.length() + b.sway) * F::splat(MOTION_FACTOR));
    let cosine = [b.axes[0].dot(normal), b.axes[1].dot(normal), b.axes[2].dot(normal)];
    let steep = [cosine[0].abs(), cosine[1].abs(), cosine[2].abs()];
    let x = steep[1].le(steep[0]) & steep[2].le(steep[0]);
    let y = steep[2].le(steep[1]);
    let [hx, hy, hz] = b.half;
    let [ax, ay, az] = b.axes;
    let down = pick_v(x, y, b.axes) * pick(x, y, b.half);
    let down = pick(x, y, cosine).gt(F::zero()).select_v(-down, down);
    let p = pick_v(x, y, [ay, az, ax]) * pick(x, y, [hy, hz, hx]);
    let q = pick_v(x, y, [az, ax, ay]) * pick(x, y, [hz, hx, hy]);
    let face = b.centre - point + down;
    let mut corners = Corners {
        normal: [normal.x.to_array(), normal.y.to_array(), normal.z.to_array()],
        points: [[[0.0; LANES]; 3]; 4],
        separation: [[0.0; LANES]; 4],
        near: [0; 4],
    };
    for (k, (along_p, along_q)) in CORNERS.into_iter().enumerate() {
        let corner = face + p * F::splat(along_p) + q * F::splat(along_q);
        let separation = corner.dot(normal);
        let middle = point + (corner - normal * (separation * F::splat(0.5)));
        corners.points[k] = [middle.x.to_array(), middle.y.to_array(), middle.z.to_array()];
        corners.separation[k] = separation.to_array();
        corners.near[k] = separation.lt(margin).bits();
    }
    corners
}

impl Corners {
    /// Appends the contact of one pair, if it has any.
    #[inline(always)]
    fn push_lane(&self, lane: usize, (pair, ground_first): ((u32, u32), bool), out: &mut Vec<Contact>) {
        if (self.near[0] | self.near[1] | self.near[2] | self.near[3]) >> lane & 1 == 0 {
            return;
        }
        let up = Vec3::new(self.normal[0][lane], self.normal[1][lane], self.normal[2][lane]);
        let normal = if ground_first { up } else { -up };
        let blank = ContactPoint { position: Vec3::ZERO, normal, separation: 0.0 };
        let manifold = Manifold { normal, points: [blank; 4], count: 0 };
        // Filled where it stays.
        out.push(Contact { first: pair.0, second: pair.1, manifold });
        let Some(Contact { manifold, .. }) = out.last_mut() else { return };
        for k in 0..4 {
            if self.near[k] >> lane & 1 == 1 {
                let p = &self.points[k];
                let point = &mut manifold.points[manifold.count as usize];
                point.position = Vec3::new(p[0][lane], p[1][lane], p[2][lane]);
                point.separation = self.separation[k][lane];
                manifold.count += 1;
            }
        }
    }
}
