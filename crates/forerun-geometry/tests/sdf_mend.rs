//! Meshes with the faults of every day: holes, flipped faces, shells that overlap, walls inside, sheets.
#![allow(dead_code, reason = "each test uses some of the common meshes")]

use forerun_geometry::contact::contact_manifolds;
use forerun_geometry::shape::{Enclosure, Inside, Mesh, MeshDraft, MeshError, MeshOptions};
use forerun_geometry::{Motion, Placed, Pose, Ray, Shape, Vec3};

#[path = "common/meshes.rs"]
mod meshes;
use meshes::{Random, Triangles};

fn mesh((vertices, triangles): &Triangles) -> Mesh {
    Mesh::new(vertices.clone(), triangles.clone()).expect("an inside")
}

fn distance(mesh: &Mesh, point: Vec3) -> f32 {
    mesh.collider().field.as_ref().expect("an inside").distance_and_gradient(point).0
}

/// Both, as one list of triangles.
fn and((mut vertices, mut triangles): Triangles, other: &Triangles, offset: Vec3) -> Triangles {
    let first = vertices.len() as u32;
    vertices.extend(other.0.iter().map(|v| *v + offset));
    triangles.extend(other.1.iter().map(|t| t.map(|i| i + first)));
    (vertices, triangles)
}

/// Compares a field with a true distance at random points; `allowed` in cells.
fn compare(mesh: &Mesh, truth: impl Fn(Vec3) -> f32, allowed: f32) {
    let field = mesh.collider().field.as_ref().expect("an inside");
    let bounds = mesh.bounds();
    let mut random = Random(5);
    let mut inside = 0;
    for _ in 0..20_000 {
        let p = bounds.centre() + random.vector() * bounds.half_extents() * 1.1;
        let (found, wanted) = (field.distance_and_gradient(p).0, truth(p));
        // Far from the surface the field only serves to cull.
        if wanted.abs() < 3.0 * field.cell() {
            let error = (found - wanted).abs() / field.cell();
            assert!(error < allowed, "{found} instead of {wanted} at {p}: {error} cells");
        }
        if wanted.abs() > field.cell() {
            assert_eq!(found < 0.0, wanted < 0.0, "{found} instead of {wanted} at {p}");
            inside += u32::from(wanted < 0.0);
        }
    }
    assert!(inside > 100, "{inside} points inside");
}

fn mass(mesh: Mesh) -> f32 {
    Shape::from(mesh).mass_properties(1.0).mass
}

#[test]
fn small_holes_are_covered_and_named() {
    let whole = meshes::sphere(0.5, 48, 24);
    let truth = mass(mesh(&whole));
    let mut holed = whole.clone();
    for k in [900, 500, 37] {
        holed.1.remove(k);
    }
    let mesh = mesh(&holed);
    assert_eq!(mesh.enclosure, Enclosure::Mended);
    assert_eq!((mesh.repairs.holes, mesh.repairs.hole_edges), (3, 9));
    let [a, b] = mesh.repairs.first_hole.expect("it has three");
    assert!((a.length() - 0.5).abs() < 0.01 && (b.length() - 0.5).abs() < 0.01);
    let area: f32 = [900, 500, 37]
        .map(|k: usize| whole.1[k].map(|i| whole.0[i as usize]))
        .iter()
        .map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0)
        .sum();
    assert!((mesh.repairs.cover_area / area - 1.0).abs() < 0.01, "{}", mesh.repairs);
    assert!(mesh.repairs.to_string().contains("3 holes with 9 edges covered"), "{}", mesh.repairs);
    let why = mesh.repairs.why_not_closed();
    assert_eq!(why, format!("3 holes with 9 edges, the first between {a} and {b}"));
    compare(&mesh, |p| p.length() - 0.5, 0.3);
    let mass = mass(mesh);
    assert!((mass / truth - 1.0).abs() < 0.01, "{mass} instead of {truth}");
}

#[test]
fn flipped_faces_are_turned() {
    let whole = meshes::torus(0.5, 0.2, 48, 16);
    let mut flipped = whole.clone();
    for triangle in flipped.1.iter_mut().step_by(7) {
        triangle.swap(1, 2);
    }
    let count = whole.1.len().div_ceil(7) as u32;
    let mesh = mesh(&flipped);
    assert_eq!((mesh.enclosure, mesh.repairs.flipped_triangles), (Enclosure::Closed, count));
    assert!(mesh.repairs.to_string().contains("turned to face outwards"), "{}", mesh.repairs);
    assert!(mesh.collider().field == self::mesh(&whole).collider().field);
    // A whole shell that faces inwards beside one that does not.
    let mut inverted = meshes::cuboid(Vec3::splat(0.2));
    inverted.1.iter_mut().for_each(|t| t.swap(0, 1));
    let mesh = self::mesh(&and(meshes::cuboid(Vec3::splat(0.5)), &inverted, Vec3::X));
    assert_eq!((mesh.enclosure, mesh.repairs.flipped_triangles), (Enclosure::Closed, 12));
    assert!((mass(mesh) - 1.064).abs() < 1e-5);
    // The same in the middle is a cavity.
    let mesh = self::mesh(&and(meshes::cuboid(Vec3::splat(0.5)), &inverted, Vec3::ZERO));
    assert_eq!((mesh.enclosure, mesh.repairs.flipped_triangles), (Enclosure::Closed, 0));
    assert!((mass(mesh) - 0.936).abs() < 1e-5);
}

#[test]
fn overlapping_shells_are_one_solid_without_walls_inside() {
    let (half, across) = (Vec3::new(0.6, 0.2, 0.2), Vec3::new(0.2, 0.6, 0.2));
    let bar = meshes::cuboid(half);
    let cross = and(bar.clone(), &meshes::cuboid(across), Vec3::ZERO);
    let mesh = mesh(&cross);
    assert_eq!(mesh.enclosure, Enclosure::Mended);
    assert!(mesh.repairs.inner_triangles > 0 && mesh.repairs.hole_edges == 0, "{}", mesh.repairs);
    assert!(!mesh.repairs.why_not_closed().contains("hole"), "{}", mesh.repairs.why_not_closed());
    let cuboid = |p: Vec3, half: Vec3| {
        let q = p.abs() - half;
        q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
    };
    // Outside the nearer one is the distance to both; inside that is a bound from above.
    let union = |p: Vec3| cuboid(p, half).min(cuboid(p, across));
    let field = mesh.collider().field.as_ref().expect("an inside");
    let mut random = Random(7);
    for _ in 0..20_000 {
        let p = random.vector() * 0.65;
        let (found, wanted) = (field.distance_and_gradient(p).0, union(p));
        if wanted > 0.0 && wanted < 3.0 * field.cell() {
            assert!((found - wanted).abs() < 0.5 * field.cell(), "{found} instead of {wanted} at {p}");
        } else if wanted < 0.0 {
            assert!(found < wanted + 0.5 * field.cell(), "{found} at {p}, at least {wanted} deep");
        }
    }
    // In the middle nothing is near but the front and the back.
    assert!((distance(&mesh, Vec3::ZERO) + 0.2).abs() < 0.01);
    let mass = mass(mesh);
    let truth = 2.0 * 1.2 * 0.16 - 0.064;
    assert!((mass / truth - 1.0).abs() < 0.01, "{mass} instead of {truth}");
}

#[test]
fn a_shell_within_a_shell_and_shells_that_touch_make_no_walls() {
    let small = meshes::cuboid(Vec3::splat(0.2));
    let nested = mesh(&and(meshes::cuboid(Vec3::splat(0.5)), &small, Vec3::ZERO));
    assert_eq!((nested.enclosure, nested.repairs.inner_triangles), (Enclosure::Mended, 12));
    assert!((distance(&nested, Vec3::ZERO) + 0.5).abs() < 0.02);
    assert!((mass(nested) - 1.0).abs() < 0.01);
    let touching = mesh(&and(small.clone(), &small, Vec3::X * 0.4));
    assert!((distance(&touching, Vec3::X * 0.2) + 0.2).abs() < 0.02);
    assert!((mass(touching) - 0.128).abs() < 0.001);
}

#[test]
fn cubes_that_share_an_edge_are_closed_and_touched_as_two() {
    let (cube, offset) = (meshes::cuboid(Vec3::splat(0.2)), Vec3::new(0.4, 0.4, 0.0));
    let mesh = mesh(&and(cube.clone(), &cube, offset));
    assert_eq!((mesh.enclosure, mesh.repairs.crowded_edges), (Enclosure::Closed, 1));
    let cuboid = |p: Vec3| {
        let q = p.abs() - Vec3::splat(0.2);
        q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
    };
    compare(&mesh, |p| cuboid(p).min(cuboid(p - offset)), 0.5);
    assert!((mass(mesh.clone()) - 0.128).abs() < 1e-5);
    // A small one in the corner between them: 3 mm into the top of one, 4 mm into the side of the other.
    let small = Shape::from(self::mesh(&meshes::cuboid(Vec3::splat(0.03))));
    let both = Shape::from(mesh);
    let at = Vec3::new(0.2 - 0.03 + 0.004, 0.2 + 0.03 - 0.003, 0.05);
    let mut manifolds = Vec::new();
    let placed = |shape, position| Placed {
        shape,
        pose: Pose { position, ..Pose::IDENTITY },
        motion: Motion::default(),
    };
    contact_manifolds(&placed(&both, Vec3::ZERO), &placed(&small, at), 0.001, &mut manifolds);
    let mut deepest = [0.0_f32; 2];
    for manifold in &manifolds {
        for (axis, deepest) in deepest.iter_mut().enumerate() {
            if manifold.normal[axis].abs() > 0.99 {
                *deepest = deepest.min(manifold.deepest());
            }
        }
    }
    assert!((deepest[0] + 0.004).abs() < 5e-4 && (deepest[1] + 0.003).abs() < 5e-4, "{manifolds:?}");
}

#[test]
fn shared_walls_of_cubes_are_inside_and_a_cube_that_is_there_twice_weighs_as_one() {
    let cube = meshes::cuboid(Vec3::splat(0.2));
    let joined = mesh(&and(cube.clone(), &cube, Vec3::X * 0.4));
    assert_eq!((joined.enclosure, joined.repairs.inner_triangles), (Enclosure::Mended, 4));
    for x in [0.19, 0.21] {
        assert!(distance(&joined, Vec3::new(x, 0.1, 0.0)) < -0.09);
    }
    let twice = mesh(&and(cube.clone(), &cube, Vec3::ZERO));
    assert!((mass(twice) - 0.064).abs() < 0.001);
}

#[test]
fn a_wall_across_the_inside_does_not_count() {
    let (mut vertices, mut triangles) = meshes::cuboid(Vec3::splat(0.5));
    // The corners of the box that the plane x = y passes through.
    let corner = |x: f32, y: f32, z: f32| {
        vertices.iter().position(|v| *v == Vec3::new(x, y, z)).expect("a corner") as u32
    };
    let [a, b, c, d] =
        [corner(-0.5, -0.5, -0.5), corner(0.5, 0.5, -0.5), corner(0.5, 0.5, 0.5), corner(-0.5, -0.5, 0.5)];
    triangles.extend([[a, b, c], [a, c, d]]);
    vertices.push(Vec3::ZERO);
    let mesh = mesh(&(vertices, triangles));
    assert_eq!((mesh.enclosure, mesh.repairs.inner_triangles), (Enclosure::Mended, 2));
    // The wall has an edge on each side of the box, and the box a diagonal along two of them.
    let why = mesh.repairs.why_not_closed();
    let crowded = mesh.repairs.crowded_edges;
    assert!(
        why.contains(&format!("{crowded} edges of more than two triangles, the first between [")),
        "{why}"
    );
    assert!(crowded > 1 && why.ends_with("2 triangles at least partly inside of other parts"), "{why}");
    let ends = mesh.repairs.first_crowded.expect("there are some");
    assert!(ends.iter().all(|end| (end.x - end.y).abs() < 1e-6), "{ends:?}");
    assert!((distance(&mesh, Vec3::new(0.1, 0.1, 0.0)) + 0.4).abs() < 0.02);
}

#[test]
fn sheets_and_terrains_have_no_inside() {
    let corners = vec![Vec3::ZERO, Vec3::Z, Vec3::X, Vec3::new(1.0, 0.3, 1.0)];
    let sheet = Mesh::new(corners.clone(), vec![[0, 1, 2], [1, 3, 2]]).unwrap_err();
    assert!(matches!(sheet, MeshError::Open { edges: 4, .. }), "{sheet}");
    assert_eq!(Mesh::open(corners, vec![[0, 1, 2], [1, 3, 2]]).unwrap().enclosure, Enclosure::Open);
    // Half a sphere: as much is missing as is there.
    let (vertices, triangles) = meshes::sphere(0.5, 24, 12);
    let bowl: Vec<[u32; 3]> =
        triangles.iter().copied().filter(|t| t.iter().all(|i| vertices[*i as usize].y < 0.01)).collect();
    assert!(bowl.len() > 100);
    let error = Mesh::new(vertices.clone(), bowl).unwrap_err();
    assert!(matches!(error, MeshError::Open { .. }) && error.to_string().contains("open mesh"), "{error}");
    // Without its bottom a box is a sheet as well.
    let (vertices, mut triangles) = meshes::cuboid(Vec3::splat(0.5));
    triangles.truncate(10);
    assert!(matches!(Mesh::new(vertices, triangles), Err(MeshError::Open { edges: 4, .. })));
}

#[test]
fn a_mended_mesh_is_made_again_from_its_own_triangles_and_from_bytes() {
    let mut holed = meshes::torus(0.5, 0.2, 48, 16);
    holed.1.truncate(holed.1.len() - 3);
    holed.1[100].swap(0, 1);
    let draft = MeshDraft::new(holed.0, holed.1, MeshOptions::default()).expect("an inside");
    let mesh = draft.bake(&|_, _| {}).expect("an inside");
    assert_eq!(mesh.enclosure, Enclosure::Mended);
    assert!(draft.restore(&mesh.baked_bytes()).expect("its own bytes") == mesh);
    let again = Mesh::new(mesh.vertices.clone(), mesh.triangles.clone()).expect("an inside");
    assert_eq!((&again.triangles, again.repairs.flipped_triangles), (&mesh.triangles, 0));
    assert!(again.collider() == mesh.collider());
}

#[test]
fn a_ray_through_a_covered_hole_starts_outside() {
    let mut holed = meshes::sphere(0.5, 48, 24);
    let hole = holed.1.remove(500).map(|i| holed.0[i as usize]).iter().sum::<Vec3>() / 3.0;
    let shape = Shape::from(mesh(&holed));
    let ray = |origin: Vec3, direction: Vec3| {
        let ray = Ray { origin, direction };
        shape.cast_ray(&forerun_geometry::Pose::IDENTITY, &ray, 10.0)
    };
    let through = ray(hole * 3.0, -hole.normalize()).expect("the other side");
    assert!(through.distance > 1.0);
    assert!(ray(Vec3::ZERO, Vec3::X).expect("the inside").distance <= 0.0);
    let options = MeshOptions { inside: Inside::Optional, ..MeshOptions::default() };
    let open = MeshDraft::new(holed.0, holed.1, options).expect("anything goes");
    assert!(!open.bake(&|_, _| {}).expect("anything goes").has_inside());
}
