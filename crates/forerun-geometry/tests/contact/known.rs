//! Known answers: separation, normal and points worked out by hand.

use forerun_geometry::{Pose, Shape, Vec3};

use crate::common::{
    at, capsule, cube_hull, cuboid, cylinder, manifolds, octahedron, outermost, sphere, tetrahedron, turned,
};

const QUARTER: f32 = std::f32::consts::FRAC_PI_2;

/// One manifold is expected: its normal, its deepest separation, and all its points in any order.
fn expect(name: &str, a: (&Shape, Pose), b: (&Shape, Pose), normal: Vec3, points: &[(Vec3, f32)]) {
    let found = manifolds(a, b, 0.1);
    assert_eq!(found.len(), 1, "{name}: {found:?}");
    let manifold = found[0];
    assert!((manifold.normal - normal).length() < 1.0e-4, "{name}: normal {:?}", manifold.normal);
    assert_eq!(manifold.count as usize, points.len(), "{name}: {manifold:#?}");
    for (position, separation) in points {
        let hit = manifold.points().iter().any(|point| {
            (point.position - *position).length() < 2.0e-4 && (point.separation - separation).abs() < 1.0e-4
        });
        assert!(hit, "{name}: no point at {position:?} with {separation}: {manifold:#?}");
    }
}

fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

#[test]
fn spheres_touch_in_one_point() {
    let ball = sphere(0.5);
    let o = Pose::IDENTITY;
    let y = Vec3::Y;
    let one = |height: f32, separation: f32| [(v(0.0, height, 0.0), separation)];
    expect("sphere", (&ball, o), (&sphere(0.25), at(0.0, 0.7, 0.0)), y, &one(0.475, -0.05));
    expect("capsule", (&ball, o), (&capsule(1.0, 0.2), at(0.0, 1.72, 0.0)), y, &one(0.51, 0.02));
    expect("cuboid", (&ball, o), (&cuboid(1.0, 0.5, 1.0), at(0.3, 0.98, 0.1)), y, &one(0.49, -0.02));
    expect("cylinder", (&ball, o), (&cylinder(0.3, 1.0), at(0.3, 0.8, 0.0)), y, &one(0.5, 0.0));
    expect("hull", (&ball, o), (&cube_hull(0.5), at(0.1, 1.05, -0.2)), y, &one(0.525, 0.05));
    expect("ground", (&Shape::HalfSpace, o), (&ball, at(0.0, 0.52, 0.0)), y, &one(0.01, 0.02));
    expect("from below", (&ball, at(0.0, 0.52, 0.0)), (&Shape::HalfSpace, o), -y, &one(0.01, 0.02));
}

#[test]
fn sphere_meets_edges_rims_and_corners_on_the_diagonal() {
    let ball = sphere(0.1);
    let diagonal = v(1.0, 1.0, 0.0).normalize();
    let expect_at = |name: &str, shape: &Shape, edge: Vec3, normal: Vec3| {
        let centre = edge + normal * 0.13;
        expect(
            name,
            (shape, Pose::IDENTITY),
            (&ball, Pose::from_position(centre)),
            normal,
            &[(edge + normal * 0.015, 0.03)],
        );
    };
    expect_at("cuboid edge", &cuboid(0.5, 0.5, 0.5), v(0.5, 0.5, 0.2), diagonal);
    expect_at("cylinder rim", &cylinder(0.5, 0.4), v(0.4, 0.5, 0.0), diagonal);
    expect_at("hull edge", &cube_hull(0.5), v(0.5, 0.5, -0.1), diagonal);
    expect_at("hull corner", &cube_hull(0.5), v(0.5, 0.5, 0.5), Vec3::ONE.normalize());
    expect_at("cylinder side", &cylinder(0.5, 0.4), v(0.0, 0.1, 0.4), Vec3::Z);
}

#[test]
fn sphere_inside_leaves_by_the_nearest_face() {
    let ball = sphere(0.1);
    for shape in [cuboid(0.5, 0.5, 0.5), cube_hull(0.5), cylinder(0.5, 0.5)] {
        let found = manifolds((&shape, Pose::IDENTITY), (&ball, at(0.1, 0.4, 0.0)), 0.0);
        assert!((found[0].normal - Vec3::Y).length() < 1.0e-5, "{shape:?}");
        assert!((found[0].points[0].separation + 0.2).abs() < 1.0e-5, "{shape:?}");
    }
}

#[test]
fn capsules_touch_in_one_point_crossed_and_in_two_side_by_side() {
    let rod = capsule(1.0, 0.25);
    let lying = |y: f32, angle: f32| {
        let flat = turned(Vec3::ZERO, Vec3::Z, QUARTER);
        Pose::new(v(0.0, y, 0.0), turned(Vec3::ZERO, Vec3::Y, angle).rotation * flat.rotation)
    };
    expect(
        "crossed",
        (&rod, lying(0.0, 0.0)),
        (&rod, lying(0.51, 1.0)),
        Vec3::Y,
        &[(v(0.0, 0.255, 0.0), 0.01)],
    );
    let ends = [(v(-1.0, 0.245, 0.0), -0.01), (v(1.0, 0.245, 0.0), -0.01)];
    expect("parallel", (&rod, lying(0.0, 0.0)), (&rod, lying(0.49, 0.0)), Vec3::Y, &ends);
    let ends = [(v(-1.0, 0.0, 0.0), 0.0), (v(1.0, 0.0, 0.0), 0.0)];
    expect("ground", (&Shape::HalfSpace, Pose::IDENTITY), (&rod, lying(0.25, 0.0)), Vec3::Y, &ends);
    expect("cuboid", (&cuboid(2.0, 0.5, 2.0), at(0.0, -0.5, 0.0)), (&rod, lying(0.25, 0.0)), Vec3::Y, &ends);
    expect("hull", (&cube_hull(2.0), at(0.0, -2.0, 0.0)), (&rod, lying(0.25, 0.0)), Vec3::Y, &ends);
    expect("cap", (&cylinder(0.5, 2.0), at(0.0, -0.5, 0.0)), (&rod, lying(0.25, 0.0)), Vec3::Y, &ends);
    let log = cylinder(3.0, 0.5);
    expect("cylinder side", (&log, lying(-0.5, 0.0)), (&rod, lying(0.25, 0.0)), Vec3::Y, &ends);
    let cut = [(v(0.0, -0.01, 0.0), -0.02), (v(1.0, -0.01, 0.0), -0.02)];
    expect(
        "over an edge",
        (&cuboid(2.0, 0.5, 2.0), at(2.0, -0.5, 0.0)),
        (&rod, lying(0.23, 0.0)),
        Vec3::Y,
        &cut,
    );
}

#[test]
fn capsule_core_deep_in_a_cuboid_leaves_by_the_nearest_face() {
    let found =
        manifolds((&cuboid(1.0, 0.5, 1.0), at(0.0, -0.5, 0.0)), (&capsule(0.5, 0.1), at(0.2, 0.4, 0.0)), 0.0);
    assert_eq!(found.len(), 1);
    assert!((found[0].normal - Vec3::Y).length() < 1.0e-5);
    assert!((found[0].deepest() + 0.2).abs() < 1.0e-5);
}

#[test]
fn a_box_on_a_face_has_the_corners_of_the_overlap() {
    let below = [cuboid(1.0, 0.5, 1.0), cube_hull(1.0)];
    for (shape, depth) in below.iter().zip([0.5, 1.0]) {
        for above in [cuboid(0.5, 0.5, 0.5), cube_hull(0.5)] {
            let corners = |x0: f32, x1: f32, z0: f32, z1: f32| {
                [(x0, z0), (x1, z0), (x0, z1), (x1, z1)].map(|(x, z)| (v(x, -0.005, z), -0.01))
            };
            let pose = at(0.0, -depth, 0.0);
            let expected = corners(-0.5, 0.5, -0.5, 0.5);
            expect("inside", (shape, pose), (&above, at(0.0, 0.49, 0.0)), Vec3::Y, &expected);
            let expected = corners(0.3, 1.0, -0.9, 0.1);
            expect("overhanging", (shape, pose), (&above, at(0.8, 0.49, -0.4)), Vec3::Y, &expected);
        }
    }
}

#[test]
fn crossed_edges_touch_in_one_point() {
    let half = libm::sqrtf(0.5);
    for make in [|| cuboid(0.5, 0.5, 0.5), || cube_hull(0.5)] {
        let shape = make();
        // Both stand on an edge, one along z and one along x.
        let below = turned(Vec3::ZERO, Vec3::Z, 0.5 * QUARTER);
        let above = turned(v(0.0, 2.0 * half - 0.01, 0.0), Vec3::X, 0.5 * QUARTER);
        let height = half - 0.005;
        expect("edges", (&shape, below), (&shape, above), Vec3::Y, &[(v(0.0, height, 0.0), -0.01)]);
    }
}

#[test]
fn a_cylinder_stands_on_four_points_lies_on_two_and_tilts_on_one() {
    let drum = cylinder(0.5, 0.4);
    let grounds = [
        (Shape::HalfSpace, Pose::IDENTITY),
        (cuboid(2.0, 0.5, 2.0), at(0.0, -0.5, 0.0)),
        (cube_hull(2.0), at(0.0, -2.0, 0.0)),
        (cylinder(0.5, 3.0), at(0.0, -0.5, 0.0)),
    ];
    for (ground, pose) in &grounds {
        let found = manifolds((ground, *pose), (&drum, at(0.0, 0.49, 0.0)), 0.02);
        assert_eq!(found[0].count, 4, "{ground:?}");
        let mut sum = Vec3::ZERO;
        for point in found[0].points() {
            assert!((point.separation + 0.01).abs() < 1.0e-5);
            let arm = point.position - v(0.0, -0.005, 0.0);
            assert!((arm.length() - 0.4).abs() < 1.0e-5, "on the rim: {point:?}");
            sum += arm;
        }
        assert!(sum.length() < 1.0e-4, "spread around the rim: {sum:?}");

        let lying = turned(v(0.0, 0.4, 0.0), Vec3::Z, QUARTER);
        let ends = [(v(-0.5, 0.0, 0.0), 0.0), (v(0.5, 0.0, 0.0), 0.0)];
        expect("lying", (ground, *pose), (&drum, lying), Vec3::Y, &ends);

        let tilt = 0.5_f32;
        let (sine, cosine) = libm::sincosf(tilt);
        let height = 0.5 * cosine + 0.4 * sine - 0.01;
        let tilted = turned(v(0.0, height, 0.0), Vec3::Z, tilt);
        // The rim's lowest point: half a height down the axis, a radius against the tilt.
        let lowest = v(0.5 * sine - 0.4 * cosine, -0.005, 0.0);
        let found = manifolds((ground, *pose), (&drum, tilted), 0.02);
        assert_eq!(found[0].count, 1, "{ground:?} {:#?}", found[0]);
        assert!((found[0].points[0].position - lowest).length() < 1.0e-5, "{ground:?} {:?}", found[0]);
        assert!((found[0].points[0].separation + 0.01).abs() < 1.0e-5);
    }
}

#[test]
fn a_coin_rolling_on_its_rim_has_its_exact_lowest_point() {
    // Euler's disk: radius 37.5 mm, 1 mm thick, from 30 down to half a degree.
    let coin = cylinder(0.0005, 0.0375);
    let grounds = [
        (Shape::HalfSpace, Pose::IDENTITY),
        (cuboid(1.0, 0.5, 1.0), at(0.0, -0.5, 0.0)),
        (cube_hull(1.0), at(0.0, -1.0, 0.0)),
    ];
    for (ground, pose) in &grounds {
        for degrees in [0.5_f32, 1.0, 5.0, 10.0, 20.0, 30.0, 80.0, 90.0] {
            for heading in [0.0_f32, 0.4, 1.3, 2.9, 5.0] {
                let tilt = degrees.to_radians();
                let spin = turned(Vec3::ZERO, Vec3::Y, heading).rotation;
                let lean = turned(Vec3::ZERO, Vec3::Z, tilt).rotation;
                let height = 0.0005 * libm::cosf(tilt) + 0.0375 * libm::sinf(tilt);
                let placed = Pose::new(v(0.01, height, 0.02), spin * lean);
                let local = v(-0.0375, -0.0005, 0.0);
                let lowest = placed.transform_point(local);
                let found = manifolds((ground, *pose), (&coin, placed), 0.005);
                let deepest = found[0]
                    .points()
                    .iter()
                    .min_by(|a, b| a.separation.total_cmp(&b.separation))
                    .expect("a manifold has points");
                assert!(deepest.separation.abs() < 1.0e-6, "{degrees} {deepest:?}");
                let off = (deepest.position - lowest).length();
                // At 90 degrees both rims are lowest.
                assert!(off < 2.0e-6 || degrees > 89.0, "{degrees} {heading}: {off} {ground:?}");
            }
        }
    }
}

#[test]
fn a_coin_shows_its_cap_until_it_nearly_stands() {
    let (coin, radius, tilt) = (cylinder(0.0005, 0.0375), 0.0375, 1.0_f32);
    let (sine, cosine) = libm::sincosf(tilt);
    for (ground, pose) in [(Shape::HalfSpace, Pose::IDENTITY), (cuboid(1.0, 0.5, 1.0), at(0.0, -0.5, 0.0))] {
        let placed = turned(v(0.0, 0.0005 * cosine + radius * sine, 0.0), Vec3::Z, tilt);
        let found = manifolds((&ground, pose), (&coin, placed), 0.1);
        let mut separations: Vec<f32> = found[0].points().iter().map(|point| point.separation).collect();
        separations.sort_by(f32::total_cmp);
        // The lowest point of the rim, the two beside it, and perhaps the one opposite.
        let expected = [0.0, radius * sine, radius * sine, 2.0 * radius * sine];
        assert!(separations.len() >= 3, "{ground:?}: {separations:?}");
        for (separation, expected) in separations.iter().zip(expected) {
            assert!((separation - expected).abs() < 1.0e-5, "{ground:?}: {separations:?}");
        }
    }
}

#[test]
fn drums_of_one_radius_stack_on_four_points() {
    let drum = cylinder(0.5, 0.4);
    for heading in [0.0, 0.2, 0.5, 1.0, 2.0] {
        let above = turned(v(0.0, 0.999, 0.0), Vec3::Y, heading);
        let found = manifolds((&drum, Pose::IDENTITY), (&drum, above), 0.02);
        assert_eq!(found[0].count, 4, "{heading}");
        for point in found[0].points() {
            assert!((point.separation + 0.001).abs() < 1.0e-5);
            let from_axis = v(point.position.x, 0.0, point.position.z).length();
            assert!(from_axis > 0.35 && from_axis < 0.401, "{heading}: {point:?}");
        }
    }
}

#[test]
fn two_logs_side_by_side_touch_in_two_points() {
    let log = cylinder(1.0, 0.25);
    let lie = |x: f32, y: f32| turned(v(0.0, y, x), Vec3::Z, QUARTER);
    let slant = v(0.0, libm::sqrtf(3.0) / 2.0, 0.5);
    let distance = 0.495;
    let ends = [-1.0, 1.0].map(|x| (v(x, 0.0, 0.0) + slant * (0.5 * distance), distance - 0.5));
    let second = lie(slant.z * distance, slant.y * distance);
    expect("logs", (&log, lie(0.0, 0.0)), (&log, second), slant, &ends);
    // Crossed, they touch in one.
    let crossed = Pose::new(v(0.0, 0.49, 0.0), turned(Vec3::ZERO, Vec3::X, QUARTER).rotation);
    expect("crossed", (&log, lie(0.0, 0.0)), (&log, crossed), Vec3::Y, &[(v(0.0, 0.245, 0.0), -0.01)]);
    // On a rail: a cuboid's edge, parallel to it.
    let rail = turned(v(0.0, -libm::sqrtf(0.5) * 0.2, 0.0), Vec3::X, 0.5 * QUARTER);
    let ends = [-0.8, 0.8].map(|x| (v(x, -0.001, 0.0), -0.002));
    expect("rail", (&cuboid(0.8, 0.1, 0.1), rail), (&log, lie(0.0, 0.248)), Vec3::Y, &ends);
}

#[test]
fn everything_stands_on_the_ground_where_it_should() {
    let o = (&Shape::HalfSpace, Pose::IDENTITY);
    let corners = [(-0.5, -0.3), (0.5, -0.3), (-0.5, 0.3), (0.5, 0.3)].map(|(x, z)| (v(x, 0.005, z), 0.01));
    expect("cuboid", o, (&cuboid(0.5, 0.2, 0.3), at(0.0, 0.21, 0.0)), Vec3::Y, &corners);
    let corners = [(-0.2, -0.2), (0.2, -0.2), (-0.2, 0.2), (0.2, 0.2)].map(|(x, z)| (v(x, 0.0, z), 0.0));
    expect("hull", o, (&cube_hull(0.2), at(0.0, 0.2, 0.0)), Vec3::Y, &corners);
    expect("point", o, (&octahedron(1.0), at(0.0, 1.0, 0.0)), Vec3::Y, &[(Vec3::ZERO, 0.0)]);
    // A tetrahedron on a face: all three corners.
    let shape = tetrahedron(1.0);
    let down = v(1.0, 1.0, 1.0).normalize();
    let pose = turned(Vec3::ZERO, down.cross(Vec3::Y), libm::acosf(down.y));
    let height = -outermost(&shape, &pose, Vec3::NEG_Y);
    let pose = Pose::new(v(0.0, -height, 0.0), pose.rotation);
    assert_eq!(manifolds(o, (&shape, pose), 0.01)[0].count, 3);
}

#[test]
fn a_tilted_ground_is_ground_too() {
    let slope = turned(v(1.0, 2.0, 3.0), Vec3::Z, 0.3);
    let up = slope.rotation * Vec3::Y;
    let ball = Pose::from_position(slope.position + up * 0.5 + slope.rotation * v(3.0, 0.0, 1.0));
    let found = manifolds((&Shape::HalfSpace, slope), (&sphere(0.5), ball), 0.1);
    assert!((found[0].normal - up).length() < 1.0e-6);
    assert!(found[0].points[0].separation.abs() < 1.0e-6);
}

#[test]
fn what_is_apart_by_more_than_the_margin_has_no_contact() {
    let shapes = [
        sphere(0.5),
        capsule(0.5, 0.5),
        cuboid(0.5, 0.5, 0.5),
        cylinder(0.5, 0.5),
        cube_hull(0.5),
        octahedron(0.5),
    ];
    for a in &shapes {
        for b in &shapes {
            assert!(manifolds((a, at(0.0, 0.0, 0.0)), (b, at(1.1, 0.0, 0.0)), 0.09).is_empty());
            let near = manifolds((a, at(0.0, 0.0, 0.0)), (b, at(1.1, 0.0, 0.0)), 0.11);
            assert_eq!(near.len(), 1, "{a:?} {b:?}");
            assert!((near[0].deepest() - 0.1).abs() < 1.0e-4, "{a:?} {b:?} {near:?}");
        }
    }
}
