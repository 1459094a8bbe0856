//! Euler's disc: steady precession of a tilted coin, and whether a coin that rolls upright falls.
//!
//! McDonald and McDonald, *The rolling motion of a disk on a horizontal plane* (arXiv physics/0008227): with its centre at rest a thin disc of
//! radius a precesses at Ω² = 4 g / (a sin α); rolling upright is stable above v² = g a / 3.

use forerun::dynamics::{BodyDef, Mass, Material};
use forerun::geometry::shape::Cylinder;
use forerun::geometry::{Quat, Shape, Vec3};

use crate::validate::Figure;
use crate::validate::lab::{angle_between, doubled, environment, watch, world};

const G: f64 = 9.81;
const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);
/// The formula is for no thickness; 1 mm changes the rate by 0.3 %.
const HALF_HEIGHT: f32 = 0.0005;
const DENSITY: f32 = 8000.0;
const FRICTION: f32 = 0.8;
/// Frames a second, and what the precession may be off, as a part.
const RATES: [(u32, f64); 2] = [(1000, 0.05), (4000, 0.02)];
/// The rate at which the loss of tilt is judged. Degrees a second.
const LOSS_RATE: u32 = 4000;
const LOSS_MAX: f64 = 3.0;
/// A coin that leans by more has fallen. Degrees.
const FALLEN: f64 = 45.0;
const UPRIGHT: f64 = 3.0;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for (rate, off) in RATES {
        precession(20.0, rate, Some(off), &mut figures);
        precession(10.0, rate, None, &mut figures);
        let (fast, slow) = (lean(0.8, rate), lean(0.3, rate));
        let name = |what: &str| format!("(b) 1/{rate}: most lean at {what}, degrees");
        figures.push(Figure::at_most(name("0.8 m/s"), fast, UPRIGHT));
        figures.push(Figure::at_least(name("0.3 m/s"), slow, FALLEN));
    }
    figures
}

fn turn_about_z(angle: f64) -> Quat {
    let (sin, cos) = (0.5 * angle).sin_cos();
    Quat::from_xyzw(0.0, 0.0, sin as f32, cos as f32)
}

fn coin(radius: f64) -> BodyDef {
    let shape = Cylinder { half_height: HALF_HEIGHT, radius: radius as f32 };
    let mut def = BodyDef::new(Shape::Cylinder(shape));
    def.mass = Mass::Density(DENSITY);
    def.material = Material::new(FRICTION, 0.0);
    def
}

fn ground() -> BodyDef {
    let mut def = BodyDef::fixed(Shape::half_space());
    def.material = Material::new(FRICTION, 0.0);
    def
}

/// (a) The rate of precession over the first second, and how fast the tilt is lost over two.
fn precession(degrees: f64, rate: u32, off: Option<f64>, figures: &mut Vec<Figure>) {
    let (radius, tilt) = (0.0375, degrees.to_radians());
    let expected = (4.0 * G / (radius * tilt.sin())).sqrt();
    let mut def = coin(radius);
    // Tilted about z: the rim is lowest towards -x, and the way from there to the centre is the disc's own x axis.
    def.pose.rotation = turn_about_z(tilt);
    def.pose.position.y = (radius * tilt.sin() + f64::from(HALF_HEIGHT) * tilt.cos()) as f32;
    let uphill = Vec3::new(tilt.cos() as f32, tilt.sin() as f32, 0.0);
    def.angular_velocity = uphill * (expected * tilt.sin()) as f32;
    let mut world = world(environment(GRAVITY, rate), &[ground(), def]);
    let (mut before, mut turned, mut in_first_second) = (None, 0.0f64, 0.0);
    let mut lost = [0.0; 2];
    watch(&mut world, 2.0, |time, states| {
        let normal = doubled(states[1].rotation * Vec3::Y);
        let azimuth = normal[2].atan2(normal[0]);
        if let Some(before) = before {
            let step: f64 = azimuth - before;
            turned += step - std::f64::consts::TAU * (step / std::f64::consts::TAU).round();
        }
        before = Some(azimuth);
        let now = angle_between(normal, [0.0, 1.0, 0.0]);
        if time < 1.0 + 1e-9 {
            in_first_second = turned.abs() / time;
            lost[0] = degrees - now;
        }
        lost[1] = (degrees - now) / 2.0;
    });
    let name = |what: &str| format!("(a) {degrees}°, 1/{rate}: {what}");
    let error = (in_first_second / expected - 1.0).abs();
    let (rate_name, loss_name) =
        (name("precession off, part"), name("loss of tilt in the first second, degrees"));
    figures.push(match off {
        Some(off) => Figure::at_most(rate_name, error, off),
        None => Figure::reported(rate_name, error),
    });
    figures.push(if off.is_some() && rate == LOSS_RATE {
        Figure::at_most(loss_name, lost[0], LOSS_MAX)
    } else {
        Figure::reported(loss_name, lost[0])
    });
    figures.push(Figure::reported(name("loss of tilt over 2 s, degrees a second"), lost[1]));
}

/// (b) The most lean from upright of a disc that rolls at a speed (m/s) with a lean of 0.01 rad at first. Degrees, over 3 s.
fn lean(speed: f64, rate: u32) -> f64 {
    let (radius, first) = (0.1, 0.01f64);
    let mut def = coin(radius);
    // The axis along z, tipped up by the lean; it rolls towards +x.
    let angle = 0.5 * (std::f64::consts::FRAC_PI_2 - first);
    def.pose.rotation = Quat::from_xyzw(angle.sin() as f32, 0.0, 0.0, angle.cos() as f32);
    def.pose.position.y = (radius * first.cos() + f64::from(HALF_HEIGHT) * first.sin()) as f32;
    def.velocity = Vec3::new(speed as f32, 0.0, 0.0);
    let axis = def.pose.rotation * Vec3::Y;
    def.angular_velocity = -axis * (speed / radius) as f32;
    let mut world = world(environment(GRAVITY, rate), &[ground(), def]);
    let mut most = 0.0f64;
    watch(&mut world, 3.0, |_, states| {
        let axis = doubled(states[1].rotation * Vec3::Y);
        most = most.max((90.0 - angle_between(axis, [0.0, 1.0, 0.0])).abs());
    });
    most
}
