//! Fields of meshes against distances by formula.
#![allow(dead_code, reason = "each test uses some of the common meshes")]

use forerun_geometry::Vec3;
use forerun_geometry::sdf::Field;
use forerun_geometry::shape::Mesh;

#[path = "common/meshes.rs"]
mod meshes;
use meshes::{Random, Triangles};

fn mesh((vertices, triangles): Triangles) -> Mesh {
    Mesh::new(vertices, triangles).expect("a closed mesh")
}

fn field(mesh: &Mesh) -> &Field {
    mesh.collider().field.as_ref().expect("closed meshes have a field")
}

/// Root mean square and largest of numbers.
fn spread(values: &[f32]) -> (f32, f32) {
    let squares: f32 = values.iter().map(|v| v * v).sum();
    ((squares / values.len() as f32).sqrt(), values.iter().fold(0.0, |m, v| m.max(v.abs())))
}

#[test]
fn a_torus_field_is_close_to_the_formula_near_the_surface() {
    let mesh = mesh(meshes::torus(0.5, 0.2, 48, 16));
    let field = field(&mesh);
    assert!((mesh.half_thickness() - 0.2).abs() < 0.01, "half thickness {}", mesh.half_thickness());
    let mut random = Random(1);
    let (mut values, mut angles, mut rough_angles) = (vec![], vec![], vec![]);
    while values.len() < 4000 {
        let p = random.vector() * Vec3::new(0.75, 0.25, 0.75);
        let true_distance = meshes::torus_distance(0.5, 0.2, p);
        if true_distance.abs() > 0.01 {
            continue;
        }
        let (distance, gradient) = field.distance_and_gradient(p);
        let normal = meshes::torus_normal(0.5, p);
        values.push(distance - true_distance);
        angles.push(field.smooth_gradient(p).normalize().angle_between(normal).to_degrees());
        rough_angles.push(gradient.normalize().angle_between(normal).to_degrees());
    }
    let (rms, largest) = spread(&values);
    // The mesh itself is up to 3.9 mm inside the torus.
    assert!(rms < 0.0045 && largest < 0.011, "distance errors: rms {rms} m, largest {largest} m");
    let (rms, largest) = spread(&angles);
    // Facets turn by up to 22 degrees; the field smooths them.
    assert!(rms < 2.5 && largest < 7.0, "smooth normals: rms {rms} degrees, largest {largest}");
    let (rms, largest) = spread(&rough_angles);
    assert!(rms < 5.0 && largest < 15.0, "trilinear normals: rms {rms} degrees, largest {largest}");
}

#[test]
fn a_sphere_field_is_close_to_the_formula_everywhere() {
    let mesh = mesh(meshes::sphere(0.5, 48, 24));
    let field = field(&mesh);
    let mut random = Random(2);
    for _ in 0..4000 {
        let p = random.vector() * 3.0;
        let (distance, gradient) = field.distance_and_gradient(p);
        let error = distance - (p.length() - 0.5);
        // Far beyond the grid the field sees the surface point that the nearest point of the box sees.
        let allowed = if field.contains(p) { 0.2 * field.cell() } else { 0.15 * p.length() };
        assert!(error.abs() < allowed, "{error} m off at {p}");
        if field.contains(p) && p.length() > 0.2 {
            let angle = gradient.normalize().angle_between(p.normalize()).to_degrees();
            assert!(angle < 10.0, "normal {angle} degrees off at {p}");
        }
    }
}

#[test]
fn inside_is_negative_and_outside_positive() {
    type Inside = fn(Vec3) -> bool;
    let shapes: [(&str, Triangles, Inside); 4] = [
        ("torus", meshes::torus(0.5, 0.2, 48, 16), |p| meshes::torus_distance(0.5, 0.2, p) < 0.0),
        ("box", meshes::cuboid(Vec3::new(0.6, 0.3, 0.2)), |p| p.abs().cmple(Vec3::new(0.6, 0.3, 0.2)).all()),
        ("l", meshes::l_shape(), meshes::inside_l_shape),
        ("sphere", meshes::sphere(0.5, 24, 12), |p| p.length() < 0.5),
    ];
    for (name, triangles, inside) in shapes {
        let mesh = self::mesh(triangles);
        let field = field(&mesh);
        let mut random = Random(3);
        let mut seen = [0, 0];
        for _ in 0..20_000 {
            let p = random.vector() * 1.2;
            let (distance, gradient) = field.distance_and_gradient(p);
            assert!(distance.is_finite() && gradient.is_finite(), "{name}: not finite at {p}");
            // Within a third of a cell of the surface, and of the facets, the sign is nobody's.
            if distance.abs() > 0.35 * field.cell() {
                assert_eq!(distance < 0.0, inside(p), "{name}: {distance} at {p}");
                seen[usize::from(inside(p))] += 1;
            }
        }
        assert!(seen[0] > 100 && seen[1] > 100, "{name}: {seen:?} points outside and inside");
    }
}

#[test]
fn a_box_field_is_exact_beside_its_faces() {
    let half = Vec3::new(0.6, 0.3, 0.2);
    let mesh = mesh(meshes::cuboid(half));
    let field = field(&mesh);
    for k in 0..40 {
        let above = -0.05 + 0.0025 * k as f32;
        let (distance, gradient) = field.distance_and_gradient(Vec3::new(0.1, -0.05, half.z + above));
        assert!((distance - above).abs() < 1e-4, "{distance} instead of {above}");
        assert!(gradient.distance(Vec3::Z) < 0.01, "{gradient}");
    }
}

#[test]
fn the_same_mesh_gives_the_same_bytes() {
    let make = || mesh(meshes::torus(0.5, 0.2, 48, 16));
    assert!(make() == make());
}

#[test]
fn an_open_mesh_has_no_field() {
    let (vertices, mut triangles) = meshes::cuboid(Vec3::ONE);
    triangles.pop();
    assert!(Mesh::open(vertices, triangles).expect("valid numbers").collider().field.is_none());
}

#[test]
fn a_large_thin_mesh_keeps_its_field_small() {
    let mesh = mesh(meshes::cuboid(Vec3::new(5.0, 0.005, 5.0)));
    let field = field(&mesh);
    assert!((mesh.half_thickness() - 0.005).abs() < 1e-4);
    assert!(field.bytes() <= 2 << 20, "{} bytes", field.bytes());
}
