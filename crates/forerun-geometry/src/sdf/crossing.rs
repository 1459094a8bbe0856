//! Crossing: whether triangles of a mesh that have no corner in common meet.
//!
//! Promise: no crossing is missed; walls nearer to each other than a little may count as crossing.

use glam::DVec3;
use rayon::prelude::*;

use super::triangle::corners;
use crate::Aabb;
use crate::shape::Mesh;

/// Walls nearer to each other than this part of the size of the mesh count as crossing: they may as well touch.
const TOUCHING: f64 = 1e-6;

/// How near to each other walls of a mesh touch. Metres.
pub(crate) fn touching(mesh: &Mesh) -> f64 {
    TOUCHING * f64::from(mesh.bounds().half_extents().length())
}

/// Whether two triangles of a mesh without a common corner cross or touch.
pub(crate) fn has_crossings(mesh: &Mesh) -> bool {
    let near = touching(mesh);
    (0..mesh.triangles.len()).into_par_iter().any(|t| {
        let own = corners(mesh, t);
        let around = Aabb::around(mesh.corners(t).into_iter()).grown(near as f32);
        let is_neighbour = |other: usize| {
            let others = &mesh.triangles[other];
            mesh.triangles[t].iter().any(|corner| others.contains(corner))
        };
        let mut found = false;
        let visit = |other: u32| {
            let other = other as usize;
            // Each pair once. Nothing more is near enough once one is found.
            found |= other > t && !is_neighbour(other) && meet(own, corners(mesh, other), near);
            if found { -1.0 } else { f64::INFINITY }
        };
        mesh.tree().walk(|bounds| bounds.overlaps(&around).then_some(0.0), visit, f64::INFINITY);
        found
    })
}

/// Whether no plane keeps two triangles farther apart than `near`: it would lie along one of them, or along an edge of each
/// (separating axes; Ericson, *Real-Time Collision Detection*, section 5.2.1).
fn meet(a: [DVec3; 3], b: [DVec3; 3], near: f64) -> bool {
    let edges = |t: [DVec3; 3]| [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let (of_a, of_b) = (edges(a), edges(b));
    let normals = [of_a[0].cross(of_a[1]), of_b[0].cross(of_b[1])];
    if normals.iter().any(|axis| apart(a, b, *axis, near)) {
        return false;
    }
    let across = of_a.iter().flat_map(|e| of_b.iter().map(|f| e.cross(*f)));
    // Triangles in one plane are kept apart by edges and planes upright on them.
    let upright = of_a.iter().map(|e| e.cross(normals[0])).chain(of_b.iter().map(|e| e.cross(normals[1])));
    !across.chain(upright).any(|axis| apart(a, b, axis, near))
}

/// Whether the extents of two triangles along an axis are farther apart than `near`.
fn apart(a: [DVec3; 3], b: [DVec3; 3], axis: DVec3, near: f64) -> bool {
    let span = |t: [DVec3; 3]| {
        // About a corner of one: far from the origin the products would lose their last digits.
        let [p, q, r] = t.map(|v| (v - a[0]).dot(axis));
        (p.min(q).min(r), p.max(q).max(r))
    };
    let ((a_low, a_high), (b_low, b_high)) = (span(a), span(b));
    (a_low - b_high).max(b_low - a_high) > near * axis.length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::shape::mesh_make;

    fn moved(mesh: &Mesh, offset: Vec3) -> Mesh {
        let count = mesh.vertices.len() as u32;
        let vertices = mesh.vertices.iter().copied().chain(mesh.vertices.iter().map(|v| *v + offset));
        let triangles =
            mesh.triangles.iter().copied().chain(mesh.triangles.iter().map(|t| t.map(|i| i + count)));
        Mesh::assemble(vertices.collect(), triangles.collect())
    }

    #[test]
    fn shells_cross_where_they_overlap_or_touch_and_nowhere_else() {
        let torus = mesh_make::torus(0.5, 0.2, 48, 16).expect("a closed mesh");
        assert!(!has_crossings(&torus));
        // Round the tube 0.2 from the ring: linked with a copy that it crosses, beside one that it does not.
        assert!(has_crossings(&moved(&torus, Vec3::X * 0.3)));
        assert!(!has_crossings(&moved(&torus, Vec3::X * 1.41)));
        assert!(!has_crossings(&moved(&torus, Vec3::Y * 0.41)));
        let cuboid = mesh_make::cuboid(Vec3::splat(0.5)).expect("a closed mesh");
        assert!(has_crossings(&moved(&cuboid, Vec3::X)), "they touch");
        assert!(!has_crossings(&moved(&cuboid, Vec3::X * 1.001)));
        assert!(has_crossings(&moved(&cuboid, Vec3::new(0.999, 0.999, 0.999))), "by a corner");
    }

    /// Whether a segment passes a triangle, by signs of volumes.
    fn passes([p, q]: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> bool {
        let volume = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (b - a).cross(c - a).dot(d - a);
        let sides = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
        let through = sides.iter().all(|v| *v > 0.0) || sides.iter().all(|v| *v < 0.0);
        through && volume(a, b, c, p) * volume(a, b, c, q) < 0.0
    }

    #[test]
    fn triangles_meet_exactly_where_an_edge_of_one_passes_the_other() {
        let mut state = 1_u32;
        let mut number = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        let mut met = 0;
        for _ in 0..3000 {
            let mut point = || DVec3::new(number(), number(), number());
            let (a, b) = ([point(), point(), point()], [point(), point(), point()]);
            let edges = |t: [DVec3; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
            let crosses = edges(a).iter().any(|e| passes(*e, b)) || edges(b).iter().any(|e| passes(*e, a));
            assert_eq!(meet(a, b, 1e-12), crosses, "{a:?} {b:?}");
            met += u32::from(crosses);
        }
        assert!((300..2700).contains(&met), "{met} of 3000 meet");
    }
}
