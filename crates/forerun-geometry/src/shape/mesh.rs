//! Mesh: a triangle mesh, convex or not.

use super::mesh_draft::{Inside, MeshDraft, MeshOptions};
use super::mesh_report::{Enclosure, MeshError, MeshRepairs};
use super::reach::Reach;
use super::triangle_tree::TriangleTree;
use crate::sdf::MeshCollider;
use crate::{Aabb, BoundingSphere, Pose, Vec3};

/// A triangle mesh. Fields are public to read; make one with [`Mesh::new`], [`Mesh::open`] or a [`MeshDraft`].
///
/// *Invariant:* vertices are finite, different from each other and each used by a triangle; the three corners of a triangle differ;
/// of a closed mesh as many triangles pass an edge one way as the other, mostly one each, and normals point outwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Vertices. Metres.
    pub vertices: Vec<Vec3>,
    /// Vertex indices of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Whether it bounds a volume. What bounds none has no mass and is for fixed and kinematic bodies only.
    pub enclosure: Enclosure,
    /// What was mended when it was made.
    pub repairs: MeshRepairs,
    bounds: Aabb,
    reach: Reach,
    pub(super) half_thickness: f32,
    tree: TriangleTree,
    pub(super) options: MeshOptions,
    pub(super) collider: MeshCollider,
}

impl Mesh {
    /// A mesh with an inside, the surface of a solid; several shells are fine, and cavities are shells that face inwards.
    ///
    /// Everyday faults are mended and noted in [`Mesh::repairs`]: see there. What was bounded badly but clearly enough is
    /// [`Enclosure::Mended`]. For a wished cell size, progress, and fields kept from an earlier run see [`MeshDraft`].
    ///
    /// # Errors
    /// When a number is not finite, an index is out of range, or there is no saying what is inside: holes too large, or no volume.
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Mesh, MeshError> {
        MeshDraft::new(vertices, triangles, MeshOptions::default())?.bake(&|_, _| {})
    }

    /// A mesh that need not have an inside: for fixed bodies, like terrain. It is closed all the same when its edges say so, unless it faces
    /// inwards: a room stays one.
    ///
    /// # Errors
    /// When there is no triangle, a number is not finite, or an index is out of range.
    pub fn open(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Mesh, MeshError> {
        let options = MeshOptions { inside: Inside::Optional, ..MeshOptions::default() };
        MeshDraft::new(vertices, triangles, options)?.bake(&|_, _| {})
    }

    /// An open mesh that nothing touches yet.
    pub(crate) fn assemble(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
        Mesh {
            enclosure: Enclosure::Open,
            repairs: MeshRepairs::default(),
            bounds: Aabb::around(vertices.iter().copied()),
            reach: Reach::of(&vertices),
            half_thickness: f32::INFINITY,
            tree: TriangleTree::new(&vertices, &triangles),
            options: MeshOptions::default(),
            collider: MeshCollider::default(),
            vertices,
            triangles,
        }
    }

    /// Whether there is an inside; see [`Enclosure::has_inside`].
    #[must_use]
    pub fn has_inside(&self) -> bool {
        self.enclosure.has_inside()
    }

    /// What it was made with.
    #[must_use]
    pub fn options(&self) -> MeshOptions {
        self.options
    }

    /// The box around the vertices, in the mesh's frame.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// A ball around the vertices, in the mesh's frame; kept, unlike [`Shape::bounding_sphere`](crate::Shape::bounding_sphere), which is smaller for some.
    #[must_use]
    pub fn ball(&self) -> BoundingSphere {
        self.reach.ball()
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
