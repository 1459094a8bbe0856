//! Friction directions: cubes slide equally far whichever way they go, and a spinning cube is braked on the spot.
//!
//! (a) Box3D's sample *IsotropicFriction*: 32 cubes at 25 m/s, friction 0.6: v² / 2 μ g = 52.083 m. (b) Jolt's test *TestAngularFriction*: a cube of 2 m on friction 0.244949
//! at 10 rad/s; with its weight on four corners it loses 5.0974 rad/s². With the weight spread evenly over the face it would lose 2.76.

use forerun::geometry::Vec3;

use crate::validate::Figure;
use crate::validate::lab::{angle_between, built_in, doubled, length, watch, world};

const DISTANCE: f64 = 25.0 * 25.0 / (2.0 * 0.6 * 10.0);
const SPREAD_MAX: f64 = 0.01;
const MEAN_OFF: f64 = 0.02;
const YAW_MAX: f64 = 2.0;
/// Of the whole weight at the four corners: √2 m from the middle, I / m = 2/3 m².
const BRAKING: f64 = 0.244_948_97 * 9.81 * std::f64::consts::SQRT_2 * 1.5;
const SPIN_OFF: f64 = 0.02;
const DRIFT_MAX: f64 = 1e-3;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    outwards(&mut figures);
    spinning(&mut figures);
    figures
}

fn outwards(figures: &mut Vec<Figure>) {
    let (bodies, environment) = built_in("a06a");
    let mut world = world(environment, &bodies);
    let first = world.states().to_vec();
    watch(&mut world, 5.0, |_, _| {});
    let pairs = || first.iter().zip(world.states()).skip(1);
    let distances: Vec<f64> = pairs().map(|(a, b)| length(doubled(b.position - a.position))).collect();
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    let (least, most) = distances.iter().fold((f64::MAX, 0.0f64), |(a, b), &d| (a.min(d), b.max(d)));
    let yaw =
        pairs().map(|(a, b)| angle_between(doubled(a.rotation * Vec3::X), doubled(b.rotation * Vec3::X)));
    figures.extend([
        Figure::at_most("(a) spread of the distances, part", (most - least) / mean, SPREAD_MAX),
        Figure::at_most("(a) mean distance off, part", (mean / DISTANCE - 1.0).abs(), MEAN_OFF),
        Figure::at_most("(a) most yaw, degrees", yaw.fold(0.0, f64::max), YAW_MAX),
    ]);
}

fn spinning(figures: &mut Vec<Figure>) {
    let (bodies, environment) = built_in("a06b");
    let mut world = world(environment, &bodies);
    let first = world.states()[1];
    watch(&mut world, 1.0, |_, _| {});
    let last = world.states()[1];
    let expected = 10.0 - BRAKING;
    let drift =
        f64::from(last.position.x - first.position.x).hypot(f64::from(last.position.z - first.position.z));
    figures.extend([
        Figure::near(
            "(b) spin after 1 s, rad/s",
            f64::from(last.angular_velocity.y),
            expected,
            SPIN_OFF * expected,
        ),
        Figure::at_most("(b) drift of the centre, m", drift, DRIFT_MAX),
    ]);
}
