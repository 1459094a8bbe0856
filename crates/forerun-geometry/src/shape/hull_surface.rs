//! Convex hull of points as triangles, by exact orientation tests.
//!
//! Points are added one by one; the triangles that a point sees are replaced by a cone over their rim (beneath-beyond). "Sees" is
//! decided by Shewchuk's exact predicate, so no rounding can tear the surface, and a triangle in whose plane the point lies is
//! never seen: rim edges border a triangle that is, hence no new triangle is degenerate.

use glam::DVec3;
use robust::{Coord3D, orient3d};

use crate::Vec3;

/// The triangles of the hull, counter-clockwise seen from outside; `None` when all points lie in one plane.
pub(super) fn hull_triangles(points: &[Vec3]) -> Option<Vec<[u32; 3]>> {
    let mut triangles = first_tetrahedron(points)?;
    for point in 0..points.len() as u32 {
        add_point(points, &mut triangles, point);
    }
    Some(triangles)
}

fn add_point(points: &[Vec3], triangles: &mut Vec<[u32; 3]>, point: u32) {
    let mut seen_edges = Vec::new();
    triangles.retain(|&[a, b, c]| {
        let seen = side(points, [a, b, c], point) > 0.0;
        if seen {
            seen_edges.extend([(a, b), (b, c), (c, a)]);
        }
        !seen
    });
    seen_edges.sort_unstable();
    for &(a, b) in &seen_edges {
        if seen_edges.binary_search(&(b, a)).is_err() {
            triangles.push([a, b, point]);
        }
    }
}

/// Above 0 where `point` is in front of the triangle's plane, exactly 0 in it. The sign is exact.
fn side(points: &[Vec3], [a, b, c]: [u32; 3], point: u32) -> f64 {
    let coord = |i: u32| {
        let p = points[i as usize];
        Coord3D { x: p.x, y: p.y, z: p.z }
    };
    -orient3d(coord(a), coord(b), coord(c), coord(point))
}

/// A tetrahedron of far apart points, to start from.
fn first_tetrahedron(points: &[Vec3]) -> Option<Vec<[u32; 3]>> {
    let at = |i: u32| points[i as usize].as_dvec3();
    let a = 0;
    let b = farthest(points, |p| (p - at(a)).length_squared())?;
    let c = farthest(points, |p| (at(b) - at(a)).cross(p - at(a)).length_squared())?;
    let normal = (at(b) - at(a)).cross(at(c) - at(a));
    let d = farthest(points, |p| normal.dot(p - at(a)).abs())?;
    let height = side(points, [a, b, c], d);
    if height < 0.0 {
        Some(vec![[a, b, c], [a, d, b], [b, d, c], [c, d, a]])
    } else if height > 0.0 {
        Some(vec![[a, c, b], [a, b, d], [b, c, d], [c, a, d]])
    } else {
        None
    }
}

/// The first of the points with the largest measure; `None` when no measure is above 0.
fn farthest(points: &[Vec3], measure: impl Fn(DVec3) -> f64) -> Option<u32> {
    let mut best = (0.0, None);
    for (i, point) in points.iter().enumerate() {
        let m = measure(point.as_dvec3());
        if m > best.0 {
            best = (m, Some(i as u32));
        }
    }
    best.1
}
