//! Free rotation: the flip of the intermediate axis (Dzhanibekov), and what free rotation conserves.
//!
//! The period follows from Euler's equations in Jacobi's elliptic functions (Landau and Lifshitz, *Mechanics*, section 37): for this box the
//! angular velocity about the intermediate axis changes sign at 2.8992 s and then every 5.28020 s.

use forerun::dynamics::{Body, BodyDef, BodyState};
use forerun::geometry::shape::{Cuboid, Cylinder};
use forerun::geometry::{Shape, Vec3};

use crate::validate::Figure;
use crate::validate::lab::{
    angle_between, doubled, environment, kinetic_energy, length, spin_momentum, watch, world,
};

const SECONDS: f64 = 30.0;
const FIRST_FLIP: f64 = 2.8992;
const INTERVAL: f64 = 5.28020;
/// Flips within [`SECONDS`].
const FLIPS: f64 = 6.0;

/// Frames a second; limits of the first flip and of the intervals, as parts.
const RATES: [(u32, Option<(f64, f64)>); 3] =
    [(60, None), (240, Some((0.03, 0.05))), (1000, Some((0.005, 0.01)))];
/// The rate at which the drifts are judged.
const JUDGED_RATE: u32 = 240;
const MOMENTUM_DRIFT: f64 = 0.005;
const DIRECTION_DEGREES: f64 = 0.5;
const ENERGY_DRIFT: f64 = 0.01;
const WOBBLE_DEGREES: f64 = 1.0;
/// The splitting lets the energy swing within a turn but not drift: means over a second are compared. What rounding may add, as a part.
const ENERGY_ROUNDING: f64 = 1e-4;

/// What was seen of one spinning body.
#[derive(Clone, Debug, Default)]
struct Spin {
    flips: Vec<f64>,
    momentum_drift: f64,
    direction_degrees: f64,
    energy_drift: f64,
    /// Mean energy of the last second over that of the first, less 1.
    growth: f64,
    wobble_degrees: f64,
    finite: bool,
}

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for (rate, limits) in RATES {
        let flipping = spin(&book(Vec3::new(5.0, 0.01, 0.01)), 0, rate, SECONDS);
        flips(&flipping, rate, limits, &mut figures);
        drifts("(a) intermediate axis", &flipping, rate, &mut figures);
        let steady = [
            ("(a) major axis", Vec3::new(0.01, 5.0, 0.01), 1),
            ("(a) minor axis", Vec3::new(0.01, 0.01, -5.0), 2),
        ];
        for (name, angular_velocity, axis) in steady {
            let spin = spin(&book(angular_velocity), axis, rate, SECONDS);
            figures.push(Figure::at_most(format!("{name}, 1/{rate}: flips"), spin.flips.len() as f64, 0.0));
            let wobble = format!("{name}, 1/{rate}: wobble, degrees");
            figures.push(Figure::at_most(wobble, spin.wobble_degrees, WOBBLE_DEGREES));
            drifts(name, &spin, rate, &mut figures);
        }
        let mut rod = BodyDef::new(Shape::Cylinder(Cylinder { half_height: 1.0, radius: 0.25 }));
        rod.angular_velocity = Vec3::ONE;
        drifts("(b) cylinder, 300 s", &spin(&rod, 1, rate, 300.0), rate, &mut figures);
    }
    figures
}

/// A box with moments in the proportion 0.0855 : 0.1242 : 0.0430.
fn book(angular_velocity: Vec3) -> BodyDef {
    let mut def = BodyDef::new(Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.35, 0.08, 0.5) }));
    def.angular_velocity = angular_velocity;
    def
}

/// Spins a body and watches one of its axes.
fn spin(def: &BodyDef, axis: usize, rate: u32, seconds: f64) -> Spin {
    let mut world = world(environment(Vec3::ZERO, rate), std::slice::from_ref(def));
    let body: Body = world.bodies()[0].clone();
    let start = world.states()[0];
    let about = |s: &BodyState| doubled(s.rotation.conjugate() * s.angular_velocity)[axis];
    let unit =
        Vec3::from_array([0, 1, 2].map(|k| if k == axis { about(&start).signum() as f32 } else { 0.0 }));
    let (momentum, energy) = (spin_momentum(&body, &start), kinetic_energy(&body, &start));
    let mut seen = Spin { finite: true, ..Spin::default() };
    let (mut before, mut time_before) = (about(&start), 0.0);
    let (mut first, mut last) = ((0.0, 0.0), (0.0, 0.0));
    watch(&mut world, seconds, |time, states| {
        let state = &states[0];
        let now = about(state);
        if (now < 0.0) != (before < 0.0) {
            seen.flips.push(time_before + (time - time_before) * before / (before - now));
        }
        (before, time_before) = (now, time);
        let l = spin_momentum(&body, state);
        let e = kinetic_energy(&body, state) / energy;
        seen.momentum_drift = seen.momentum_drift.max((length(l) / length(momentum) - 1.0).abs());
        seen.direction_degrees = seen.direction_degrees.max(angle_between(l, momentum));
        seen.energy_drift = seen.energy_drift.max((e - 1.0).abs());
        seen.wobble_degrees =
            seen.wobble_degrees.max(angle_between(doubled(state.rotation * unit), momentum));
        seen.finite &= state.is_finite();
        if time <= 1.0 {
            first = (first.0 + e, first.1 + 1.0);
        }
        if time > seconds - 1.0 {
            last = (last.0 + e, last.1 + 1.0);
        }
    });
    seen.growth = (last.0 / last.1) / (first.0 / first.1) - 1.0;
    seen
}

fn flips(spin: &Spin, rate: u32, limits: Option<(f64, f64)>, figures: &mut Vec<Figure>) {
    let name = |what: &str| format!("(a) intermediate axis, 1/{rate}: {what}");
    let first = spin.flips.first().map_or(f64::INFINITY, |t| (t / FIRST_FLIP - 1.0).abs());
    let interval = spin.flips.windows(2).map(|w| ((w[1] - w[0]) / INTERVAL - 1.0).abs()).fold(0.0, f64::max);
    figures.push(Figure::near(name("flips"), spin.flips.len() as f64, FLIPS, 0.0));
    let (first_name, interval_name) = (name("first flip off, part"), name("worst interval off, part"));
    figures.extend(match limits {
        Some((of_first, of_interval)) => [
            Figure::at_most(first_name, first, of_first),
            Figure::at_most(interval_name, interval, of_interval),
        ],
        None => [Figure::reported(first_name, first), Figure::reported(interval_name, interval)],
    });
}

fn drifts(name: &str, spin: &Spin, rate: u32, figures: &mut Vec<Figure>) {
    let judged = |what: &str, value: f64, limit: f64| {
        let name = format!("{name}, 1/{rate}: {what}");
        if rate == JUDGED_RATE { Figure::at_most(name, value, limit) } else { Figure::reported(name, value) }
    };
    figures.extend([
        judged("drift of |L|, part", spin.momentum_drift, MOMENTUM_DRIFT),
        judged("turn of L, degrees", spin.direction_degrees, DIRECTION_DEGREES),
        judged("drift of the energy, part", spin.energy_drift, ENERGY_DRIFT),
        Figure::at_most(
            format!("{name}, 1/{rate}: growth of the energy, part"),
            spin.growth,
            ENERGY_ROUNDING,
        ),
        Figure::near(format!("{name}, 1/{rate}: finite"), f64::from(u8::from(spin.finite)), 1.0, 0.0),
    ]);
}
