//! Pseudo-normals: normals of faces, edges and vertices that tell inside from outside, and the form of edges.

use glam::DVec3;

use super::triangle::{corners, face_normal};
use crate::Vec3;
use crate::shape::Mesh;

/// Edges and vertices of a mesh with their angle-weighted normals.
///
/// Bærentzen and Aanæs, *Signed Distance Computation Using the Angle Weighted Pseudonormal* (2005): with these normals
/// a point is outside a closed surface exactly where the offset from its nearest surface point has a positive product
/// with the normal of the face, edge or vertex that this point lies on. That holds of edges of four triangles or more too: the sum of their
/// normals faces away from what is inside around the edge, as the integral over the part inside of a small circle does, and where it
/// is zero no point but those of the edge is nearest to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PseudoNormals {
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
    /// The edges of each triangle: edge k runs from corner k to the next.
    pub(crate) triangle_edges: Vec<[u32; 3]>,
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
    /// More than two triangles meet without an end of the surface: edges of parts that touch here.
    Crowded,
}

/// Cosine of the angle between normals above which an edge counts as flat: 5 degrees.
const FLAT_COSINE: f64 = 0.996_194_7;

impl PseudoNormals {
    /// Those of a mesh.
    pub(crate) fn new(mesh: &Mesh) -> PseudoNormals {
        let mut edges: Vec<[u32; 2]> = mesh.triangles.iter().flat_map(|t| edges_of(*t)).collect();
        edges.sort_unstable();
        edges.dedup();
        let edge_index = |edge: [u32; 2]| edges.partition_point(|e| *e < edge) as u32;
        let triangle_edges: Vec<[u32; 3]> =
            mesh.triangles.iter().map(|t| edges_of(*t).map(edge_index)).collect();
        let (edge_normals, edge_kinds) = edge_normals(mesh, &triangle_edges, edges.len());
        let mut vertex_on_boundary = vec![false; mesh.vertices.len()];
        for (edge, kind) in edges.iter().zip(&edge_kinds) {
            if *kind == EdgeKind::Boundary {
                for v in edge {
                    vertex_on_boundary[*v as usize] = true;
                }
            }
        }
        let vertex_normals = vertex_normals(mesh);
        PseudoNormals { vertex_normals, vertex_on_boundary, edges, edge_normals, edge_kinds, triangle_edges }
    }

    /// Memory that they take.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.vertex_normals)
            + size_of_val(&*self.vertex_on_boundary)
            + size_of_val(&*self.edges)
            + size_of_val(&*self.edge_normals)
            + size_of_val(&*self.edge_kinds)
            + size_of_val(&*self.triangle_edges)
    }
}

fn edges_of(c: [u32; 3]) -> [[u32; 2]; 3] {
    [(c[0], c[1]), (c[1], c[2]), (c[2], c[0])].map(|(a, b)| [a.min(b), a.max(b)])
}

fn edge_normals(mesh: &Mesh, triangle_edges: &[[u32; 3]], edges: usize) -> (Vec<Vec3>, Vec<EdgeKind>) {
    let mut sums = vec![DVec3::ZERO; edges];
    let mut counts = vec![0_i32; edges];
    // Triangles that run along the edge upwards less those that run downwards: 0 where the surface goes on.
    let mut balance = vec![0_i32; edges];
    for (t, (corners, edges)) in mesh.triangles.iter().zip(triangle_edges).enumerate() {
        let normal = face_normal(mesh, t);
        for (k, edge) in edges.map(|e| e as usize).into_iter().enumerate() {
            sums[edge] += normal;
            counts[edge] += 1;
            balance[edge] += if corners[k] < corners[(k + 1) % 3] { 1 } else { -1 };
        }
    }
    let normals: Vec<Vec3> = sums.iter().map(|s| s.normalize_or_zero().as_vec3()).collect();
    let heights = apex_heights(mesh, triangle_edges, &normals);
    let kind = |k: usize| {
        let mean = sums[k].length() / f64::from(counts[k].max(1));
        if balance[k] != 0 {
            EdgeKind::Boundary
        } else if counts[k] > 2 {
            EdgeKind::Crowded
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
fn apex_heights(mesh: &Mesh, triangle_edges: &[[u32; 3]], edge_normals: &[Vec3]) -> Vec<f32> {
    let mut heights = vec![0.0; edge_normals.len()];
    for (corners, edges) in mesh.triangles.iter().zip(triangle_edges) {
        for (k, edge) in edges.map(|e| e as usize).into_iter().enumerate() {
            let [from, apex] = [k, (k + 2) % 3].map(|c| mesh.vertices[corners[c] as usize]);
            heights[edge] += edge_normals[edge].dot(apex - from);
        }
    }
    heights
}

fn vertex_normals(mesh: &Mesh) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; mesh.vertices.len()];
    for t in 0..mesh.triangles.len() {
        let (normal, p) = (face_normal(mesh, t), corners(mesh, t));
        for k in 0..3 {
            let (u, v) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            let angle = libm::atan2(u.cross(v).length(), u.dot(v));
            sums[mesh.triangles[t][k] as usize] += normal * angle;
        }
    }
    sums.iter().map(|s| s.normalize_or_zero().as_vec3()).collect()
}
