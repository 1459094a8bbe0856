//! What the makers build with: vertices that weld, rings of vertices, and bands of triangles between rings.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use crate::Vec3;
use crate::shape::TriangleList;
use crate::shape::mesh_topology::drop_unused;

/// A surface in the making. Vertices at the same place, to the bit, are one.
#[derive(Default)]
pub(super) struct Surface {
    list: TriangleList,
    known: BTreeMap<[u32; 3], u32>,
}

impl Surface {
    pub(super) fn vertex(&mut self, at: Vec3) -> u32 {
        // Adding 0 makes -0 and +0 one place.
        let key = (at + Vec3::ZERO).to_array().map(f32::to_bits);
        *self.known.entry(key).or_insert_with(|| {
            self.list.vertices.push(at);
            self.list.vertices.len() as u32 - 1
        })
    }

    pub(super) fn triangle(&mut self, corners: [u32; 3]) {
        self.list.triangles.push(corners);
    }

    /// Four corners, counter-clockwise seen from outside; cut from the first to the third.
    pub(super) fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.list.triangles.extend([[a, b, c], [a, c, d]]);
    }

    pub(super) fn ring(&mut self, points: impl IntoIterator<Item = DVec3>) -> Vec<u32> {
        points.into_iter().map(|point| self.vertex(point.as_vec3())).collect()
    }

    /// The band from one closed ring of vertices to the next; both go counter-clockwise about the way from `a` to `b`. One of them
    /// may have 2, 4, 8... times as many vertices as the other.
    pub(super) fn band(&mut self, a: &[u32], b: &[u32]) {
        if a.len() >= b.len() {
            self.fans(a, b, |fine, next, coarse| [fine, next, coarse]);
        } else {
            // Seen from the other end both rings go clockwise.
            self.fans(b, a, |fine, next, coarse| [next, fine, coarse]);
        }
    }

    /// For each edge of the coarse ring a triangle on it, and fans about its ends over the fine ring's edges beside it.
    fn fans(&mut self, fine: &[u32], coarse: &[u32], corners: fn(u32, u32, u32) -> [u32; 3]) {
        let ratio = fine.len() / coarse.len();
        for (j, &end) in coarse.iter().enumerate() {
            let next = coarse[(j + 1) % coarse.len()];
            let at = |k: usize| fine[(j * ratio + k) % fine.len()];
            let middle = ratio.div_ceil(2);
            for k in 0..ratio {
                self.triangle(corners(at(k), at(k + 1), if k < middle { end } else { next }));
            }
            self.triangle(corners(next, end, at(middle)));
        }
    }

    /// The fan from a ring to a point that it goes round counter-clockwise, on the way to it.
    pub(super) fn cap(&mut self, ring: &[u32], tip: DVec3) {
        let tip = self.vertex(tip.as_vec3());
        for (i, &corner) in ring.iter().enumerate() {
            self.triangle([corner, ring[(i + 1) % ring.len()], tip]);
        }
    }

    /// The triangles, and the vertices that they use.
    pub(super) fn finish(self) -> TriangleList {
        let TriangleList { vertices, mut triangles } = self.list;
        TriangleList { vertices: drop_unused(vertices, &mut triangles), triangles }
    }
}

/// Cosine and sine of `i` of `of` parts of a full turn.
pub(super) fn on_circle(i: u32, of: u32) -> DVec2 {
    at_angle(TAU * f64::from(i) / f64::from(of))
}

/// Cosine and sine of an angle in radians.
pub(super) fn at_angle(angle: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(angle);
    DVec2::new(cos, sin)
}

/// Adds the points of a straight line from the last point to `to`, equal parts apart of at most `step`.
pub(super) fn line_to(points: &mut Vec<DVec2>, to: DVec2, step: f64) {
    let Some(&from) = points.last() else { return points.push(to) };
    // A little less: a line of four steps is not to become five by rounding.
    let parts = ((from.distance(to) / step - 0.01).ceil() as u32).max(1);
    points.extend((1..=parts).map(|i| from.lerp(to, f64::from(i) / f64::from(parts))));
}

/// Adds the points of an arc of an ellipse from the last point on: about `centre`, from one angle (radians) to another, in `parts`.
pub(super) fn arc(
    points: &mut Vec<DVec2>,
    centre: DVec2,
    half_axes: DVec2,
    (from, to, parts): (f64, f64, u32),
) {
    let angle = |i: u32| from + (to - from) * f64::from(i) / f64::from(parts);
    points.extend((1..=parts).map(|i| centre + half_axes * at_angle(angle(i))));
}
