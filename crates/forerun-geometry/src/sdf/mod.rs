//! Signed distance fields: what makes contact between meshes of any form quick.
//!
//! A mesh is looked at in two ways: as a *field* (how far is this point from the surface, and which way is out) and as
//! *samples* (points of its surface). Contact looks the samples of one shape up in the field of the other, both ways;
//! see [`crate::contact`].

use crate::Vec3;
use crate::shape::{Enclosure, Mesh};

pub(crate) mod bake;
mod crossing;
pub(crate) mod eight;
mod field;
pub(crate) mod kept;
pub(crate) mod mend;
pub(crate) mod moments;
pub(crate) mod nearest;
pub(crate) mod primitive;
pub(crate) mod pseudo_normals;
pub(crate) mod samples;
pub(crate) mod winding;

pub use bake::BakeProgress;
pub use field::Field;
pub use kept::{BakeKey, KeptError};
pub use samples::{Sample, Samples};

use moments::Moments;
use pseudo_normals::{EdgeKind, PseudoNormals};

/// All that contact needs to know of a mesh beyond its triangles, computed once. The default finds nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshCollider {
    /// Signed distances; none for a mesh without an inside.
    pub field: Option<Field>,
    /// Points of the surface: vertices, and points along long edges.
    pub samples: Samples,
    /// Distance from the origin to the farthest vertex. Metres.
    pub radius: f32,
    /// Of what is inside, where the triangles do not say it.
    pub(crate) moments: Option<Moments>,
    /// How far off its surface the field sees points of its own sharp edges and corners: none where all is smooth. Metres.
    ///
    /// Between its nodes a field cuts edges off that are askew to its grid. Contact asks the triangles there.
    pub(crate) blur: f32,
    normals: PseudoNormals,
}

/// Most points along edges; longer spacings where there would be more.
const EDGE_SAMPLES_MAX: f32 = 16_384.0;
/// Surfaces are smooth whose field is off by less than this part of a cell.
const BLUR_PART: f32 = 1.0 / 6.0;
/// Points along an edge of middling length of an open mesh, whose thickness says nothing.
const OPEN_EDGE_PARTS: f32 = 4.0;

impl MeshCollider {
    /// The collider of a mesh that is complete but for it.
    ///
    /// An open mesh has no field: contact goes to its triangles, and only their front collides.
    pub(crate) fn new(mesh: &Mesh, normals: PseudoNormals, field: Option<Field>) -> MeshCollider {
        let mut points = sample_points(mesh, &normals);
        let mut moments = None;
        if let (Enclosure::Mended, Some(field)) = (mesh.enclosure, &field) {
            // What is inside of other parts touches nothing.
            points.retain(|sample| field.distance_and_gradient(sample.point).0 > -0.5 * field.cell());
            moments = Some(Moments::of(field));
        }
        let samples = Samples::new(points);
        let radius = mesh.vertices.iter().fold(0.0_f32, |r, v| r.max(v.length()));
        let blur = field.as_ref().map_or(0.0, |field| blur(field, &samples));
        MeshCollider { field, samples, radius, moments, blur, normals }
    }

    /// Memory that it takes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.field.as_ref().map_or(0, Field::bytes) + self.samples.bytes() + self.normals.bytes()
    }
}

/// [`MeshCollider::blur`]: how far off the points of the surface seem to be, where that is too much to be left alone.
fn blur(field: &Field, samples: &Samples) -> f32 {
    let off = samples.iter().fold(0.0_f32, |off, s| off.max(field.distance_and_gradient(s.point).0));
    if off > BLUR_PART * field.cell() { off } else { 0.0 }
}

/// The vertices, and points along ridges and boundaries no further apart than the thickness of the mesh (of an open
/// one, which has none, a quarter of their mean length): where the edges of two frames cross, no vertex is near.
fn sample_points(mesh: &Mesh, normals: &PseudoNormals) -> Vec<Sample> {
    let (vertex_facing, edge_facing) = facing_max(mesh, normals);
    let vertices = mesh.vertices.iter().zip(&normals.vertex_normals).zip(vertex_facing);
    let mut samples: Vec<Sample> = vertices
        .map(|((point, normal), facing_max)| Sample { point: *point, normal: *normal, facing_max })
        .collect();
    let sharp: Vec<([Vec3; 2], Vec3, f32)> = (0..normals.edges.len())
        .filter(|e| matches!(normals.edge_kinds[*e], EdgeKind::Ridge | EdgeKind::Boundary))
        .map(|e| {
            let ends = normals.edges[e].map(|v| mesh.vertices[v as usize]);
            (ends, normals.edge_normals[e], edge_facing[e])
        })
        .collect();
    let total = sharp.iter().map(|([a, b], ..)| a.distance(*b)).sum::<f32>();
    let wished = if mesh.has_inside() {
        2.0 * mesh.half_thickness()
    } else {
        total / (OPEN_EDGE_PARTS * sharp.len().max(1) as f32)
    };
    let spacing = wished.max(total / EDGE_SAMPLES_MAX);
    for ([a, b], normal, facing_max) in sharp {
        let parts = (a.distance(b) / spacing).ceil() as u32;
        let point = |k: u32| a + (b - a) * (k as f32 / parts as f32);
        samples.extend((1..parts).map(|k| Sample { point: point(k), normal, facing_max }));
    }
    samples
}

/// [`Sample::facing_max`] of the vertices and edges: by the widest angle between the normal there and that of a triangle around.
fn facing_max(mesh: &Mesh, normals: &PseudoNormals) -> (Vec<f32>, Vec<f32>) {
    let (mut at_vertices, mut at_edges) =
        (vec![1.0_f32; mesh.vertices.len()], vec![1.0_f32; normals.edges.len()]);
    for (t, (corners, edges)) in mesh.triangles.iter().zip(&normals.triangle_edges).enumerate() {
        let normal = pseudo_normals::face_normal(mesh, t).as_vec3();
        for v in corners.map(|v| v as usize) {
            at_vertices[v] = at_vertices[v].min(normals.vertex_normals[v].dot(normal));
        }
        for e in edges.map(|e| e as usize) {
            at_edges[e] = at_edges[e].min(normals.edge_normals[e].dot(normal));
        }
    }
    // Where the surface ends, what comes from the side touches it too.
    let bounded =
        |bounded: bool, cosine: f32| if bounded { Sample::SHARP } else { Sample::facing_within(cosine) };
    let vertices = at_vertices.iter().zip(&normals.vertex_on_boundary);
    let edges = at_edges.iter().zip(&normals.edge_kinds);
    (
        vertices.map(|(cosine, on_boundary)| bounded(*on_boundary, *cosine)).collect(),
        edges.map(|(cosine, kind)| bounded(*kind == EdgeKind::Boundary, *cosine)).collect(),
    )
}
