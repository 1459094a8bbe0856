//! Nearest: the point of a mesh nearest to a point, and on which side of the surface that is.
//!
//! Promise: distances are exact up to rounding in double precision. Only + - * / and square roots are used, so they
//! too have the same bits on every target.

use glam::DVec3;

use super::pseudo_normals::{EdgeKind, PseudoNormals};
use super::triangle::{ON_SURFACE, corners, face_normal};
use crate::shape::Mesh;
use crate::{Aabb, Vec3};

/// The surface of a mesh with the normals that tell its sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Skin<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) normals: &'a PseudoNormals,
}

/// The part of a triangle that a point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    Face,
    Edge(usize),
    Corner(usize),
}

/// The nearest point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    distance_squared: f64,
    point: DVec3,
    triangle: usize,
    feature: Feature,
}

impl Nearest {
    /// Metres.
    pub(crate) fn distance(&self) -> f64 {
        self.distance_squared.sqrt()
    }

    /// Of equally near triangles the first is meant, whatever the guess was.
    fn rank(&self) -> (f64, usize) {
        (self.distance_squared, self.triangle)
    }
}

/// A surface point seen from a point, with its side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Signed {
    /// Distance, negative behind the surface. Metres.
    pub(crate) distance: f64,
    /// Gradient of the distance: from the surface outwards. Unit.
    pub(crate) gradient: Vec3,
    /// Whether the surface ends at the nearest point.
    pub(crate) on_boundary: bool,
}

impl<'a> Skin<'a> {
    /// The skin of a finished mesh.
    pub(crate) fn of(mesh: &'a Mesh) -> Skin<'a> {
        Skin { mesh, normals: &mesh.collider().normals }
    }

    /// [`nearest`] on this surface.
    pub(crate) fn nearest(&self, point: DVec3, guess: Option<&Nearest>) -> Nearest {
        nearest(self.mesh, point, guess)
    }

    /// On which side of the surface a point is, and how far, given its nearest point.
    pub(crate) fn signed(&self, point: DVec3, nearest: &Nearest) -> Signed {
        let n = self.normals;
        let (normal, on_boundary) = match nearest.feature {
            Feature::Face => (face_normal(self.mesh, nearest.triangle), false),
            Feature::Edge(k) => {
                let edge = n.triangle_edges[nearest.triangle][k] as usize;
                (n.edge_normals[edge].as_dvec3(), n.edge_kinds[edge] == EdgeKind::Boundary)
            }
            Feature::Corner(k) => {
                let corner = self.mesh.triangles[nearest.triangle][k] as usize;
                (n.vertex_normals[corner].as_dvec3(), n.vertex_on_boundary[corner])
            }
        };
        let offset = point - nearest.point;
        let length = nearest.distance_squared.sqrt();
        let sign = if offset.dot(normal) < 0.0 { -1.0 } else { 1.0 };
        // On the surface itself the offset is rounding; the normal is what it stands for.
        let gradient = if length > f64::from(ON_SURFACE) { offset * (sign / length) } else { normal };
        // Where parts touch that lie opposite to each other normals cancel out.
        let gradient =
            if gradient == DVec3::ZERO { face_normal(self.mesh, nearest.triangle) } else { gradient };
        Signed { distance: sign * length, gradient: gradient.as_vec3(), on_boundary }
    }

    /// [`Skin::signed`] of the nearest point.
    pub(crate) fn look_up(&self, point: Vec3) -> Signed {
        let point = point.as_dvec3();
        self.signed(point, &self.nearest(point, None))
    }
}

/// The point of the triangles nearest to `point`. `guess`, an earlier answer for a point close by, makes it quick.
pub(crate) fn nearest(mesh: &Mesh, point: DVec3, guess: Option<&Nearest>) -> Nearest {
    let mut best = nearest_on(mesh, guess.map_or(0, |g| g.triangle), point);
    let limit = best.distance_squared;
    let distance = |bounds: &Aabb| Some(distance_squared(bounds, point));
    let visit = |triangle: u32| {
        let candidate = nearest_on(mesh, triangle as usize, point);
        if candidate.rank() < best.rank() {
            best = candidate;
        }
        best.distance_squared
    };
    mesh.tree().walk(distance, visit, limit);
    best
}

/// The triangles no farther from a point than a limit (metres), in the order of their numbers; none if they are more than `most`.
pub(crate) fn near_triangles(mesh: &Mesh, point: DVec3, limit: f64, most: usize) -> Option<Vec<u32>> {
    let mut found = Vec::new();
    let distance = |bounds: &Aabb| Some(distance_squared(bounds, point));
    let visit = |triangle: u32| {
        if triangle_distance(mesh, triangle, point) <= limit {
            found.push(triangle);
        }
        // Nothing more is near enough once they are too many.
        if found.len() > most { -1.0 } else { limit * limit }
    };
    mesh.tree().walk(distance, visit, limit * limit);
    found.sort_unstable();
    (found.len() <= most).then_some(found)
}

/// How far a triangle is from a point. Metres.
pub(crate) fn triangle_distance(mesh: &Mesh, triangle: u32, point: DVec3) -> f64 {
    nearest_on(mesh, triangle as usize, point).distance()
}

fn nearest_on(mesh: &Mesh, triangle: usize, point: DVec3) -> Nearest {
    let (nearest, feature) = nearest_on_triangle(point, corners(mesh, triangle));
    Nearest { distance_squared: point.distance_squared(nearest), point: nearest, triangle, feature }
}

fn distance_squared(bounds: &Aabb, point: DVec3) -> f64 {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    (min - point).max(point - max).max(DVec3::ZERO).length_squared()
}

/// The nearest point of a triangle (Ericson, *Real-Time Collision Detection*, section 5.1.5) and what it lies on.
fn nearest_on_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> (DVec3, Feature) {
    let (ab, ac) = (b - a, c - a);
    let ap = p - a;
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, Feature::Corner(0));
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, Feature::Corner(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * (d1 / (d1 - d3)), Feature::Edge(0));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, Feature::Corner(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * (d2 / (d2 - d6)), Feature::Edge(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return (b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), Feature::Edge(1));
    }
    let inverse = 1.0 / (va + vb + vc);
    (a + ab * (vb * inverse) + ac * (vc * inverse), Feature::Face)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sdf::triangle::face_vector;

    /// A cube of half extent 1 with a pyramid cut into its top: convex and concave edges and corners.
    fn notched_cube() -> Mesh {
        let mut vertices: Vec<Vec3> = (0_u8..8)
            .map(|k| {
                Vec3::new(f32::from(k & 1), f32::from(k >> 1 & 1), f32::from(k >> 2 & 1)) * 2.0 - Vec3::ONE
            })
            .collect();
        vertices.push(Vec3::new(0.1, 0.2, -0.1));
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [0, 2, 3, 1], [4, 5, 7, 6]];
        let mut triangles: Vec<[u32; 3]> =
            quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        triangles.extend([[2, 6, 8], [6, 7, 8], [7, 3, 8], [3, 2, 8]]);
        Mesh::new(vertices, triangles).expect("closed")
    }

    /// Inside by counting crossings of a slanted ray.
    fn is_inside(mesh: &Mesh, p: DVec3) -> bool {
        let way = DVec3::new(0.137, 0.951, 0.277);
        let crossings = (0..mesh.triangles.len()).filter(|t| {
            let [a, b, c] = corners(mesh, *t).map(|v| v - p);
            let volumes = [a.cross(b).dot(way), b.cross(c).dot(way), c.cross(a).dot(way)];
            let through = volumes.iter().all(|v| *v > 0.0) || volumes.iter().all(|v| *v < 0.0);
            let n = face_vector([a, b, c]);
            through && a.dot(n) / way.dot(n) > 0.0
        });
        crossings.count() % 2 == 1
    }

    #[test]
    fn nearest_points_and_sides_agree_with_brute_force() {
        let mesh = notched_cube();
        let skin = Skin::of(&mesh);
        let mut guess = None;
        let (mut inside, mut features) = (0, [0; 3]);
        for i in 0..4000_u32 {
            let part = |k: u32| f64::from((i * 7919 + i * i % 613 * k * 104_729) % 4001) / 4001.0 * 4.0 - 2.0;
            let p = DVec3::new(part(1), part(2), part(3));
            let nearest = skin.nearest(p, guess.as_ref());
            let all = (0..mesh.triangles.len()).map(|t| nearest_on(&mesh, t, p).distance_squared);
            let brute = all.fold(f64::INFINITY, f64::min);
            assert!((nearest.distance_squared - brute).abs() < 1e-12, "{p}");
            let signed = skin.signed(p, &nearest);
            if signed.distance.abs() > 1e-6 {
                assert_eq!(signed.distance < 0.0, is_inside(&mesh, p), "side of {p}, nearest {nearest:?}");
            }
            inside += u32::from(signed.distance < 0.0);
            features[match nearest.feature {
                Feature::Face => 0,
                Feature::Edge(_) => 1,
                Feature::Corner(_) => 2,
            }] += 1;
            guess = Some(nearest);
        }
        assert!(inside > 200 && features.iter().all(|n| *n > 100), "{inside} inside, {features:?}");
    }

    #[test]
    fn edges_are_known_by_their_form() {
        let mesh = notched_cube();
        let kinds = &mesh.collider().normals.edge_kinds;
        let count = |kind| kinds.iter().filter(|k| **k == kind).count();
        // Twelve edges of the cube, four down into the notch, and the diagonals of five faces.
        assert_eq!(
            [EdgeKind::Ridge, EdgeKind::Valley, EdgeKind::Flat, EdgeKind::Boundary].map(count),
            [12, 4, 5, 0]
        );
    }
}
