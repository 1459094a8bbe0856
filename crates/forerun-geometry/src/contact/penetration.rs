//! Penetration: the shortest way out of an overlap, by the expanding polytope (van den Bergen, 2001).

use glam::DVec3;

use super::gjk::{Simplex, Vertex, Witness, support};
use super::solid::Solid;

/// Smooth pairs are refined up to here; the depth is then known far better than a step can tell.
const VERTICES_MAX: usize = 160;

/// The depth is known when one more vertex would change it by less. Metres.
const DEPTH_KNOWN: f64 = 1.0e-8;

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
        if gain <= DEPTH_KNOWN || vertices.len() >= VERTICES_MAX {
            return Some(nearest.witness(&vertices));
        }
        vertices.push(vertex);
        if !grow(&mut facets, &vertices) {
            return Some(nearest.witness(&vertices));
        }
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

    /// The point of the facet that is nearest to the origin, carried back to the two cores.
    fn witness(&self, vertices: &[Vertex]) -> Witness {
        let [p, q, r] = self.corners.map(|corner| vertices[corner]);
        let foot = self.normal * self.distance;
        let area = |x: DVec3, y: DVec3| (x - foot).cross(y - foot).dot(self.normal).max(0.0);
        let parts = [area(q.w, r.w), area(r.w, p.w), area(p.w, q.w)];
        let sum = parts[0] + parts[1] + parts[2];
        let weights = if sum > 0.0 { parts.map(|part| part / sum) } else { [1.0, 0.0, 0.0] };
        let on_a = p.on_a * weights[0] + q.on_a * weights[1] + r.on_a * weights[2];
        let on_b = p.on_b * weights[0] + q.on_b * weights[1] + r.on_b * weights[2];
        // Moving the second by -n d takes the origin out: it leaves the first along the opposite of the facet's normal.
        Witness { on_a, on_b, normal: -self.normal, separation: -self.distance }
    }
}

/// Replaces all facets that see the last vertex. Says whether there were any.
fn grow(facets: &mut Vec<Facet>, vertices: &[Vertex]) -> bool {
    let newest = vertices.len() - 1;
    let point = vertices[newest].w;
    let mut horizon: Vec<[usize; 2]> = Vec::new();
    let before = facets.len();
    facets.retain(|facet| {
        let sees = if facet.distance.is_finite() {
            facet.normal.dot(point) - facet.distance > 1.0e-12
        } else {
            // A sliver goes with the neighbours that it is nearly an edge of.
            false
        };
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
    facets.extend(horizon.iter().map(|&[from, to]| Facet::new([from, to, newest], vertices)));
    facets.len() != before || !horizon.is_empty()
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
