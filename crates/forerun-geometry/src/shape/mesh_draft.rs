//! Mesh draft: triangles that are cleaned, ready to be baked or to take up what was baked before.
//!
//! Promise: baked or restored, the mesh is the same, bit for bit; bytes that are not of this draft are refused.

use super::mesh::Mesh;
use super::mesh_report::{Enclosure, MeshError, MeshRepairs};
use super::mesh_topology::{
    check_edges, covers, crowded_edges, drop_degenerate, drop_unused, recut_slivers, turn_shells,
    turn_to_neighbours, volume_and_area, weld_equal,
};
use crate::Vec3;
use crate::sdf::MeshCollider;
use crate::sdf::bake::{Bounding, Grid, bake, suitable_cell};
use crate::sdf::kept::{BakeKey, Found, Kept, KeptError};
use crate::sdf::mend::{Covers, Verdict, survey};
use crate::sdf::nearest::Skin;
use crate::sdf::pseudo_normals::PseudoNormals;
use crate::sdf::{BakeProgress, Field};

/// Farther out along an axis, positions are rounded to decimetres, and mass and inertia soon are no `f32` any more. Metres.
const POSITION_MAX_M: f32 = 1e6;

/// How a mesh is to be made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeshOptions {
    /// Whether it must have an inside.
    pub inside: Inside,
    /// Wished distance between nodes of the field. Metres, above 0. Larger cells are used where the field would take
    /// more than 2 MiB. None: an eighth of the smallest thickness or narrowest gap of the mesh.
    pub cell: Option<f32>,
}

/// Whether a mesh must have an inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Inside {
    /// It is an error to have none. What is nearly closed is mended.
    #[default]
    Needed,
    /// What is not closed, or is but faces inwards as a room does, stays [open](Enclosure::Open) as it is: terrain and other fixed bodies.
    Optional,
}

/// Triangles that are cleaned and need only a distance field to become a mesh.
///
/// A field takes up to seconds to bake; who keeps fields from run to run asks by [`MeshDraft::key`] for the bytes that
/// [`Mesh::baked_bytes`] gave, tries [`MeshDraft::restore`] with them, and bakes if that fails.
#[derive(Clone, Debug)]
pub struct MeshDraft {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    repairs: MeshRepairs,
    options: MeshOptions,
    /// Why there is no inside.
    fault: Option<MeshError>,
    /// The first fault of its edges, if they have any.
    edges: Option<MeshError>,
    /// What covers holes.
    covers: Covers,
    /// The first triangle of each part that hangs together.
    shells: Vec<usize>,
}

impl MeshDraft {
    /// Cleans and checks triangles, counter-clockwise seen from outside. Metres.
    ///
    /// # Errors
    /// When there is no triangle, a number is not finite, an index is out of range, or an inside is needed and there can be none.
    pub fn new(
        vertices: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        options: MeshOptions,
    ) -> Result<MeshDraft, MeshError> {
        if let Some(cell) = options.cell
            && !(cell > 0.0 && cell.is_finite())
        {
            return Err(MeshError::Cell { cell });
        }
        let (vertices, triangles, repairs) = clean(vertices, triangles)?;
        let mut draft = MeshDraft {
            vertices,
            triangles,
            repairs,
            options,
            fault: None,
            edges: None,
            covers: Covers::default(),
            shells: Vec::new(),
        };
        if let Err(fault) = draft.face_outwards() {
            if options.inside == Inside::Needed {
                return Err(fault);
            }
            draft.fault = Some(fault);
        }
        Ok(draft)
    }

    /// Turns triangles to face outwards and covers holes, as far as an inside may be got that way.
    fn face_outwards(&mut self) -> Result<(), MeshError> {
        let edges = check_edges(&self.vertices, &self.triangles);
        if edges.is_err() && self.options.inside == Inside::Optional {
            return edges;
        }
        let (flipped, parts) = turn_to_neighbours(&self.vertices, &mut self.triangles);
        self.repairs.flipped_triangles = flipped;
        if edges.is_err() {
            self.cover();
        }
        let (volume, area) = self.volume_and_area();
        if self.options.inside == Inside::Optional && self.faces_inwards(volume, &parts) {
            return Err(MeshError::NoVolume { volume });
        }
        // Of a solid of size L the volume is known to about 1e-7 L³ and the area is about L²: less than that is nothing.
        if volume.abs() <= 1e-6 * area * area.sqrt() {
            return edges.and(Err(MeshError::NoVolume { volume }));
        }
        if volume < 0.0 {
            self.triangles.iter_mut().chain(&mut self.covers.triangles).for_each(|t| t.swap(1, 2));
            self.repairs.turned = true;
        }
        self.repairs.flipped_triangles += turn_shells(&self.vertices, &mut self.triangles, &parts);
        self.cover();
        let mut shells: Vec<(u32, usize)> = parts.into_iter().zip(0..).collect();
        shells.sort_unstable();
        shells.dedup_by_key(|(part, _)| *part);
        self.shells = shells.into_iter().map(|(_, triangle)| triangle).collect();
        self.edges = edges.err();
        Ok(())
    }

    /// Whether any part of a mesh faces inwards that is no cavity of others: a room, seen from inside.
    fn faces_inwards(&self, volume: f64, parts: &[u32]) -> bool {
        volume < 0.0 || turn_shells(&self.vertices, &mut self.triangles.clone(), parts) > 0
    }

    fn cover(&mut self) {
        self.covers = covers(&self.vertices, &self.triangles);
        let (crowded_edges, first_crowded) = crowded_edges(&self.triangles);
        let first_cover = self.covers.triangles.first().map(|t| [t[0], t[1]]);
        let ends = |edge: Option<[u32; 2]>| edge.map(|edge| edge.map(|v| self.vertices[v as usize]));
        self.repairs = MeshRepairs {
            holes: self.covers.apexes.len() as u32,
            hole_edges: self.covers.triangles.len() as u32,
            first_hole: ends(first_cover),
            crowded_edges,
            first_crowded: ends(first_crowded),
            ..self.repairs
        };
    }

    /// Signed volume (m³) and area (m²), covers of holes included.
    fn volume_and_area(&self) -> (f64, f64) {
        let vertices: Vec<Vec3> = self.vertices.iter().chain(&self.covers.apexes).copied().collect();
        let triangles: Vec<[u32; 3]> = self.triangles.iter().chain(&self.covers.triangles).copied().collect();
        volume_and_area(&vertices, &triangles)
    }

    /// What the baked field depends on, as a name: triangles, options, and the version of the baker.
    #[must_use]
    pub fn key(&self) -> BakeKey {
        BakeKey::of(&self.vertices, &self.triangles, &self.options)
    }

    /// Makes the mesh, in parallel on the threads of the caller's pool; the same bits for any number of threads.
    ///
    /// # Errors
    /// When an inside is needed and it turns out that there is none.
    pub fn bake(&self, progress: BakeProgress<'_>) -> Result<Mesh, MeshError> {
        let mut mesh = self.unbaked();
        let normals = PseudoNormals::new(&mesh);
        let field = if self.fault.is_none() { self.bake_field(&mut mesh, &normals, progress)? } else { None };
        mesh.collider = MeshCollider::new(&mesh, normals, field);
        Ok(mesh)
    }

    /// The field of a mesh, and what the mesh turns out to be. No field if there is no inside, and none is needed.
    fn bake_field(
        &self,
        mesh: &mut Mesh,
        normals: &PseudoNormals,
        progress: BakeProgress<'_>,
    ) -> Result<Option<Field>, MeshError> {
        mesh.half_thickness = mesh.measure_half_thickness();
        let wished = self.options.cell.unwrap_or_else(|| suitable_cell(mesh));
        let cell = Grid::around(mesh, wished).cell();
        match survey(mesh, &self.shells, &self.covers, cell.into()) {
            Verdict::Sound => {
                mesh.enclosure = Enclosure::Closed;
                let surface = Bounding::Exactly(Skin { mesh, normals });
                Ok(Some(bake(mesh, wished, &surface, progress)))
            }
            Verdict::Mended(mended) => {
                mesh.enclosure = Enclosure::Mended;
                mended.found.note_in(&mut mesh.repairs);
                Ok(Some(bake(mesh, wished, &Bounding::mended(&mended), progress)))
            }
            Verdict::Hopeless if self.options.inside == Inside::Needed => {
                let (volume, _) = self.volume_and_area();
                Err(self.edges.clone().unwrap_or(MeshError::NoVolume { volume }))
            }
            Verdict::Hopeless => {
                mesh.half_thickness = f32::INFINITY;
                Ok(None)
            }
        }
    }

    /// Makes the mesh from what [`Mesh::baked_bytes`] gave for one of an equal draft.
    ///
    /// # Errors
    /// When the bytes are of another draft or version, or damaged. Then [bake](MeshDraft::bake) it.
    pub fn restore(&self, bytes: &[u8]) -> Result<Mesh, KeptError> {
        let mut mesh = self.unbaked();
        let kept = Kept::read(bytes, self.key())?;
        mesh.enclosure = kept.enclosure;
        kept.found.note_in(&mut mesh.repairs);
        if let Some(field) = &kept.field {
            let (bounds, grid) = (mesh.bounds(), field.bounds());
            if !(grid.contains(bounds.min) && grid.contains(bounds.max)) {
                return Err(KeptError::Damaged);
            }
            mesh.half_thickness = mesh.measure_half_thickness();
        }
        let normals = PseudoNormals::new(&mesh);
        mesh.collider = MeshCollider::new(&mesh, normals, kept.field);
        Ok(mesh)
    }

    fn unbaked(&self) -> Mesh {
        let mut mesh = Mesh::assemble(self.vertices.clone(), self.triangles.clone());
        mesh.repairs = self.repairs;
        mesh.options = self.options;
        mesh
    }
}

impl Mesh {
    /// What took time to bake, to be kept and given to [`MeshDraft::restore`].
    #[must_use]
    pub fn baked_bytes(&self) -> Vec<u8> {
        let key = BakeKey::of(&self.vertices, &self.triangles, &self.options);
        Kept::write(key, self.enclosure, &Found::of(&self.repairs), self.collider.field.as_ref())
    }
}

type Parts = (Vec<Vec3>, Vec<[u32; 3]>, MeshRepairs);

/// Checks the numbers; welds, and leaves out what is degenerate or unused.
fn clean(vertices: Vec<Vec3>, mut triangles: Vec<[u32; 3]>) -> Result<Parts, MeshError> {
    if let Some(vertex) = vertices.iter().position(|v| !v.is_finite()) {
        return Err(MeshError::NotFinite { vertex, position: vertices[vertex] });
    }
    if let Some(vertex) = vertices.iter().position(|v| v.abs().max_element() > POSITION_MAX_M) {
        return Err(MeshError::TooFar { vertex, position: vertices[vertex], most: POSITION_MAX_M });
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
        MeshRepairs {
            welded_vertices,
            unused_vertices,
            dropped_triangles,
            recut_triangles,
            ..MeshRepairs::default()
        },
    ))
}
