//! Degenerate input: whatever is finite gives finite points and unit normals.

use std::sync::Arc;

use forerun_geometry::contact::contact_manifolds;
use forerun_geometry::shape::Compound;
use forerun_geometry::{Manifold, Motion, Placed, Pose, Quat, Shape, Vec3};

use crate::common::{
    Random, at, capsule, cube_hull, cuboid, cylinder, hull, manifolds, octahedron, sphere, tetrahedron,
    turned,
};

fn all_shapes() -> Vec<Shape> {
    let mut shapes = vec![
        sphere(0.5),
        sphere(1.0e-4),
        capsule(0.0, 0.3),
        capsule(0.5, 0.2),
        capsule(5.0, 1.0e-3),
        cuboid(0.5, 0.5, 0.5),
        cuboid(5.0, 1.0e-3, 1.0e-3),
        cuboid(5.0, 1.0e-4, 5.0),
        cylinder(0.5, 0.5),
        cylinder(1.0e-4, 1.0),
        cylinder(5.0, 1.0e-3),
        cube_hull(0.5),
        cube_hull(50.0),
        octahedron(0.5),
        tetrahedron(0.5),
        Shape::HalfSpace,
    ];
    shapes.push(hull(&[Vec3::ZERO, Vec3::X, Vec3::Y * 0.01, Vec3::new(0.3, 0.002, 0.01)]));
    let parts = vec![(at(0.0, 0.0, 0.0), sphere(0.5)), (at(0.0, 0.0, 0.0), cuboid(0.5, 0.5, 0.5))];
    shapes.push(Shape::Compound(Arc::new(Compound { parts })));
    shapes
}

fn check(manifold: &Manifold, margin: f32) {
    assert!((1..=4).contains(&manifold.count), "{manifold:?}");
    assert!((manifold.normal.length() - 1.0).abs() < 1.0e-4, "{manifold:?}");
    for point in manifold.points() {
        assert!((point.normal.length() - 1.0).abs() < 1.0e-4, "{manifold:?}");
        assert!(point.position.is_finite() && point.separation.is_finite(), "{manifold:?}");
        assert!(point.separation < margin, "{manifold:?}");
    }
}

#[test]
fn no_placing_breaks_any_pair() {
    let shapes = all_shapes();
    let eighth = std::f32::consts::FRAC_PI_4;
    let mut placings = vec![Pose::IDENTITY];
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for k in 1..8 {
            placings.push(turned(Vec3::ZERO, axis, eighth * k as f32));
        }
        for reach in [1.0e-7, 1.0e-4, 0.5, 1.0, 1.000_000_1] {
            placings.push(Pose::from_position(axis * reach));
            placings.push(Pose::from_position(-axis * reach));
        }
        placings.push(turned(Vec3::ONE * 0.3, axis, 1.0e-4));
        placings.push(turned(axis * 0.5, axis, 1.0e-3));
    }
    for a in &shapes {
        for b in &shapes {
            for pose in &placings {
                for margin in [0.0, 0.02, 0.3] {
                    for manifold in manifolds((a, Pose::IDENTITY), (b, *pose), margin) {
                        check(&manifold, margin);
                    }
                }
            }
        }
    }
}

#[test]
fn no_random_pair_breaks() {
    let shapes = all_shapes();
    let mut random = Random(5);
    for a in &shapes {
        for b in &shapes {
            for _ in 0..60 {
                let far = random.vector(1000.0);
                let reach = random.between(0.0, 1.5);
                let pose_a = Pose::new(far, random.rotation());
                let pose_b = Pose::new(far + random.vector(reach), random.rotation());
                for manifold in manifolds((a, pose_a), (b, pose_b), 0.1) {
                    check(&manifold, 0.1);
                }
            }
        }
    }
}

#[test]
fn the_same_arguments_give_the_same_bits() {
    let mut random = Random(11);
    let shapes = all_shapes();
    for a in &shapes {
        for b in &shapes {
            let pose = Pose::new(random.vector(0.6), random.rotation());
            let first = manifolds((a, Pose::IDENTITY), (b, pose), 0.1);
            assert_eq!(first, manifolds((a, Pose::IDENTITY), (b, pose), 0.1));
        }
    }
}

#[test]
fn a_trembling_stack_keeps_its_points() {
    // What rests trembles by micrometres; the manifold must not jump.
    let mut random = Random(3);
    let ground = cuboid(2.0, 0.5, 2.0);
    let below = at(0.0, -0.5, 0.0);
    for shape in [cuboid(0.3, 0.3, 0.3), cube_hull(0.3), cylinder(0.3, 0.4)] {
        for heading in [0.0, 0.3, std::f32::consts::FRAC_PI_4] {
            for other in [(&ground, below), (&Shape::HalfSpace, Pose::IDENTITY)] {
                let rest = turned(Vec3::new(0.1, 0.299, -0.2), Vec3::Y, heading);
                let still = manifolds(other, (&shape, rest), 0.02)[0];
                assert_eq!(still.count, 4, "{shape:?}");
                for _ in 0..100 {
                    let tremble = turned(Vec3::ZERO, random.direction(), 1.0e-4).rotation;
                    let position = rest.position + random.vector(1.0e-5);
                    let rotation: Quat = (tremble * rest.rotation).normalize();
                    let now = manifolds(other, (&shape, Pose::new(position, rotation)), 0.02)[0];
                    assert_eq!(now.count, 4);
                    for (point, was) in now.points().iter().zip(still.points()) {
                        let jump = (point.position - was.position).length();
                        assert!(jump < 2.0e-3, "{shape:?} at {heading}: jumps by {jump}");
                    }
                }
            }
        }
    }
}

fn compound(parts: &[(Pose, Shape)]) -> Shape {
    Shape::Compound(Arc::new(Compound { parts: parts.to_vec() }))
}

#[test]
fn each_part_of_a_compound_touches_for_itself() {
    let dumbbell = compound(&[(at(-1.0, 0.0, 0.0), sphere(0.2)), (at(1.0, 0.0, 0.0), sphere(0.2))]);
    let found = manifolds((&Shape::HalfSpace, Pose::IDENTITY), (&dumbbell, at(0.0, 0.2, 0.0)), 0.01);
    assert_eq!(found.len(), 2);
    for (manifold, x) in found.iter().zip([-1.0, 1.0]) {
        assert!((manifold.points[0].position - Vec3::X * x).length() < 1.0e-6);
        assert!((manifold.normal - Vec3::Y).length() < 1.0e-6);
    }
    let found = manifolds((&dumbbell, at(0.0, 0.2, 0.0)), (&Shape::HalfSpace, Pose::IDENTITY), 0.01);
    assert!(found.iter().all(|manifold| (manifold.normal + Vec3::Y).length() < 1.0e-6));
}

#[test]
fn many_parts_on_one_plane_become_one_manifold() {
    let mut parts = Vec::new();
    for x in -2..=2 {
        for z in -2..=2 {
            parts.push((at(x as f32, 0.0, z as f32), sphere(0.2)));
        }
    }
    let bed = compound(&parts);
    for ground in [Shape::HalfSpace, compound(&[(at(0.0, -1.0, 0.0), cuboid(5.0, 1.0, 5.0))])] {
        let found = manifolds((&ground, Pose::IDENTITY), (&bed, at(0.0, 0.195, 0.0)), 0.01);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].count, 4);
        for point in found[0].points() {
            assert!((point.separation + 0.005).abs() < 1.0e-6);
            // The corners of the bed.
            assert!((point.position.x.abs() - 2.0).abs() < 1.0e-5, "{point:?}");
            assert!((point.position.z.abs() - 2.0).abs() < 1.0e-5, "{point:?}");
        }
    }
}

#[test]
fn a_compound_of_one_is_that_one() {
    let mut random = Random(23);
    for shape in [sphere(0.4), capsule(0.3, 0.2), cuboid(0.3, 0.4, 0.5), cylinder(0.3, 0.4), octahedron(0.5)]
    {
        let local = Pose::new(random.vector(0.3), random.rotation());
        let wrapped = compound(&[(local, shape.clone())]);
        for _ in 0..50 {
            let (pose, other) = (Pose::new(random.vector(0.5), random.rotation()), cuboid(0.5, 0.3, 0.4));
            let mut found = Vec::new();
            let place = |shape, pose| Placed { shape, pose, motion: Motion::default() };
            contact_manifolds(&place(&wrapped, pose), &place(&other, at(0.0, -0.5, 0.0)), 0.05, &mut found);
            assert_eq!(found, manifolds((&shape, pose * local), (&other, at(0.0, -0.5, 0.0)), 0.05));
        }
    }
}
