//! Mesh files: triangle meshes from OBJ, STL, PLY and glTF.
//!
//! The readers are our own: the usual crates do not say where in the file an error is, and some panic on a bad index; the tests compare
//! with them on good files. Nothing in a file makes ours panic, or allocate more than a few times its size and, of a glTF file, the size of what
//! its nodes copy: at most 16 million vertices and triangles.

use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::Vec3;
use crate::shape::{Mesh, MeshError};

mod gltf;
mod obj;
mod ply;
mod ply_header;
mod polygon;
mod stl;

pub use crate::shape::TriangleList;
pub use gltf::{ReadBeside, parse_gltf};
pub use obj::parse_obj;
pub use ply::parse_ply;
pub use stl::parse_stl;

/// Largest file that is read. Bytes.
const LARGEST_FILE: u64 = 1 << 30;

/// A solid larger than this was most likely drawn in millimetres. Metres.
pub const LIKELY_MILLIMETRES: f32 = 20.0;

/// Which axis of a file points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// x is up, -y to the right.
    X,
    /// As everywhere here.
    #[default]
    Y,
    /// z is up, as in most programs for construction: (x, y, z) becomes (x, z, -y).
    Z,
}

impl UpAxis {
    /// A position of the file with y up.
    #[must_use]
    pub fn turned(self, position: Vec3) -> Vec3 {
        let Vec3 { x, y, z } = position;
        match self {
            UpAxis::X => Vec3::new(-y, x, z),
            UpAxis::Y => position,
            UpAxis::Z => Vec3::new(x, z, -y),
        }
    }
}

/// How the coordinates of a file are meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshFileOptions {
    /// Factor on all lengths: 0.001 for a file in millimetres. A finite number above 0, default 1.
    pub scale: f32,
    /// Which axis points up. Default y.
    pub up: UpAxis,
}

impl Default for MeshFileOptions {
    fn default() -> Self {
        MeshFileOptions { scale: 1.0, up: UpAxis::Y }
    }
}

/// Why bytes are no mesh file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseError {
    /// Where, like `line 12` or `triangle 3`.
    pub place: String,
    /// What is wrong, and what to do about it.
    pub message: String,
}

impl ParseError {
    fn new(place: impl Into<String>, message: impl Into<String>) -> Self {
        ParseError { place: place.into(), message: message.into() }
    }

    fn at_line(number: usize, message: impl Into<String>) -> Self {
        ParseError::new(format!("line {number}"), message)
    }
}

impl fmt::Display for ParseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}

impl std::error::Error for ParseError {}

/// Why a file gives no mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFileError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub problem: MeshFileProblem,
}

/// What is wrong with a mesh file.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshFileProblem {
    /// The file system says no; its words.
    Unreadable(String),
    /// More than 1 GiB.
    TooLarge,
    /// The extension is none of `obj`, `stl`, `ply`, `gltf` and `glb`.
    UnknownFormat,
    /// The scale asked for is not a finite number above 0.
    Scale(f32),
    /// The content is not of the format.
    Parse(ParseError),
    /// The triangles are no usable mesh.
    Mesh(MeshError),
}

impl fmt::Display for MeshFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.path.display())?;
        match &self.problem {
            MeshFileProblem::Unreadable(why) => write!(f, "cannot be read: {why}"),
            MeshFileProblem::TooLarge => write!(f, "is larger than 1 GiB; simplify the mesh"),
            MeshFileProblem::UnknownFormat => {
                write!(
                    f,
                    "is of no known mesh format; use a file that ends in .obj, .stl, .ply, .gltf or .glb"
                )
            }
            MeshFileProblem::Scale(scale) => {
                write!(f, "the scale must be a finite number above 0, is {scale}")
            }
            MeshFileProblem::Parse(error) => error.fmt(f),
            MeshFileProblem::Mesh(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for MeshFileError {}

/// The closed mesh in a file.
///
/// # Errors
/// When the file cannot be read or parsed, or its triangles are no closed mesh; see [`Mesh::new`].
pub fn load_mesh(path: impl AsRef<Path>, options: MeshFileOptions) -> Result<Mesh, MeshFileError> {
    load(path.as_ref(), options, Mesh::new)
}

/// The same for a mesh that may be open: terrain and other fixed bodies.
///
/// # Errors
/// When the file cannot be read or parsed, or has no triangles; see [`Mesh::open`].
pub fn load_open_mesh(path: impl AsRef<Path>, options: MeshFileOptions) -> Result<Mesh, MeshFileError> {
    load(path.as_ref(), options, Mesh::open)
}

type MakeMesh = fn(Vec<Vec3>, Vec<[u32; 3]>) -> Result<Mesh, MeshError>;

fn load(path: &Path, options: MeshFileOptions, make: MakeMesh) -> Result<Mesh, MeshFileError> {
    let list = load_triangles(path, options)?;
    make(list.vertices, list.triangles)
        .map_err(|error| MeshFileError { path: path.to_owned(), problem: MeshFileProblem::Mesh(error) })
}

/// The triangles in a file, scaled and turned, before anybody asks whether they make a mesh.
///
/// # Errors
/// When the file cannot be read or parsed.
pub fn load_triangles(
    path: impl AsRef<Path>,
    options: MeshFileOptions,
) -> Result<TriangleList, MeshFileError> {
    let path = path.as_ref();
    let fail = |problem| MeshFileError { path: path.to_owned(), problem };
    let MeshFileOptions { scale, up } = options;
    if !(scale > 0.0 && scale.is_finite()) {
        return Err(fail(MeshFileProblem::Scale(scale)));
    }
    let beside = |name: &str| {
        let folder = path.parent().unwrap_or(Path::new(""));
        read(&folder.join(name)).map_err(|problem| match problem {
            MeshFileProblem::Unreadable(why) => why,
            _ => "it is larger than 1 GiB".to_owned(),
        })
    };
    let parse: &dyn Fn(&[u8]) -> Result<TriangleList, ParseError> = match Extension::of(path).map_err(fail)? {
        Extension::Obj => &parse_obj,
        Extension::Stl => &parse_stl,
        Extension::Ply => &parse_ply,
        Extension::Gltf => &|bytes| parse_gltf(bytes, &beside),
    };
    let bytes = read(path).map_err(fail)?;
    let mut list = parse(&bytes).map_err(|e| fail(MeshFileProblem::Parse(e)))?;
    list.vertices.iter_mut().for_each(|v| *v = up.turned(*v) * scale);
    Ok(list)
}

/// What the end of a file's name says of its content.
enum Extension {
    Obj,
    Stl,
    Ply,
    Gltf,
}

impl Extension {
    fn of(path: &Path) -> Result<Extension, MeshFileProblem> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match extension.as_str() {
            "obj" => Ok(Extension::Obj),
            "stl" => Ok(Extension::Stl),
            "ply" => Ok(Extension::Ply),
            "gltf" | "glb" => Ok(Extension::Gltf),
            _ => Err(MeshFileProblem::UnknownFormat),
        }
    }
}

fn read(path: &Path) -> Result<Vec<u8>, MeshFileProblem> {
    let unreadable = |e: std::io::Error| MeshFileProblem::Unreadable(e.to_string());
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(LARGEST_FILE + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > LARGEST_FILE { Err(MeshFileProblem::TooLarge) } else { Ok(bytes) }
}

/// Three finite numbers from words.
fn parse_position<'a>(words: &mut impl Iterator<Item = &'a str>) -> Result<Vec3, String> {
    let mut position = Vec3::ZERO;
    for axis in 0..3 {
        let word = words.next().ok_or_else(|| format!("a vertex needs three numbers, there are {axis}"))?;
        let number: f32 = word.parse().map_err(|_| format!("\"{}\" is not a number", shortened(word)))?;
        if !number.is_finite() {
            return Err(format!("\"{}\" is not a finite number", shortened(word)));
        }
        position[axis] = number;
    }
    Ok(position)
}

/// The first characters of a word that may be anything, fit to be shown.
fn shortened(word: &str) -> String {
    let mut shown: String = word.chars().take(24).flat_map(char::escape_debug).collect();
    if word.chars().nth(24).is_some() {
        shown.push('…');
    }
    shown
}
