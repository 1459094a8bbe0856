//! Signed distance fields: what makes contact between meshes of any form quick.
//!
//! A mesh is looked at in two ways: as a *field* (how far is this point from the surface, and which way is out) and as
//! *samples* (points of its surface). Contact looks the samples of one shape up in the field of the other, both ways;
//! see [`crate::contact::mesh`].

use crate::Vec3;

mod bake;
mod field;
pub(crate) mod lanes;
pub(crate) mod primitive;
mod samples;
mod topology;
mod triangle_tree;

pub use field::Field;
pub use samples::Samples;
pub use triangle_tree::TriangleTree;

use topology::{EdgeKind, Topology};

/// All that contact needs to know of a mesh, computed once.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshCollider {
    /// Signed distances; none for an open mesh, which has no inside.
    pub field: Option<Field>,
    /// Points of the surface: vertices and points along long edges.
    pub samples: Samples,
    /// The triangles: nearest points.
    pub tree: TriangleTree,
    /// Half the thickness of the thinnest part; 0 for an open mesh. Metres.
    pub half_thickness: f32,
    /// Distance from the origin to the farthest vertex. Metres.
    pub radius: f32,
}

/// Why a mesh cannot collide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshDefect {
    /// A vertex has a coordinate that is not a finite number.
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// A triangle names a vertex that does not exist.
    NoSuchVertex {
        /// Index of the triangle.
        triangle: usize,
    },
    /// No triangle has an area.
    NoArea,
    /// The triangles enclose a negative volume: they are wound clockwise seen from outside.
    InsideOut,
}

impl std::fmt::Display for MeshDefect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            MeshDefect::NotFinite { vertex } => {
                write!(f, "vertex {vertex}: coordinates must be finite numbers")
            }
            MeshDefect::NoSuchVertex { triangle } => {
                write!(f, "triangle {triangle}: its indices must be below the number of vertices")
            }
            MeshDefect::NoArea => write!(f, "triangles: at least one must have an area above 0"),
            MeshDefect::InsideOut => {
                write!(f, "triangles: must be counter-clockwise seen from outside; swap two indices of each")
            }
        }
    }
}

impl std::error::Error for MeshDefect {}

/// Most points along edges; longer spacings where there would be more.
const EDGE_SAMPLES_MAX: f32 = 16_384.0;
/// Points along an edge of middling length of an open mesh, whose thickness says nothing.
const OPEN_EDGE_PARTS: f32 = 4.0;

impl MeshCollider {
    /// The collider of triangles (vertex indices, counter-clockwise seen from outside) of vertices (metres).
    ///
    /// Vertices at the same place count as one; triangles without an area are ignored. Takes some milliseconds for
    /// thousands of triangles.
    ///
    /// # Errors
    /// When the mesh has a [`MeshDefect`]. That it is open is none: it gets no field, and only its front collides.
    pub fn build(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<MeshCollider, MeshDefect> {
        if let Some(vertex) = vertices.iter().position(|v| !v.is_finite()) {
            return Err(MeshDefect::NotFinite { vertex });
        }
        let exists = |i: &u32| (*i as usize) < vertices.len();
        if let Some(triangle) = triangles.iter().position(|t| !t.iter().all(exists)) {
            return Err(MeshDefect::NoSuchVertex { triangle });
        }
        let topology = Topology::new(vertices, triangles);
        if topology.triangles.is_empty() {
            return Err(MeshDefect::NoArea);
        }
        let closed = topology.is_closed();
        if closed && topology.volume() < 0.0 {
            return Err(MeshDefect::InsideOut);
        }
        let tree = TriangleTree::new(topology);
        let half_thickness = if closed { bake::half_thickness(&tree) } else { 0.0 };
        let field = closed.then(|| bake::bake(&tree, half_thickness));
        let samples = Samples::new(sample_points(tree.topology(), closed.then_some(2.0 * half_thickness)));
        let radius = vertices.iter().fold(0.0_f32, |r, v| r.max(v.length()));
        Ok(MeshCollider { field, samples, tree, half_thickness, radius })
    }

    /// Whether the surface is closed, so that it has an inside.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.field.is_some()
    }

    /// Memory that it takes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.field.as_ref().map_or(0, Field::bytes) + self.samples.bytes() + self.tree.bytes()
    }
}

/// The vertices that triangles use, and points along ridges and boundaries no further apart than the thickness (of an
/// open mesh, which has none, a quarter of the mean length): where the edges of two frames cross, no vertex is near.
fn sample_points(topology: &Topology, thickness: Option<f32>) -> Vec<Vec3> {
    let mut used = vec![false; topology.vertices.len()];
    for triangle in &topology.triangles {
        for v in triangle.corners {
            used[v as usize] = true;
        }
    }
    let mut points: Vec<Vec3> =
        topology.vertices.iter().zip(&used).filter(|(_, used)| **used).map(|(v, _)| *v).collect();
    let sharp: Vec<[Vec3; 2]> = topology
        .edges
        .iter()
        .zip(&topology.edge_kinds)
        .filter(|(_, kind)| matches!(kind, EdgeKind::Ridge | EdgeKind::Boundary))
        .map(|(edge, _)| edge.map(|v| topology.vertices[v as usize]))
        .collect();
    let total = sharp.iter().map(|[a, b]| a.distance(*b)).sum::<f32>();
    let wished = thickness.unwrap_or(total / (OPEN_EDGE_PARTS * sharp.len().max(1) as f32));
    let spacing = wished.max(total / EDGE_SAMPLES_MAX);
    for [a, b] in sharp {
        // No parts, and no points, where the spacing is 0: there is no edge then.
        let parts = (a.distance(b) / spacing).ceil() as u32;
        points.extend((1..parts).map(|k| a + (b - a) * (k as f32 / parts as f32)));
    }
    points
}
