//! Mesh files: OBJ and STL, as triangles in the order of the file.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use forerun_geometry::Vec3;

use crate::error::Fault;
use crate::mesh::Triangles;

/// Reads a mesh file. All objects of an OBJ file become one mesh; equal corners of STL triangles become one vertex.
pub(crate) fn read(path: &Path) -> Result<Triangles, Fault> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let reader: fn(File) -> Result<Triangles, String> = match extension.as_str() {
        "obj" => read_obj,
        "stl" => read_stl,
        _ => {
            return Err(Fault::new(
                format!("a mesh file ends in .obj or .stl, this is \"{}\"", path.display()),
                "convert the mesh to OBJ or STL",
            ));
        }
    };
    let file = File::open(path).map_err(|error| {
        Fault::new(
            format!("cannot open \"{}\": {error}", path.display()),
            "the name is relative to the folder of the scene file",
        )
    })?;
    let mesh = reader(file).map_err(|error| {
        Fault::new(
            format!("cannot read \"{}\": {error}", path.display()),
            "export the mesh again from its program",
        )
    })?;
    if mesh.triangles.is_empty() {
        return Err(Fault::new(
            format!("\"{}\" has no triangles", path.display()),
            "export faces, not only points or lines",
        ));
    }
    if let Some(vertex) = mesh.vertices.iter().find(|v| !v.is_finite()) {
        return Err(Fault::new(
            format!("\"{}\" has a vertex that is not finite: {vertex}", path.display()),
            "export the mesh again from its program",
        ));
    }
    Ok(mesh)
}

fn read_obj(file: File) -> Result<Triangles, String> {
    let options = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
    // Materials say how a mesh looks, not what it is: they are not read.
    let (models, _) =
        tobj::load_obj_buf(&mut BufReader::new(file), &options, |_| Err(tobj::LoadError::GenericFailure))
            .map_err(|error| error.to_string())?;
    let mut mesh = Triangles { vertices: Vec::new(), triangles: Vec::new() };
    for model in models {
        let first = mesh.vertices.len() as u32;
        mesh.vertices.extend(model.mesh.positions.chunks_exact(3).map(Vec3::from_slice));
        let corners = model.mesh.indices.chunks_exact(3);
        mesh.triangles.extend(corners.map(|c| [first + c[0], first + c[1], first + c[2]]));
    }
    Ok(mesh)
}

fn read_stl(file: File) -> Result<Triangles, String> {
    let stl = stl_io::read_stl(&mut BufReader::new(file)).map_err(|error| error.to_string())?;
    Ok(Triangles {
        vertices: stl.vertices.iter().map(|v| Vec3::new(v[0], v[1], v[2])).collect(),
        triangles: stl.faces.iter().map(|face| face.vertices.map(|i| i as u32)).collect(),
    })
}
