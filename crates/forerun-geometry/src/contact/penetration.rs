//! Penetration: the shortest way out of an overlap, by the expanding polytope (van den Bergen, 2001).

use glam::DVec3;

use super::gjk::{Simplex, Vertex, Witness, support};
use super::solid::Solid;

/// Smooth pairs are refined up to here; the depth is then known far better than a step can tell.
const VERTICES_MAX: usize = 160;

/// The depth is known when one more vertex would change it by less. Metres.
const DEPTH_KNOWN: f64 = 1.0e-8;

/// A vertex is seen from a facet if it is above the facet's plane by more than this. Metres.
const SEEN: f64 = 1.0e-12;

/// Planes whose distances differ by less are one. Metres.
const SAME_PLANE: f64 = 1.0e-7;

/// A face of the polytope, counter-clockwise seen from outside.
#[derive(Clone, Copy)]
struct Facet {
    corners: [usize; 3],
    /// Unit outward normal; zero for a sliver.
    normal: DVec3,
    /// Of its plane from the origin; infinite for a sliver, which is never the nearest. Metres.
    distance: f64,
}

/// The nearest way to separate two overlapping cores, from the simplex that GJK ended with. None if the difference of
/// the cores has no volume.
pub(super) fn penetration(a: &Solid, b: &Solid, simplex: &Simplex) -> Option<Witness> {
    let mut vertices = tetrahedron(a, b, simplex)?;
    let mut facets: Vec<Facet> = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]
        .into_iter()
        .map(|corners| Facet::new(corners, &vertices))
        .collect();
    loop {
        let nearest =
            *facets.iter().reduce(|best, facet| if facet.distance < best.distance { facet } else { best })?;
        if !nearest.distance.is_finite() {
            return None;
        }
        let vertex = support(a, b, nearest.normal);
        let gain = vertex.w.dot(nearest.normal) - nearest.distance;
        let done = gain <= DEPTH_KNOWN || vertices.len() >= VERTICES_MAX;
        vertices.push(vertex);
        if done || !grow(&mut facets, &vertices) {
            return Some(witness(&nearest, &facets, &vertices));
        }
    }
}

/// The point of the nearest plane that is nearest to the origin, carried back to the two cores.
///
/// An edge against an edge makes a parallelogram of two facets; rounding may pick the one beside the point. So the facet
/// that holds the point is looked for among all that are as near.
fn witness(nearest: &Facet, facets: &[Facet], vertices: &[Vertex]) -> Witness {
    let foot = nearest.normal * nearest.distance;
    let mut weights = nearest.weights(foot, vertices);
    let mut corners = nearest.corners;
    let least = |weights: &[f64; 3]| weights.iter().fold(f64::INFINITY, |least, w| least.min(*w));
    for facet in facets.iter().filter(|facet| facet.distance < nearest.distance + SAME_PLANE) {
        let candidate = facet.weights(foot, vertices);
        if least(&candidate) > least(&weights) {
            (weights, corners) = (candidate, facet.corners);
        }
    }
    let inside = weights.map(|weight| weight.max(0.0));
    let sum = inside[0] + inside[1] + inside[2];
    let [p, q, r] = corners.map(|corner| vertices[corner]);
    let mix = |x: DVec3, y: DVec3, z: DVec3| (x * inside[0] + y * inside[1] + z * inside[2]) / sum;
    Witness {
        on_a: mix(p.on_a, q.on_a, r.on_a),
        on_b: mix(p.on_b, q.on_b, r.on_b),
        // The difference reaches as far beyond the origin as the second shape must go back to leave the first.
        normal: -nearest.normal,
        separation: -nearest.distance,
    }
}

impl Facet {
    fn new(corners: [usize; 3], vertices: &[Vertex]) -> Self {
        let [p, q, r] = corners.map(|corner| vertices[corner].w);
        let across = (q - p).cross(r - p);
        let length = across.length();
        let longest = (q - p).length_squared().max((r - p).length_squared());
        if length <= 1.0e-12 * longest {
            return Facet { corners, normal: DVec3::ZERO, distance: f64::INFINITY };
        }
        let normal = across / length;
        Facet { corners, normal, distance: normal.dot(p) }
    }

    /// Barycentric coordinates of a point of the facet's plane; they add up to 1.
    fn weights(&self, point: DVec3, vertices: &[Vertex]) -> [f64; 3] {
        let [p, q, r] = self.corners.map(|corner| vertices[corner].w - point);
        let double_area = (q - p).cross(r - p).dot(self.normal);
        [q.cross(r), r.cross(p), p.cross(q)].map(|part| part.dot(self.normal) / double_area)
    }
}

/// Replaces all facets that see the last vertex. Says whether the polytope is still whole: rounding may tear a needle's,
/// and what was the nearest facet until then must do.
fn grow(facets: &mut Vec<Facet>, vertices: &[Vertex]) -> bool {
    let newest = vertices.len() - 1;
    let point = vertices[newest].w;
    // The edges between what sees the vertex and what does not.
    let mut horizon: Vec<[usize; 2]> = Vec::new();
    facets.retain(|facet| {
        // A sliver never sees it; its neighbours grow around it.
        let sees = facet.distance.is_finite() && facet.normal.dot(point) - facet.distance > SEEN;
        if sees {
            for k in 0..3 {
                let (from, to) = (facet.corners[k], facet.corners[(k + 1) % 3]);
                match horizon.iter().position(|&edge| edge == [to, from]) {
                    Some(twin) => {
                        horizon.remove(twin);
                    }
                    None => horizon.push([from, to]),
                }
            }
        }
        !sees
    });
    // A whole horizon is one loop: every corner begins one edge of it.
    let torn =
        horizon.iter().enumerate().any(|(k, edge)| horizon[..k].iter().any(|other| other[0] == edge[0]));
    if torn {
        return false;
    }
    facets.extend(horizon.iter().map(|&[from, to]| Facet::new([from, to, newest], vertices)));
    !horizon.is_empty()
}

/// Four vertices around the origin with a volume, counter-clockwise facets as listed by the caller.
fn tetrahedron(a: &Solid, b: &Solid, simplex: &Simplex) -> Option<Vec<Vertex>> {
    let mut vertices = simplex.vertices().to_vec();
    if vertices.len() == 1 {
        let extra = farthest(a, b, &[DVec3::X, DVec3::Y, DVec3::Z], |w| (w - vertices[0].w).length())?;
        vertices.push(extra);
    }
    if vertices.len() == 2 {
        let along = (vertices[1].w - vertices[0].w).normalize_or_zero();
        let across = [along.cross(DVec3::X), along.cross(DVec3::Y), along.cross(DVec3::Z)];
        let extra = farthest(a, b, &across, |w| (w - vertices[0].w).cross(along).length())?;
        vertices.push(extra);
    }
    let normal = (vertices[1].w - vertices[0].w).cross(vertices[2].w - vertices[0].w).normalize_or_zero();
    if vertices.len() == 3 {
        let extra = farthest(a, b, &[normal], |w| (w - vertices[0].w).dot(normal).abs())?;
        vertices.push(extra);
    }
    // Facet 0 1 2 must look away from vertex 3.
    if normal.dot(vertices[3].w - vertices[0].w) > 0.0 {
        vertices.swap(1, 2);
    }
    Some(vertices)
}

/// The vertex that scores most among the supports along both ways of all directions; none if all score nothing.
fn farthest(a: &Solid, b: &Solid, directions: &[DVec3], score: impl Fn(DVec3) -> f64) -> Option<Vertex> {
    let mut best = None;
    let mut most = 1.0e-9;
    for &direction in directions {
        if direction.length_squared() < 1.0e-6 {
            continue;
        }
        for direction in [direction, -direction] {
            let vertex = support(a, b, direction);
            if score(vertex.w) > most {
                most = score(vertex.w);
                best = Some(vertex);
            }
        }
    }
    best
}
