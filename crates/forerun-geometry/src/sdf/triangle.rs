//! Triangle: corners, normal and area of the triangles of a mesh, in double precision.

use glam::DVec3;

use crate::Vec3;
use crate::shape::Mesh;

/// Points this near to the surface are on it: poses are no better known. Metres.
pub(super) const ON_SURFACE: f32 = 1e-5;

/// Normal of a triangle, to where its corners are seen to turn counter-clockwise from, as long as twice its area.
pub(crate) fn face_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Area of a triangle.
pub(super) fn area(corners: [DVec3; 3]) -> f64 {
    0.5 * face_vector(corners).length()
}

/// The corners of a triangle that names vertices.
pub(crate) fn corners_of(vertices: &[Vec3], triangle: [u32; 3]) -> [DVec3; 3] {
    triangle.map(|i| vertices[i as usize].as_dvec3())
}

/// The corners of a triangle of a mesh.
pub(crate) fn corners(mesh: &Mesh, triangle: usize) -> [DVec3; 3] {
    corners_of(&mesh.vertices, mesh.triangles[triangle])
}

/// Unit normal of a triangle of a mesh.
pub(super) fn face_normal(mesh: &Mesh, triangle: usize) -> DVec3 {
    face_vector(corners(mesh, triangle)).normalize()
}
