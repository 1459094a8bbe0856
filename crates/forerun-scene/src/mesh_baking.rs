//! Mesh baking: from triangles to meshes with fields, kept from run to run where there is a folder for it, with somebody who is told.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use forerun_geometry::mesh_file::TriangleList;
use forerun_geometry::shape::{Enclosure, Mesh, MeshDraft, MeshError, MeshOptions};

use crate::MeshCache;

/// Somebody who is told how baking goes.
pub trait MeshWatch: fmt::Debug + Send + Sync {
    /// Of the mesh of this name so much is baked, of so much in all. Called by several threads, with each number from 1 to all of it once, but
    /// not in order.
    fn baking(&self, name: &str, done: usize, total: usize);

    /// Something about a mesh that is no error.
    fn warning(&self, name: &str, message: &str);
}

/// How meshes are baked. The default keeps nothing and tells nobody.
#[derive(Clone, Debug, Default)]
pub struct MeshBaking {
    /// Where baked fields are kept from run to run.
    pub cache: Option<MeshCache>,
    /// Who is told.
    pub watch: Option<Arc<dyn MeshWatch>>,
}

/// A mesh, and where its field is from.
#[derive(Clone, Debug)]
pub struct BakedMesh {
    /// The mesh.
    pub mesh: Mesh,
    /// Whether its field was kept from an earlier run.
    pub kept: bool,
}

impl MeshBaking {
    /// Makes a mesh, from what was kept of an earlier run if there is anything. `name` is for who is told.
    ///
    /// # Errors
    /// As [`MeshDraft::new`] and [`MeshDraft::bake`]. A cache that does not work is none: only a warning.
    pub fn make(&self, name: &str, list: TriangleList, options: MeshOptions) -> Result<BakedMesh, MeshError> {
        let draft = MeshDraft::new(list.vertices, list.triangles, options)?;
        let warn = |message: &str| self.warn(name, message);
        let kept = self.cache.as_ref().and_then(|cache| cache.find(&draft, &warn));
        if let Some(mesh) = kept {
            return Ok(BakedMesh { mesh, kept: true });
        }
        let mesh = match &self.watch {
            Some(watch) => draft.bake(&|done, total| watch.baking(name, done, total))?,
            None => draft.bake(&|_, _| {})?,
        };
        if let Some(cache) = &self.cache {
            cache.keep(&draft, &mesh, &warn);
        }
        Ok(BakedMesh { mesh, kept: false })
    }

    fn warn(&self, name: &str, message: &str) {
        if let Some(watch) = &self.watch {
            watch.warning(name, message);
        }
    }
}

/// Where a mesh of a scene is made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BakeSite<'a> {
    /// That of the scene file.
    pub(crate) folder: &'a Path,
    /// Of the mesh in the scene.
    pub(crate) name: &'a str,
    pub(crate) baking: &'a MeshBaking,
}

impl BakeSite<'_> {
    /// Makes the mesh; tells if that took more than small repairs.
    pub(crate) fn make(&self, list: TriangleList, options: MeshOptions) -> Result<Mesh, MeshError> {
        let mesh = self.baking.make(self.name, list, options)?.mesh;
        if mesh.enclosure == Enclosure::Mended {
            self.warn(&format!("is not quite closed, and was mended: {}", mesh.repairs.why_not_closed()));
        }
        Ok(mesh)
    }

    pub(crate) fn warn(&self, message: &str) {
        self.baking.warn(self.name, message);
    }

    /// For tests of meshes that are in no scene.
    #[cfg(test)]
    pub(crate) fn nowhere() -> BakeSite<'static> {
        const NONE: &MeshBaking = &MeshBaking { cache: None, watch: None };
        BakeSite { folder: Path::new(""), name: "", baking: NONE }
    }
}
