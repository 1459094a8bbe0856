//! Hull: a convex polyhedron with what contact needs to know of it.

use crate::Vec3;

/// A convex polyhedron. Faces are planar polygons, coplanar triangles merged.
#[derive(Clone, Debug, PartialEq)]
pub struct Hull {
    /// Corners, in the order in which they were first given. Metres.
    pub vertices: Vec<Vec3>,
    /// Faces.
    pub faces: Vec<HullFace>,
    /// Vertex indices of all faces, one face after the other, counter-clockwise seen from outside.
    pub corners: Vec<u32>,
    /// Edges, each once.
    pub edges: Vec<HullEdge>,
    /// A point well inside: the mean of the vertices. Metres.
    pub centre: Vec3,
}

/// A face of a hull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HullFace {
    /// Unit outward normal.
    pub normal: Vec3,
    /// Distance of the plane from the origin along the normal. Metres.
    pub offset: f32,
    /// First of its corners in [`Hull::corners`].
    pub first: u32,
    /// How many corners it has, 3 or more.
    pub count: u32,
}

/// An edge of a hull, between two faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HullEdge {
    /// Its two vertices, the lower index first.
    pub vertices: [u32; 2],
    /// The two faces that meet in it.
    pub faces: [u32; 2],
}
