//! Recorded hashes: the same bits as on every other machine, and as before the last change.

mod common;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use common::{Random, UNIT, cuboid, ground, pyramid, rain, run, world_of};
use forerun_dynamics::BodyDef;
use forerun_geometry::shape::mesh_make;
use forerun_geometry::{Shape, Vec3};

/// Set by `cargo xtask golden --bless`: write the hashes down instead of comparing them.
const BLESS: &str = "FORERUN_BLESS";

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(format!("{name}.txt"))
}

/// Frame and hash of all states, at frame 1 and at every 20th: the first line that differs says about when.
fn hashes(defs: &[BodyDef], frames: usize) -> String {
    let mut world = world_of(defs);
    // The rest are the defaults: to move one of them moves everybody's results. Rest comes early enough to be seen here.
    world.environment.settings.rest_seconds = 0.5;
    let mut lines = String::new();
    for frame in 1..=frames {
        run(&mut world, 1);
        if frame == 1 || frame.is_multiple_of(20) {
            writeln!(lines, "{frame} {:016x}", world.state_hash()).expect("a String takes everything");
        }
    }
    lines
}

fn compare(name: &str, defs: &[BodyDef], frames: usize) {
    let found = hashes(defs, frames);
    let path = file(name);
    if std::env::var_os(BLESS).is_some() {
        std::fs::write(&path, &found).expect("the folder of recorded hashes can be written");
        return;
    }
    let recorded = std::fs::read_to_string(&path).unwrap_or_default().replace('\r', "");
    assert!(
        found == recorded,
        "the step gives other bits than {}.\nrecorded (frame, hash):\n{recorded}found:\n{found}\
         If that is meant, record the new hashes with `cargo xtask golden --bless`, add a line under Determinism to CHANGELOG.md, and say \
         in the commit why they moved. If it is not, something in the step depends on the machine, the profile or the last change.",
        path.display()
    );
}

/// A pyramid that comes to rest and is shot at.
#[test]
fn boxes() {
    let mut defs = pyramid(5);
    let mut ball = cuboid(Vec3::splat(0.3), Vec3::new(2.0, 2.0, 20.0));
    ball.velocity = Vec3::new(0.0, 3.0, -15.0);
    defs.push(ball);
    compare("boxes", &defs, 120);
}

#[test]
fn spheres_capsules_and_boxes() {
    compare("spheres_capsules", &rain(48, 5), 120);
}

/// Falls in a heap at random over the ground.
fn heap(count: usize, shape: impl Fn(&mut Random, usize) -> Shape) -> Vec<BodyDef> {
    let mut r = Random(17);
    let mut defs = vec![ground()];
    for i in 0..count {
        let shape = shape(&mut r, i);
        let at = Vec3::new(0.5 * (i % 3) as f32, 1.0 + 0.9 * (i / 3) as f32, 0.3 * (i % 2) as f32);
        let mut def = BodyDef::new(shape).at(at);
        def.pose.rotation = r.rotation();
        defs.push(def);
    }
    defs
}

#[test]
fn hulls_and_cylinders() {
    let shape = |r: &mut Random, i: usize| {
        if i.is_multiple_of(2) {
            return Shape::cylinder(r.between(0.2, 0.4), r.between(0.2, 0.4)).expect("sizes are above 0");
        }
        let mut number = || r.between(-0.4, 0.4);
        let points: Vec<Vec3> = (0..20).map(|_| Vec3::new(number(), number(), number())).collect();
        Shape::hull(&points).expect("the points fill space")
    };
    compare("hulls_cylinders", &heap(15, shape), 100);
}

/// Rings that fall over each other and a box.
#[test]
fn mesh_tori() {
    let torus = Shape::from(mesh_make::torus(0.4, 0.15, 24, 12).expect("a plain torus"));
    let mut defs = heap(6, |_, _| torus.clone());
    defs.push(cuboid(UNIT, Vec3::new(0.5, 6.0, 0.0)));
    compare("mesh_tori", &defs, 80);
}
