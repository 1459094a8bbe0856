//! Signed distance fields: what makes contact between meshes of any form quick.
//!
//! A mesh is looked at in two ways: as a *field* (how far is this point from the surface, and which way is out) and as
//! *samples* (points of its surface). Contact looks the samples of one shape up in the field of the other, both ways;
//! see [`crate::contact`].

use crate::Vec3;
use crate::shape::{Enclosure, Mesh};

mod accuracy;
pub(crate) mod bake;
mod bake_blocks;
mod blocks;
pub(crate) mod blur;
pub(crate) mod crossing;
pub(crate) mod eight;
pub(crate) mod facets;
mod field;
mod field_storage;
pub(crate) mod kept;
pub(crate) mod mend;
pub(crate) mod moments;
pub(crate) mod nearest;
pub(crate) mod primitive;
pub(crate) mod pseudo_normals;
pub(crate) mod ridges;
pub(crate) mod samples;
pub(crate) mod triangle;
pub(crate) mod winding;

pub use accuracy::{FieldError, Spread};
pub use bake::BakeProgress;
pub use field::Field;
pub use kept::{BakeKey, KeptError};
pub use samples::{Sample, Samples};

use blur::Blur;
use moments::Moments;
use pseudo_normals::{EdgeKind, PseudoNormals};
use ridges::{Ridge, Ridges};

/// All that contact needs to know of a mesh beyond its triangles, computed once. The default finds nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshCollider {
    /// Signed distances; none for a mesh without an inside.
    pub field: Option<Field>,
    /// Points of the surface: vertices, and points along long edges.
    pub samples: Samples,
    /// Edges that are long against the thickness of the mesh.
    pub(crate) ridges: Ridges,
    /// Of what is inside, where the triangles do not say it.
    pub(crate) moments: Option<Moments>,
    /// Where the field blurs sharp edges.
    pub(crate) blur: Blur,
    normals: PseudoNormals,
}

/// Most points along edges; longer spacings where there would be more.
const EDGE_SAMPLES_MAX: f32 = 16_384.0;
/// Edges between triangles that differ by more than 40 degrees are sharp: this is the cosine of half of it.
const SHARP_COSINE: f32 = 0.94;
/// Points along an edge of middling length of an open mesh, whose thickness says nothing.
const OPEN_EDGE_PARTS: f32 = 4.0;

impl MeshCollider {
    /// The collider of a mesh that is complete but for it.
    ///
    /// An open mesh has no field: contact goes to its triangles, and only their front collides.
    pub(crate) fn new(mesh: &Mesh, normals: PseudoNormals, field: Option<Field>) -> MeshCollider {
        let mut edges = touchable_edges(mesh, &normals);
        let mut points = sample_points(mesh, &normals, &edges);
        let mut moments = None;
        if let (Enclosure::Mended, Some(field)) = (mesh.enclosure, &field) {
            // What is inside of other parts touches nothing.
            let outside = |point: Vec3| field.distance_and_gradient(point).0 > -0.5 * field.cell();
            points.retain(|sample| outside(sample.point));
            edges.retain(|edge| outside((edge.ends[0] + edge.ends[1]) * 0.5));
            moments = Some(Moments::of(field));
        }
        let samples = Samples::new(points);
        let ridges = long_ridges(mesh, &edges);
        let blur = match &field {
            // The triangles of a mended mesh do not tell its sides.
            Some(field) if mesh.enclosure != Enclosure::Mended => {
                Blur::new(mesh, field, &sharp_edges(mesh, &normals))
            }
            _ => Blur::default(),
        };
        MeshCollider { field, samples, ridges, moments, blur, normals }
    }

    /// Cells of the field around sharp edges whose triangles are too many to be asked: there contact goes by the field, which rounds edges off.
    #[must_use]
    pub fn crowded_cells(&self) -> usize {
        self.blur.crowded
    }

    /// Memory that it takes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.field.as_ref().map_or(0, Field::bytes)
            + self.samples.bytes()
            + self.ridges.bytes()
            + self.blur.bytes()
            + self.normals.bytes()
    }
}

/// The ends of edges that interpolation blurs, convex or not.
fn sharp_edges(mesh: &Mesh, normals: &PseudoNormals) -> Vec<[Vec3; 2]> {
    let (_, cosines) = least_cosines(mesh, normals);
    let sharp = normals.edges.iter().zip(cosines).filter(|(_, cosine)| *cosine < SHARP_COSINE);
    sharp.map(|(edge, _)| edge.map(|v| mesh.vertices[v as usize])).collect()
}

/// The edges that another surface can touch.
fn touchable_edges(mesh: &Mesh, normals: &PseudoNormals) -> Vec<Ridge> {
    let (_, facing_max) = facing_max(mesh, normals);
    (0..normals.edges.len())
        .filter(|e| {
            matches!(normals.edge_kinds[*e], EdgeKind::Ridge | EdgeKind::Boundary | EdgeKind::Crowded)
        })
        .map(|e| Ridge {
            ends: normals.edges[e].map(|v| mesh.vertices[v as usize]),
            normal: normals.edge_normals[e],
            facing_max: facing_max[e],
        })
        .collect()
}

/// The edges of a closed mesh that are longer than half its thickness, in stretches as long as it is thick at most.
///
/// Shorter ones have points enough. Where two edges cross one of them must be long: against what is thinner than the
/// spacing of its points the edge of a smooth part may have none, but then the other's has.
fn long_ridges(mesh: &Mesh, edges: &[Ridge]) -> Ridges {
    let half_thickness = mesh.half_thickness();
    let mut ridges = Vec::new();
    let long: Vec<&Ridge> = edges.iter().filter(|e| e.length() > half_thickness).collect();
    let total = long.iter().map(|e| e.length()).sum::<f32>();
    let spacing = (2.0 * half_thickness).max(total / EDGE_SAMPLES_MAX);
    for edge in long {
        edge.cut(spacing, &mut ridges);
    }
    Ridges::new(ridges)
}

/// The vertices, and points along ridges and boundaries no further apart than the thickness of the mesh (of an open
/// one, which has none, a quarter of their mean length).
fn sample_points(mesh: &Mesh, normals: &PseudoNormals, edges: &[Ridge]) -> Vec<Sample> {
    let (facing_max, _) = facing_max(mesh, normals);
    let vertices = mesh.vertices.iter().zip(&normals.vertex_normals).zip(facing_max);
    let mut samples: Vec<Sample> = vertices
        .map(|((point, normal), facing_max)| Sample { point: *point, normal: *normal, facing_max })
        .collect();
    let total = edges.iter().map(Ridge::length).sum::<f32>();
    let wished = if mesh.has_inside() {
        2.0 * mesh.half_thickness()
    } else {
        total / (OPEN_EDGE_PARTS * edges.len().max(1) as f32)
    };
    let spacing = wished.max(total / EDGE_SAMPLES_MAX);
    for Ridge { ends: [a, b], normal, facing_max } in edges.iter().copied() {
        let parts = (a.distance(b) / spacing).ceil() as u32;
        let point = |k: u32| a + (b - a) * (k as f32 / parts as f32);
        samples.extend((1..parts).map(|k| Sample { point: point(k), normal, facing_max }));
    }
    samples
}

/// The cosines of the widest angles between the normal at each vertex, and each edge, and that of a triangle around.
fn least_cosines(mesh: &Mesh, normals: &PseudoNormals) -> (Vec<f32>, Vec<f32>) {
    let (mut at_vertices, mut at_edges) =
        (vec![1.0_f32; mesh.vertices.len()], vec![1.0_f32; normals.edges.len()]);
    for (t, (corners, edges)) in mesh.triangles.iter().zip(&normals.triangle_edges).enumerate() {
        let normal = triangle::face_normal(mesh, t).as_vec3();
        for v in corners.map(|v| v as usize) {
            at_vertices[v] = at_vertices[v].min(normals.vertex_normals[v].dot(normal));
        }
        for e in edges.map(|e| e as usize) {
            at_edges[e] = at_edges[e].min(normals.edge_normals[e].dot(normal));
        }
    }
    (at_vertices, at_edges)
}

/// [`Sample::facing_max`] of the vertices and edges.
fn facing_max(mesh: &Mesh, normals: &PseudoNormals) -> (Vec<f32>, Vec<f32>) {
    let (at_vertices, at_edges) = least_cosines(mesh, normals);
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
