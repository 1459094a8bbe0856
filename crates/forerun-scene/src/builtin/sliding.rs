//! Cases with an answer in closed form, first part: sliding, rolling, friction on turning surfaces.

use std::f32::consts::PI;

use forerun_geometry::{Quat, Vec3};

use super::parts::{Incline, cube, cylinder, ground, mesh, radians, sphere, turn};
use crate::command_entry::VelocityEntry;
use crate::mesh::BallEntry;
use crate::{BodyEntry, BodyRef, CommandEntry, KindEntry, MeshEntry, Scene};

/// The frame at which these cases are judged.
const FRAME: f32 = 1.0 / 240.0;

/// A plane through the origin that falls towards +x.
fn plane(incline: &Incline, friction: f32, restitution: f32) -> BodyEntry {
    ground().named("plane").turned(incline.rotation).surface(friction, restitution)
}

/// A block on a slope of 20 degrees slides 0.6237 m in 0.9978 s and stops. Restitution 1 must not make it hop.
pub(super) fn a01a(_: u32) -> Scene {
    block_on_slope("a01a", 0.5, 1.25).timed(12.0, FRAME, 9.8)
}

/// The same with friction 0.25, from rest: 2.099 m/s after 2 s.
pub(super) fn a01b(_: u32) -> Scene {
    block_on_slope("a01b", 0.25, 0.0).timed(3.0, FRAME, 9.8)
}

fn block_on_slope(name: &str, friction: f32, speed: f32) -> Scene {
    let mut scene =
        Scene::new(name, "A block slides down a slope of 20 degrees; restitution 1 must not make it hop.");
    let incline = Incline::new(radians(20.0));
    scene.put(plane(&incline, friction, 1.0));
    let block = cube(0.05).named("block").of_mass(1.0).surface(friction, 1.0);
    scene.put(block.at(incline.normal * 0.05).turned(incline.rotation).moving(incline.down * speed));
    scene
}

/// Three cubes slide to a stop after 40.816 m, whatever their mass and load.
pub(super) fn a01c(_: u32) -> Scene {
    let mut scene = Scene::new("a01c", "Three cubes of different mass and load slide equally far, 40.8 m.");
    scene.put(ground().surface(0.5, 1.0));
    for (name, z, mass) in [("light", -4.0, 1.0), ("heavy", 0.0, 2.0), ("loaded", 4.0, 1.0)] {
        let block = cube(1.0).named(name).of_mass(mass).surface(0.5, 1.0);
        scene.put(block.at(Vec3::new(0.0, 1.0, z)).moving(Vec3::X * 20.0));
    }
    // Friction 2 between the two: the geometric mean of 0.5 and 8.
    let load = cube(1.0).named("load").of_mass(1.0).surface(8.0, 1.0);
    scene.put(load.at(Vec3::new(0.0, 3.0, 4.0)).moving(Vec3::X * 20.0));
    scene.timed(6.0, FRAME, 9.8)
}

/// What rolls in the cases a04: a body whose axis is z, and its friction with the plane.
fn rolling(name: &str, tilt: u32, (body, friction): (BodyEntry, f32)) -> Scene {
    let mut scene = Scene::new(name, "A round body rolls down a plane tilted by a multiple of 4.5 degrees.");
    let incline = Incline::new(tilt as f32 * (PI / 40.0));
    scene.put(plane(&incline, friction, 0.0));
    scene.put(body.named("roller").surface(friction, 0.0).at(incline.normal));
    scene.timed(5.0, FRAME, 9.8)
}

/// A ball rolls: it drops by 5/14 g t² sin² of the tilt.
pub(super) fn a04a(tilt: u32) -> Scene {
    rolling("a04a", tilt, (sphere(1.0).of_mass(1.0), 1.0))
}

/// A solid cylinder rolls: 2/3 of g sin.
pub(super) fn a04b(tilt: u32) -> Scene {
    rolling("a04b", tilt, (cylinder(1.0, 1.0).of_mass(1.0).turned(lying()), 1.0))
}

/// A hoop rolls: 1/2 of g sin. A cylinder with the moments of inertia of a thin hoop.
pub(super) fn a04c(tilt: u32) -> Scene {
    let mut hoop = cylinder(1.0, 0.25).of_mass(1.0).turned(lying());
    let across = 0.5 + 0.5 * 0.5 / 12.0;
    hoop.inertia = Some([across, 1.0, across]);
    rolling("a04c", tilt, (hoop, 1.0))
}

/// A ball slips: g (sin - friction cos).
pub(super) fn a04d(tilt: u32) -> Scene {
    rolling("a04d", tilt, (sphere(1.0).of_mass(1.0), 0.05))
}

/// A ball of 2420 triangles rolls.
pub(super) fn a04e(tilt: u32) -> Scene {
    let mut scene = rolling("a04e", tilt, (mesh("ball").of_mass(1.0), 1.0));
    scene.meshes.insert("ball".to_owned(), MeshEntry::from(BallEntry { radius: 1.0, parts: 11 }));
    scene
}

/// A cylinder's axis, y, put along z.
fn lying() -> Quat {
    turn(Vec3::X, 0.5 * PI)
}

/// 32 cubes slide outwards equally far, 52.083 m, in all directions.
pub(super) fn a06a(_: u32) -> Scene {
    let mut scene = Scene::new("a06a", "32 cubes slide outwards: friction is the same in all directions.");
    scene.put(ground().surface(0.6, 0.0));
    for i in 0..32 {
        let angle = i as f32 * (PI / 16.0);
        let (sin, cos) = libm::sincosf(angle);
        let outward = Vec3::new(cos, 0.0, sin);
        let block = cube(1.0).surface(0.6, 0.0).at(outward * 15.0 + Vec3::Y);
        scene.put(block.turned(turn(Vec3::Y, -angle)).moving(outward * 25.0));
    }
    scene.timed(5.0, 1.0 / 60.0, 10.0)
}

/// A spinning cube is braked by friction at its face, and stays in its place.
pub(super) fn a06b(_: u32) -> Scene {
    let mut scene =
        Scene::new("a06b", "A cube spins on its face and is braked: 4.90 rad/s are left after 1 s.");
    // The geometric mean of 0.2 and 0.3 is the 0.244949 of the case.
    scene.put(ground().surface(0.2, 0.0));
    let block = cube(1.0).named("cube").surface(0.3, 0.0);
    scene.put(block.at(Vec3::Y * 0.999).spinning(Vec3::Y * 10.0));
    scene.timed(1.0, 1.0 / 60.0, 9.81)
}

/// A cube on a disc whose spin grows by 0.05 rad/s²; it slips at sqrt(friction g / 1.5 m).
fn turntable(name: &str, friction: f32, until: f32) -> Scene {
    let mut scene =
        Scene::new(name, "A cube on a turntable slips when the turntable is too fast for its friction.");
    let disc = BodyEntry { kind: KindEntry::Kinematic, ..cylinder(2.0, 0.05) };
    scene.put(disc.named("turntable").surface(friction, 0.0).at(Vec3::Y * -0.05));
    scene.put(cube(0.125).named("cube").surface(friction, 0.0).at(Vec3::new(1.5, 0.125, 0.0)));
    let steps = (until / 0.05 * 60.0).round() as u32;
    for i in 1..=steps {
        let seconds = i as f32 / 60.0;
        let spin = VelocityEntry {
            body: BodyRef::Name("turntable".to_owned()),
            velocity: [0.0; 3],
            angular_velocity: [0.0, 0.05 * seconds, 0.0],
        };
        let seconds = Some(seconds);
        scene.commands.push(CommandEntry { seconds, set_velocity: Some(spin), ..CommandEntry::default() });
    }
    scene.timed(until / 0.05, FRAME, 9.8)
}

/// Friction 0.1: slips at 0.80829 rad/s.
pub(super) fn a18a(_: u32) -> Scene {
    turntable("a18a", 0.1, 0.95)
}

/// Friction 0.5: slips at 1.80739 rad/s.
pub(super) fn a18b(_: u32) -> Scene {
    turntable("a18b", 0.5, 2.1)
}

/// Friction 1: slips at 2.55604 rad/s.
pub(super) fn a18c(_: u32) -> Scene {
    turntable("a18c", 1.0, 2.95)
}

/// Friction 0.5 at a constant 1.6 rad/s: the cube goes round with the disc.
pub(super) fn a18d(_: u32) -> Scene {
    let mut scene = turntable("a18d", 0.5, 0.0);
    let spin = Vec3::Y * 1.6;
    for body in &mut scene.bodies {
        body.angular_velocity = spin.to_array();
        body.velocity = spin.cross(Vec3::from_array(body.position)).to_array();
    }
    scene.seconds = 20.0;
    scene
}
