//! Ray casts against sphere tracing of distance functions, brute force over triangles, and simple truths.

mod shapes_common;

use forerun_geometry::shape::{Mesh, mesh_make};
use forerun_geometry::{Pose, Ray, RayHit, Shape, Vec3};
use shapes_common::Random;

/// Signed distance (exact outside) of the simple shapes, written apart from the library.
fn distance(shape: &Shape, p: Vec3) -> f32 {
    match shape {
        Shape::Sphere(s) => p.length() - s.radius,
        Shape::Cuboid(c) => {
            let q = p.abs() - c.half_extents;
            q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
        }
        Shape::Capsule(c) => p.distance(Vec3::Y * p.y.clamp(-c.half_height, c.half_height)) - c.radius,
        Shape::Cylinder(c) => {
            let (x, y) = (p.x.hypot(p.z) - c.radius, p.y.abs() - c.half_height);
            x.max(0.0).hypot(y.max(0.0)) + x.max(y).min(0.0)
        }
        // A bound from below, which is all that tracing needs.
        Shape::Hull(h) => {
            h.faces.iter().map(|f| f.normal.dot(p) - f.offset).fold(f32::NEG_INFINITY, f32::max)
        }
        Shape::HalfSpace => p.y,
        Shape::Compound(c) => {
            let parts = c.parts.iter().map(|(pose, s)| distance(s, pose.inverse_transform_point(p)));
            parts.fold(f32::INFINITY, f32::min)
        }
        Shape::Mesh(_) => panic!("no distance function"),
    }
}

/// Goes on by the distance until it is nothing (a hit) or too far (a miss). `None`: too close to tell.
fn trace(shape: &Shape, pose: &Pose, ray: &Ray, max: f32) -> Option<Option<f32>> {
    let mut t = 0.0;
    let mut closest = f32::INFINITY;
    for _ in 0..20_000 {
        let d = distance(shape, pose.inverse_transform_point(ray.at(t)));
        if d < 2e-5 {
            return Some(Some(t));
        }
        closest = closest.min(d);
        t += d;
        if t > max {
            return if closest > 1e-3 { Some(None) } else { None };
        }
    }
    None
}

fn shapes() -> Vec<Shape> {
    let mut random = Random(21);
    let cloud: Vec<Vec3> = (0..15).map(|_| random.vector(1.0)).collect();
    let simple = vec![
        Shape::sphere(0.8).unwrap(),
        Shape::cuboid(Vec3::new(0.9, 0.3, 0.5)).unwrap(),
        Shape::capsule(0.5, 0.4).unwrap(),
        Shape::capsule(0.0, 0.4).unwrap(),
        Shape::cylinder(0.2, 0.9).unwrap(),
        Shape::hull(&cloud).unwrap(),
    ];
    let parts = simple.iter().map(|s| (random.pose(0.8), s.clone())).collect();
    let mut all = simple;
    all.push(Shape::half_space());
    all.push(Shape::compound(parts).unwrap());
    all
}

fn random_ray(random: &mut Random, about: Vec3) -> Ray {
    let origin = about + random.direction() * random.between(0.0, 6.0);
    let aim = about + random.vector(1.0);
    Ray::towards(origin, aim).unwrap()
}

#[test]
fn agree_with_sphere_tracing() {
    let mut random = Random(22);
    for shape in shapes() {
        let (mut hits, mut misses) = (0, 0);
        for _ in 0..2000 {
            let pose = random.pose(3.0);
            let ray = random_ray(&mut random, pose.position);
            let max = 12.0;
            let Some(expected) = trace(&shape, &pose, &ray, max) else {
                continue;
            };
            let found = shape.cast_ray(&pose, &ray, max);
            match (expected, found) {
                (None, None) => misses += 1,
                (Some(t), Some(hit)) => {
                    hits += 1;
                    check_hit(&shape, &pose, &ray, hit);
                    // Tracing stops short by 2e-5 over the sine of the angle of incidence.
                    let steep = -hit.normal.dot(ray.direction);
                    assert!((hit.distance - t).abs() < 1e-4 + 1e-4 / steep.max(1e-3), "{t}: {hit:?}");
                }
                // A glancing hit, or one near the limit.
                (None, Some(hit)) => assert!(hit.distance > max - 1e-3, "{shape:?} {ray:?} {hit:?}"),
                (Some(t), None) => {
                    let there = pose.inverse_transform_point(ray.at(t));
                    let (before, after) = (there - ray.direction * 1e-2, there + ray.direction * 1e-2);
                    assert!(
                        distance(&shape, before) > -1e-3 && distance(&shape, after) > -1e-3,
                        "{shape:?} {ray:?} at {t}"
                    );
                }
            }
        }
        assert!(
            hits > 400 && (misses > 20 || shape == Shape::HalfSpace),
            "{hits} hits, {misses} misses of {shape:?}"
        );
    }
}

fn check_hit(shape: &Shape, pose: &Pose, ray: &Ray, hit: RayHit) {
    assert!((hit.normal.length() - 1.0).abs() < 1e-5);
    assert!(hit.normal.dot(ray.direction) <= 1e-5, "{hit:?}");
    assert!(hit.point.distance(ray.at(hit.distance)) < 1e-5);
    let local = |p: Vec3| distance(shape, pose.inverse_transform_point(p));
    if hit.distance > 0.0 {
        assert!(local(hit.point).abs() < 1e-4, "{hit:?} is {} from {shape:?}", local(hit.point));
        assert!(leads_out(shape, pose, &hit), "{hit:?}: the normal does not lead out of {shape:?}");
    } else {
        assert!(local(hit.point) <= 2e-5);
        assert_eq!(hit.normal, -ray.direction);
    }
}

fn leads_out(shape: &Shape, pose: &Pose, hit: &RayHit) -> bool {
    if let Shape::Compound(compound) = shape {
        // In a crease between two parts the way out of one leads into the other.
        return compound.parts.iter().any(|(part, shape)| leads_out(shape, &(*pose * *part), hit));
    }
    let local = |p: Vec3| distance(shape, pose.inverse_transform_point(p));
    local(hit.point).abs() < 1e-4 && local(hit.point + hit.normal * 1e-2) > 5e-3
}

/// Möller and Trumbore (1997), over all triangles, in f64.
fn brute_force(mesh: &Mesh, ray: &Ray) -> Option<(f64, bool)> {
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let mut best: Option<(f64, bool)> = None;
    for i in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(i).map(|v| v.as_dvec3());
        let (e1, e2) = (b - a, c - a);
        let p = d.cross(e2);
        let det = e1.dot(p);
        let u = (o - a).dot(p) / det;
        let q = (o - a).cross(e1);
        let v = d.dot(q) / det;
        let t = e2.dot(q) / det;
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 && best.is_none_or(|b| t < b.0) {
            best = Some((t, det > 0.0));
        }
    }
    best
}

#[test]
fn meshes_agree_with_brute_force() {
    let mut random = Random(23);
    let mut holed = mesh_make::ball(0.7, 6).unwrap().triangles;
    let vertices = mesh_make::ball(0.7, 6).unwrap().vertices;
    holed.truncate(500);
    let meshes = [
        mesh_make::torus(0.6, 0.25, 36, 18).unwrap(),
        mesh_make::frame(Vec3::new(0.9, 0.1, 0.9), 0.2).unwrap(),
        mesh_make::angle(1.0, 0.3, 0.2).unwrap(),
        Mesh::open(vertices, holed).unwrap(),
    ];
    for mesh in meshes {
        let shape = Shape::from(mesh.clone());
        let (mut outside, mut inside, mut missed) = (0, 0, 0);
        for _ in 0..3000 {
            let ray = random_ray(&mut random, Vec3::ZERO);
            let found = shape.cast_ray(&Pose::IDENTITY, &ray, f32::INFINITY);
            match (brute_force(&mesh, &ray), found) {
                (None, None) => missed += 1,
                (Some((t, front)), Some(hit)) if front || !mesh.has_inside() => {
                    outside += 1;
                    assert!((f64::from(hit.distance) - t).abs() < 1e-6 * (1.0 + t));
                    assert!(hit.normal.dot(ray.direction) < 0.0);
                }
                (Some(_), Some(hit)) => {
                    inside += 1;
                    assert!(hit.distance <= 0.0 && hit.normal == -ray.direction);
                }
                (expected, found) => panic!("{ray:?}: {expected:?} but {found:?}"),
            }
        }
        assert!(
            outside > 500 && missed > 100 && (inside > 10 || !mesh.has_inside()),
            "{outside} {missed} {inside}"
        );
    }
}

#[test]
fn a_mesh_of_a_box_answers_as_the_box() {
    let h = Vec3::new(0.4, 0.7, 0.2);
    let (cuboid, mesh) = (Shape::cuboid(h).unwrap(), Shape::from(mesh_make::cuboid(h).unwrap()));
    let mut random = Random(24);
    for _ in 0..3000 {
        let pose = random.pose(5.0);
        let ray = random_ray(&mut random, pose.position);
        let (a, b) = (cuboid.cast_ray(&pose, &ray, 20.0), mesh.cast_ray(&pose, &ray, 20.0));
        assert_eq!(a.is_some(), b.is_some());
        if let (Some(a), Some(b)) = (a, b) {
            assert!(
                (a.distance - b.distance).abs() < 1e-5 && a.normal.distance(b.normal) < 1e-5,
                "{a:?} {b:?}"
            );
        }
    }
}

#[test]
fn no_ray_slips_through_edges_or_corners() {
    for mesh in [mesh_make::ball(1.0, 8).unwrap(), mesh_make::cuboid(Vec3::new(1.0, 0.5, 0.25)).unwrap()] {
        let shape = Shape::from(mesh.clone());
        for t in 0..mesh.triangles.len() {
            let [a, b, c] = mesh.corners(t);
            for target in [a, a.lerp(b, 0.5), b.lerp(c, 0.25), (a + b + c) / 3.0] {
                let ray = Ray::towards(target * 3.0, Vec3::ZERO).unwrap();
                let hit = shape.cast_ray(&Pose::IDENTITY, &ray, 10.0).expect("a ray to the centre hits");
                assert!(hit.point.distance(target) < 1e-5, "{hit:?} aimed at {target}");
            }
        }
    }
}

#[test]
fn a_ray_that_grazes_a_mesh_does_not_start_in_it() {
    let mut random = Random(25);
    for mesh in [mesh_make::ball(1.0, 8).unwrap(), mesh_make::cuboid(Vec3::new(1.0, 0.5, 0.25)).unwrap()] {
        let shape = Shape::from(mesh.clone());
        for v in &mesh.vertices {
            for _ in 0..50 {
                let along = v.cross(random.direction()).normalize();
                let ray = Ray { origin: *v - along * 3.0, direction: along };
                let hit = shape.cast_ray(&Pose::IDENTITY, &ray, 10.0);
                assert!(hit.is_none_or(|hit| hit.distance > 1.0), "{ray:?}: {hit:?}");
            }
        }
    }
}

#[test]
fn far_away_and_small() {
    let ball = Shape::sphere(0.01).unwrap();
    let pose = Pose::from_position(Vec3::new(0.0, 5000.0, 0.0));
    let ray = Ray { origin: Vec3::new(0.009, 0.0, 0.0), direction: Vec3::Y };
    assert!(ball.cast_ray(&pose, &ray, 1e4).is_some());
    let ray = Ray { origin: Vec3::new(0.011, 0.0, 0.0), direction: Vec3::Y };
    assert!(ball.cast_ray(&pose, &ray, 1e4).is_none());
}

#[test]
fn respect_the_limit_and_refuse_nonsense() {
    let ball = Shape::sphere(1.0).unwrap();
    let ray = Ray { origin: Vec3::X * 3.0, direction: -Vec3::X };
    assert!(ball.cast_ray(&Pose::IDENTITY, &ray, 1.99).is_none());
    let hit = ball.cast_ray(&Pose::IDENTITY, &ray, 2.01).unwrap();
    assert_eq!((hit.distance, hit.normal, hit.point), (2.0, Vec3::X, Vec3::X));
    let away = Ray { direction: Vec3::X, ..ray };
    assert!(ball.cast_ray(&Pose::IDENTITY, &away, f32::INFINITY).is_none());
    for shape in shapes() {
        for bad in [Vec3::NAN, Vec3::ZERO, Vec3::INFINITY] {
            assert!(shape.cast_ray(&Pose::IDENTITY, &Ray { direction: bad, ..ray }, 10.0).is_none());
        }
        assert!(shape.cast_ray(&Pose::IDENTITY, &Ray { origin: Vec3::NAN, ..ray }, 10.0).is_none());
    }
    assert!(Ray::towards(Vec3::X, Vec3::X).is_none());
}
