//! Bounds against points sampled from the shapes, and overlap tests against independent ones.

mod shapes_common;

use forerun_geometry::shape::mesh_make;
use forerun_geometry::{Aabb, BoundingSphere, Obb, Pose, Ray, Shape, Vec3};
use shapes_common::Random;

fn shapes() -> Vec<Shape> {
    let mut random = Random(31);
    let cloud: Vec<Vec3> = (0..15).map(|_| random.vector(1.0) * Vec3::new(1.0, 0.3, 0.6)).collect();
    let convex = [
        Shape::sphere(0.8).unwrap(),
        Shape::cuboid(Vec3::new(0.9, 0.3, 0.5)).unwrap(),
        Shape::capsule(0.5, 0.4).unwrap(),
        Shape::cylinder(0.2, 0.9).unwrap(),
        Shape::hull(&cloud).unwrap(),
    ];
    let parts = convex.iter().map(|s| (random.pose(1.0), s.clone())).collect();
    let mut all = convex.to_vec();
    all.push(Shape::compound(parts).unwrap());
    all.push(mesh_make::torus(0.6, 0.2, 24, 12).unwrap().into());
    all.push(mesh_make::angle(1.0, 0.2, 0.1).unwrap().into());
    all
}

/// Points of the surface, in the shape's frame: where rays from all around arrive.
fn surface(shape: &Shape, random: &mut Random) -> Vec<Vec3> {
    let mut points = Vec::new();
    while points.len() < 4000 {
        let direction = random.direction();
        let ray = Ray { origin: random.vector(2.2) - direction * 6.0, direction };
        points.extend(shape.cast_ray(&Pose::IDENTITY, &ray, 20.0).map(|hit| hit.point));
    }
    points
}

#[test]
fn every_bound_holds_every_point() {
    let mut random = Random(32);
    for shape in shapes() {
        let points = surface(&shape, &mut random);
        let sphere = shape.bounding_sphere();
        for _ in 0..20 {
            let pose = random.pose(2.0);
            let (aabb, obb, placed) = (shape.aabb(&pose), shape.obb(&pose), sphere.at(&pose));
            let about = random.vector(1.0);
            let radius = shape.radius_about(about);
            for local in &points {
                let p = pose.transform_point(*local);
                assert!(aabb.grown(1e-5).contains(p));
                assert!(obb.closest_point(p).distance(p) < 1e-5, "{shape:?}");
                assert!(p.distance(placed.centre) < placed.radius + 1e-5);
                assert!(local.distance(about) < radius + 1e-5);
            }
        }
    }
}

#[test]
fn bounds_are_tight() {
    let mut random = Random(33);
    for shape in shapes() {
        let points = surface(&shape, &mut random);
        let is_mesh = matches!(shape, Shape::Mesh(_));
        for _ in 0..20 {
            let pose = random.pose(2.0);
            let around = Aabb::around(points.iter().map(|p| pose.transform_point(*p)));
            let aabb = shape.aabb(&pose);
            let slack = (around.min - aabb.min).max(aabb.max - around.max).max_element();
            // Samples seldom reach the tip of a corner; the box around a turned mesh is not the smallest.
            assert!(slack < if is_mesh { 0.25 } else { 0.12 }, "{slack} m too large for {shape:?}");
            let about = random.vector(1.0);
            let reach = points.iter().map(|p| p.distance(about)).fold(0.0, f32::max);
            assert!(shape.radius_about(about) < reach + 0.1);
        }
        let sphere = shape.bounding_sphere();
        let reach = points.iter().map(|p| p.distance(sphere.centre)).fold(0.0, f32::max);
        assert!(sphere.radius < 1.02 * reach + 0.05, "{sphere:?} of {shape:?}");
        assert!(sphere.radius <= shape.radius_about(Vec3::ZERO) * 1.001);
        assert!(shape.own_obb().volume() <= 1.001 * Obb::from(shape.aabb(&Pose::IDENTITY)).volume());
    }
}

#[test]
fn spheres_around_points_are_nearly_smallest() {
    let mut random = Random(34);
    let points: Vec<Vec3> = (0..300).map(|_| random.direction() * 2.0 + Vec3::X).collect();
    let sphere = BoundingSphere::around(&points);
    assert!(sphere.radius < 2.0 * 1.02, "{sphere:?}");
    let pair = [Vec3::X * -3.0, Vec3::X * 5.0, Vec3::Y * 0.5];
    let sphere = BoundingSphere::around(&pair);
    assert!(sphere.radius < 4.05 && pair.iter().all(|p| p.distance(sphere.centre) <= sphere.radius));
    assert!(BoundingSphere::around(&[]).radius <= 0.0);
}

#[test]
fn a_turned_mesh_gets_the_box_of_its_mass() {
    let mut random = Random(35);
    for _ in 0..20 {
        let h = Vec3::new(0.2, 0.5, 1.0);
        let pose = random.pose(1.0);
        let corners: Vec<Vec3> =
            mesh_make::cuboid(h).unwrap().vertices.iter().map(|v| pose.transform_point(*v)).collect();
        let obb = Shape::hull(&corners).unwrap().own_obb();
        assert!((obb.volume() / (8.0 * 0.1) - 1.0).abs() < 1e-4, "{obb:?}");
    }
}

/// Distance between two boxes by projecting from one to the other until nothing moves.
fn distance(a: &Obb, b: &Obb) -> f32 {
    let mut p = a.centre;
    for _ in 0..3000 {
        p = a.closest_point(b.closest_point(p));
    }
    p.distance(b.closest_point(p))
}

fn random_obb(random: &mut Random) -> Obb {
    let half_extents =
        Vec3::new(random.between(0.05, 1.0), random.between(0.05, 1.0), random.between(0.05, 1.0));
    Obb { centre: Vec3::ZERO, axes: glam::Mat3::IDENTITY, half_extents }.at(&random.pose(1.2))
}

#[test]
fn boxes_overlap_when_they_have_a_common_point() {
    let mut random = Random(36);
    let (mut overlapping, mut apart) = (0, 0);
    for round in 0..3000 {
        let a = random_obb(&mut random);
        let mut b = random_obb(&mut random);
        if round % 3 == 0 {
            b.axes = a.axes;
        }
        let d = distance(&a, &b);
        assert_eq!(a.overlaps(&b), b.overlaps(&a));
        if a.overlaps(&b) {
            overlapping += 1;
            assert!(d < 2e-3, "{d} m apart: {a:?} {b:?}");
        } else {
            apart += 1;
            assert!(d > 1e-6, "{a:?} {b:?}");
        }
        let aabb = b.aabb();
        let d = distance(&a, &aabb.into());
        assert!(if a.overlaps_aabb(&aabb) { d < 2e-3 } else { d > 1e-6 });
        let sphere = BoundingSphere { centre: b.centre, radius: b.half_extents.x };
        let d = a.closest_point(sphere.centre).distance(sphere.centre) - sphere.radius;
        assert_eq!(sphere.overlaps_obb(&a), d <= 0.0);
        let upright = Obb { axes: glam::Mat3::IDENTITY, ..a };
        assert_eq!(sphere.overlaps_aabb(&upright.aabb()), sphere.overlaps_obb(&upright));
    }
    assert!(overlapping > 300 && apart > 300, "{overlapping} {apart}");
}

#[test]
fn spheres_overlap_as_in_the_formula() {
    let a = BoundingSphere { centre: Vec3::ZERO, radius: 1.0 };
    let b = |x: f32| BoundingSphere { centre: Vec3::X * x, radius: 0.5 };
    assert!(a.overlaps(&b(1.5)) && !a.overlaps(&b(1.51)));
    assert!((a.penetration(&b(1.2)) - 0.3).abs() < 1e-6 && a.penetration(&b(2.0)) <= 0.0);
}

#[test]
fn a_half_space_overlaps_all_that_is_not_surely_above() {
    let ground = Shape::half_space();
    let up = ground.aabb(&Pose::from_position(Vec3::new(1.0, 2.0, 3.0)));
    assert!(up.max == Vec3::new(f32::INFINITY, 2.0, f32::INFINITY) && up.min == Vec3::NEG_INFINITY);
    let wall = glam::Quat::from_xyzw(0.0, 0.0, -(0.5_f32.sqrt()), 0.5_f32.sqrt());
    let sideways = ground.aabb(&Pose::new(Vec3::X, wall));
    assert!(sideways.max.y == f32::INFINITY, "{sideways:?}");
    assert!(ground.half_thickness().is_infinite() && ground.bounding_sphere().radius.is_infinite());
    let ball = BoundingSphere { centre: Vec3::Y * 1e6, radius: 1.0 };
    assert!(ball.overlaps(&ground.bounding_sphere()));
    let obb = random_obb(&mut Random(37));
    assert!(obb.overlaps(&ground.obb(&Pose::IDENTITY)) && ground.obb(&Pose::IDENTITY).overlaps(&obb));
}
