//! Convex hulls against what every convex polyhedron must fulfil.

mod shapes_common;

use forerun_geometry::shape::Hull;
use forerun_geometry::{Quat, Shape, Vec3};
use shapes_common::Random;

/// Every point behind every face, faces planar and convex, edges consistent, Euler's formula.
fn check(hull: &Hull, points: &[Vec3], tolerance: f32) {
    for face in &hull.faces {
        assert!((face.normal.length() - 1.0).abs() < 1e-5);
        for p in points {
            let d = face.normal.dot(*p) - face.offset;
            assert!(d <= tolerance, "point {p} is {d} m in front of {face:?}");
        }
        let corners = hull.face_corners(face);
        for (i, &c) in corners.iter().enumerate() {
            let [a, b, c] = [c, corners[(i + 1) % corners.len()], corners[(i + 2) % corners.len()]]
                .map(|i| hull.vertices[i as usize]);
            assert!((face.normal.dot(a) - face.offset).abs() <= 2.0 * tolerance);
            assert!((b - a).cross(c - b).dot(face.normal) > -tolerance, "a face turns right at {b}");
        }
    }
    assert_eq!(hull.vertices.len() + hull.faces.len(), hull.edges.len() + 2, "Euler");
    assert_eq!(hull.corners.len(), 2 * hull.edges.len());
    for edge in &hull.edges {
        let [a, b] = edge.vertices;
        assert!(a < b);
        let passes = |face: u32, from: u32, to: u32| {
            let corners = hull.face_corners(&hull.faces[face as usize]);
            corners.iter().enumerate().any(|(i, &c)| c == from && corners[(i + 1) % corners.len()] == to)
        };
        assert!(passes(edge.faces[0], a, b) && passes(edge.faces[1], b, a));
    }
}

fn box_points(h: Vec3) -> Vec<Vec3> {
    (0..8)
        .map(|i| {
            Vec3::new(
                if i & 1 == 0 { -h.x } else { h.x },
                if i & 2 == 0 { -h.y } else { h.y },
                if i & 4 == 0 { -h.z } else { h.z },
            )
        })
        .collect()
}

#[test]
fn a_box_has_six_faces_however_it_is_turned() {
    let mut random = Random(1);
    for round in 0..200 {
        let q = if round == 0 { Quat::IDENTITY } else { random.rotation() };
        let h = Vec3::new(random.between(0.01, 2.0), random.between(0.01, 2.0), random.between(0.01, 2.0));
        let at = random.vector(3.0);
        let points: Vec<Vec3> = box_points(h).iter().map(|p| q * *p + at).collect();
        let hull = Hull::new(&points).unwrap();
        assert_eq!((hull.vertices.len(), hull.faces.len(), hull.edges.len()), (8, 6, 12));
        assert!(hull.faces.iter().all(|f| f.count == 4));
        assert_eq!(hull.vertices, points);
        assert!((hull.centre - at).length() < 1e-5);
        assert!((0.5 * hull.thinnest_width() - h.min_element()).abs() < 1e-4);
        check(&hull, &points, 5e-5);
    }
}

#[test]
fn a_grid_of_points_on_a_box_is_a_box() {
    let mut points = Vec::new();
    for x in 0..5 {
        for y in 0..5 {
            for z in 0..5 {
                points.push(Vec3::new(x as f32, y as f32, z as f32) * 0.3 - Vec3::splat(0.6));
            }
        }
    }
    let mut random = Random(2);
    for round in 0..50 {
        let q = if round == 0 { Quat::IDENTITY } else { random.rotation() };
        let turned: Vec<Vec3> = points.iter().map(|p| q * *p).collect();
        let hull = Hull::new(&turned).unwrap();
        assert_eq!((hull.vertices.len(), hull.faces.len(), hull.edges.len()), (8, 6, 12), "{q}");
        check(&hull, &turned, 3e-5);
    }
}

#[test]
fn random_points() {
    let mut random = Random(3);
    for round in 0..200 {
        let count = 4 + round % 60;
        let flatten = Vec3::new(1.0, if round % 3 == 0 { 0.01 } else { 1.0 }, 1.0);
        let points: Vec<Vec3> = (0..count).map(|_| random.vector(1.0) * flatten).collect();
        let hull = Hull::new(&points).unwrap();
        check(&hull, &points, 1e-4);
        assert!(hull.vertices.iter().all(|v| points.contains(v)));
    }
}

#[test]
fn a_round_thing_keeps_its_vertices() {
    let mut random = Random(4);
    let points: Vec<Vec3> = (0..500).map(|_| random.direction()).collect();
    let hull = Hull::new(&points).unwrap();
    check(&hull, &points, 5e-5);
    assert!(hull.vertices.len() > 480, "{}", hull.vertices.len());
}

#[test]
fn a_prism_keeps_its_round_side_and_two_flat_ends() {
    let n = 24;
    let mut points = Vec::new();
    for i in 0..n {
        let (s, c) = libm::sincosf(i as f32 * std::f32::consts::TAU / n as f32);
        points.extend([Vec3::new(c, -0.5, s), Vec3::new(c, 0.5, s)]);
    }
    let q = Random(5).rotation();
    let points: Vec<Vec3> = points.iter().map(|p| q * *p).collect();
    let hull = Hull::new(&points).unwrap();
    assert_eq!((hull.vertices.len(), hull.faces.len(), hull.edges.len()), (2 * n, n + 2, 3 * n));
    check(&hull, &points, 5e-5);
}

#[test]
fn refuses_and_says_why() {
    let says = |points: &[Vec3], what: &str| {
        let error = Shape::hull(points).unwrap_err();
        assert_eq!(error.field, "points");
        assert!(error.message.contains(what), "{error}");
    };
    says(&[], "at least 4");
    says(&[Vec3::ZERO, Vec3::X, Vec3::Y], "there are 3");
    says(&[Vec3::ZERO; 10], "there are 1");
    let square = [Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::X + Vec3::Z];
    says(&square, "in a plane");
    says(&[Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::X * 3.0, Vec3::X * 4.0], "in a plane");
    let mut thin = square.to_vec();
    thin.extend(square.map(|p| p + Vec3::Y * 2e-5));
    says(&thin, "in a plane");
    let mut bad = box_points(Vec3::ONE);
    bad[3].y = f32::NAN;
    says(&bad, "point 3");
}
