//! Facets: the triangles of a mesh, eight of which at a time are asked how near they are to a point.
//!
//! Promise: in single precision, off by no more than a few ten-millionths of the size of a triangle. The same bits on
//! every processor.

use forerun_lanes::{LANES, LaneMask, Lanes, Row, V8};

use super::nearest::{Feature, Skin};
use super::pseudo_normals::EdgeKind;
use super::triangle::{ON_SURFACE, corners};
use crate::Vec3;
use crate::shape::Mesh;

/// Rows that a triangle takes.
pub(super) const ROWS: u32 = 2;

/// The triangles of a mesh, each in a frame of its own: the first corner is the origin, the first edge the first axis,
/// and the normal the third.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Facets {
    /// Of each triangle: the first corner, the first axis, the length of the first edge, and the inverse of the square
    /// of the second edge's; then the normal, the third corner in the plane, and the inverse of the square of the third edge's.
    rows: Vec<Row>,
}

/// The point of a triangle that is nearest to another point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Seen {
    triangle: u32,
    feature: Feature,
    /// From it to the other point. Metres.
    offset: Vec3,
}

impl Facets {
    pub(super) fn new(mesh: &Mesh) -> Facets {
        let rows = (0..mesh.triangles.len()).flat_map(|t| {
            let [a, b, c] = corners(mesh, t);
            let (ab, ac, bc) = (b - a, c - a, c - b);
            let first = ab.normalize();
            // A triangle that is all but a line has any normal that is at a right angle to it.
            let normal = ab.cross(ac).try_normalize().unwrap_or_else(|| first.any_orthonormal_vector());
            let second = normal.cross(first);
            let inverse = |edge: glam::DVec3| (1.0 / edge.length_squared()) as f32;
            let (n, u) = (normal.as_vec3(), first.as_vec3());
            let (x, y) = (ac.dot(first) as f32, ac.dot(second) as f32);
            let a = a.as_vec3();
            [
                Row([a.x, a.y, a.z, u.x, u.y, u.z, ab.length() as f32, inverse(bc)]),
                Row([n.x, n.y, n.z, x, y, inverse(ac), 0.0, 0.0]),
            ]
        });
        Facets { rows: rows.collect() }
    }

    /// Memory that they take.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.rows)
    }

    /// Unit normal of a triangle.
    fn normal(&self, triangle: u32) -> Vec3 {
        let row = &self.rows[(ROWS * triangle + 1) as usize].0;
        Vec3::new(row[0], row[1], row[2])
    }

    /// Of some triangles, eight at a time and each by the number of its first row, the one that is nearest to a point; of
    /// equally near ones the first.
    #[inline(always)]
    pub(super) fn nearest<F: Lanes>(&self, eights: &[[u32; LANES]], point: Vec3) -> Seen {
        let at = V8::<F>::splat(point.to_array());
        let (mut least, mut which) = (F::splat(f32::INFINITY), F::zero());
        for (k, eight) in eights.iter().enumerate() {
            let squared = self.distances_squared(eight, at);
            let nearer = squared.lt(least);
            least = nearer.select(squared, least);
            which = nearer.select(F::splat(k as f32), which);
        }
        let (least, which) = (least.to_array(), which.to_array());
        let row_of = |lane: usize| eights[which[lane] as usize][lane];
        let mut best = 0;
        for lane in 1..LANES {
            let is_first = least[lane] <= least[best] && row_of(lane) < row_of(best);
            best = if least[lane] < least[best] || is_first { lane } else { best };
        }
        self.seen(row_of(best) / ROWS, point)
    }

    /// The squares of the distances of eight triangles. Square metres.
    #[inline(always)]
    fn distances_squared<F: Lanes>(&self, eight: &[u32; LANES], point: V8<F>) -> F {
        let [ax, ay, az, ux, uy, uz, length, by_bc] = F::gather(&self.rows, eight);
        let [nx, ny, nz, cx, cy, by_ac, ..] = F::gather(&self.rows[1..], eight);
        let (zero, one) = (F::zero(), F::one());
        let (u, n) = (V8 { x: ux, y: uy, z: uz }, V8 { x: nx, y: ny, z: nz });
        let w = point - V8 { x: ax, y: ay, z: az };
        let (x, y, z) = (w.dot(u), w.dot(n.cross(u)), w.dot(n));
        let beyond = x - x.max(zero).min(length);
        let to_ab = beyond * beyond + y * y;
        let (ex, px) = (cx - length, x - length);
        let t = ((px * ex + y * cy) * by_bc).max(zero).min(one);
        let (qx, qy) = (px - t * ex, y - t * cy);
        let to_bc = qx * qx + qy * qy;
        let t = ((x * cx + y * cy) * by_ac).max(zero).min(one);
        let (qx, qy) = (x - t * cx, y - t * cy);
        let to_ac = qx * qx + qy * qy;
        let inside = zero.le(y) & zero.le(ex * y - cy * px) & zero.le(cy * x - cx * y);
        z * z + inside.select(zero, to_ab.min(to_bc).min(to_ac))
    }

    /// The same for one triangle, with the point of it that is nearest.
    fn seen(&self, triangle: u32, point: Vec3) -> Seen {
        let first = (ROWS * triangle) as usize;
        let ([ax, ay, az, ux, uy, uz, length, by_bc], [_, _, _, cx, cy, by_ac, ..]) =
            (self.rows[first].0, self.rows[first + 1].0);
        let (u, n) = (Vec3::new(ux, uy, uz), self.normal(triangle));
        let v = n.cross(u);
        let w = point - Vec3::new(ax, ay, az);
        let (x, y, z) = (w.dot(u), w.dot(v), w.dot(n));
        let (ex, px) = (cx - length, x - length);
        if y >= 0.0 && ex * y - cy * px >= 0.0 && cy * x - cx * y >= 0.0 {
            return Seen { triangle, feature: Feature::Face, offset: n * z };
        }
        let part = |along: f32| along.clamp(0.0, 1.0);
        let (on_bc, on_ac) = (part((px * ex + y * cy) * by_bc), part((x * cx + y * cy) * by_ac));
        let on_ab = x.max(0.0).min(length);
        // By edge: the offset in the plane, and where on the edge from which corner to which.
        let edges = [
            (x - on_ab, y, on_ab / length, [0, 1]),
            (px - on_bc * ex, y - on_bc * cy, on_bc, [1, 2]),
            (x - on_ac * cx, y - on_ac * cy, on_ac, [0, 2]),
        ];
        let squared = edges.map(|(x, y, ..)| x * x + y * y);
        let nearest = if squared[1] < squared[0] { 1 } else { 0 };
        let nearest = if squared[2] < squared[nearest] { 2 } else { nearest };
        let (ox, oy, at, [from, to]) = edges[nearest];
        let feature = if at <= 0.0 {
            Feature::Corner(from)
        } else if at >= 1.0 {
            Feature::Corner(to)
        } else {
            Feature::Edge(nearest)
        };
        Seen { triangle, feature, offset: u * ox + v * oy + n * z }
    }
}

impl Seen {
    /// What is seen of nothing.
    pub(crate) const NOTHING: Seen = Seen { triangle: 0, feature: Feature::Face, offset: Vec3::ZERO };

    /// Whether the nearest point is inside a triangle, not on an edge or corner.
    pub(crate) fn is_on_face(&self) -> bool {
        self.feature == Feature::Face
    }

    /// On which side of the surface the other point is: signed distance (metres) and gradient. See [`Skin::signed`].
    pub(crate) fn signed(&self, skin: &Skin<'_>, facets: &Facets) -> (f32, Vec3) {
        let (n, triangle) = (skin.normals, self.triangle as usize);
        let normal = match self.feature {
            Feature::Face => facets.normal(self.triangle),
            Feature::Edge(k) => n.edge_normals[n.triangle_edges[triangle][k] as usize],
            Feature::Corner(k) => n.vertex_normals[skin.mesh.triangles[triangle][k] as usize],
        };
        let length = self.offset.length();
        let sign = if self.offset.dot(normal) < 0.0 { -1.0 } else { 1.0 };
        // On the surface itself the offset is rounding; the normal is what it stands for.
        let gradient = if length > ON_SURFACE { self.offset * (sign / length) } else { normal };
        // Where parts touch that lie opposite to each other normals cancel out.
        (sign * length, if gradient == Vec3::ZERO { facets.normal(self.triangle) } else { gradient })
    }

    /// Of the planes of the triangles at the nearest point the one that faces `outwards` best: distance (metres) and normal.
    ///
    /// At a corner it is one of the triangle that was found and those next to it; at an edge of more than two triangles the one that was found.
    pub(crate) fn facing(&self, skin: &Skin<'_>, facets: &Facets, outwards: Vec3) -> (f32, Vec3) {
        let own = facets.normal(self.triangle);
        let edges = match self.feature {
            Feature::Face => [None, None],
            Feature::Edge(k) => [Some(k), None],
            Feature::Corner(k) => [Some(k), Some((k + 2) % 3)],
        };
        let mut best = own;
        for k in edges.into_iter().flatten() {
            let edge = skin.normals.triangle_edges[self.triangle as usize][k] as usize;
            // The normal of the edge is halfway between those of its two triangles. Of more it does not tell them.
            let middle = skin.normals.edge_normals[edge];
            let other = middle * (2.0 * own.dot(middle)) - own;
            let is_of_two = !matches!(skin.normals.edge_kinds[edge], EdgeKind::Boundary | EdgeKind::Crowded);
            let is_better = is_of_two && other.dot(outwards) < best.dot(outwards) - 1e-6;
            best = if is_better { other } else { best };
        }
        (self.offset.dot(best), best)
    }
}

#[cfg(test)]
mod tests {
    use forerun_lanes::Portable;

    use super::*;
    use crate::sdf::nearest::nearest;
    use crate::shape::{Enclosure, mesh_make};

    /// Two wedges with one edge in common, along z.
    fn wedges() -> Mesh {
        let mut vertices = vec![Vec3::ZERO, Vec3::Z];
        let mut triangles: Vec<[u32; 3]> = Vec::new();
        for [from, to] in [[0.0_f32, 30.0], [90.0, 140.0]] {
            let first = vertices.len() as u32;
            for angle in [from, to] {
                let (sin, cos) = libm::sincosf(angle.to_radians());
                let end = Vec3::new(cos, sin, 0.0);
                vertices.extend([end, end + Vec3::Z]);
            }
            let [a, b, c, d] = [first, first + 1, first + 2, first + 3];
            let quads = [[0, a, b, 1], [a, c, d, b], [c, 0, 1, d]];
            triangles.extend(quads.iter().flat_map(|[p, q, r, s]| [[*p, *q, *r], [*p, *r, *s]]));
            triangles.extend([[0, c, a], [1, b, d]]);
        }
        Mesh::new(vertices, triangles).expect("a closed mesh")
    }

    #[test]
    fn at_an_edge_of_four_triangles_only_planes_of_triangles_face_anything() {
        let mesh = wedges();
        let (skin, facets) = (Skin::of(&mesh), Facets::new(&mesh));
        assert_eq!((mesh.enclosure, mesh.repairs.crowded_edges), (Enclosure::Closed, 1));
        let eights = [0, 1].map(|k| std::array::from_fn(|i| ROWS * (LANES * k + i) as u32));
        for i in 0..24_u8 {
            let (sin, cos) = libm::sincosf((15.0 * f32::from(i)).to_radians());
            let way = Vec3::new(cos, sin, 0.0);
            let seen = facets.nearest::<Portable>(&eights, way * 0.01 + Vec3::Z * 0.4);
            let inside = (0..30).contains(&(15 * u32::from(i))) || (91..140).contains(&(15 * u32::from(i)));
            let (distance, _) = seen.signed(&skin, &facets);
            assert!(distance.abs() < 1e-6 || (distance < 0.0) == inside, "{distance} at {} degrees", 15 * i);
            for outwards in [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y, way, -way] {
                let (_, normal) = seen.facing(&skin, &facets, outwards);
                let is_of_triangle = (0..16).any(|t| facets.normal(t).distance(normal) < 1e-5);
                assert!(is_of_triangle, "{normal} at {} degrees", 15 * u32::from(i));
            }
        }
        // On the edge itself of cubes opposite to each other normals cancel out.
        let cube = mesh_make::cuboid(Vec3::ONE).expect("a closed mesh");
        let offset = Vec3::new(2.0, 2.0, 0.0);
        let vertices = cube.vertices.iter().copied().chain(cube.vertices.iter().map(|v| *v + offset));
        let triangles = cube.triangles.iter().copied().chain(cube.triangles.iter().map(|t| t.map(|i| i + 8)));
        let mesh = Mesh::new(vertices.collect(), triangles.collect()).expect("a closed mesh");
        let gradient = Skin::of(&mesh).look_up(Vec3::new(1.0, 1.0, 0.3)).gradient;
        assert!((gradient.length() - 1.0).abs() < 1e-6, "{gradient}");
    }

    #[test]
    fn of_eight_triangles_the_nearest_is_found_as_exactly_as_in_double_precision() {
        let part = |i: u32, k: u32| ((i * 7919 + i * i % 613 * k * 104_729) % 2003) as f32 / 2003.0 - 0.5;
        let vector = |i: u32| Vec3::new(part(i, 1), part(i, 2), part(i, 3));
        let mut features = [0; 3];
        for round in 0..200 {
            // Every other time slivers: corners that are almost in line.
            let shrink = if round % 2 == 0 { 1.0 } else { 1e-3 };
            let vertices: Vec<Vec3> =
                (0..48).map(|i| vector(round * 48 + i) * Vec3::new(1.0, shrink, 1.0)).collect();
            let triangles = (0..16).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            let mesh = Mesh::assemble(vertices, triangles);
            let facets = Facets::new(&mesh);
            let eights = [0, 1].map(|k| std::array::from_fn(|i| ROWS * (LANES * k + i) as u32));
            for i in 0..20 {
                let point = vector(round * 31 + i * 7 + 3) * 1.5;
                let seen = facets.nearest::<Portable>(&eights, point);
                let exact = nearest(&mesh, point.as_dvec3(), None);
                assert!(
                    (f64::from(seen.offset.length()) - exact.distance()).abs() < 1e-6,
                    "{seen:?}, {exact:?}"
                );
                features[match seen.feature {
                    Feature::Face => 0,
                    Feature::Edge(_) => 1,
                    Feature::Corner(_) => 2,
                }] += 1;
            }
        }
        assert!(features.iter().all(|n| *n > 50), "{features:?}");
    }
}
