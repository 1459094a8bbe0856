//! What every maker promises, and volumes against formulas.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::*;
use crate::Vec3;
use crate::shape::TriangleList;
use crate::shape::mesh_topology::{check_edges, drop_degenerate, drop_unused, recut_slivers, weld_equal};
use crate::shape::triangle_tree::TriangleTree;

const BOWL: Bowl = Bowl { radius: 2.0, foot_radius: 0.8, height: 1.2, thickness: 0.2, segments: 64 };
const MUG: Mug =
    Mug { radius: 0.4, height: 0.9, thickness: 0.05, handle_radius: 0.06, handle_reach: 0.28, segments: 48 };
const GEAR: Gear = Gear { teeth: 18, module: 0.1, half_width: 0.15, bore: 0.3 };
const CHAIR: Chair = Chair { width: 0.5, depth: 0.45, seat_height: 0.45, height: 0.95, bar: 0.05 };
const JACK: Jack = Jack { reach: 0.5, arm_radius: 0.07, knob_radius: 0.12, cells: 28 };
const TERRAIN: Terrain = Terrain { half_width: 10.0, height: 2.0, hill: 5.0, cells: 40, seed: 1 };
const TREFOIL: TorusKnot =
    TorusKnot { p: 2, q: 3, radius: 0.5, winding_radius: 0.22, tube_radius: 0.1, segments: 256, sides: 32 };

fn letter(letter: char) -> TriangleList {
    Letter { letter, height: 1.0, depth: 0.3 }.triangles().unwrap()
}

fn all() -> Vec<(String, TriangleList)> {
    let torus = Torus { radius: 0.4, tube_radius: 0.2, segments: 48, sides: 16 };
    let mut made = vec![
        ("torus".to_owned(), torus.triangles().unwrap()),
        ("ball".to_owned(), Ball { radius: 0.5, parts: 12 }.triangles().unwrap()),
        ("knot".to_owned(), TREFOIL.triangles().unwrap()),
        ("bowl".to_owned(), BOWL.triangles().unwrap()),
        ("odd bowl".to_owned(), Bowl { segments: 37, ..BOWL }.triangles().unwrap()),
        ("flat bowl".to_owned(), Bowl { height: 0.25, foot_radius: 1.7, ..BOWL }.triangles().unwrap()),
        ("mug".to_owned(), MUG.triangles().unwrap()),
        ("fine mug".to_owned(), Mug { segments: 96, ..MUG }.triangles().unwrap()),
        ("gear".to_owned(), GEAR.triangles().unwrap()),
        ("pinion".to_owned(), Gear { teeth: 6, bore: 0.1, ..GEAR }.triangles().unwrap()),
        ("wheel".to_owned(), Gear { teeth: 120, bore: 3.0, ..GEAR }.triangles().unwrap()),
        ("chair".to_owned(), CHAIR.triangles().unwrap()),
        ("jack".to_owned(), JACK.triangles().unwrap()),
        ("odd jack".to_owned(), Jack { cells: 35, ..JACK }.triangles().unwrap()),
        (
            "stick".to_owned(),
            Jack { arm_radius: 0.1, knob_radius: 0.1, cells: 16, ..JACK }.triangles().unwrap(),
        ),
    ];
    made.extend(('A'..='Z').map(|c| (format!("letter {c}"), letter(c))));
    made
}

/// By the divergence theorem. m³.
fn volume(list: &TriangleList) -> f64 {
    let six = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| list.vertices[i as usize].as_dvec3());
        a.dot(b.cross(c))
    };
    list.triangles.iter().map(six).sum::<f64>() / 6.0
}

/// The smallest angle of all triangles. Degrees.
fn smallest_angle(list: &TriangleList) -> f64 {
    let angles = list.triangles.iter().flat_map(|t| {
        let [a, b, c] = t.map(|i| list.vertices[i as usize].as_dvec3());
        [(a, b, c), (b, c, a), (c, a, b)].map(|(p, q, r)| (q - p).angle_between(r - p).to_degrees())
    });
    angles.fold(180.0, f64::min)
}

/// That nothing is to be mended: see [`Mesh::new`].
fn assert_whole(name: &str, list: &TriangleList) {
    let TriangleList { vertices, mut triangles } = list.clone();
    assert_eq!(weld_equal(&vertices, &mut triangles), 0, "{name}");
    assert_eq!(recut_slivers(&vertices, &mut triangles), 0, "{name}");
    assert_eq!(drop_degenerate(&vertices, &mut triangles), 0, "{name}");
    assert_eq!(drop_unused(vertices.clone(), &mut triangles).len(), vertices.len(), "{name}");
    check_edges(&vertices, &triangles).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(volume(list) > 0.0, "{name}");
}

/// Whether a segment goes through a triangle, by the signs of the volumes that they span (touching is not going through).
fn pierces([p, q]: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> bool {
    let side = |u: DVec3, v: DVec3, w: DVec3| (u - p).dot((v - p).cross(w - p));
    let from_q = |u: DVec3, v: DVec3, w: DVec3| (u - q).dot((v - q).cross(w - q));
    let edges = [side(a, b, q), side(b, c, q), side(c, a, q)];
    side(a, b, c) * from_q(a, b, c) < 0.0
        && (edges.iter().all(|x| *x > 0.0) || edges.iter().all(|x| *x < 0.0))
}

fn assert_does_not_cut_itself(name: &str, list: &TriangleList) {
    let place = |v: &u32| list.vertices[*v as usize];
    let tree = TriangleTree::new(&list.vertices, &list.triangles);
    for triangle in &list.triangles {
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let ends = [triangle[i], triangle[j]];
            let places = ends.each_ref().map(place);
            let mut pierced = false;
            tree.near(&crate::Aabb::around(places.into_iter()), |other| {
                let corners = list.triangles[other as usize];
                pierced |= !corners.iter().any(|v| ends.contains(v))
                    && pierces(
                        places.map(|v| v.as_dvec3()),
                        corners.each_ref().map(place).map(|v| v.as_dvec3()),
                    );
            });
            assert!(!pierced, "{name}: between {} and {}", places[0], places[1]);
        }
    }
}

#[test]
fn all_are_closed_wound_outwards_and_well_cut() {
    for (name, list) in all() {
        assert_whole(&name, &list);
        assert_does_not_cut_itself(&name, &list);
        let angle = smallest_angle(&list);
        assert!(angle > 3.0, "{name}: an angle of {angle} degrees");
    }
}

#[test]
fn plain_makers_have_the_triangles_that_they_say() {
    for (mesh, triangles) in [
        (torus(0.4, 0.2, 48, 16).unwrap(), 2 * 48 * 16),
        (ring(1.0, 0.5, 0.1, 60).unwrap(), 8 * 60),
        (ball(1.0, 1).unwrap(), 20),
        (ball(0.5, 12).unwrap(), 2880),
        (cuboid(Vec3::new(1.0, 2.0, 3.0)).unwrap(), 12),
        (frame(Vec3::new(0.5, 0.04, 0.5), 0.08).unwrap(), 2 * 32),
        (angle(1.0, 0.2, 0.1).unwrap(), 2 * 14),
    ] {
        assert!(mesh.has_inside() && mesh.repairs.is_none(), "{}", mesh.repairs);
        assert_eq!(mesh.triangles.len(), triangles);
    }
}

#[test]
fn a_balls_vertices_lie_on_it() {
    let mesh = ball(2.0, 7).unwrap();
    assert_eq!(mesh.vertices.len(), 10 * 49 + 2);
    assert!(mesh.vertices.iter().all(|v| (v.length() - 2.0).abs() < 1e-6));
}

#[test]
fn a_knot_has_the_volume_of_its_tube() {
    let length: f32 =
        (0..1000).map(|i| TREFOIL.point(i, 1000).distance(TREFOIL.point((i + 1) % 1000, 1000))).sum();
    // Pappus: section times the length of the middle line.
    let ratio = volume(&TREFOIL.triangles().unwrap()) / (f64::from(length) * PI * 0.01);
    assert!((0.97..1.0).contains(&ratio), "{ratio}");
}

#[test]
fn a_bowl_nears_the_volume_of_the_formula_from_below() {
    // A quarter ellipse with the half axes a, h outside a cylinder of the foot's radius f, turned about the axis.
    let filled = |a: f64, h: f64, f: f64| PI * h * (f * f + 0.5 * PI * f * a + 2.0 / 3.0 * a * a);
    // Pappus: half an octagon of the thickness, its middle half a thickness inside the rim.
    let rim = 2.0 * (0.25 * PI).sin() * 0.1 * 0.1 * 2.0 * PI * 1.9;
    let exact = filled(1.2, 1.2, 0.8) - filled(1.0, 1.0, 0.8) + rim;
    let short: Vec<f64> = [32, 64, 128]
        .map(|segments| 1.0 - volume(&Bowl { segments, ..BOWL }.triangles().unwrap()) / exact)
        .to_vec();
    assert!(
        short[0] < 0.02 && short[1] < 0.5 * short[0] && short[2] < 0.5 * short[1] && short[2] > 0.0,
        "{short:?}"
    );
}

#[test]
fn a_mug_has_the_volume_of_cup_and_handle() {
    let mug = Mug { segments: 256, ..MUG };
    let (r, h, t) = (0.4, 0.9, 0.05);
    // A cup with sharp edges, less what its three roundings take away (less than a half of a square of t / 2 each).
    let cup = PI * r * r * h - PI * (r - t) * (r - t) * (h - t);
    let roundings = 3.0 * (1.0 - PI / 4.0) * (0.5 * t) * (0.5 * t) * 2.0 * PI * r;
    // Half an ellipse with the half axes 0.28 and 0.55 / 2 of the height (Ramanujan's length).
    let (a, b) = (0.28, 0.5 * 0.55 * h);
    let length = 0.5 * PI * (3.0 * (a + b) - ((3.0 * a + b) * (a + 3.0 * b)).sqrt());
    let handle = length * PI * 0.06 * 0.06;
    let ratio = volume(&mug.triangles().unwrap()) / (cup - roundings + handle);
    assert!((0.99..1.01).contains(&ratio), "{ratio}");
}

#[test]
fn a_gear_has_the_area_between_its_involutes() {
    // Counted, not cut into triangles: a point of the plane is in the gear when the involute from the base circle at its radius is past its angle.
    let (teeth, module) = (18.0, 0.1);
    let (pitch, root, tip) = (0.9, 0.9 - 0.125, 1.0);
    let base = pitch * (20.0_f64).to_radians().cos();
    let inv = |a: f64| a.tan() - a;
    let half =
        |r: f64| (0.5 * PI - 0.08) / teeth + inv((20.0_f64).to_radians()) - inv((base / r).min(1.0).acos());
    let rings = 10_000;
    let width = (tip - root) / f64::from(rings);
    let tooth: f64 =
        (0..rings).map(|i| root + width * (f64::from(i) + 0.5)).map(|r| 2.0 * half(r) * r * width).sum();
    let area = teeth * tooth + PI * root * root - PI * 0.09;
    let ratio = volume(&GEAR.triangles().unwrap()) / (area * 0.3);
    assert!((ratio - 1.0).abs() < 0.01, "{ratio} at module {module}");
}

/// Whether a point is inside a closed line, by counting crossings.
fn inside(line: &[DVec2], p: DVec2) -> bool {
    let crossings = (0..line.len()).filter(|i| {
        let (a, b) = (line[*i], line[(i + 1) % line.len()]);
        (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)
    });
    crossings.count() % 2 == 1
}

#[test]
fn two_gears_of_one_module_mesh_without_cutting_each_other() {
    let (small, large) = (Gear { teeth: 14, ..GEAR }, Gear { teeth: 31, ..GEAR });
    let apart = f64::from(small.pitch_radius() + large.pitch_radius());
    let mut closest = f64::INFINITY;
    for step in 0..40 {
        let angle = 0.05 * f64::from(step);
        // The small one's tooth at +x meets a gap of the large one at -x.
        let turned = |gear: &Gear, angle: f64, x: f64| -> Vec<DVec2> {
            let turn = DVec2::from_angle(angle);
            gear.border().iter().map(|p| turn.rotate(*p) + DVec2::new(x, 0.0)).collect()
        };
        let a = turned(&small, angle, 0.0);
        // Tooth 15 of 31 is half a pitch past -x.
        let b = turned(&large, -angle * 14.0 / 31.0, apart);
        assert!(a.iter().all(|p| !inside(&b, *p)) && b.iter().all(|p| !inside(&a, *p)), "step {step}");
        for p in &a {
            closest = b.iter().fold(closest, |c, q| c.min(p.distance(*q)));
        }
    }
    assert!(closest < 0.02, "they are in mesh: {closest}");
}

#[test]
fn a_chair_has_the_volume_of_its_boards() {
    let (legs, seat) = (4.0 * 0.05 * 0.05 * 0.4, 0.5 * 0.45 * 0.05);
    let (posts, rail) = (2.0 * 0.05 * 0.05 * 0.4, 0.5 * 0.05 * 0.1);
    let exact = legs + seat + posts + rail;
    assert!((volume(&CHAIR.triangles().unwrap()) / exact - 1.0).abs() < 1e-5);
}

#[test]
fn letters_have_the_areas_of_their_strokes() {
    // In tenths of the height, by hand: boxes of strokes.
    for (c, area) in [('I', 20.0), ('L', 32.0), ('T', 32.0), ('F', 40.0), ('E', 52.0), ('H', 48.0)] {
        let found = volume(&letter(c)) / (0.01 * 0.3);
        assert!((found - area).abs() < 1e-3, "{c}: {found}");
    }
    // A hole: O is a box less four corners of 2, less a hole of 4 by 6 that has four corners of 0.5 back.
    let found = volume(&letter('O')) / (0.01 * 0.3);
    assert!((found - (80.0 - 8.0 - (24.0 - 2.0))).abs() < 1e-3, "{found}");
}

#[test]
fn a_jack_has_the_volume_of_its_field() {
    let list = Jack { cells: 64, ..JACK }.triangles().unwrap();
    for v in &list.vertices {
        assert!(JACK.distance(v.as_dvec3()).abs() < 1e-6, "{v}: {}", JACK.distance(v.as_dvec3()));
    }
    let n = 100;
    let cell = 0.5 / f64::from(n);
    let mut count = 0;
    for i in 0..n * n * n {
        let at = DVec3::new(f64::from(i % n), f64::from(i / n % n), f64::from(i / n / n)) + 0.5;
        count += i32::from(JACK.distance(at * cell) < 0.0);
    }
    let counted = 8.0 * f64::from(count) * cell * cell * cell;
    assert!((volume(&list) / counted - 1.0).abs() < 0.01, "{} {counted}", volume(&list));
}

#[test]
fn a_terrain_faces_up_stays_between_its_heights_and_does_not_jump() {
    let list = TERRAIN.triangles().unwrap();
    assert_eq!((list.vertices.len(), list.triangles.len()), (41 * 41, 2 * 40 * 40));
    let heights = || list.vertices.iter().map(|v| v.y);
    assert!(heights().all(|y| (0.0..=2.0).contains(&y)));
    assert!(heights().fold(0.0, f32::max) - heights().fold(2.0, f32::min) > 0.8, "hills");
    for triangle in &list.triangles {
        let [a, b, c] = triangle.map(|i| list.vertices[i as usize]);
        let normal = (b - a).cross(c - a).normalize();
        assert!(normal.y > 0.5, "{normal}");
    }
    let other = Terrain { seed: 2, ..TERRAIN }.triangles().unwrap();
    assert!(list.vertices.iter().zip(&other.vertices).any(|(a, b)| (a.y - b.y).abs() > 0.5));
}

#[test]
fn refuse_what_cannot_be() {
    assert_eq!(torus(0.2, 0.4, 48, 16).unwrap_err().field, "radius");
    assert_eq!(torus(0.4, 0.2, 2, 16).unwrap_err().field, "segments");
    assert_eq!(frame(Vec3::ONE, 1.0).unwrap_err().field, "width");
    assert_eq!(angle(1.0, f32::NAN, 0.1).unwrap_err().field, "width");
    assert_eq!(ball(1.0, 5000).unwrap_err().field, "parts");
    let field = |result: Result<TriangleList, ShapeError>| result.unwrap_err().field;
    assert_eq!(field(TorusKnot { tube_radius: 0.23, ..TREFOIL }.triangles()), "tube_radius");
    assert_eq!(field(TorusKnot { q: 4, ..TREFOIL }.triangles()), "q");
    assert_eq!(field(Bowl { thickness: 1.3, ..BOWL }.triangles()), "thickness");
    assert_eq!(field(Bowl { foot_radius: 1.9, ..BOWL }.triangles()), "foot_radius");
    assert_eq!(field(Mug { thickness: f32::INFINITY, ..MUG }.triangles()), "thickness");
    assert_eq!(field(Mug { handle_radius: 0.3, ..MUG }.triangles()), "handle_radius");
    assert_eq!(field(Mug { handle_reach: -1.0, ..MUG }.triangles()), "handle_reach");
    assert_eq!(field(Mug { segments: 16, radius: 0.8, ..MUG }.triangles()), "segments");
    assert_eq!(field(Gear { teeth: 5, ..GEAR }.triangles()), "teeth");
    assert_eq!(field(Gear { bore: 0.9, ..GEAR }.triangles()), "bore");
    assert_eq!(field(Chair { bar: 0.2, ..CHAIR }.triangles()), "bar");
    assert_eq!(field(Letter { letter: 'f', height: 1.0, depth: 0.1 }.triangles()), "letter");
    assert_eq!(field(Letter { letter: 'F', height: 1.0, depth: 11.0 }.triangles()), "depth");
    assert_eq!(field(Jack { arm_radius: 0.2, ..JACK }.triangles()), "arm_radius");
    assert_eq!(field(Jack { cells: 16, ..JACK }.triangles()), "cells");
    assert_eq!(field(Terrain { hill: 30.0, ..TERRAIN }.triangles()), "hill");
}
