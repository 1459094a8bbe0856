//! Topology: which triangles share which edges, and the pseudo-normals that tell inside from outside.
//!
//! Promise: vertices at the same place count as one; triangles without an area are left out.

use glam::DVec3;

use crate::Vec3;

/// A triangle of a [`Topology`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Triangle {
    /// Its vertices, counter-clockwise seen from outside.
    pub(crate) corners: [u32; 3],
    /// Its edges: edge k runs from corner k to the next.
    pub(crate) edges: [u32; 3],
}

/// Triangles, edges and vertices with their angle-weighted normals.
///
/// Bærentzen and Aanæs, *Signed Distance Computation Using the Angle Weighted Pseudonormal* (2005): with these normals
/// a point is outside a closed surface exactly where the offset from its nearest surface point has a positive product
/// with the normal of the face, edge or vertex that this point lies on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Topology {
    /// Vertices. Metres.
    pub(crate) vertices: Vec<Vec3>,
    /// Unit normal at each vertex, weighted by the angles of its triangles.
    pub(crate) vertex_normals: Vec<Vec3>,
    /// Whether each vertex lies on an edge that [`EdgeKind::Boundary`] names.
    pub(crate) vertex_on_boundary: Vec<bool>,
    /// Vertices of each edge, the lower index first.
    pub(crate) edges: Vec<[u32; 2]>,
    /// Unit normal at each edge: the sum of its triangles' normals.
    pub(crate) edge_normals: Vec<Vec3>,
    /// What each edge is.
    pub(crate) edge_kinds: Vec<EdgeKind>,
    /// Triangles.
    pub(crate) triangles: Vec<Triangle>,
}

/// What the triangles do at an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EdgeKind {
    /// Its triangles bend away from the outside: another surface can touch it.
    Ridge,
    /// Its triangles bend towards the outside.
    Valley,
    /// Its triangles lie in one plane.
    Flat,
    /// Triangles are missing: the surface ends here.
    Boundary,
}

/// Cosine of the angle between normals above which an edge counts as flat: 5 degrees.
const FLAT_COSINE: f64 = 0.996_194_7;

impl Topology {
    /// The topology of triangles that index vertices.
    pub(crate) fn new(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Topology {
        let (vertices, names) = weld(vertices);
        let corners = triangles.iter().map(|t| t.map(|i| names[i as usize]));
        let corners: Vec<[u32; 3]> =
            corners.filter(|c| normal_times_area(&vertices, *c).length_squared() > 0.0).collect();
        let mut edges: Vec<[u32; 2]> = corners.iter().flat_map(|c| edges_of(*c)).collect();
        edges.sort_unstable();
        edges.dedup();
        let edge_index = |edge: [u32; 2]| edges.partition_point(|e| *e < edge) as u32;
        let triangles: Vec<Triangle> =
            corners.iter().map(|c| Triangle { corners: *c, edges: edges_of(*c).map(edge_index) }).collect();
        let (edge_normals, edge_kinds) = edge_normals(&vertices, &triangles, edges.len());
        let mut vertex_on_boundary = vec![false; vertices.len()];
        for (edge, kind) in edges.iter().zip(&edge_kinds) {
            if *kind == EdgeKind::Boundary {
                for v in edge {
                    vertex_on_boundary[*v as usize] = true;
                }
            }
        }
        let vertex_normals = vertex_normals(&vertices, &triangles);
        Topology { vertices, vertex_normals, vertex_on_boundary, edges, edge_normals, edge_kinds, triangles }
    }

    /// Whether the surface has no boundary.
    pub(crate) fn is_closed(&self) -> bool {
        !self.triangles.is_empty() && !self.edge_kinds.contains(&EdgeKind::Boundary)
    }

    /// Enclosed volume; negative where the triangles are wound inside out. Cubic metres.
    pub(crate) fn volume(&self) -> f64 {
        let six_volumes = self.triangles.iter().map(|t| {
            let [a, b, c] = self.corners(t);
            a.dot(b.cross(c))
        });
        six_volumes.sum::<f64>() / 6.0
    }

    /// The corners of a triangle.
    pub(crate) fn corners(&self, triangle: &Triangle) -> [DVec3; 3] {
        triangle.corners.map(|i| self.vertices[i as usize].as_dvec3())
    }
}

/// The vertices at different places, and for each given vertex which of them it is.
fn weld(vertices: &[Vec3]) -> (Vec<Vec3>, Vec<u32>) {
    let place = |i: u32| {
        // -0 + 0 is +0: both zeros are the same place.
        let v = vertices[i as usize] + Vec3::ZERO;
        [v.x.to_bits(), v.y.to_bits(), v.z.to_bits()]
    };
    let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
    order.sort_unstable_by_key(|i| (place(*i), *i));
    let mut first_there = vec![0_u32; vertices.len()];
    for pair in order.chunk_by(|a, b| place(*a) == place(*b)) {
        for i in pair {
            first_there[*i as usize] = pair[0];
        }
    }
    let mut names = vec![0_u32; vertices.len()];
    let mut welded = Vec::new();
    for (i, vertex) in vertices.iter().enumerate() {
        if first_there[i] == i as u32 {
            names[i] = welded.len() as u32;
            welded.push(*vertex);
        } else {
            names[i] = names[first_there[i] as usize];
        }
    }
    (welded, names)
}

fn edges_of(c: [u32; 3]) -> [[u32; 2]; 3] {
    [(c[0], c[1]), (c[1], c[2]), (c[2], c[0])].map(|(a, b)| [a.min(b), a.max(b)])
}

fn normal_times_area(vertices: &[Vec3], corners: [u32; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|i| vertices[i as usize].as_dvec3());
    (b - a).cross(c - a) * 0.5
}

fn edge_normals(vertices: &[Vec3], triangles: &[Triangle], edges: usize) -> (Vec<Vec3>, Vec<EdgeKind>) {
    let mut sums = vec![DVec3::ZERO; edges];
    let mut counts = vec![0_i32; edges];
    // Triangles that run along the edge upwards less those that run downwards: 0 where the surface goes on.
    let mut balance = vec![0_i32; edges];
    for triangle in triangles {
        let normal = normal_times_area(vertices, triangle.corners).normalize();
        for (k, edge) in triangle.edges.into_iter().enumerate() {
            let upwards = triangle.corners[k] < triangle.corners[(k + 1) % 3];
            sums[edge as usize] += normal;
            counts[edge as usize] += 1;
            balance[edge as usize] += if upwards { 1 } else { -1 };
        }
    }
    let normals: Vec<Vec3> = sums.iter().map(|s| s.normalize_or_zero().as_vec3()).collect();
    let heights = apex_heights(vertices, triangles, &normals);
    let kind = |k: usize| {
        let mean = sums[k].length() / f64::from(counts[k].max(1));
        if balance[k] != 0 {
            EdgeKind::Boundary
        } else if 2.0 * mean * mean - 1.0 > FLAT_COSINE {
            // The mean of two unit vectors is as long as the cosine of half the angle between them.
            EdgeKind::Flat
        } else if heights[k] <= 0.0 {
            EdgeKind::Ridge
        } else {
            EdgeKind::Valley
        }
    };
    let kinds = (0..edges).map(kind).collect();
    (normals, kinds)
}

/// For each edge how far its triangles rise from it along its normal, in all: negative for ridges.
fn apex_heights(vertices: &[Vec3], triangles: &[Triangle], edge_normals: &[Vec3]) -> Vec<f32> {
    let mut heights = vec![0.0; edge_normals.len()];
    for triangle in triangles {
        for (k, edge) in triangle.edges.into_iter().enumerate() {
            let [from, apex] = [k, (k + 2) % 3].map(|c| vertices[triangle.corners[c] as usize]);
            heights[edge as usize] += edge_normals[edge as usize].dot(apex - from);
        }
    }
    heights
}

fn vertex_normals(vertices: &[Vec3], triangles: &[Triangle]) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; vertices.len()];
    for triangle in triangles {
        let normal = normal_times_area(vertices, triangle.corners).normalize();
        let p = triangle.corners.map(|i| vertices[i as usize].as_dvec3());
        for k in 0..3 {
            let (u, v) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            let angle = libm::atan2(u.cross(v).length(), u.dot(v));
            sums[triangle.corners[k] as usize] += normal * angle;
        }
    }
    sums.iter().map(|s| s.normalize_or_zero().as_vec3()).collect()
}
