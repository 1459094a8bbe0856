//! Mesh files: good ones as other readers read them, bad ones without a panic.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use forerun_geometry::mesh_file::{
    MeshFileOptions, MeshFileProblem, UpAxis, load_mesh, load_open_mesh, parse_obj, parse_stl,
};
use forerun_geometry::shape::{Mesh, mesh_make};
use forerun_geometry::{Shape, Vec3};

fn scaled(scale: f32) -> MeshFileOptions {
    MeshFileOptions { scale, ..MeshFileOptions::default() }
}

fn torus() -> Mesh {
    mesh_make::torus(0.4, 0.15, 20, 10).unwrap()
}

fn as_obj(mesh: &Mesh) -> String {
    let mut text = String::from("# torus\no thing\n");
    for v in &mesh.vertices {
        text += &format!("v {} {} {}\n", v.x, v.y, v.z);
    }
    text += "vn 0 1 0\nusemtl none\ns off\n";
    for t in &mesh.triangles {
        text += &format!("f {}//1 {}//1 {}//1\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    text
}

fn as_stl_text(mesh: &Mesh) -> String {
    let mut text = String::from("solid thing\n");
    for t in 0..mesh.triangles.len() {
        text += "facet normal 0 0 0\n outer loop\n";
        for v in mesh.corners(t) {
            text += &format!("  vertex {:e} {:e} {:e}\n", v.x, v.y, v.z);
        }
        text += " endloop\nendfacet\n";
    }
    text + "endsolid thing\n"
}

fn as_stl_binary(mesh: &Mesh) -> Vec<u8> {
    let triangles: Vec<stl_io::Triangle> = (0..mesh.triangles.len())
        .map(|t| stl_io::Triangle {
            normal: stl_io::Normal::new([0.0; 3]),
            vertices: mesh.corners(t).map(|v| stl_io::Vertex::new(v.to_array())),
        })
        .collect();
    let mut bytes = Vec::new();
    stl_io::write_stl(&mut bytes, triangles.iter()).unwrap();
    bytes
}

#[test]
fn obj_as_tobj_reads_it() {
    let text = as_obj(&torus());
    let ours = parse_obj(text.as_bytes()).unwrap();
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let options = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(&text), &options, no_materials).unwrap();
    assert_eq!(models.len(), 1);
    let theirs = &models[0].mesh;
    let corner = |i: u32| &theirs.positions[3 * i as usize..][..3];
    let positions = theirs.indices.iter().map(|&i| Vec3::from_slice(corner(i)));
    let own = ours.triangles.iter().flatten().map(|&i| ours.vertices[i as usize]);
    assert!(own.eq(positions));
}

#[test]
fn stl_as_stl_io_reads_it() {
    let mesh = torus();
    for bytes in [as_stl_text(&mesh).into_bytes(), as_stl_binary(&mesh)] {
        let ours = parse_stl(&bytes).unwrap();
        let theirs = stl_io::read_stl(&mut Cursor::new(&bytes)).unwrap();
        let positions =
            theirs.faces.iter().flat_map(|f| f.vertices).map(|i| Vec3::from(theirs.vertices[i].0));
        assert!(ours.triangles.iter().flatten().map(|&i| ours.vertices[i as usize]).eq(positions));
    }
}

fn file(name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn all_formats_give_the_same_solid() {
    let mesh = torus();
    let mass = Shape::from(mesh.clone()).mass_properties(1000.0).mass;
    let files = [
        file("torus.obj", as_obj(&mesh)),
        file("torus.STL", as_stl_text(&mesh)),
        file("torus_binary.stl", as_stl_binary(&mesh)),
    ];
    for path in files {
        let loaded = load_mesh(&path, scaled(2.0)).unwrap();
        assert_eq!((loaded.vertices.len(), loaded.triangles.len()), (200, 400));
        assert!(loaded.repairs.welded_vertices == 0 || loaded.repairs.welded_vertices == 1000);
        let loaded = Shape::from(loaded).mass_properties(1000.0);
        assert!((loaded.mass / mass - 8.0).abs() < 1e-5);
    }
}

#[test]
fn errors_name_file_place_and_remedy() {
    let error = load_mesh("nowhere/mug.obj", scaled(1.0)).unwrap_err();
    assert!(matches!(error.problem, MeshFileProblem::Unreadable(_)));
    assert!(error.to_string().starts_with("nowhere/mug.obj: cannot be read: "), "{error}");
    let error = load_mesh("mug.blend", scaled(1.0)).unwrap_err().to_string();
    assert_eq!(
        error,
        "mug.blend: is of no known mesh format; use a file that ends in .obj, .stl, .ply, .gltf or .glb"
    );
    let path = file("scaled.obj", as_obj(&torus()));
    assert_eq!(load_mesh(&path, scaled(-1.0)).unwrap_err().problem, MeshFileProblem::Scale(-1.0));
    let path = file("large.obj", as_obj(&mesh_make::cuboid(Vec3::splat(2.0)).unwrap()));
    assert!(matches!(load_mesh(&path, scaled(f32::MAX)).unwrap_err().problem, MeshFileProblem::Mesh(_)));

    let text = as_obj(&torus());
    let path = file("cut.obj", &text[..text.len() - 30]);
    let error = load_mesh(&path, scaled(1.0)).unwrap_err();
    assert!(matches!(error.problem, MeshFileProblem::Parse(_) | MeshFileProblem::Mesh(_)), "{error}");
    let path = file("mended.obj", text.rsplit_once("\nf").unwrap().0);
    assert_eq!(load_mesh(&path, scaled(1.0)).unwrap().repairs.hole_edges, 3);
    assert!(!load_open_mesh(&path, scaled(1.0)).unwrap().has_inside());
    // A twelfth of the surface is too much to be covered.
    let text = as_obj(&mesh_make::cuboid(Vec3::splat(0.5)).unwrap());
    let path = file("holed.obj", text.rsplit_once("\nf").unwrap().0);
    let error = load_mesh(&path, scaled(1.0)).unwrap_err().to_string();
    assert!(error.contains("holed.obj: the mesh is not closed: 3 edges"), "{error}");
    assert!(!load_open_mesh(&path, scaled(1.0)).unwrap().has_inside());
    for name in ["empty.obj", "empty.stl"] {
        assert!(matches!(
            load_mesh(file(name, ""), scaled(1.0)).unwrap_err().problem,
            MeshFileProblem::Parse(_)
        ));
    }
}

#[test]
fn what_points_up_in_the_file_points_up_here() {
    let path = file("upright.obj", as_obj(&mesh_make::cuboid(Vec3::new(0.1, 0.2, 0.3)).unwrap()));
    let half = |up| load_mesh(&path, MeshFileOptions { scale: 10.0, up }).unwrap().bounds().max;
    assert_eq!(half(UpAxis::Y), Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(half(UpAxis::Z), Vec3::new(1.0, 3.0, 2.0));
    assert_eq!(half(UpAxis::X), Vec3::new(2.0, 1.0, 3.0));
    // Turned, not mirrored.
    for up in [UpAxis::X, UpAxis::Y, UpAxis::Z] {
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| up.turned(axis));
        assert_eq!(x.cross(y), z);
    }
}
