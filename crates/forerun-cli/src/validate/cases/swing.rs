//! Swing: a body hangs on a round peg by a notch, without friction, and swings as a physical pendulum: it keeps its time and its energy.
//!
//! Textbook: two planes of the body touch the peg wherever it has swung to, so that it turns about the peg's axis. From an angle `a` at rest its period is
//! 2 π √((I + m L²) / m g L) (1 + a² / 16 + 11 a⁴ / 3072), and its energy above the lowest point m g L (1 - cos a).

use std::f64::consts::{FRAC_PI_4, TAU};

use forerun::dynamics::{BodyDef, Mass, Material};
use forerun::geometry::shape::{Capsule, Cuboid};
use forerun::geometry::{Pose, Quat, Shape, Vec3};

use crate::validate::Figure;
use crate::validate::lab::{environment, kinetic_energy, watch, world};

const G: f64 = 9.81;
/// From the peg's axis to the centre of mass. Metres.
const LENGTH: f64 = 0.7;
const PEG_RADIUS: f32 = 0.05;
/// Half the thickness of the two slabs of the notch. Metres.
const SLAB: f32 = 0.03;
/// About the centre of mass, for 1 kg. kg m²
const INERTIA: f64 = 0.05;
/// Radians.
const START: f64 = 0.3;
const SECONDS: f64 = 20.0;
/// Frames a second.
const RATES: [u32; 2] = [60, 240];
const PERIOD_OFF: f64 = 0.01;
const GROWTH_MAX: f64 = 0.02;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for rate in RATES {
        swing(rate, &mut figures);
    }
    figures
}

/// About z.
fn turn(angle: f64) -> Quat {
    let (sin, cos) = (0.5 * angle).sin_cos();
    Quat::from_xyzw(0.0, 0.0, sin as f32, cos as f32)
}

/// The peg along z through the origin, and what hangs on it, aside by [`START`].
fn defs() -> [BodyDef; 2] {
    let material = Material::new(0.0, 0.0);
    let capsule = Shape::Capsule(Capsule { half_height: 0.5, radius: PEG_RADIUS });
    let mut peg = BodyDef::fixed(capsule);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    peg.pose.rotation = Quat::from_xyzw(half, 0.0, 0.0, half);
    peg.material = material;
    // The inner faces of both slabs touch the peg.
    let slab = |angle: f64| {
        let rotation = turn(angle);
        let cuboid = Cuboid { half_extents: Vec3::new(0.15, SLAB, 0.1) };
        (Pose::new(rotation * Vec3::Y * (PEG_RADIUS + SLAB), rotation), Shape::Cuboid(cuboid))
    };
    // Two parts, neither of them endless.
    let notch = Shape::compound(vec![slab(FRAC_PI_4), slab(-FRAC_PI_4)]).expect("two slabs are possible");
    let mut body = BodyDef::new(notch);
    body.pose.rotation = turn(START);
    body.mass = Mass::Given {
        mass: 1.0,
        centre: Vec3::new(0.0, -LENGTH as f32, 0.0),
        inertia: Vec3::splat(INERTIA as f32),
        principal_rotation: Quat::IDENTITY,
    };
    body.material = material;
    [peg, body]
}

fn swing(rate: u32, figures: &mut Vec<Figure>) {
    let mut world = world(environment(Vec3::new(0.0, -G as f32, 0.0), rate), &defs());
    let body = world.bodies()[1].clone();
    let first = G * LENGTH * (1.0 - START.cos());
    let (mut most, mut last) = (0.0f64, 0.0);
    // Times at which it passes the lowest point, and the side and time of the frame before.
    let mut passes = Vec::new();
    let mut before = (1.0, 0.0);
    watch(&mut world, SECONDS, |time, states| {
        let state = &states[1];
        last = (kinetic_energy(&body, state) + G * (LENGTH + f64::from(state.position.y))) / first;
        most = most.max(last);
        let side = f64::from(state.position.x);
        if side * before.0 < 0.0 {
            passes.push(before.1 + (time - before.1) * before.0 / (before.0 - side));
        }
        before = (side, time);
    });
    let small = TAU * ((INERTIA + LENGTH * LENGTH) / (G * LENGTH)).sqrt();
    let period = small * (1.0 + START * START / 16.0 + 11.0 * START.powi(4) / 3072.0);
    // The first two periods: later ones are of another swing if the energy is.
    let measured = passes.get(4).map_or(f64::NAN, |fifth| 0.5 * (fifth - passes[0]));
    let name = |what: &str| format!("1/{rate}: {what}");
    figures.extend([
        Figure::near(name("period, s"), measured, period, PERIOD_OFF * period),
        Figure::at_most(name("most growth of the energy in 20 s, part"), most - 1.0, GROWTH_MAX),
        Figure::reported(name("energy after 20 s, part of the first"), last),
    ]);
}
