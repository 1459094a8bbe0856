//! Winding: how often a closed surface goes round a point: 1 inside, 0 outside, 2 where two shells overlap.
//!
//! Counted where a half-line from the point leaves the surface, less where it enters it. Which triangles a line passes is told edge by
//! edge, and of the two triangles at an edge both get the same answer: so the count is right also for a line that passes an edge or a
//! corner as nearly as rounding goes, as in Woop, Benthin, Wald, *Watertight Ray/Triangle Intersection* (2013).
//!
//! Needs: triangles that pass each edge as often one way as the other. Promise: right but for points that rounding puts on a triangle.

use glam::DVec3;

use super::triangle::corners;
use crate::Aabb;
use crate::shape::Mesh;

/// How far the half-line along z leans towards x and y: a little, and not along walls that anyone builds.
const LEAN: [f64; 2] = [0.031_37, 0.019_31];

/// How often the triangles of a mesh go round a point that is not on one of them.
pub(crate) fn winding(mesh: &Mesh, point: DVec3) -> i32 {
    let from = leant(point);
    let mut count = 0;
    let visit = |triangle: u32| {
        let [a, b, c] = corners(mesh, triangle as usize);
        count += passes([leant(a) - from, leant(b) - from, leant(c) - from]);
        f64::INFINITY
    };
    mesh.tree().walk(|bounds| is_on_line(bounds, from).then_some(0.0), visit, f64::INFINITY);
    count
}

/// A point where the half-lines are upright. Volumes are as before.
fn leant(point: DVec3) -> DVec3 {
    DVec3::new(point.x - LEAN[0] * point.z, point.y - LEAN[1] * point.z, point.z)
}

/// Whether the half-line up from a point may pass what is in a box. Rounding keeps order, so none is missed.
fn is_on_line(bounds: &Aabb, from: DVec3) -> bool {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let low = leant(DVec3::new(min.x, min.y, max.z));
    let high = leant(DVec3::new(max.x, max.y, min.z));
    low.x <= from.x && from.x <= high.x && low.y <= from.y && from.y <= high.y && from.z <= max.z
}

/// 1 for a triangle that the half-line up from the origin passes from behind, -1 from the front, 0 if it does not.
fn passes(triangle: [DVec3; 3]) -> i32 {
    let [a, b, c] = triangle;
    let around = turn(a, b) + turn(b, c) + turn(c, a);
    // Above the origin is the triangle whose normal the tetrahedron with the origin lies behind.
    let above = around != 0 && a.dot(b.cross(c)) * f64::from(around) > 0.0;
    if above { around } else { 0 }
}

/// Whether an edge seen from above passes the half-line along x: 1 if upwards in y, -1 downwards, 0 if not at all. The other way round
/// it is exactly the opposite.
fn turn(a: DVec3, b: DVec3) -> i32 {
    if (a.y > 0.0) == (b.y > 0.0) {
        return 0;
    }
    let (low, high, way) = if a.y < b.y { (a, b, 1) } else { (b, a, -1) };
    if low.x * high.y - high.x * low.y > 0.0 { way } else { 0 }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::Vec3;
    use crate::shape::mesh_make;

    /// The sum of the solid angles of all triangles (van Oosterom, Strackee, *The Solid Angle of a Plane Triangle*, 1983).
    fn brute_force(mesh: &Mesh, point: DVec3) -> f64 {
        let angle = |t| {
            let [a, b, c] = corners(mesh, t).map(|v| v - point);
            let (la, lb, lc) = (a.length(), b.length(), c.length());
            let adjacent = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
            2.0 * libm::atan2(a.dot(b.cross(c)), adjacent)
        };
        (0..mesh.triangles.len()).map(angle).sum::<f64>() / (4.0 * PI)
    }

    #[test]
    fn the_count_is_the_sum_of_solid_angles() {
        let torus = mesh_make::torus(0.5, 0.2, 60, 30).expect("a closed mesh");
        let inverted = torus.triangles.iter().map(|t| [t[0], t[2], t[1]]);
        let twice = torus.triangles.iter().chain(&torus.triangles).copied();
        let moved = torus.vertices.iter().map(|v| *v + Vec3::X * 0.3);
        let count = torus.vertices.len() as u32;
        let crossing =
            torus.triangles.iter().copied().chain(torus.triangles.iter().map(|t| t.map(|i| i + count)));
        let meshes = [
            Mesh::assemble(torus.vertices.clone(), twice.collect()),
            Mesh::assemble(torus.vertices.clone(), inverted.collect()),
            Mesh::assemble(torus.vertices.iter().copied().chain(moved).collect(), crossing.collect()),
            torus,
        ];
        for mesh in &meshes {
            let mut seen = [0; 4];
            for i in 0..1500_u32 {
                let part = |k: u32| ((i * 7919 + i * i % 613 * k * 104_729) % 2003) as f32 / 2003.0 - 0.5;
                let point = Vec3::new(1.6 * part(1), 0.6 * part(2), 1.6 * part(3)).as_dvec3();
                let (count, sum) = (winding(mesh, point), brute_force(mesh, point));
                assert!((f64::from(count) - sum).abs() < 1e-9, "{count} instead of {sum} at {point}");
                seen[(count + 1).clamp(0, 3) as usize] += 1;
            }
            assert!(seen.iter().filter(|n| **n > 100).count() >= 2, "{seen:?}");
        }
    }

    #[test]
    fn lines_through_corners_and_along_walls_count_once() {
        let cuboid = mesh_make::cuboid(Vec3::new(0.5, 0.25, 1.0)).expect("a closed mesh");
        let lean = DVec3::new(LEAN[0], LEAN[1], 1.0);
        for triangle in 0..cuboid.triangles.len() {
            let [a, b, c] = corners(&cuboid, triangle);
            // Through corners, edges and diagonals of both ends, from below, from inside, and from beside.
            for on in [a, b, c, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5, (a + b + c) / 3.0] {
                for k in -40..=40 {
                    let point = on + lean * (f64::from(k) * 0.0625 + 0.01);
                    let away = point.abs() - DVec3::new(0.5, 0.25, 1.0);
                    if away.max_element().abs() > 1e-9 {
                        let inside = i32::from(away.max_element() < 0.0);
                        assert_eq!(winding(&cuboid, point), inside, "at {point}, through {on}");
                    }
                }
            }
        }
    }
}
