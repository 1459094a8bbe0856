//! Cases with an answer in closed form, second part: impacts, free rotation, precession.

use forerun_geometry::Vec3;

use super::parts::{box_part, cuboid, cylinder, ground, radians, sphere, turn};
use crate::{BodyEntry, Scene, ShapeEntry};

/// The frame at which these cases are judged.
const FRAME: f32 = 1.0 / 240.0;

/// 49 elastic balls keep their energy (SimBenchmark's bouncing).
pub(super) fn a07(_: u32) -> Scene {
    let mut scene = Scene::new("a07", "49 elastic balls bounce and must neither gain nor lose energy.");
    scene.put(ground().surface(0.0, 1.0));
    for i in 0..49 {
        let place = Vec3::new(2.0 * (i / 7) as f32, 5.0, 2.0 * (i % 7) as f32);
        scene.put(sphere(0.1).of_mass(10.0).surface(0.0, 1.0).at(place));
    }
    scene.timed(20.0, 0.004, 9.81)
}

fn free_rotation(name: &str, body: BodyEntry, seconds: f32) -> Scene {
    let mut scene = Scene::new(name, "A body turns freely: angular momentum and energy stay.");
    scene.put(body.named("body"));
    scene.timed(seconds, FRAME, 0.0)
}

fn book(spin: Vec3) -> BodyEntry {
    cuboid(0.35, 0.08, 0.5).spinning(spin)
}

/// About the intermediate axis: it flips at 2.8992 s and every 5.2802 s after.
pub(super) fn a09a(_: u32) -> Scene {
    free_rotation("a09a", book(Vec3::new(5.0, 0.01, 0.01)), 30.0)
}

/// About the axis of the largest moment: it does not flip.
pub(super) fn a09b(_: u32) -> Scene {
    free_rotation("a09b", book(Vec3::new(0.01, 5.0, 0.01)), 30.0)
}

/// About the axis of the smallest moment: it does not flip.
pub(super) fn a09c(_: u32) -> Scene {
    free_rotation("a09c", book(Vec3::new(0.01, 0.01, -5.0)), 30.0)
}

/// A cylinder turns about all axes at once, for 300 s.
pub(super) fn a09d(_: u32) -> Scene {
    free_rotation("a09d", cylinder(0.25, 1.0).spinning(Vec3::ONE), 300.0)
}

/// A ball hits `target` 0.4 m off its centre.
fn off_centre(name: &str, target: BodyEntry) -> Scene {
    let mut scene =
        Scene::new(name, "A ball hits a free body off its centre: momentum and angular momentum stay.");
    scene.put(target.named("target").of_mass(2.0).surface(0.0, 0.5));
    let ball = sphere(0.1).named("ball").of_mass(1.0).surface(0.0, 0.5);
    scene.put(ball.at(Vec3::new(0.4, -0.25, 0.0)).moving(Vec3::Y * 2.0));
    scene.timed(1.0, FRAME, 0.0)
}

/// A rod: ball 0.775757 m/s, rod 0.612121 m/s and 2.909092 rad/s after the impact.
pub(super) fn a11a(_: u32) -> Scene {
    off_centre("a11a", cuboid(0.5, 0.05, 0.05))
}

/// An L of two boxes.
pub(super) fn a11b(_: u32) -> Scene {
    let parts = vec![box_part([0.5, 0.05, 0.05], [0.0; 3]), box_part([0.05, 0.2, 0.05], [-0.45, 0.25, 0.0])];
    off_centre("a11b", BodyEntry::new(ShapeEntry::Compound(parts)))
}

fn spinning_drop(name: &str, friction: f32) -> Scene {
    let mut scene = Scene::new(name, "A spinning ball falls on the floor, and friction makes it run away.");
    scene.put(ground().surface(friction, 0.5));
    let ball = sphere(1.0).named("ball").surface(friction, 0.5);
    scene.put(ball.at(Vec3::new(-4.0, 10.0, 0.0)).spinning(Vec3::X * -10.0));
    scene.timed(15.0, FRAME, 9.8)
}

/// Friction 0.8 sticks at the first impact: 2.857 m/s along -z, 2.857 rad/s, rebound 6.6408 m/s.
pub(super) fn a12a(_: u32) -> Scene {
    spinning_drop("a12a", 0.8)
}

/// Friction 0.05 slides: 0.99612 m/s and 7.5097 rad/s after the first impact.
pub(super) fn a12b(_: u32) -> Scene {
    spinning_drop("a12b", 0.05)
}

/// A tilted disc precesses at sqrt(4 g / (a sin tilt)): 55.3 rad/s at 20 degrees. `tilt` in degrees.
pub(super) fn a16a(tilt: u32) -> Scene {
    const RADIUS: f32 = 0.0375;
    const HALF_THICKNESS: f32 = 0.0005;
    let mut scene =
        Scene::new("a16a", "A tilted disc rolls round on its rim at a steady rate (Euler's disc).");
    scene.put(ground().surface(0.8, 0.0));
    let angle = radians(tilt as f32);
    let (sin, cos) = libm::sincosf(angle);
    // The lowest point of the rim touches the ground; from there to the centre points `up_the_disc`.
    let up_the_disc = Vec3::new(cos, sin, 0.0);
    let rate = (4.0 * 9.81 / (RADIUS * sin)).sqrt();
    let disc = cylinder(RADIUS, HALF_THICKNESS).named("disc").of_density(8000.0).surface(0.8, 0.0);
    let height = RADIUS * sin + HALF_THICKNESS * cos;
    scene.put(disc.at(Vec3::Y * height).turned(turn(Vec3::Z, angle)).spinning(up_the_disc * (rate * sin)));
    scene.timed(2.0, 1.0 / 1000.0, 9.81)
}

fn upright_disc(name: &str, speed: f32) -> Scene {
    const RADIUS: f32 = 0.1;
    let mut scene = Scene::new(name, "A disc rolls upright: stable above 0.57 m/s, below it falls over.");
    scene.put(ground().surface(0.8, 0.0));
    // The axis, y of the cylinder, is put along z and then leant over by 0.01 rad about the way it rolls, x.
    let lean = std::f32::consts::FRAC_PI_2 - 0.01;
    let rotation = turn(Vec3::X, lean);
    let axis = rotation * Vec3::Y;
    let half_thickness = 0.001;
    let (sin, cos) = libm::sincosf(0.01);
    let height = RADIUS * cos + half_thickness * sin;
    let disc = cylinder(RADIUS, half_thickness).named("disc").surface(0.8, 0.0);
    let body = disc.at(Vec3::Y * height).turned(rotation).moving(Vec3::X * speed);
    scene.put(body.spinning(axis * (-speed / RADIUS)));
    scene.timed(3.0, 1.0 / 1000.0, 9.81)
}

/// 0.8 m/s: stays up.
pub(super) fn a16b(_: u32) -> Scene {
    upright_disc("a16b", 0.8)
}

/// 0.3 m/s: falls.
pub(super) fn a16c(_: u32) -> Scene {
    upright_disc("a16c", 0.3)
}

/// Five balls in a row, hit by a sixth at 20 m/s.
fn chain(name: &str, gap: f32, restitution: f32) -> Scene {
    let mut scene = Scene::new(name, "A ball hits a row of five: how much goes through to the last.");
    let ball = sphere(1.0).surface(0.0, restitution);
    scene.put(ball.clone().named("cue").at(Vec3::X * -30.0).moving(Vec3::X * 20.0));
    for i in 0..5 {
        scene.put(ball.clone().at(Vec3::X * ((2.0 + gap) * (i as f32 - 2.0))));
    }
    scene.timed(10.0, FRAME, 0.0)
}

/// Gaps, restitution 1: the last leaves with all of it.
pub(super) fn a19a(_: u32) -> Scene {
    chain("a19a", 0.02, 1.0)
}

/// Gaps, restitution 0.9: the last leaves with 0.77378 of it.
pub(super) fn a19b(_: u32) -> Scene {
    chain("a19b", 0.02, 0.9)
}

/// Touching, restitution 1: momentum stays, energy does not grow.
pub(super) fn a19c(_: u32) -> Scene {
    chain("a19c", 0.0, 1.0)
}

/// On the ground with friction: the cue ball rolls at 14.2857 m/s after 19.99 m.
pub(super) fn a19d(_: u32) -> Scene {
    let mut scene = chain("a19d", 0.0, 1.0).timed(10.0, FRAME, 9.8);
    // Between ball and ground friction 0.5 for the cue ball and 0.3 for the others, restitution 0: the larger of two would be the
    // balls' 1, so the ground cannot have less; a ball that rests does not bounce all the same.
    for (i, body) in scene.bodies.iter_mut().enumerate() {
        body.friction = Some(if i == 0 { 0.5 } else { 0.3 });
        body.position[1] = 1.0;
    }
    scene.put(ground().surface(0.5, 0.0));
    scene
}
