//! Mesh: a closed triangle mesh, convex or not.

use crate::Vec3;
use crate::sdf::MeshCollider;

/// A closed triangle mesh, wound counter-clockwise seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Vertices. Metres.
    pub vertices: Vec<Vec3>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// What contact knows of it.
    pub collider: MeshCollider,
}
