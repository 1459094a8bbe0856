//! Tests of bolts and nuts: volumes, and where the triangles are.

use super::*;
use crate::shape::{MeshDraft, MeshOptions};

const THREAD: Thread = Thread { radius: 0.005, pitch: 0.0015 };

fn any_bolt(head: Grip) -> Bolt {
    Bolt { thread: THREAD, length: 0.02, head_radius: 0.008, head_height: 0.006, head, segments: 48 }
}

fn any_nut(outside: Grip) -> Nut {
    Nut { thread: THREAD, clearance: 0.0001, height: 0.008, outer_radius: 0.008, outside, segments: 48 }
}

fn corners(list: &TriangleList) -> impl Iterator<Item = [DVec3; 3]> {
    list.triangles.iter().map(|t| t.map(|i| list.vertices[i as usize].as_dvec3()))
}

fn volume(list: &TriangleList) -> f64 {
    corners(list).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// Mean of the square of the radius over a pitch, by a formula of its own: flat crest (1/8), flat root (1/4), flanks between.
fn mean_square(crest: f64) -> f64 {
    let root = crest - 0.625 * 0.75_f64.sqrt() * f64::from(THREAD.pitch);
    crest * crest / 8.0 + root * root / 4.0 + 0.625 * (crest * crest + crest * root + root * root) / 3.0
}

#[test]
fn bolts_and_nuts_are_closed_and_outwards_without_repairs() {
    for grip in [Grip::Hexagonal, Grip::Round] {
        for list in [any_bolt(grip).triangles().unwrap(), any_nut(grip).triangles().unwrap()] {
            // Coarse: the field does not matter here.
            let options = MeshOptions { cell: Some(0.001), ..MeshOptions::default() };
            let draft = MeshDraft::new(list.vertices, list.triangles, options).unwrap();
            let mesh = draft.bake(&|_, _| {}).unwrap();
            assert!(mesh.has_inside() && mesh.repairs.is_none(), "{}", mesh.repairs);
        }
    }
}

#[test]
fn volumes_are_those_of_the_profile() {
    // A regular polygon of n corners has this part of its circle's area.
    let polygon = 48.0 / TAU * (TAU / 48.0).sin();
    let circle = std::f64::consts::PI;
    let made = volume(&any_bolt(Grip::Round).triangles().unwrap());
    let shank = circle * polygon * mean_square(0.005) * 0.02;
    let head = circle * polygon * 0.008 * 0.008 * 0.006;
    // The chamfer takes a little off the last pitch.
    assert!((0.985..1.0).contains(&(made / (shank + head))), "{}", made / (shank + head));
    let made = volume(&any_nut(Grip::Hexagonal).triangles().unwrap());
    let outside = 2.0 * 3.0_f64.sqrt() * 0.008 * 0.008 * 0.008;
    let hole = circle * polygon / (0.5 * TAU / 48.0).cos().powi(2) * mean_square(0.0051) * 0.008;
    assert!((0.985..1.0).contains(&(made / (outside - hole))), "{}", made / (outside - hole));
}

#[test]
fn triangles_lie_on_the_true_thread_all_round() {
    // From column to column an arc of 5 mm radius rises by this much over its chord.
    let sagitta = 0.005 * (1.0 - (0.5 * TAU / 48.0).cos());
    let below_chamfer = |p: &DVec3| p.y > -0.018 && p.y < -1e-5;
    let mut met = 0;
    for corners in corners(&any_bolt(Grip::Round).triangles().unwrap()) {
        if !corners.iter().all(below_chamfer) || corners.iter().any(|p| p.x.hypot(p.z) > 0.0051) {
            continue;
        }
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        for p in corners.into_iter().chain([middle]) {
            let off = p.x.hypot(p.z) - THREAD.radius_at((-p.z).atan2(p.x), p.y);
            assert!(off < 1e-8 && off > -2.0 * sagitta, "{off} at {p}");
        }
        met += 1;
    }
    assert!(met > 48 * 12 * 11, "{met} triangles of the thread");
}

#[test]
fn the_thread_is_right_handed() {
    // A quarter of a turn about +y, from +x to -z, raises the crest by a quarter of the pitch.
    let up = 0.25 * f64::from(THREAD.pitch);
    assert!((THREAD.radius_at(0.25 * TAU, up) - 0.005).abs() < 1e-9);
    let list = any_bolt(Grip::Round).triangles().unwrap();
    let crest = |v: &&crate::Vec3| v.y < -0.005 && (v.x.hypot(v.z) - 0.005).abs() < 1e-7;
    let before = list.vertices.iter().filter(crest).find(|v| v.x.abs() < 1e-7 && v.z < 0.0).unwrap();
    let phase = f64::from(before.y) / f64::from(THREAD.pitch) - 0.25;
    assert!((phase - phase.round()).abs() < 0.0626, "{phase}");
}

#[test]
fn a_nut_keeps_its_distance_from_the_bolt() {
    for corners in corners(&any_nut(Grip::Round).triangles().unwrap()) {
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        for p in corners.into_iter().chain([middle]).filter(|p| p.y.abs() < 0.003) {
            let gap = p.x.hypot(p.z) - THREAD.radius_at((-p.z).atan2(p.x), p.y);
            assert!(gap > 0.000_099, "{gap} at {p}");
        }
    }
}

#[test]
fn refuse_what_cannot_be() {
    let refused = |change: fn(&mut Bolt)| {
        let mut made = any_bolt(Grip::Hexagonal);
        change(&mut made);
        made.check().unwrap_err().field
    };
    assert_eq!(refused(|b| b.segments = 50), "segments");
    assert_eq!(refused(|b| b.thread.pitch = 0.006), "pitch");
    assert_eq!(refused(|b| b.head_radius = f32::NAN), "head_radius");
    assert_eq!(refused(|b| b.length = 0.001), "length");
    let nut = any_nut(Grip::Round);
    assert_eq!(Nut { outer_radius: 0.0052, ..nut }.check().unwrap_err().field, "outer_radius");
    assert_eq!(Nut { clearance: -0.1, ..nut }.check().unwrap_err().field, "clearance");
}

#[test]
fn limits_are_those_that_are_documented() {
    let says = |checked: Result<(), ShapeError>, field: &str, expected: &str| {
        let error = checked.unwrap_err();
        assert!(error.field == field && error.message.contains(expected), "{error:?}");
    };
    let (bolt, nut) = (any_bolt(Grip::Round), any_nut(Grip::Round));
    assert!(bolt.check().is_ok() && nut.check().is_ok());
    says(Bolt { head_radius: 0.005, ..bolt }.check(), "head_radius", "above radius (0.005), is 0.005");
    says(Bolt { head_radius: f32::INFINITY, ..bolt }.check(), "head_radius", "finite");
    says(
        Bolt { length: 0.001, ..bolt }.check(),
        "length",
        "from one to a thousand pitches (0.0015 to 1.5 m)",
    );
    let mouth = (nut.mouth() * nut.chord()) as f32;
    says(Nut { outer_radius: mouth, ..nut }.check(), "outer_radius", "above that of the thread's mouths");
    says(Nut { clearance: -0.1, ..nut }.check(), "clearance", "0 or more");
    says(Nut { height: f32::NAN, ..nut }.check(), "height", "pitches");
    let coarse = Thread { radius: 0.005, pitch: 0.006 };
    says(Bolt { thread: coarse, ..bolt }.check(), "pitch", "at most radius (0.005), is 0.006");
}
