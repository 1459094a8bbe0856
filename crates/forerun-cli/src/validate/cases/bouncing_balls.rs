//! Bouncing balls: 49 elastic balls keep their energy.
//!
//! SimBenchmark, *bouncing* (leggedrobotics): balls of 10 kg and radius 0.1 m fall from 5 m, restitution 1, no friction, 20 s; the metric is the
//! mean square of the error of the total energy. Published at 1 ms: RaiSim 0.0186 J², ODE 185, Bullet 7.5e4.

use forerun::dynamics::{BodyDef, Mass, Material};
use forerun::geometry::shape::Sphere;
use forerun::geometry::{Shape, Vec3};

use crate::validate::Figure;
use crate::validate::lab::{environment, kinetic_energy, watch, world};

const G: f32 = 9.81;
const HEIGHT: f32 = 5.0;
const MASS: f32 = 10.0;
const SIDE: u32 = 7;
const SECONDS: f64 = 20.0;

/// Frames a second and the limits of the metric, in J²: to pass (ODE) and the target (RaiSim).
const RATES: [(u32, Option<(f64, f64)>); 4] =
    [(1000, Some((185.0, 1.86e-2))), (250, None), (100, Some((1.9e4, 186.0))), (60, None)];
/// Rate at which the energy must not grow by more than [`GROWTH_MAX`].
const GROWTH_RATE: u32 = 60;
const GROWTH_MAX: f64 = 0.02;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for (rate, limits) in RATES {
        bounce(rate, limits, &mut figures);
    }
    figures
}

fn bounce(rate: u32, limits: Option<(f64, f64)>, figures: &mut Vec<Figure>) {
    let material = Material::new(0.0, 1.0);
    let mut ground = BodyDef::fixed(Shape::half_space());
    ground.material = material;
    let mut defs = vec![ground];
    for k in 0..SIDE * SIDE {
        let (i, j) = (k / SIDE, k % SIDE);
        let position = Vec3::new(2.0 * i as f32, HEIGHT, 2.0 * j as f32);
        let mut ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.1 })).at(position);
        ball.mass = Mass::Total(MASS);
        ball.material = material;
        defs.push(ball);
    }
    let mut world = world(environment(Vec3::new(0.0, -G, 0.0), rate), &defs);
    let bodies = world.bodies().to_vec();
    let expected = f64::from(MASS) * f64::from(G) * f64::from(HEIGHT) * f64::from(SIDE * SIDE);
    let (mut squares, mut count, mut most) = (0.0, 0.0, 0.0f64);
    watch(&mut world, SECONDS, |_, states| {
        let mut energy = 0.0;
        for (body, state) in bodies.iter().zip(states).skip(1) {
            energy += kinetic_energy(body, state);
            energy += f64::from(MASS) * f64::from(G) * f64::from(state.position.y);
        }
        squares += (energy - expected) * (energy - expected);
        count += 1.0;
        most = most.max(energy / expected - 1.0);
    });
    let error: f64 = squares / count;
    let name = |what: &str| format!("1/{rate}: {what}");
    let metric = name("mean square error of the energy, J²");
    match limits {
        Some((pass, target)) => figures.extend([
            Figure::at_most(metric, error, pass),
            Figure::at_most(name("the same against the target, J²"), error, target),
        ]),
        None => figures.push(Figure::reported(metric, error)),
    }
    figures.push(Figure::reported(name("relative root mean square"), error.sqrt() / expected));
    let growth = name("most growth of the energy, part");
    figures.push(if rate == GROWTH_RATE {
        Figure::at_most(growth, most, GROWTH_MAX)
    } else {
        Figure::reported(growth, most)
    });
}
