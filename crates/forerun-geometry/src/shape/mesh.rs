//! Mesh: a triangle mesh, convex or not.

use std::fmt;

use glam::DVec3;

use super::mesh_topology::{check_edges, drop_degenerate, drop_unused, recut_slivers, weld_equal};
use super::reach::Reach;
use super::triangle_tree::TriangleTree;
use crate::sdf::MeshCollider;
use crate::{Aabb, Pose, Vec3};

/// A triangle mesh. Fields are public to read; make one with [`Mesh::new`] or [`Mesh::open`].
///
/// *Invariant:* vertices are finite, different from each other and each used by a triangle; the three corners of a triangle differ;
/// of a closed mesh every edge belongs to exactly two triangles that pass it in opposite directions, and normals point outwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Vertices. Metres.
    pub vertices: Vec<Vec3>,
    /// Vertex indices of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Whether it bounds a volume. An open mesh has no mass and is for fixed bodies only.
    pub closed: bool,
    /// What was mended when it was made.
    pub repairs: MeshRepairs,
    bounds: Aabb,
    reach: Reach,
    half_thickness: f32,
    tree: TriangleTree,
    collider: MeshCollider,
}

/// What was mended when a mesh was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshRepairs {
    /// Vertices that had exactly the position of an earlier one and were merged with it.
    pub welded_vertices: u32,
    /// Vertices that no triangle used and that were left out.
    pub unused_vertices: u32,
    /// Triangles that were left out because two of their corners are the same or all three lie in a line.
    pub dropped_triangles: u32,
    /// Triangles with their corners in a line that were cut anew together with a neighbour, so that the mesh stays closed.
    pub recut_triangles: u32,
    /// Whether all triangles faced inwards and were turned round.
    pub turned: bool,
}

impl MeshRepairs {
    /// Whether the mesh was taken as it was given.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == MeshRepairs::default()
    }
}

impl fmt::Display for MeshRepairs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut notes = Vec::new();
        if self.welded_vertices > 0 {
            notes.push(format!("{} duplicate vertices welded", self.welded_vertices));
        }
        if self.unused_vertices > 0 {
            notes.push(format!("{} unused vertices left out", self.unused_vertices));
        }
        if self.dropped_triangles > 0 {
            notes.push(format!("{} degenerate triangles left out", self.dropped_triangles));
        }
        if self.recut_triangles > 0 {
            notes.push(format!("{} triangles with their corners in a line cut anew", self.recut_triangles));
        }
        if self.turned {
            notes.push("all triangles faced inwards and were turned round".to_owned());
        }
        if notes.is_empty() { write!(f, "nothing mended") } else { write!(f, "{}", notes.join(", ")) }
    }
}

/// Why triangles are no usable mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshError {
    /// There is no triangle (left).
    Empty {
        /// Triangles that were left out as degenerate.
        dropped: u32,
    },
    /// A vertex is not finite.
    NotFinite {
        /// Its index.
        vertex: usize,
        /// Its position.
        position: Vec3,
    },
    /// A triangle names a vertex that does not exist.
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// Edges with a triangle on one side only.
    Open {
        /// How many.
        edges: usize,
        /// Ends of the first. Metres.
        first: [Vec3; 2],
    },
    /// Edges of two triangles that face opposite ways.
    Twisted {
        /// How many.
        edges: usize,
        /// Ends of the first. Metres.
        first: [Vec3; 2],
    },
    /// Edges of more than two triangles.
    Crowded {
        /// How many.
        edges: usize,
        /// Ends of the first. Metres.
        first: [Vec3; 2],
        /// How many triangles have the first.
        triangles: usize,
    },
    /// The volume is zero to rounding.
    NoVolume {
        /// What was computed. m³.
        volume: f64,
    },
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let between = |[a, b]: &[Vec3; 2]| format!("the first is between {a} and {b}");
        match self {
            MeshError::Empty { dropped: 0 } => write!(f, "the mesh has no triangles"),
            MeshError::Empty { dropped } => {
                write!(
                    f,
                    "the mesh has no triangles but {dropped} degenerate ones (corners equal or in a line)"
                )
            }
            MeshError::NotFinite { vertex, position } => {
                write!(f, "vertex {vertex} is {position}; positions must be finite numbers")
            }
            MeshError::IndexOutOfRange { triangle, index, vertices } => write!(
                f,
                "triangle {triangle} names vertex {index}, but there are {vertices} vertices (0 to {})",
                vertices.saturating_sub(1)
            ),
            MeshError::Open { edges, first } => write!(
                f,
                "the mesh is not closed: {edges} edges have a triangle on one side only, {}; close the holes (weld vertices that \
                 should be one), or use it for a fixed body as an open mesh",
                between(first)
            ),
            MeshError::Twisted { edges, first } => write!(
                f,
                "{edges} edges join triangles that face opposite ways, {}; give all triangles the same winding",
                between(first)
            ),
            MeshError::Crowded { edges, first, triangles } => write!(
                f,
                "{edges} edges belong to more than two triangles, {} and has {triangles}; remove inner walls and doubled triangles",
                between(first)
            ),
            MeshError::NoVolume { volume } => write!(
                f,
                "the mesh encloses no volume ({volume:e} m³); a sheet needs thickness, and shells must not cancel each other"
            ),
        }
    }
}

impl std::error::Error for MeshError {}

impl Mesh {
    /// A closed mesh, the surface of a solid; several shells are fine, and cavities are shells that face inwards.
    ///
    /// Mended and noted in [`Mesh::repairs`]: duplicate vertices, unused vertices, degenerate triangles, and triangles that all
    /// face inwards.
    ///
    /// # Errors
    /// When a number is not finite, an index is out of range, the surface is not closed and consistently wound, or it encloses no
    /// volume.
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Mesh, MeshError> {
        let (vertices, mut triangles, mut repairs) = clean(vertices, triangles)?;
        check_edges(&vertices, &triangles)?;
        let (volume, area) = volume_and_area(&vertices, &triangles);
        // Of a solid of size L the volume is known to about 1e-7 L³ and the area is about L²: less than that is nothing.
        if volume.abs() <= 1e-6 * area * area.sqrt() {
            return Err(MeshError::NoVolume { volume });
        }
        if volume < 0.0 {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
            repairs.turned = true;
        }
        let mut mesh = Mesh::assemble(vertices, triangles, repairs);
        mesh.closed = true;
        mesh.half_thickness = mesh.measure_half_thickness();
        mesh.collider = MeshCollider::new(&mesh);
        Ok(mesh)
    }

    /// A mesh that need not be closed: for fixed bodies, like terrain. It is closed all the same when its edges say so.
    ///
    /// # Errors
    /// When there is no triangle, a number is not finite, or an index is out of range.
    pub fn open(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Mesh, MeshError> {
        if let Ok(mesh) = Mesh::new(vertices.clone(), triangles.clone()) {
            return Ok(mesh);
        }
        let (vertices, triangles, repairs) = clean(vertices, triangles)?;
        let mut mesh = Mesh::assemble(vertices, triangles, repairs);
        mesh.collider = MeshCollider::new(&mesh);
        Ok(mesh)
    }

    /// An open mesh that nothing touches yet.
    fn assemble(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>, repairs: MeshRepairs) -> Mesh {
        let bounds = Aabb::around(vertices.iter().copied());
        let reach = Reach::of(&vertices);
        let tree = TriangleTree::new(&vertices, &triangles);
        let collider = MeshCollider::default();
        let (closed, half_thickness) = (false, f32::INFINITY);
        Mesh { vertices, triangles, closed, repairs, bounds, reach, half_thickness, tree, collider }
    }

    /// The box around the vertices, in the mesh's frame.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The corners of a triangle. Metres.
    #[must_use]
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.vertices[i as usize])
    }

    /// Calls `visit` with the index of every triangle whose box overlaps `aabb` (in the mesh's frame), and some near it, always in
    /// the same order.
    pub fn triangles_near(&self, aabb: &Aabb, visit: impl FnMut(u32)) {
        self.tree.near(aabb, visit);
    }

    /// What contact knows of the mesh.
    #[must_use]
    pub fn collider(&self) -> &MeshCollider {
        &self.collider
    }

    pub(crate) fn tree(&self) -> &TriangleTree {
        &self.tree
    }

    /// Half of the smallest thickness: from triangle middles straight through to the other side, but for the thinnest twentieth of the
    /// surface, as sharp edges are thin without end. Infinite for open meshes: what passes a sheet is told by the
    /// thickness of the other body alone. Metres.
    #[must_use]
    pub fn half_thickness(&self) -> f32 {
        self.half_thickness
    }

    pub(super) fn aabb(&self, pose: &Pose) -> Aabb {
        self.reach.aabb(pose)
    }
}

type Parts = (Vec<Vec3>, Vec<[u32; 3]>, MeshRepairs);

/// Checks the numbers; welds, and leaves out what is degenerate or unused.
fn clean(vertices: Vec<Vec3>, mut triangles: Vec<[u32; 3]>) -> Result<Parts, MeshError> {
    if let Some(vertex) = vertices.iter().position(|v| !v.is_finite()) {
        return Err(MeshError::NotFinite { vertex, position: vertices[vertex] });
    }
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|i| **i as usize >= vertices.len()) {
            return Err(MeshError::IndexOutOfRange { triangle, index, vertices: vertices.len() });
        }
    }
    let welded_vertices = weld_equal(&vertices, &mut triangles);
    let recut_triangles = recut_slivers(&vertices, &mut triangles);
    let dropped_triangles = drop_degenerate(&vertices, &mut triangles);
    if triangles.is_empty() {
        return Err(MeshError::Empty { dropped: dropped_triangles });
    }
    let given = vertices.len() as u32;
    let vertices = drop_unused(vertices, &mut triangles);
    let unused_vertices = given - vertices.len() as u32 - welded_vertices;
    Ok((
        vertices,
        triangles,
        MeshRepairs { welded_vertices, unused_vertices, dropped_triangles, recut_triangles, turned: false },
    ))
}

/// Signed volume (m³, by the divergence theorem) and area (m²).
fn volume_and_area(vertices: &[Vec3], triangles: &[[u32; 3]]) -> (f64, f64) {
    let origin = vertices[triangles[0][0] as usize].as_dvec3();
    let (mut volume, mut area) = (0.0, 0.0);
    for triangle in triangles {
        let [a, b, c]: [DVec3; 3] = triangle.map(|i| vertices[i as usize].as_dvec3() - origin);
        volume += a.dot(b.cross(c)) / 6.0;
        area += (b - a).cross(c - a).length() / 2.0;
    }
    (volume, area)
}
