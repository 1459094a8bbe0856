//! True mesh: how deep a point lies inside a triangle mesh, from its triangles alone, by code that no engine uses.
//!
//! The side is told by the normal at the nearest feature, weighted by angle at corners (Bærentzen, Aanæs, *Signed Distance Computation Using the Angle
//! Weighted Pseudonormal*, 2005). A coarse grid that fills up as it is asked leaves out points that cannot be deeper than one already known.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::Arc;

use forerun::geometry::shape::Mesh;
use forerun::{Aabb, Vec3};

/// Cells of the grid along the longest side of the mesh.
const GRID_CELLS: f32 = 32.0;

/// A closed triangle mesh that can be asked for depths.
pub(crate) struct TrueMesh {
    mesh: Arc<Mesh>,
    normals: Normals,
    grid: Grid,
}

/// Outward normals of the features. Those of edges and corners are not unit: only their side counts.
struct Normals {
    faces: Vec<Vec3>,
    /// Of the edges from corner 0 to 1, 1 to 2 and 2 to 0 of each triangle.
    edges: Vec<[Vec3; 3]>,
    vertices: Vec<Vec3>,
}

/// Cubes over the bounds of the mesh.
struct Grid {
    bounds: Aabb,
    /// Side of a cube. Metres.
    cell: f32,
    size: [usize; 3],
    /// Depth in the middle of each cube, not a number until it is asked for. Metres.
    depths: Vec<Cell<f32>>,
}

/// The point of a triangle nearest to another, and the normal of the feature that it is on.
#[derive(Clone, Copy)]
struct Nearest {
    distance_squared: f32,
    point: Vec3,
    normal: Vec3,
}

impl TrueMesh {
    pub(crate) fn new(mesh: Arc<Mesh>) -> Self {
        let bounds = mesh.bounds();
        let extents = bounds.max - bounds.min;
        let cell = (extents.max_element() / GRID_CELLS).max(f32::MIN_POSITIVE);
        let size = extents.to_array().map(|side| (side / cell).ceil().max(1.0) as usize);
        let depths = vec![Cell::new(f32::NAN); size.iter().product()];
        TrueMesh { normals: Normals::of(&mesh), mesh, grid: Grid { bounds, cell, size, depths } }
    }

    /// How deep a point of the mesh's frame lies inside, if that is more than `least`, which is 0 or more. Metres.
    pub(crate) fn depth_above(&self, point: Vec3, least: f32) -> Option<f32> {
        let (index, middle) = self.grid.cube_of(point)?;
        let cell = &self.grid.depths[index];
        if cell.get().is_nan() {
            cell.set(-self.signed_distance(middle));
        }
        // Depth changes by no more than the way that is gone.
        if cell.get() + point.distance(middle) <= least {
            return None;
        }
        let depth = -self.signed_distance(point);
        (depth > least).then_some(depth)
    }

    /// Distance to the surface, negative inside. Metres.
    pub(crate) fn signed_distance(&self, point: Vec3) -> f32 {
        let bounds = self.mesh.bounds();
        let mut reach = self.grid.cell + bounds.closest_point(point).distance(point);
        loop {
            match self.nearest(point, reach) {
                // Triangles beyond the box that was looked through are at least `reach` away.
                Some(nearest) if nearest.distance_squared <= reach * reach => {
                    let away = point - nearest.point;
                    return nearest.distance_squared.sqrt().copysign(away.dot(nearest.normal));
                }
                Some(nearest) => reach = nearest.distance_squared.sqrt() * 1.001,
                None => reach *= 2.0,
            }
        }
    }

    /// The nearest point of the triangles that are within `reach` of a point, and some more.
    fn nearest(&self, point: Vec3, reach: f32) -> Option<Nearest> {
        let mut best: Option<Nearest> = None;
        self.mesh.triangles_near(&Aabb::from_centre(point, Vec3::splat(reach)), |triangle| {
            let found = self.nearest_on(triangle as usize, point);
            if best.is_none_or(|best| found.distance_squared < best.distance_squared) {
                best = Some(found);
            }
        });
        best
    }

    /// Ericson, *Real-Time Collision Detection*, section 5.1.5.
    fn nearest_on(&self, triangle: usize, p: Vec3) -> Nearest {
        let [a, b, c] = self.mesh.corners(triangle);
        let Normals { faces, edges, vertices } = &self.normals;
        let corner = |k: usize| vertices[self.mesh.triangles[triangle][k] as usize];
        let edge = |k: usize| edges[triangle][k];
        let (ab, ac) = (b - a, c - a);
        let (d1, d2) = (ab.dot(p - a), ac.dot(p - a));
        let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
        let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
        let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
        let (point, normal) = if d1 <= 0.0 && d2 <= 0.0 {
            (a, corner(0))
        } else if d3 >= 0.0 && d4 <= d3 {
            (b, corner(1))
        } else if d6 >= 0.0 && d5 <= d6 {
            (c, corner(2))
        } else if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
            (a + ab * (d1 / (d1 - d3)), edge(0))
        } else if va <= 0.0 && d4 >= d3 && d5 >= d6 {
            (b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), edge(1))
        } else if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
            (a + ac * (d2 / (d2 - d6)), edge(2))
        } else {
            let sum = va + vb + vc;
            (a + ab * (vb / sum) + ac * (vc / sum), faces[triangle])
        };
        Nearest { distance_squared: p.distance_squared(point), point, normal }
    }
}

impl Normals {
    fn of(mesh: &Mesh) -> Self {
        let mut vertices = vec![Vec3::ZERO; mesh.vertices.len()];
        let mut by_edge: BTreeMap<[u32; 2], Vec3> = BTreeMap::new();
        let mut faces = Vec::with_capacity(mesh.triangles.len());
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            let corners = mesh.corners(t);
            let face = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
            for k in 0..3 {
                let (to_next, to_last) =
                    (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
                vertices[triangle[k] as usize] += face * to_next.angle_between(to_last);
                *by_edge.entry(ends(triangle, k)).or_default() += face;
            }
            faces.push(face);
        }
        let edges = mesh.triangles.iter().map(|t| [0, 1, 2].map(|k| by_edge[&ends(t, k)])).collect();
        Normals { faces, edges, vertices }
    }
}

/// The vertices of a triangle's edge, the smaller index first.
pub(crate) fn ends(triangle: &[u32; 3], edge: usize) -> [u32; 2] {
    let (a, b) = (triangle[edge], triangle[(edge + 1) % 3]);
    [a.min(b), a.max(b)]
}

impl Grid {
    /// Index and middle of the cube that a point is in; none outside the bounds.
    fn cube_of(&self, point: Vec3) -> Option<(usize, Vec3)> {
        if !self.bounds.contains(point) {
            return None;
        }
        let place = ((point - self.bounds.min) / self.cell).to_array();
        let [x, y, z] = [0, 1, 2].map(|k| (place[k] as usize).min(self.size[k] - 1));
        let middle = self.bounds.min + (Vec3::new(x as f32, y as f32, z as f32) + 0.5) * self.cell;
        Some(((z * self.size[1] + y) * self.size[0] + x, middle))
    }
}

#[cfg(test)]
mod tests {
    use forerun::Shape;

    use super::*;
    use crate::stage::Stage;

    fn ring() -> TrueMesh {
        let stage = Stage::of(&forerun::Scene::open("tori:1").unwrap()).unwrap();
        let Shape::Mesh(mesh) = &stage.actors[1].def.shape else { panic!("not a mesh") };
        TrueMesh::new(mesh.clone())
    }

    fn points() -> impl Iterator<Item = Vec3> {
        let part = |i: u32, irrational: f32| (i as f32 * irrational).fract() * 2.0 - 1.0;
        (0..4000).map(move |i| Vec3::new(part(i, 0.618_034), 0.3 * part(i, 0.414_214), part(i, 0.732_051)))
    }

    #[test]
    fn a_ring_is_as_deep_as_its_formula_says() {
        let ring = ring();
        let mut inside = 0;
        for p in points() {
            // Radii 0.5 and 0.2 m, axis y; the mesh of 48 x 16 is up to 0.2 (1 - cos(π/16)) + 0.7 (1 - cos(π/48)) smaller.
            let from_middle = Vec3::new(p.x.hypot(p.z) - 0.5, p.y, 0.0).length();
            let found = ring.signed_distance(p);
            let smaller = found - (from_middle - 0.2);
            assert!((-0.001..0.007).contains(&smaller), "{found} at {p}, formula {}", from_middle - 0.2);
            inside += u32::from(found < 0.0);
        }
        assert!(inside > 500, "{inside} inside");
    }

    #[test]
    fn the_nearest_triangle_is_that_of_all_and_the_grid_leaves_out_nothing() {
        let ring = ring();
        let all = 0..ring.mesh.triangles.len();
        for p in points().step_by(37) {
            let found = ring.signed_distance(p);
            let brute =
                all.clone().map(|t| ring.nearest_on(t, p).distance_squared).fold(f32::INFINITY, f32::min);
            assert!((found.abs() - brute.sqrt()).abs() < 1e-6, "{found} at {p}, of all {}", brute.sqrt());
        }
        for p in points() {
            let depth = -ring.signed_distance(p);
            for least in [0.0, 0.05, 0.15] {
                assert_eq!(ring.depth_above(p, least), (depth > least).then_some(depth), "{p}");
            }
        }
    }
}
