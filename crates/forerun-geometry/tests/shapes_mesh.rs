//! What makes a mesh, what is mended and what is refused.

mod shapes_common;

use forerun_geometry::shape::{Mesh, MeshError, MeshRepairs, mesh_make};
use forerun_geometry::{Shape, Vec3};

fn cube() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mesh = mesh_make::cuboid(Vec3::ONE).unwrap();
    (mesh.vertices, mesh.triangles)
}

fn volume(mesh: Mesh) -> f32 {
    Shape::from(mesh).mass_properties(1.0).mass
}

#[test]
fn a_clean_mesh_is_taken_as_it_is() {
    let (vertices, triangles) = cube();
    let mesh = Mesh::new(vertices.clone(), triangles.clone()).unwrap();
    assert!(mesh.has_inside() && mesh.repairs.is_none());
    assert_eq!((mesh.vertices, mesh.triangles), (vertices, triangles));
}

#[test]
fn an_inverted_mesh_is_turned() {
    let (vertices, mut triangles) = cube();
    triangles.iter_mut().for_each(|t| t.reverse());
    let mesh = Mesh::new(vertices, triangles).unwrap();
    assert_eq!(mesh.repairs, MeshRepairs { turned: true, ..MeshRepairs::default() });
    assert!(mesh.repairs.to_string().contains("turned round"));
    assert!((volume(mesh) - 8.0).abs() < 1e-6);
}

#[test]
fn separate_triangles_are_welded() {
    let (vertices, triangles) = cube();
    let mut soup = Vec::new();
    for triangle in &triangles {
        soup.extend(triangle.map(|i| vertices[i as usize]));
    }
    // -0 and +0 are one place.
    soup.iter_mut().for_each(|v| *v -= Vec3::ONE);
    soup.iter_mut().step_by(2).for_each(|v| *v = v.map(|x| if x == 0.0 { -0.0 } else { x }));
    let indices = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let mesh = Mesh::new(soup, indices).unwrap();
    assert_eq!(mesh.vertices.len(), 8);
    assert_eq!(mesh.repairs, MeshRepairs { welded_vertices: 28, ..MeshRepairs::default() });
    assert!((volume(mesh) - 8.0).abs() < 1e-6);
}

#[test]
fn degenerate_triangles_and_unused_vertices_are_left_out() {
    let (mut vertices, mut triangles) = cube();
    vertices.insert(3, Vec3::splat(77.0));
    triangles.iter_mut().flatten().for_each(|i| *i += u32::from(*i >= 3));
    triangles.push([0, 0, 1]);
    triangles.push([2, 1, 2]);
    let mesh = Mesh::new(vertices, triangles).unwrap();
    let expected = MeshRepairs { dropped_triangles: 2, unused_vertices: 1, ..MeshRepairs::default() };
    assert_eq!(mesh.repairs, expected);
    assert!((volume(mesh.clone()) - 8.0).abs() < 1e-6);
    assert_eq!(mesh.bounds().max, Vec3::ONE);
}

#[test]
fn slivers_are_cut_anew_without_opening_the_mesh() {
    // An extra vertex in the middle of an edge: one side's triangle is split there, the other has a sliver.
    let (mut vertices, triangles) = cube();
    let [a, b, c] = triangles[0];
    let middle = vertices.len() as u32;
    vertices.push((vertices[a as usize] + vertices[b as usize]) * 0.5);
    let mut cut = triangles[1..].to_vec();
    cut.extend([[a, middle, c], [middle, b, c], [a, b, middle]]);
    let mesh = Mesh::new(vertices.clone(), cut.clone()).unwrap();
    assert_eq!(mesh.repairs, MeshRepairs { recut_triangles: 1, ..MeshRepairs::default() });
    assert_eq!(mesh.triangles.len(), 14);
    assert!((0..14).all(|t| {
        let [p, q, r] = mesh.corners(t);
        (q - p).cross(r - p).length() > 0.1
    }));
    assert!((volume(mesh) - 8.0).abs() < 1e-6);
    // Two points on the edge: a sliver beside a sliver.
    vertices.push(vertices[a as usize].lerp(vertices[b as usize], 0.25));
    let quarter = middle + 1;
    cut.truncate(11);
    cut.extend([[a, quarter, c], [quarter, middle, c], [middle, b, c], [a, b, middle], [a, middle, quarter]]);
    let mesh = Mesh::new(vertices, cut).unwrap();
    assert_eq!((mesh.repairs.dropped_triangles, mesh.triangles.len()), (0, 16));
    assert!((volume(mesh) - 8.0).abs() < 1e-6);
}

#[test]
fn an_open_mesh_is_refused_by_the_place_of_its_hole() {
    let (vertices, mut triangles) = cube();
    let hole = triangles.remove(5).map(|i| vertices[i as usize]);
    let error = Mesh::new(vertices.clone(), triangles.clone()).unwrap_err();
    let MeshError::Open { edges, first } = &error else { panic!("{error}") };
    assert_eq!(*edges, 3);
    assert!(hole.contains(&first[0]) && hole.contains(&first[1]));
    let message = error.to_string();
    assert!(message.contains("3 edges") && message.contains(&first[0].to_string()), "{message}");
    let open = Mesh::open(vertices.clone(), triangles).unwrap();
    assert!(!open.has_inside() && open.half_thickness().is_infinite());
    // What is closed is closed, however it is asked for.
    assert!(Mesh::open(vertices.clone(), cube().1).unwrap().has_inside());
    // A room faces inwards, with or without something in it: its walls stay as they are.
    let inwards: Vec<[u32; 3]> = cube().1.into_iter().map(|[a, b, c]| [a, c, b]).collect();
    let mut furnished = (vertices.clone(), inwards.clone());
    furnished.0.extend(vertices.iter().map(|v| *v * 0.5));
    furnished.1.extend(cube().1.into_iter().map(|t| t.map(|i| i + 8)));
    for (vertices, triangles) in [(vertices.clone(), inwards.clone()), furnished] {
        let room = Mesh::open(vertices, triangles.clone()).unwrap();
        assert!(!room.has_inside() && room.triangles == triangles && room.repairs.is_none());
    }
    assert!(Mesh::new(vertices, inwards).unwrap().repairs.turned);
}

#[test]
fn twisted_triangles_are_turned_and_crowded_edges_refused() {
    let (vertices, mut triangles) = cube();
    triangles[4].swap(0, 1);
    let mesh = Mesh::new(vertices.clone(), triangles).unwrap();
    assert_eq!(mesh.repairs, MeshRepairs { flipped_triangles: 1, ..MeshRepairs::default() });
    // A band of an odd number of half turns has one side only.
    let triangles = (0..5).map(|i| [i, (i + 1) % 5, (i + 2) % 5]).collect();
    let error = Mesh::new(vertices.clone(), triangles).unwrap_err();
    assert!(matches!(error, MeshError::Open { .. }), "{error}");
    let (_, mut triangles) = cube();
    triangles.push(triangles[0]);
    triangles.push(triangles[0]);
    let error = Mesh::new(vertices, triangles).unwrap_err();
    assert!(matches!(error, MeshError::Crowded { edges: 3, triangles: 4, .. }), "{error}");
}

#[test]
fn nonsense_is_refused_by_name() {
    let (vertices, triangles) = cube();
    let mut far = triangles.clone();
    far[7][1] = 8;
    let error = Mesh::new(vertices.clone(), far).unwrap_err();
    assert_eq!(error.to_string(), "triangle 7 names vertex 8, but there are 8 vertices (0 to 7)");
    let mut broken = vertices.clone();
    broken[2].z = f32::NAN;
    assert!(matches!(
        Mesh::new(broken.clone(), triangles.clone()),
        Err(MeshError::NotFinite { vertex: 2, .. })
    ));
    assert!(Mesh::open(broken, triangles.clone()).is_err());
    let mut far = vertices.clone();
    far[3].x = -2e6;
    let error = Mesh::new(far, triangles).unwrap_err();
    assert!(
        matches!(error, MeshError::TooFar { vertex: 3, .. }) && error.to_string().contains("scale"),
        "{error}"
    );
    assert!(matches!(Mesh::new(vertices.clone(), vec![]), Err(MeshError::Empty { dropped: 0 })));
    let points = Mesh::open(vertices.clone(), vec![[0, 0, 1]]).unwrap_err();
    assert!(matches!(points, MeshError::Empty { dropped: 1 }));
    // Both sides of one sheet are closed but enclose nothing.
    let sheet = Mesh::new(vertices, vec![[0, 1, 2], [0, 2, 1]]).unwrap_err();
    assert!(matches!(sheet, MeshError::NoVolume { .. }), "{sheet}");
    assert_eq!(Shape::mesh(vec![], vec![]).unwrap_err().field, "mesh");
}

#[test]
fn several_shells_and_cavities_are_one_solid() {
    let (mut vertices, mut triangles) = cube();
    let (small, inner) = cube();
    let first = vertices.len() as u32;
    vertices.extend(small.iter().map(|v| *v * 0.5));
    triangles.extend(inner.iter().map(|t| [t[0] + first, t[2] + first, t[1] + first]));
    let second = vertices.len() as u32;
    vertices.extend(small.iter().map(|v| *v + Vec3::X * 4.0));
    triangles.extend(inner.iter().map(|t| t.map(|i| i + second)));
    let mesh = Mesh::new(vertices, triangles).unwrap();
    assert!(mesh.repairs.is_none());
    assert!((volume(mesh) - 15.0).abs() < 1e-5);
}
