//! Nearest: the point of a mesh nearest to a point, and on which side of the surface that is.
//!
//! Promise: distances are exact up to rounding in double precision. Only + - * / and square roots are used, so they
//! too have the same bits on every target.

use glam::DVec3;

use super::pseudo_normals::{EdgeKind, PseudoNormals, corners, face_normal};
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
enum Feature {
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

    /// The point of the surface nearest to `point`. `guess`, an earlier answer for a point close by, makes it quick.
    pub(crate) fn nearest(&self, point: DVec3, guess: Option<&Nearest>) -> Nearest {
        let mut best = self.nearest_on(guess.map_or(0, |g| g.triangle), point);
        let limit = best.distance_squared;
        let distance = |bounds: &Aabb| Some(distance_squared(bounds, point));
        let visit = |triangle: u32| {
            let candidate = self.nearest_on(triangle as usize, point);
            if candidate.distance_squared < best.distance_squared {
                best = candidate;
            }
            best.distance_squared
        };
        self.mesh.tree().walk(distance, visit, limit);
        best
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
        let gradient = if length > 1e-7 { offset * (sign / length) } else { normal };
        Signed { distance: sign * length, gradient: gradient.as_vec3(), on_boundary }
    }

    /// [`Skin::signed`] of the nearest point.
    pub(crate) fn look_up(&self, point: Vec3) -> Signed {
        let point = point.as_dvec3();
        self.signed(point, &self.nearest(point, None))
    }

    fn nearest_on(&self, triangle: usize, point: DVec3) -> Nearest {
        let (nearest, feature) = nearest_on_triangle(point, corners(self.mesh, triangle));
        Nearest { distance_squared: point.distance_squared(nearest), point: nearest, triangle, feature }
    }
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
