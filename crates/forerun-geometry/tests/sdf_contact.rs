//! Contact with meshes against answers by formula.
#![allow(dead_code, reason = "each test uses some of the common meshes")]

use std::sync::Arc;

use forerun_geometry::contact::contact_manifolds;
use forerun_geometry::shape::{Capsule, Compound, Cuboid, Cylinder, Hull, Mesh, Sphere};
use forerun_geometry::{ContactPoint, Manifold, Motion, Placed, Pose, Quat, Shape, Vec3};

#[path = "common/meshes.rs"]
mod meshes;
use meshes::{Random, Triangles};

const MARGIN: f32 = 0.02;

fn shape((vertices, triangles): Triangles) -> Shape {
    Shape::Mesh(Arc::new(Mesh::open(vertices, triangles).expect("a valid mesh")))
}

fn torus() -> Shape {
    shape(meshes::torus(0.5, 0.2, 48, 16))
}

fn at(shape: &Shape, position: Vec3) -> Placed<'_> {
    Placed { shape, pose: Pose::from_position(position), motion: Motion::default() }
}

fn contact(first: &Placed, second: &Placed) -> Vec<Manifold> {
    let mut out = Vec::new();
    // As far as they may move towards each other.
    let turning = (first.motion.angular.length() + second.motion.angular.length()) * 2.0;
    let motion = (first.motion.linear - second.motion.linear).length() + turning;
    contact_manifolds(first, second, MARGIN.max(1.2 * motion), &mut out);
    for m in &out {
        assert!((1..=4).contains(&m.count));
        assert!(m.normal.is_normalized());
        for p in points_of(m) {
            assert!(p.normal.is_normalized() && p.position.is_finite() && p.separation.is_finite());
        }
    }
    out
}

fn points_of(m: &Manifold) -> &[ContactPoint] {
    &m.points[..m.count as usize]
}

fn all_points(manifolds: &[Manifold]) -> Vec<ContactPoint> {
    manifolds.iter().flat_map(|m| points_of(m).to_vec()).collect()
}

fn smallest_separation(manifolds: &[Manifold]) -> f32 {
    all_points(manifolds).iter().fold(f32::INFINITY, |m, p| m.min(p.separation))
}

#[test]
fn a_torus_rests_on_the_ground_all_around() {
    let (torus, ground) = (torus(), Shape::HalfSpace);
    // The mesh's lowest vertices are at half a segment beside the bottom of the tube.
    let lowest = 0.2 * libm::cosf(std::f32::consts::PI / 16.0);
    for depth in [-0.01, 0.0, 0.01, 0.05] {
        let found = contact(&at(&ground, Vec3::ZERO), &at(&torus, Vec3::Y * (lowest - depth)));
        let points = all_points(&found);
        assert_eq!(points.len(), 8);
        let mut quadrants = [0; 4];
        for p in &points {
            assert!((p.separation + depth).abs() < 1e-5, "{} at depth {depth}", p.separation);
            assert!(p.normal.distance(Vec3::Y) < 1e-6);
            assert!((p.position.y + 0.5 * depth).abs() < 1e-5, "not midway: {}", p.position);
            let ring = Vec3::new(p.position.x, 0.0, p.position.z).length();
            assert!((ring - 0.5).abs() < 0.06, "off the ring: {ring}");
            quadrants[usize::from(p.position.x > 0.0) + 2 * usize::from(p.position.z > 0.0)] += 1;
        }
        assert!(quadrants.iter().all(|n| *n > 0), "on one side: {quadrants:?}");
    }
}

#[test]
fn bodies_far_apart_do_not_touch() {
    let (torus, ground, ball) = (torus(), Shape::HalfSpace, Shape::Sphere(Sphere { radius: 0.3 }));
    assert!(contact(&at(&ground, Vec3::ZERO), &at(&torus, Vec3::Y * 0.25)).is_empty());
    assert!(contact(&at(&torus, Vec3::ZERO), &at(&torus, Vec3::Y * 0.45)).is_empty());
    assert!(contact(&at(&torus, Vec3::ZERO), &at(&torus, Vec3::X * 30.0)).is_empty());
    assert!(contact(&at(&torus, Vec3::ZERO), &at(&ball, Vec3::Y * 0.4)).is_empty());
    // A small ball in the hole of the torus touches nothing either.
    let small = Shape::Sphere(Sphere { radius: 0.25 });
    assert!(contact(&at(&torus, Vec3::ZERO), &at(&small, Vec3::ZERO)).is_empty());
}

#[test]
fn crossing_frames_touch_edge_on_edge() {
    let frame = shape(meshes::frame(0.5, 0.04));
    // Turned by 45 degrees about y and lying a little inside: no vertex of one is near the other.
    for overlap in [-0.01_f32, 0.005, 0.02] {
        let lower = at(&frame, Vec3::ZERO);
        let mut upper = at(&frame, Vec3::Y * (0.08 - overlap));
        upper.pose.rotation = Quat::from_axis_angle(Vec3::Y, std::f32::consts::FRAC_PI_4);
        let found = contact(&lower, &upper);
        let points = all_points(&found);
        assert!(points.len() >= 4, "{} points at overlap {overlap}", points.len());
        assert!((smallest_separation(&found) + overlap).abs() < 0.004, "{}", smallest_separation(&found));
        let up = points.iter().filter(|p| p.normal.y > 0.95).count();
        assert!(up >= 4, "{up} of {} normals point up", points.len());
    }
    // Upright across the lower one, edges only: a wedge on a wedge.
    let lower = at(&frame, Vec3::ZERO);
    let mut upper = at(&frame, Vec3::new(0.5, 0.555, 0.013));
    upper.pose.rotation = Quat::from_axis_angle(Vec3::X, std::f32::consts::FRAC_PI_2);
    let found = contact(&lower, &upper);
    assert!(!found.is_empty(), "an upright frame on a bar of the other");
}

#[test]
fn a_mesh_ball_touches_a_ball_where_the_formula_says() {
    let mesh = shape(meshes::sphere(0.5, 48, 24));
    let ball = Shape::Sphere(Sphere { radius: 0.3 });
    let mut random = Random(5);
    for _ in 0..50 {
        let way = random.vector().normalize();
        let overlap = 0.015 * random.number();
        let found = contact(&at(&mesh, Vec3::ZERO), &at(&ball, way * (0.8 - overlap)));
        assert!(!found.is_empty());
        // Facets lie up to 4.3 mm inside of the ball.
        assert!(
            (smallest_separation(&found) + overlap).abs() < 0.006,
            "{} for {overlap}",
            smallest_separation(&found)
        );
        let deepest = all_points(&found).into_iter().min_by(|a, b| a.separation.total_cmp(&b.separation));
        let deepest = deepest.expect("has points");
        assert!(deepest.normal.dot(way) > 0.99, "{} instead of {way}", deepest.normal);
        assert!(deepest.position.distance(way * (0.5 - 0.5 * overlap)) < 0.05);
    }
}

#[test]
fn primitives_on_a_mesh_plate_touch_as_on_a_plane() {
    let plate = shape(meshes::cuboid(Vec3::new(2.0, 0.1, 2.0)));
    let tilt = Quat::from_axis_angle(Vec3::Z, std::f32::consts::FRAC_PI_2);
    let half = Vec3::new(0.3, 0.2, 0.1);
    let cases = [
        ("sphere", Shape::Sphere(Sphere { radius: 0.25 }), 0.25, Quat::IDENTITY, 1),
        ("box", Shape::Cuboid(Cuboid { half_extents: half }), 0.2, Quat::IDENTITY, 4),
        ("capsule", Shape::Capsule(Capsule { half_height: 0.4, radius: 0.1 }), 0.1, tilt, 2),
        (
            "upright capsule",
            Shape::Capsule(Capsule { half_height: 0.4, radius: 0.1 }),
            0.5,
            Quat::IDENTITY,
            1,
        ),
        ("cylinder", Shape::Cylinder(Cylinder { half_height: 0.4, radius: 0.1 }), 0.4, Quat::IDENTITY, 4),
        ("lying cylinder", Shape::Cylinder(Cylinder { half_height: 0.4, radius: 0.1 }), 0.1, tilt, 2),
        (
            "compound",
            Shape::Compound(Arc::new(Compound {
                parts: [-0.5, 0.5]
                    .map(|x| (Pose::from_position(Vec3::X * x), Shape::Cuboid(Cuboid { half_extents: half })))
                    .to_vec(),
            })),
            0.2,
            Quat::IDENTITY,
            4,
        ),
    ];
    for (name, shape, height, rotation, fewest) in cases {
        for depth in [-0.015, 0.0, 0.01] {
            let mut upper = at(&shape, Vec3::new(0.37, 0.1 + height - depth, -0.21));
            upper.pose.rotation = rotation;
            let points = all_points(&contact(&at(&plate, Vec3::ZERO), &upper));
            assert!(points.len() >= fewest, "{name}: {} points at depth {depth}", points.len());
            for p in &points {
                assert!((p.separation + depth).abs() < 1e-3, "{name}: {} at depth {depth}", p.separation);
                assert!(p.normal.y > 0.999, "{name}: normal {}", p.normal);
                assert!((p.position.y - (0.1 - 0.5 * depth)).abs() < 1e-3, "{name}: {}", p.position);
            }
        }
    }
}

#[test]
fn a_fast_body_is_seen_in_time() {
    let (torus, ground) = (torus(), Shape::HalfSpace);
    let still = at(&torus, Vec3::Y * 0.6);
    assert!(contact(&at(&ground, Vec3::ZERO), &still).is_empty());
    let fast = Placed { motion: Motion { linear: Vec3::Y * -0.5, ..Motion::default() }, ..still };
    let found = contact(&at(&ground, Vec3::ZERO), &fast);
    assert!((smallest_separation(&found) - 0.4).abs() < 0.005);
    let away = Placed { motion: Motion { linear: Vec3::Y * 0.5, ..Motion::default() }, ..still };
    assert!(contact(&at(&ground, Vec3::ZERO), &away).is_empty());
    // Mesh on mesh, far outside the grid of the other: the gap is not taken for smaller than it is.
    let lower = at(&torus, Vec3::Y * -0.2);
    let found = contact(&lower, &fast);
    assert!((smallest_separation(&found) - 0.4).abs() < 0.02, "{}", smallest_separation(&found));
}

#[test]
fn of_two_that_fall_together_one_may_be_stopped() {
    let torus = torus();
    let (lower, upper) = (at(&torus, Vec3::ZERO), at(&torus, Vec3::Y * 0.5));
    let meet = |motion: Motion| {
        let mut out = Vec::new();
        let falling = [lower, upper].map(|placed| Placed { motion, ..placed });
        contact_manifolds(&falling[0], &falling[1], 0.36, &mut out);
        out
    };
    assert!(meet(Motion::default()).is_empty());
    let found = meet(Motion { linear: Vec3::Y * -0.3, ..Motion::default() });
    assert!((smallest_separation(&found) - 0.1).abs() < 0.02, "{}", smallest_separation(&found));
}

#[test]
fn swapping_the_bodies_mirrors_the_manifolds() {
    let torus = torus();
    let mut random = Random(7);
    let mut touching = 0;
    for _ in 0..40 {
        let first = at(&torus, Vec3::ZERO);
        let mut second = at(&torus, random.vector() * 0.8);
        second.pose.rotation = Quat::from_axis_angle(random.vector().normalize(), 3.0 * random.number());
        let (there, back) = (contact(&first, &second), contact(&second, &first));
        assert_eq!(there.is_empty(), back.is_empty());
        if there.is_empty() {
            continue;
        }
        touching += 1;
        assert!((smallest_separation(&there) - smallest_separation(&back)).abs() < 1e-5);
        assert!(there[0].normal.dot(back[0].normal) < -0.99, "{} and {}", there[0].normal, back[0].normal);
    }
    assert!(touching > 10);
}

#[test]
fn tori_overlap_as_deep_as_a_brute_force_says() {
    let (major, minor) = (0.5, 0.2);
    let (vertices, _) = meshes::torus(major, minor, 192, 64);
    let torus = torus();
    let mut random = Random(11);
    let mut checked = 0;
    for _ in 0..60 {
        let mut second = at(&torus, random.vector() * 1.2);
        second.pose.rotation = Quat::from_axis_angle(random.vector().normalize(), 3.0 * random.number());
        // Depth of the finely sampled second torus in the exact first.
        let distances =
            vertices.iter().map(|v| meshes::torus_distance(major, minor, second.pose.transform_point(*v)));
        let depth = distances.fold(f32::INFINITY, f32::min);
        if !(-0.1..0.0).contains(&depth) {
            continue;
        }
        checked += 1;
        let found = smallest_separation(&contact(&at(&torus, Vec3::ZERO), &second));
        assert!((found - depth).abs() < 0.02, "{found} instead of {depth}");
    }
    assert!(checked > 3, "only {checked} poses");
}

#[test]
fn no_pose_gives_a_number_that_is_none() {
    let shapes = [
        torus(),
        shape(meshes::l_shape()),
        shape(meshes::frame(0.5, 0.04)),
        Shape::HalfSpace,
        Shape::Sphere(Sphere { radius: 0.3 }),
        Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.3, 0.5, 0.1) }),
        Shape::Capsule(Capsule { half_height: 0.3, radius: 0.2 }),
        Shape::Cylinder(Cylinder { half_height: 0.3, radius: 0.2 }),
    ];
    let mut random = Random(13);
    for _ in 0..300 {
        for mesh in &shapes[..3] {
            for other in &shapes {
                let mut first = at(mesh, Vec3::ZERO);
                let mut second = at(other, random.vector());
                first.motion =
                    Motion { linear: random.vector(), angular: random.vector(), about: random.vector() };
                second.pose.rotation =
                    Quat::from_axis_angle(random.vector().normalize(), 3.0 * random.number());
                // `contact` checks the numbers; concentric shapes are the hardest.
                contact(&first, &second);
                second.pose = Pose::IDENTITY;
                contact(&first, &second);
            }
        }
    }
    // Poses that are not numbers find nothing.
    let nowhere = at(&shapes[0], Vec3::new(f32::NAN, 0.0, 0.0));
    for other in &shapes {
        assert!(contact(&nowhere, &at(other, Vec3::ZERO)).is_empty());
    }
}

/// A hilly sheet, open, that faces up: squares of a metre, cut in two.
fn terrain(height: impl Fn(f32, f32) -> f32) -> Shape {
    let n = 8_u32;
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for z in 0..=n {
        for x in 0..=n {
            let (px, pz) = (x as f32 - 4.0, z as f32 - 4.0);
            vertices.push(Vec3::new(px, height(px, pz), pz));
            if x < n && z < n {
                let [a, b, c, d] = [0, 1, n + 2, n + 1].map(|k| z * (n + 1) + x + k);
                triangles.extend([[a, d, c], [a, c, b]]);
            }
        }
    }
    shape((vertices, triangles))
}

#[test]
fn an_open_sheet_holds_shapes_on_its_front_only() {
    let flat = terrain(|_, _| 0.0);
    let half_extents = Vec3::new(0.3, 0.2, 0.1);
    let shapes = [
        ("sphere", Shape::Sphere(Sphere { radius: 0.2 }), 1),
        ("box", Shape::Cuboid(Cuboid { half_extents }), 4),
        ("mesh box", shape(meshes::cuboid(half_extents)), 4),
        ("cylinder", Shape::Cylinder(Cylinder { half_height: 0.2, radius: 0.3 }), 4),
    ];
    for (name, shape, fewest) in shapes {
        for depth in [-0.01, 0.0, 0.02] {
            let upper = at(&shape, Vec3::new(0.13, 0.2 - depth, 0.31));
            let points = all_points(&contact(&at(&flat, Vec3::ZERO), &upper));
            assert!(points.len() >= fewest, "{name}: {} points", points.len());
            for p in &points {
                assert!((p.separation + depth).abs() < 1e-4, "{name}: {} at {depth}", p.separation);
                assert!(p.normal.y > 0.999, "{name}: {}", p.normal);
            }
        }
        let below = at(&shape, Vec3::new(0.13, -3.0, 0.31));
        assert!(contact(&at(&flat, Vec3::ZERO), &below).is_empty(), "{name} far below the sheet");
        let beside = at(&shape, Vec3::new(4.4, -0.05, 0.31));
        assert!(contact(&at(&flat, Vec3::ZERO), &beside).is_empty(), "{name} beside the sheet");
    }
}

#[test]
fn nothing_catches_on_the_vertices_inside_a_flat_floor() {
    let flat = terrain(|_, _| 0.0);
    let half_extents = Vec3::splat(0.5);
    let boxes =
        [("box", Shape::Cuboid(Cuboid { half_extents })), ("mesh box", shape(meshes::cuboid(half_extents)))];
    for (name, shape) in boxes {
        // Its front goes over the row of vertices at x = 1.
        for step in 0..60 {
            let front = 0.97 + 0.001 * step as f32;
            let mut upper = at(&shape, Vec3::new(front - 0.5, 0.4999, 0.03));
            upper.motion.linear = Vec3::X * 0.05;
            upper.motion.about = upper.pose.position;
            for p in all_points(&contact(&at(&flat, Vec3::ZERO), &upper)) {
                assert!(p.normal.y > 0.999, "{name} with its front at {front}: {}", p.normal);
            }
        }
    }
}

#[test]
fn a_box_rests_on_the_ridge_of_a_sheet() {
    // A ridge along x whose vertices are a metre apart; the box lies between two of them.
    let ridge = terrain(|_, z| -0.5 * z.abs());
    let slab = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.4, 0.1, 0.4) });
    let found = contact(&at(&ridge, Vec3::ZERO), &at(&slab, Vec3::new(0.5, 0.09, 0.0)));
    assert!((smallest_separation(&found) + 0.01).abs() < 1e-3, "{}", smallest_separation(&found));
    let points = all_points(&found);
    let spread =
        points.iter().map(|p| p.position.x).fold((9.0_f32, -9.0_f32), |(a, b), x| (a.min(x), b.max(x)));
    assert!(spread.1 - spread.0 > 0.4, "points from x = {} to {}", spread.0, spread.1);
    // Points of the box's edges that are below the ridge see its slopes.
    assert!(points.iter().all(|p| p.normal.y > 0.85));
}

#[test]
fn a_bar_pressed_into_another_is_pushed_back_the_way_it_came() {
    let frame = shape(meshes::frame(0.5, 0.04));
    for overlap in [0.005_f32, 0.015, 0.025] {
        let mut upper = at(&frame, Vec3::new(0.013, 0.08 - overlap, 0.021));
        upper.pose.rotation = Quat::from_axis_angle(Vec3::Y, 0.7);
        let points = all_points(&contact(&at(&frame, Vec3::ZERO), &upper));
        assert!(points.len() >= 4);
        for p in &points {
            assert!(p.normal.y > -0.2, "pulled in at overlap {overlap}: {p:?}");
        }
        let deepest = points.iter().min_by(|a, b| a.separation.total_cmp(&b.separation)).expect("points");
        assert!(deepest.normal.y > 0.95 && (deepest.separation + overlap).abs() < 0.004, "{deepest:?}");
    }
}

#[test]
fn a_ball_in_the_hole_of_a_torus_is_held_all_around() {
    // The hole has a radius of 0.3; a ball of 0.35 sits in its upper mouth where (0.5)² + y² = (0.35 + 0.2)².
    let (torus, ball) = (torus(), Shape::Sphere(Sphere { radius: 0.35 }));
    let height = (0.55_f32 * 0.55 - 0.25).sqrt();
    let points = all_points(&contact(&at(&torus, Vec3::ZERO), &at(&ball, Vec3::Y * (height - 0.003))));
    assert!(points.len() >= 3);
    let middle = points.iter().map(|p| p.position).sum::<Vec3>() / points.len() as f32;
    assert!(Vec3::new(middle.x, 0.0, middle.z).length() < 0.1, "all on one side: {middle}");
    for p in &points {
        // Facets are up to 4 mm inside the torus.
        assert!(p.separation > -0.005 && p.separation < 0.012, "{}", p.separation);
    }
}

#[test]
fn a_hull_stands_on_a_mesh_like_the_box_that_it_is() {
    let plate = shape(meshes::cuboid(Vec3::new(2.0, 0.1, 2.0)));
    let half = Vec3::new(0.3, 0.2, 0.1);
    let corners: Vec<Vec3> = meshes::cuboid(half).0;
    let hull = Shape::Hull(Arc::new(Hull::new(&corners).expect("a box")));
    let cuboid = Shape::Cuboid(Cuboid { half_extents: half });
    let found = [&hull, &cuboid].map(|shape| {
        let mut upper = at(shape, Vec3::new(0.2, 0.3, 0.1));
        upper.pose.rotation = Quat::from_axis_angle(Vec3::Y, 0.3);
        contact(&at(&plate, Vec3::ZERO), &upper)
    });
    assert_eq!(found[0].len(), found[1].len());
    assert!((smallest_separation(&found[0]) - smallest_separation(&found[1])).abs() < 1e-5);
}

#[test]
fn a_box_stands_on_one_of_the_same_size() {
    // Every corner of one is exactly on an edge of the other: nothing says by itself which face it came through.
    let half = Vec3::new(0.3, 0.2, 0.1);
    let mesh = shape(meshes::cuboid(half));
    let hull = Shape::Hull(Arc::new(Hull::new(&meshes::cuboid(half).0).expect("a box")));
    let cuboid = Shape::Cuboid(Cuboid { half_extents: half });
    for (name, lower, upper) in
        [("mesh", &mesh, &mesh), ("cuboid", &cuboid, &mesh), ("hull", &mesh, &hull), ("box", &mesh, &cuboid)]
    {
        for aside in [Vec3::ZERO, Vec3::X * 0.1, Vec3::new(0.001, 0.0, -0.0005)] {
            for depth in [-0.002, 0.0, 0.01] {
                let found = contact(&at(lower, Vec3::ZERO), &at(upper, aside + Vec3::Y * (0.4 - depth)));
                let points = all_points(&found);
                assert!(points.len() >= 4, "{name}: {} points at depth {depth}, {aside}", points.len());
                for p in &points {
                    assert!(
                        (p.separation + depth).abs() < 2e-3,
                        "{name}: {} at {depth}, {aside}",
                        p.separation
                    );
                    assert!(p.normal.y > 0.99, "{name}: {} at {depth}, {aside}", p.normal);
                }
            }
        }
    }
}

#[test]
fn a_bar_past_the_middle_of_another_is_not_pulled_through() {
    // Sections of 8 cm, 5 cm inside: the nearest way out of the lower bar for the lowest points is down.
    let frame = shape(meshes::frame(0.5, 0.04));
    let mut upper = at(&frame, Vec3::new(0.013, 0.03, 0.021));
    upper.pose.rotation = Quat::from_axis_angle(Vec3::Y, 0.7);
    let points = all_points(&contact(&at(&frame, Vec3::ZERO), &upper));
    // Edges may be pushed out askew, but nothing straight down.
    let down = points.iter().filter(|p| p.normal.y < -0.9).count();
    assert!(!points.is_empty() && down == 0, "{down} of {} pull it through", points.len());
}

/// A block 1 m deep on a four-sided face, as a mesh of its own frame.
fn wedge(face: [Vec3; 4]) -> Shape {
    let corners: Vec<Vec3> = [-0.5, 0.5].iter().flat_map(|z| face.map(|c| c + Vec3::Z * *z)).collect();
    let hull = Hull::new(&corners).expect("a wedge");
    let corners: Vec<Vec3> = hull.triangles().flatten().collect();
    let triangles = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    shape((corners, triangles))
}

#[test]
fn wedges_touch_at_the_corners_of_their_joint() {
    // Two stones of an arch: the joint is askew to the grids of both, whose cells are an eighth of a metre.
    let (inner, outer) = (Vec3::new(2.8, 5.1, 0.0), Vec3::new(4.117, 5.953, 0.0));
    let below = wedge([Vec3::new(3.145, 3.835, 0.0), Vec3::new(4.65, 4.487, 0.0), outer, inner]);
    let above = wedge([inner, outer, Vec3::new(3.513, 7.393, 0.0), Vec3::new(2.416, 6.351, 0.0)]);
    let normal = Vec3::new(inner.y - outer.y, outer.x - inner.x, 0.0).normalize();
    for gap in [0.0, 0.002, -0.002] {
        let points = all_points(&contact(&at(&below, Vec3::ZERO), &at(&above, normal * gap)));
        for corner in [inner, outer].iter().flat_map(|c| [-0.5, 0.5].map(|z| *c + Vec3::Z * z)) {
            let point = points
                .iter()
                .min_by(|a, b| a.position.distance(corner).total_cmp(&b.position.distance(corner)));
            let point = point.expect("has points");
            assert!(point.position.distance(corner) < 0.01, "none at {corner}, gap {gap}: {points:?}");
            assert!((point.separation - gap).abs() < 5e-4, "{} at {corner}, gap {gap}", point.separation);
            assert!(point.normal.dot(normal) > 0.999, "{} instead of {normal}", point.normal);
        }
    }
}

/// The area that the points span on the ground: that of their convex hull, corner by corner (Jarvis' march).
fn spanned(points: &[ContactPoint]) -> f32 {
    let ground: Vec<[f32; 2]> = points.iter().map(|p| [p.position.x, p.position.z]).collect();
    let same = |a: [f32; 2], b: [f32; 2]| a.map(f32::to_bits) == b.map(f32::to_bits);
    let cross = |a: [f32; 2], b: [f32; 2]| a[0] * b[1] - a[1] * b[0];
    let way = |a: [f32; 2], b: [f32; 2]| [b[0] - a[0], b[1] - a[1]];
    let Some(first) = ground.iter().copied().min_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])))
    else {
        return 0.0;
    };
    let (mut area, mut corner) = (0.0, first);
    for _ in 0..ground.len() {
        let mut next = first;
        for p in &ground {
            let (side, far) = (cross(way(corner, next), way(corner, *p)), |q| way(corner, q).map(|c| c * c));
            let farther = far(*p)[0] + far(*p)[1] > far(next)[0] + far(next)[1];
            if same(next, corner) || side < -1e-6 || (side < 1e-6 && farther) {
                next = *p;
            }
        }
        area += 0.5 * cross(corner, next);
        corner = next;
        if same(corner, first) {
            break;
        }
    }
    area
}

#[test]
fn a_box_lying_across_another_is_held_by_all_that_they_share() {
    let cube = shape(meshes::cuboid(Vec3::splat(0.5)));
    let cuboid = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
    let hull = Shape::Hull(Arc::new(Hull::new(&meshes::cuboid(Vec3::splat(0.5)).0).expect("a box")));
    // An octagon: of a square of 1 m four corners are cut off at 0.5 m from the middle.
    let cut = 0.5_f32.sqrt() - 0.5;
    let octagon = 1.0 - 4.0 * cut * cut;
    for (name, lower, upper) in
        [("mesh", &cube, &cube), ("cuboid", &cuboid, &cube), ("box", &cube, &cuboid), ("hull", &cube, &hull)]
    {
        for (turn, aside, expected) in [
            (std::f32::consts::FRAC_PI_4, Vec3::ZERO, octagon),
            (0.0, Vec3::new(0.3, 0.0, 0.4), 0.7 * 0.6),
            (0.0, Vec3::new(0.3, 0.0, 0.0), 0.7),
        ] {
            for depth in [-0.002, 0.0, 0.004] {
                let mut above = at(upper, aside + Vec3::Y * (1.0 - depth));
                above.pose.rotation = Quat::from_axis_angle(Vec3::Y, turn);
                let points = all_points(&contact(&at(lower, Vec3::ZERO), &above));
                for p in &points {
                    assert!(p.normal.y > 0.999, "{name} turned by {turn}, {depth} deep: {p:?}");
                    assert!(
                        (p.separation + depth).abs() < 1e-3,
                        "{name} turned by {turn}, {depth} deep: {p:?}"
                    );
                }
                let area = spanned(&points);
                assert!(
                    (0.9..1.01).contains(&(area / expected)),
                    "{name} turned by {turn}, {depth} deep: {area} m² of {expected}: {points:?}"
                );
            }
        }
    }
}

#[test]
fn a_thin_wedge_does_not_go_between_the_points_of_an_edge() {
    // Its edge across that of a long block, between the corners, which are two metres apart.
    let block = shape(meshes::cuboid(Vec3::new(1.0, 1.0, 1.0)));
    for half_width in [0.01, 0.1] {
        let corners =
            |z: f32| [Vec3::new(0.0, 0.0, z), Vec3::new(1.0, half_width, z), Vec3::new(1.0, -half_width, z)];
        let corners: Vec<Vec3> = [-1.5, 1.5].into_iter().flat_map(corners).collect();
        let hull = Hull::new(&corners).expect("a wedge");
        let triangles: Vec<Vec3> = hull.triangles().flatten().collect();
        let count = triangles.len() as u32 / 3;
        let wedge = shape((triangles, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()));
        // What is farther than a fifth of its thickness is not near.
        for depth in [-0.001, 0.003, 0.01] {
            // It comes in over the vertical edge at (1, 1), its own edge in the horizontal plane, and halves the angle.
            let mut across =
                at(&wedge, Vec3::new(1.0, 0.237, 1.0) - Vec3::new(1.0, 0.0, 1.0).normalize() * depth);
            across.pose.rotation = Quat::from_axis_angle(Vec3::Y, -std::f32::consts::FRAC_PI_4);
            let found = contact(&at(&block, Vec3::ZERO), &across);
            let out = Vec3::new(1.0, 0.0, 1.0).normalize();
            assert!(
                (smallest_separation(&found) + depth).abs() < 0.003,
                "{half_width} wide, {depth} deep: {}",
                smallest_separation(&found)
            );
            assert!(found.iter().any(|m| m.normal.dot(out) > 0.7), "{found:?}");
        }
    }
}
