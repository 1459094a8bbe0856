//! Mass properties against formulas and against sums over particles (dissertation, equations 2.10, 2.11 and 2.20).

mod shapes_common;

use forerun_geometry::shape::{Hull, Mesh, mesh_make};
use forerun_geometry::{MassProperties, Pose, Quat, Shape, Vec3};
use glam::{DMat3, DVec3};
use shapes_common::Random;

/// Mass, centre of mass and inertia tensor of particles that fill a shape.
struct ParticleSum {
    mass: f64,
    centre: DVec3,
    inertia: DMat3,
}

/// Cuts the box from -size to size into `cells`³ cubes; each whose middle weighs something is a particle.
fn particle_sum(size: f64, cells: u32, density_at: impl Fn(Vec3) -> f64) -> ParticleSum {
    let side = 2.0 * size / f64::from(cells);
    let middle = |i: u32| (f64::from(i) + 0.5) * side - size;
    let mut particles = Vec::new();
    for x in 0..cells {
        for y in 0..cells {
            for z in 0..cells {
                let r = DVec3::new(middle(x), middle(y), middle(z));
                let m = density_at(r.as_vec3()) * side * side * side;
                if m > 0.0 {
                    particles.push((m, r));
                }
            }
        }
    }
    let mass: f64 = particles.iter().map(|(m, _)| m).sum();
    let centre = particles.iter().map(|(m, r)| *r * *m).sum::<DVec3>() / mass;
    let mut inertia = DMat3::ZERO;
    for (m, r) in particles {
        let d = r - centre;
        let products = DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        inertia += (DMat3::from_diagonal(DVec3::splat(d.dot(d))) - products) * m;
    }
    ParticleSum { mass, centre, inertia }
}

fn assert_close(found: &MassProperties, expected: &ParticleSum, size: f64, relative: f64) {
    let mass = f64::from(found.mass);
    assert!((mass - expected.mass).abs() <= relative * expected.mass, "{mass} kg, not {}", expected.mass);
    let centre = found.centre.as_dvec3();
    assert!((centre - expected.centre).length() <= relative * size, "{centre}, not {}", expected.centre);
    let trace = expected.inertia.x_axis.x + expected.inertia.y_axis.y + expected.inertia.z_axis.z;
    let tensor = found.inertia_tensor();
    assert!(tensor.abs_diff_eq(expected.inertia, relative * trace), "{tensor}\nnot\n{}", expected.inertia);
    assert!((found.principal_rotation.length() - 1.0).abs() < 1e-6);
    assert!(found.principal_inertia.min_element() > 0.0);
}

/// Whether a local point is in a convex shape, written apart from the library.
fn contains(shape: &Shape, p: Vec3) -> bool {
    match shape {
        Shape::Sphere(s) => p.length() <= s.radius,
        Shape::Cuboid(c) => (p.abs() - c.half_extents).max_element() <= 0.0,
        Shape::Capsule(c) => p.distance(Vec3::Y * p.y.clamp(-c.half_height, c.half_height)) <= c.radius,
        Shape::Cylinder(c) => p.y.abs() <= c.half_height && p.x.hypot(p.z) <= c.radius,
        Shape::Hull(hull) => hull.faces.iter().all(|f| f.normal.dot(p) <= f.offset),
        _ => panic!("not convex"),
    }
}

fn convex_shapes() -> Vec<Shape> {
    let mut random = Random(11);
    let cloud: Vec<Vec3> = (0..12).map(|_| random.vector(0.9)).collect();
    vec![
        Shape::sphere(0.8).unwrap(),
        Shape::cuboid(Vec3::new(0.9, 0.3, 0.5)).unwrap(),
        Shape::capsule(0.5, 0.4).unwrap(),
        Shape::capsule(0.0, 0.7).unwrap(),
        Shape::cylinder(0.2, 0.9).unwrap(),
        Shape::hull(&cloud).unwrap(),
    ]
}

#[test]
fn convex_shapes_weigh_what_their_particles_do() {
    for shape in convex_shapes() {
        let sum = particle_sum(1.0, 100, |p| if contains(&shape, p) { 700.0 } else { 0.0 });
        let properties = shape.mass_properties(700.0);
        assert_close(&properties, &sum, 1.0, 0.01);
        if !matches!(shape, Shape::Hull(_)) {
            assert_eq!(properties.principal_rotation, Quat::IDENTITY);
            assert_eq!(properties.centre, Vec3::ZERO);
        }
    }
}

#[test]
fn compounds_weigh_what_their_particles_do() {
    let mut random = Random(12);
    for _ in 0..4 {
        let parts: Vec<(Pose, Shape)> = convex_shapes().into_iter().map(|s| (random.pose(0.6), s)).collect();
        let weighed = |p: Vec3| {
            let holding = parts.iter().filter(|(pose, s)| contains(s, pose.inverse_transform_point(p)));
            3.0 * holding.count() as f64
        };
        let sum = particle_sum(2.2, 130, weighed);
        let compound = Shape::compound(parts.clone()).unwrap();
        assert_close(&compound.mass_properties(3.0), &sum, 2.2, 0.01);
    }
}

#[test]
fn formulas() {
    let m = Shape::sphere(0.5).unwrap().mass_properties(1000.0);
    assert!((m.mass - 523.599).abs() < 0.01);
    assert!((m.principal_inertia.x - 0.4 * 523.599 * 0.25).abs() < 0.01);
    let m = Shape::cuboid(Vec3::splat(0.5)).unwrap().mass_properties(600.0);
    assert!((m.mass - 600.0).abs() < 1e-3);
    assert!((m.principal_inertia - Vec3::splat(100.0)).length() < 1e-3);
    let m = Shape::cylinder(1.0, 1.0).unwrap().mass_properties(1.0);
    let pi = std::f32::consts::PI;
    assert!((m.mass - 2.0 * pi).abs() < 1e-5);
    assert!((m.principal_inertia - Vec3::new(7.0 / 6.0, 1.0, 7.0 / 6.0) * pi).length() < 1e-5);
    let thin = Shape::capsule(0.5, 1e-4).unwrap().mass_properties(1.0);
    assert!((thin.principal_inertia.x / thin.mass - 1.0 / 12.0).abs() < 1e-3, "a rod: m L² / 12");
    let ground = Shape::half_space().mass_properties(1.0);
    assert_eq!((ground.mass, ground.principal_inertia), (0.0, Vec3::ZERO));
}

#[test]
fn a_moved_and_turned_box_of_triangles_weighs_as_the_box() {
    let mut random = Random(13);
    for _ in 0..100 {
        let h = Vec3::new(random.between(0.1, 0.3), random.between(0.4, 0.6), random.between(0.8, 1.0));
        let pose = random.pose(3.0);
        let expected = Shape::cuboid(h).unwrap().mass_properties(800.0);
        let flat = mesh_make::cuboid(h).unwrap();
        let vertices: Vec<Vec3> = flat.vertices.iter().map(|v| pose.transform_point(*v)).collect();
        let mesh: Shape = Mesh::new(vertices.clone(), flat.triangles).unwrap().into();
        let turned = glam::Mat3::from_quat(pose.rotation).as_dmat3();
        let moments = DMat3::from_diagonal(expected.principal_inertia.as_dvec3());
        let sum = ParticleSum {
            mass: expected.mass.into(),
            centre: pose.position.as_dvec3(),
            inertia: turned * moments * turned.transpose(),
        };
        assert_close(&mesh.mass_properties(800.0), &sum, 1.0, 2e-6);
        assert_close(&Shape::hull(&vertices).unwrap().mass_properties(800.0), &sum, 1.0, 2e-6);
        let mut found = mesh.mass_properties(800.0).principal_inertia.to_array();
        let mut wanted = expected.principal_inertia.to_array();
        found.sort_by(f32::total_cmp);
        wanted.sort_by(f32::total_cmp);
        assert!((Vec3::from(found) - Vec3::from(wanted)).length() < 1e-5 * wanted[2]);
    }
}

#[test]
fn an_upright_mesh_is_not_turned() {
    for mesh in [
        mesh_make::cuboid(Vec3::splat(0.5)).unwrap(),
        mesh_make::cuboid(Vec3::new(0.1, 0.2, 0.3)).unwrap(),
        mesh_make::torus(0.4, 0.2, 48, 16).unwrap(),
        mesh_make::torus(1.0, 0.05, 47, 11).unwrap(),
        mesh_make::frame(Vec3::new(0.5, 0.04, 0.5), 0.08).unwrap(),
        mesh_make::ball(1.0, 12).unwrap(),
    ] {
        let properties = Shape::from(mesh).mass_properties(1000.0);
        assert_eq!(properties.principal_rotation, Quat::IDENTITY);
        assert!(properties.centre.length() < 1e-7, "{}", properties.centre);
    }
    let cube = Hull::new(&mesh_make::cuboid(Vec3::splat(0.5)).unwrap().vertices).unwrap();
    let properties = Shape::Hull(cube.into()).mass_properties(6.0);
    assert_eq!((properties.principal_rotation, properties.mass), (Quat::IDENTITY, 6.0));
    assert!((properties.principal_inertia - Vec3::ONE).length() < 1e-6);
}

#[test]
fn a_torus_of_triangles_nears_the_formula_from_below() {
    let (major, minor) = (1.5_f64, 0.4_f64);
    let mass = 2.0 * std::f64::consts::PI.powi(2) * major * minor * minor;
    let along = mass * (major * major + 0.75 * minor * minor);
    let across = mass * (0.5 * major * major + 0.625 * minor * minor);
    let mut last = (f64::INFINITY, f64::INFINITY);
    for (segments, sides) in [(24, 8), (48, 16), (96, 32), (192, 64)] {
        let torus = mesh_make::torus(major as f32, minor as f32, segments, sides).unwrap();
        let m = Shape::from(torus).mass_properties(1.0);
        let short = (1.0 - f64::from(m.mass) / mass, 1.0 - f64::from(m.principal_inertia.y) / along);
        assert!(short.0 > 0.0 && short.0 < last.0 && short.1 > 0.0 && short.1 < last.1, "{short:?}");
        assert!((f64::from(m.principal_inertia.x) / across - 1.0).abs() < 2.0 * short.0);
        last = short;
    }
    assert!(last.0 < 3e-3 && last.1 < 3e-3, "{last:?}");
}

#[test]
fn an_angle_has_slanted_principal_axes() {
    let angle = mesh_make::angle(1.0, 0.2, 0.1).unwrap();
    let mesh = Shape::from(angle).mass_properties(1.0);
    let inside = |p: Vec3| {
        let p = p + Vec3::new(0.3, 0.3, 0.0);
        let in_arm = |along: f32, across: f32| (0.0..1.0).contains(&along) && (0.0..0.2).contains(&across);
        (in_arm(p.x, p.y) || in_arm(p.y, p.x)) && p.z.abs() < 0.1
    };
    let mut sum = particle_sum(0.8, 160, |p| if inside(p) { 1.0 } else { 0.0 });
    sum.centre += DVec3::new(0.3, 0.3, 0.0);
    assert_close(&mesh, &sum, 1.0, 1e-3);
    // By symmetry two axes lie at 45° in the plane of the arms.
    let x = mesh.principal_rotation * Vec3::X;
    assert!((x.x.abs() - 0.5_f32.sqrt()).abs() < 1e-4 && x.z.abs() < 1e-4, "{x}");
}

#[test]
fn an_open_mesh_weighs_nothing() {
    let closed = mesh_make::cuboid(Vec3::ONE).unwrap();
    let open = Mesh::open(closed.vertices.clone(), closed.triangles[1..].to_vec()).unwrap();
    assert!(!open.has_inside());
    assert!(Shape::from(open).mass_properties(1000.0).mass.abs() <= 0.0);
}
