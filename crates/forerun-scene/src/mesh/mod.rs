//! Triangle meshes of a scene: from a file, or made by a formula.

use forerun_geometry::mesh_file::{
    LIKELY_MILLIMETRES, MeshFileError, MeshFileOptions, MeshFileProblem, UpAxis, load_triangles,
};
use forerun_geometry::shape::{Inside, Mesh, MeshOptions, ShapeError};
use serde::{Deserialize, Serialize};

use crate::error::{Fault, Step, Within};
use crate::mesh_baking::BakeSite;
use crate::range;

mod formula;
mod source;

pub use formula::{
    BallEntry, BoltEntry, BowlEntry, ChairEntry, GearEntry, GripEntry, JackEntry, LetterEntry, LinkEntry,
    MugEntry, NutEntry, TerrainEntry, ThreadEntry, TorusEntry, TorusKnotEntry,
};
pub use source::MeshSource;

use formula::Formula;
use source::{MeshTable, Origin};

/// A mesh in a scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "MeshTable", into = "MeshTable")]
pub struct MeshEntry {
    /// Where it comes from: a file or a formula.
    pub source: MeshSource,
    /// Factor on all coordinates. Above 0, default 1.
    pub scale: f32,
    /// Which axis of the file points up. Default y.
    pub up: UpEntry,
    /// Wished distance between the nodes of its distance field, after scaling. Metres, above 0. Default an eighth of the smallest thickness or narrowest gap.
    pub cell: Option<f32>,
    /// Whether it may have holes and edges, or face inwards: a terrain, a room. Such a mesh has no inside and is for fixed and kinematic bodies
    /// only. One that is closed and faces outwards has an inside all the same. Default false.
    pub open: bool,
}

/// Which axis of a mesh file points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UpEntry {
    /// x is up.
    X,
    /// y is up: glTF, and most programs that draw.
    #[default]
    Y,
    /// z is up: most programs that construct.
    Z,
}

impl UpEntry {
    /// Whether nothing has to be turned.
    pub(crate) fn is_y(&self) -> bool {
        *self == UpEntry::Y
    }
}

impl From<UpEntry> for UpAxis {
    fn from(entry: UpEntry) -> Self {
        match entry {
            UpEntry::X => UpAxis::X,
            UpEntry::Y => UpAxis::Y,
            UpEntry::Z => UpAxis::Z,
        }
    }
}

impl<T: Into<MeshSource>> From<T> for MeshEntry {
    fn from(source: T) -> MeshEntry {
        MeshEntry { source: source.into(), scale: 1.0, up: UpEntry::Y, cell: None, open: false }
    }
}

impl MeshEntry {
    /// Everything but whether the file can be read.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        range::above_zero(self.scale, "scale")?;
        range::above_zero(self.cell.unwrap_or(1.0), "cell")?;
        let Origin::Formula(name, formula) = self.source.origin() else { return Ok(()) };
        if !self.up.is_y() {
            let fault =
                Fault::new("only a mesh from a file may have another axis up", "turn the body instead");
            return Err(fault).in_field("up");
        }
        formula.check().map_err(parameter_fault).in_field(name)
    }

    /// The mesh itself. Reads a file if there is one to read.
    pub(crate) fn build(&self, site: &BakeSite<'_>) -> Result<Mesh, Fault> {
        match self.source.origin() {
            Origin::File(file) => self.load(file, site).in_field("file"),
            Origin::Formula(name, formula) => self.shape(formula, site).in_field(name),
        }
    }

    fn load(&self, file: &str, site: &BakeSite<'_>) -> Result<Mesh, Fault> {
        let path = site.folder.join(file);
        let options = MeshFileOptions { scale: self.scale, up: self.up.into() };
        let list = load_triangles(&path, options).map_err(|error| file_fault(&error))?;
        let mesh = site.make(list, self.options()).map_err(|error| {
            file_fault(&MeshFileError { path: path.clone(), problem: MeshFileProblem::Mesh(error) })
        })?;
        let bounds = mesh.bounds();
        let size = (bounds.max - bounds.min).max_element();
        if mesh.has_inside() && size > LIKELY_MILLIMETRES {
            site.warn(&format!("is {size} m large; write scale = 0.001 if the file is in millimetres"));
        }
        Ok(mesh)
    }

    fn shape(&self, formula: &dyn Formula, site: &BakeSite<'_>) -> Result<Mesh, Fault> {
        let mut list = formula.triangles().map_err(parameter_fault)?;
        list.vertices.iter_mut().for_each(|v| *v *= self.scale);
        site.make(list, self.options()).map_err(|error| Fault::new(error.to_string(), MEND))
    }

    fn options(&self) -> MeshOptions {
        let inside = if self.open { Inside::Optional } else { Inside::Needed };
        MeshOptions { inside, cell: self.cell }
    }
}

const MEND: &str = "mend the mesh, or say open = true if it is a fixed terrain";

fn parameter_fault(ShapeError { field, message }: ShapeError) -> Fault {
    Fault::new(message, "change this or what it is compared with").under(Step::Field(field.to_owned()))
}

fn file_fault(error: &MeshFileError) -> Fault {
    let remedy = match error.problem {
        MeshFileProblem::Unreadable(_) => "the name is relative to the folder of the scene file",
        MeshFileProblem::TooLarge => "simplify the mesh",
        MeshFileProblem::UnknownFormat => "convert the mesh to glTF, PLY, OBJ or STL",
        MeshFileProblem::Scale(_) => "write a factor above 0",
        MeshFileProblem::Parse(_) => "export the mesh again from its program",
        MeshFileProblem::Mesh(_) => MEND,
    };
    Fault::new(error.to_string(), remedy)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TORUS: TorusEntry = TorusEntry { radius: 0.5, tube_radius: 0.2, segments: 12, sides: 6 };

    #[test]
    fn scale_and_cell_reach_the_mesh() {
        let plain = MeshEntry::from(TORUS).build(&BakeSite::nowhere()).unwrap();
        let scaled = MeshEntry { scale: 2.0, cell: Some(0.1), ..TORUS.into() };
        let scaled = scaled.build(&BakeSite::nowhere()).unwrap();
        assert_eq!(scaled.bounds().max, plain.bounds().max * 2.0);
        assert_eq!((plain.options().cell, scaled.options().cell), (None, Some(0.1)));
    }

    #[test]
    fn faults_name_the_parameter() {
        let thick = TorusEntry { tube_radius: 0.6, ..TORUS };
        let fault = MeshEntry::from(thick).check().unwrap_err();
        assert_eq!(fault.path.to_string(), "torus.radius");
        let fault = MeshEntry { cell: Some(-1.0), ..TORUS.into() }.check().unwrap_err();
        assert_eq!(fault.path.to_string(), "cell");
        // A terrain has no inside, and is not to be used as if it had.
        let terrain = TerrainEntry { half_width: 5.0, height: 1.0, hill: 4.0, cells: 10, seed: 1 };
        let fault = MeshEntry::from(terrain).build(&BakeSite::nowhere()).unwrap_err();
        assert!(fault.path.to_string() == "terrain" && fault.remedy.contains("open = true"), "{fault:?}");
    }
}
