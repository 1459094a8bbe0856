//! Overlap against the least that a point must be away from both shapes, meshes against the solids that they stand for, and simple truths.

mod shapes_common;

use forerun_geometry::shape::{Mesh, mesh_make};
use forerun_geometry::{Pose, Quat, Shape, Vec3};
use shapes_common::Random;

/// Distance of the simple convex shapes: convex functions, negative inside. Written apart from the library.
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
        Shape::Hull(h) => {
            h.faces.iter().map(|f| f.normal.dot(p) - f.offset).fold(f32::NEG_INFINITY, f32::max)
        }
        Shape::HalfSpace => p.y,
        Shape::Compound(_) | Shape::Mesh(_) => panic!("not convex"),
    }
}

/// The least over all points of the larger of the two distances: above 0 where the shapes are apart, below where they share a volume.
/// By ever smaller steps in random directions, as the function is convex.
fn least_distance(first: (&Shape, &Pose), second: (&Shape, &Pose), random: &mut Random) -> f32 {
    let at = |p: Vec3| {
        let of = |(shape, pose): (&Shape, &Pose)| distance(shape, pose.inverse_transform_point(p));
        of(first).max(of(second))
    };
    let mut point = (first.1.position + second.1.position) * 0.5;
    let (mut least, mut step) = (at(point), 1.0);
    while step > 1e-5 {
        let mut improved = false;
        for _ in 0..60 {
            let candidate = point + random.direction() * step;
            let found = at(candidate);
            if found < least {
                (least, point, improved) = (found, candidate, true);
            }
        }
        if !improved {
            step *= 0.6;
        }
    }
    least
}

fn convex_shapes() -> Vec<Shape> {
    let mut random = Random(5);
    let cloud: Vec<Vec3> = (0..15).map(|_| random.vector(0.8)).collect();
    vec![
        Shape::sphere(0.6).unwrap(),
        Shape::cuboid(Vec3::new(0.9, 0.1, 0.5)).unwrap(),
        Shape::capsule(0.5, 0.3).unwrap(),
        Shape::cylinder(0.2, 0.7).unwrap(),
        Shape::hull(&cloud).unwrap(),
    ]
}

fn both_ways(a: &Shape, pose_a: &Pose, b: &Shape, pose_b: &Pose) -> bool {
    let found = a.overlaps(pose_a, b, pose_b);
    assert_eq!(found, b.overlaps(pose_b, a, pose_a), "{a:?} {pose_a:?} {b:?} {pose_b:?}");
    found
}

#[test]
fn convex_pairs_agree_with_a_search_for_a_common_point() {
    let mut random = Random(6);
    let mut others = convex_shapes();
    others.push(Shape::half_space());
    for a in convex_shapes() {
        for b in &others {
            let (mut apart, mut common) = (0, 0);
            for _ in 0..25 {
                let (pose_a, pose_b) = (random.pose(1.2), random.pose(1.2));
                let least = least_distance((&a, &pose_a), (b, &pose_b), &mut random);
                let found = both_ways(&a, &pose_a, b, &pose_b);
                if least > 2e-3 {
                    apart += 1;
                    assert!(!found, "{least} m: {a:?} {pose_a:?} {b:?} {pose_b:?}");
                } else if least < -1e-4 {
                    common += 1;
                    assert!(found, "{least} m: {a:?} {pose_a:?} {b:?} {pose_b:?}");
                }
            }
            assert!(apart > 1 && common > 1, "{apart} apart, {common} together of {a:?} {b:?}");
        }
    }
}

#[test]
fn meshes_overlap_as_the_solids_that_they_stand_for() {
    let mut random = Random(7);
    let half = Vec3::new(0.9, 0.15, 0.5);
    let (solid, mesh) = (Shape::cuboid(half).unwrap(), Shape::from(mesh_make::cuboid(half).unwrap()));
    let small = Vec3::splat(0.06);
    let (small_solid, small_mesh) =
        (Shape::cuboid(small).unwrap(), Shape::from(mesh_make::cuboid(small).unwrap()));
    let mut others = convex_shapes();
    others.push(Shape::half_space());
    let parts = convex_shapes().into_iter().map(|shape| (random.pose(1.0), shape)).collect();
    others.push(Shape::compound(parts).unwrap());
    let mut together = 0;
    for _ in 0..300 {
        let (pose_a, pose_b) = (random.pose(1.0), random.pose(1.0));
        for other in &others {
            let found = both_ways(&mesh, &pose_a, other, &pose_b);
            assert_eq!(found, both_ways(&solid, &pose_a, other, &pose_b), "{other:?} {pose_a:?} {pose_b:?}");
        }
        // Two meshes; the small one is at times all inside the other.
        let found = both_ways(&mesh, &pose_a, &small_mesh, &pose_b);
        assert_eq!(found, both_ways(&solid, &pose_a, &small_solid, &pose_b), "{pose_a:?} {pose_b:?}");
        together += u32::from(found);
    }
    assert!((10..280).contains(&together), "{together}");
}

#[test]
fn holes_are_empty_and_insides_are_full() {
    let at = |x: f32, y: f32, z: f32| Pose::from_position(Vec3::new(x, y, z));
    let torus = Shape::from(mesh_make::torus(1.0, 0.3, 32, 16).unwrap());
    let ball = Shape::sphere(0.2).unwrap();
    let tiny = Shape::from(mesh_make::ball(0.05, 4).unwrap());
    for small in [&ball, &tiny] {
        assert!(!both_ways(&torus, &Pose::IDENTITY, small, &Pose::IDENTITY), "in the hole");
        let ring = (0..8).map(|i| f32::from(i as u8) * 0.7).map(libm::sincosf);
        let inside = ring.filter(|(s, c)| {
            // The tube lies in one of the planes of the axes: in which, the mesh says itself.
            let flat = torus.aabb(&Pose::IDENTITY).half_extents();
            let pose = if flat.y < flat.z { at(*c, 0.0, *s) } else { at(*c, *s, 0.0) };
            both_ways(&torus, &Pose::IDENTITY, small, &pose)
        });
        assert_eq!(inside.count(), 8, "in the tube");
    }
    // All of the torus in a box, of either kind.
    let half = Vec3::splat(3.0);
    for large in [Shape::cuboid(half).unwrap(), Shape::from(mesh_make::cuboid(half).unwrap())] {
        assert!(both_ways(&torus, &at(0.3, 0.2, 0.1), &large, &Pose::IDENTITY));
        assert!(!both_ways(&torus, &at(9.3, 0.2, 0.1), &large, &Pose::IDENTITY));
    }
    // A sheet is nothing but its surface.
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Z];
    let sheet = Shape::from(Mesh::open(corners, vec![[0, 2, 1]]).unwrap());
    assert!(both_ways(&sheet, &Pose::IDENTITY, &ball, &at(0.2, 0.1, 0.2)));
    assert!(!both_ways(&sheet, &Pose::IDENTITY, &ball, &at(0.2, 0.21, 0.2)));
    assert!(!both_ways(&sheet, &Pose::IDENTITY, &ball, &at(0.2, -0.21, 0.2)));
}

#[test]
fn half_spaces_and_poses_that_are_no_numbers() {
    let ground = Shape::half_space();
    let upside_down = Quat::from_xyzw(1.0, 0.0, 0.0, 0.0);
    assert!(both_ways(&ground, &Pose::IDENTITY, &ground, &Pose::from_position(Vec3::Y * -9.0)));
    assert!(both_ways(&ground, &Pose::IDENTITY, &ground, &Pose::new(Vec3::Y * -0.1, upside_down)));
    assert!(!both_ways(&ground, &Pose::IDENTITY, &ground, &Pose::new(Vec3::Y * 0.1, upside_down)));
    let nowhere = Pose::from_position(Vec3::new(f32::NAN, 0.0, 0.0));
    for shape in convex_shapes() {
        assert!(both_ways(&shape, &Pose::IDENTITY, &shape, &Pose::IDENTITY));
        assert!(!both_ways(&shape, &nowhere, &shape, &Pose::IDENTITY));
        assert!(!both_ways(&shape, &nowhere, &ground, &Pose::IDENTITY));
    }
}

#[test]
fn shapes_that_touch_overlap() {
    let cube = Shape::cuboid(Vec3::splat(0.5)).unwrap();
    let at = |x: f32| Pose::from_position(Vec3::new(x, 0.0, 0.0));
    assert!(both_ways(&cube, &at(0.0), &cube, &at(1.0)));
    assert!(!both_ways(&cube, &at(0.0), &cube, &at(1.0001)));
    let ball = Shape::sphere(0.5).unwrap();
    assert!(both_ways(&ball, &at(0.0), &ball, &at(1.0)));
    assert!(!both_ways(&ball, &at(0.0), &ball, &at(1.0001)));
}
