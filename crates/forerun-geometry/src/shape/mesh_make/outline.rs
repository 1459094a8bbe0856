//! Outlines with holes, cut into triangles and given a thickness.

use std::collections::BTreeSet;

use earcut::{Earcut, Refiner};
use glam::DVec2;

use super::surface::Surface;
use crate::Vec3;
use crate::shape::TriangleList;

/// A flat region: one outline and the holes in it, each a closed line that does not cross itself or another. Any winding.
pub(super) struct Outline {
    pub(super) border: Vec<DVec2>,
    pub(super) holes: Vec<Vec<DVec2>>,
    /// Circles about the origin, each inside the one before, that fill the first hole from its border (not listed again) inwards: the
    /// last is the border of what stays open. They start on the x axis and go counter-clockwise, as that hole must.
    pub(super) web: Vec<Vec<DVec2>>,
}

impl Outline {
    /// The triangles of the region, Delaunay where the outline lets them be; counter-clockwise.
    fn triangles(&self) -> (Vec<DVec2>, Vec<[u32; 3]>) {
        let mut points = self.border.clone();
        let mut hole_starts = Vec::new();
        for hole in &self.holes {
            hole_starts.push(points.len() as u32);
            points.extend(hole);
        }
        let mut corners = Vec::new();
        Earcut::new().earcut(points.iter().map(DVec2::to_array), &hole_starts, &mut corners);
        let mut outer = (self.border.len() as u32, self.holes.first().map_or(0, Vec::len) as u32);
        for circle in &self.web {
            let inner = (points.len() as u32, circle.len() as u32);
            points.extend(circle);
            corners.extend(between_circles(outer, inner));
            outer = inner;
        }
        // The library winds all its triangles the same way, but not always counter-clockwise.
        let turned = |[a, b, c]: [u32; 3]| {
            let [p, q, r] = [a, b, c].map(|i| points[i as usize]);
            if (q - p).perp_dot(r - p) < 0.0 { [a, c, b] } else { [a, b, c] }
        };
        let mut corners: Vec<u32> = corners.as_chunks().0.iter().copied().flat_map(turned).collect();
        let data: Vec<[f64; 2]> = points.iter().map(DVec2::to_array).collect();
        Refiner::new().refine(&mut corners, &data);
        (points, corners.as_chunks().0.to_vec())
    }

    /// The solid between two copies of the region, at minus and plus `half_depth`; `place` puts (x, y of the region, depth) into space, without
    /// mirroring.
    pub(super) fn extrude(&self, half_depth: f64, place: fn([f64; 3]) -> [f64; 3]) -> TriangleList {
        let (points, triangles) = self.triangles();
        let mut surface = Surface::default();
        let mut layer = |depth: f64| -> Vec<u32> {
            let at = |p: &DVec2| Vec3::from_array(place([p.x, p.y, depth]).map(|x| x as f32));
            points.iter().map(|p| surface.vertex(at(p))).collect()
        };
        let (back, front) = (layer(-half_depth), layer(half_depth));
        let mut edges = BTreeSet::new();
        for &[a, b, c] in &triangles {
            surface.triangle([a, b, c].map(|i| front[i as usize]));
            surface.triangle([a, c, b].map(|i| back[i as usize]));
            for (from, to) in [(a, b), (b, c), (c, a)] {
                // An edge that is passed both ways is inside, and has no wall.
                if !edges.remove(&(to, from)) {
                    edges.insert((from, to));
                }
            }
        }
        for (from, to) in edges {
            let (from, to) = (from as usize, to as usize);
            surface.quad([back[from], back[to], front[to], front[from]]);
        }
        surface.finish()
    }
}

/// The triangles between two circles of points, each given by its first index and number: on both, always the next by angle.
fn between_circles(outer: (u32, u32), inner: (u32, u32)) -> Vec<u32> {
    let at = |(first, count): (u32, u32), i: u32| first + i % count;
    let (mut i, mut j) = (0, 0);
    let mut corners = Vec::new();
    while i < outer.1 || j < inner.1 {
        // (i + 1/2) / outer against (j + 1/2) / inner, in whole numbers: the edge whose middle comes first.
        if j == inner.1 || (i < outer.1 && (2 * i + 1) * inner.1 <= (2 * j + 1) * outer.1) {
            corners.extend([at(outer, i), at(outer, i + 1), at(inner, j)]);
            i += 1;
        } else {
            corners.extend([at(outer, i), at(inner, j + 1), at(inner, j)]);
            j += 1;
        }
    }
    corners
}
