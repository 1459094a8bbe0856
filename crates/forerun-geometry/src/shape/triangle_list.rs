//! Triangle list: vertices and corners, before anything is checked but the numbers themselves.

use super::{Mesh, MeshError};
use crate::Vec3;

/// What a file says, or a formula gives, before it becomes a [`Mesh`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleList {
    /// Vertices. In the file's unit of length; metres from a formula.
    pub vertices: Vec<Vec3>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleList {
    /// The closed mesh of these triangles.
    ///
    /// # Errors
    /// As [`Mesh::new`].
    pub fn mesh(self) -> Result<Mesh, MeshError> {
        Mesh::new(self.vertices, self.triangles)
    }
}
