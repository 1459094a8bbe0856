//! Rolling plate: a plate with 25 balls on it is pushed; friction cones must be round.
//!
//! SimBenchmark, *rolling* (leggedrobotics): a plate of 10 kg, balls of 1 kg, friction 0.4 below and 0.8 above, 150 N along an axis or at 60 degrees to it; 4 s in frames
//! of 1 ms. From rolling: the balls accelerate by f₂/m = 0.211 m/s², the plate by 3.5 times that. The metric is the mean over frames of the squared errors of
//! the velocities of the plate and of one ball. Published for 60 degrees: Bullet 5.7e-9, RaiSim 4.1e-7, MuJoCo 2.4e-3 to 8.1e-3, ODE and DART 3.14 (nothing moves).

use forerun::dynamics::{BodyDef, Mass, Material};
use forerun::geometry::shape::{Cuboid, Sphere};
use forerun::geometry::{Shape, Vec3};

use crate::validate::Figure;
use crate::validate::lab::{dot, doubled, environment, watch, world};

const G: f64 = 9.81;
const FORCE: f64 = 150.0;
const PLATE_MASS: f64 = 10.0;
const BALL_MASS: f64 = 1.0;
const SIDE: u32 = 5;
/// m²/s²
const ERROR_MAX: f64 = 1e-4;
const ERROR_TARGET: f64 = 4.1e-7;
const RATIO_MAX: f64 = 10.0;

pub(crate) fn run() -> Vec<Figure> {
    let directions = [("along y", Vec3::NEG_Z), ("at 60°", Vec3::new(0.5, 0.0, -0.866))];
    let errors = directions.map(|(_, direction)| push(direction));
    let mut figures = Vec::new();
    for ((name, _), error) in directions.iter().zip(errors) {
        let metric = format!("{name}: mean square error of the velocities, m²/s²");
        figures.push(Figure::at_most(metric, error, ERROR_MAX));
        let target = format!("{name}: the same against the target, m²/s²");
        figures.push(Figure::at_most(target, error, ERROR_TARGET));
    }
    // Errors that are nothing have no ratio: that of equal ones.
    let ratio = if errors[0] > 0.0 { errors[1] / errors[0] } else { 1.0 };
    figures.push(Figure::at_most("error at 60° over error along y", ratio, RATIO_MAX));
    figures
}

/// The plate, which the force acts on, and the balls on it; each lies a few hundredths of a millimetre in what is below.
fn bodies(force: Vec3) -> Vec<BodyDef> {
    // Geometric means: 0.4 between ground and plate, 0.8 between plate and balls.
    let (ground_material, material) = (Material::new(0.2, 0.0), Material::new(0.8, 0.0));
    let mut ground = BodyDef::fixed(Shape::half_space());
    ground.material = ground_material;
    let half_extents = Vec3::new(10.0, 0.5, 10.0);
    let mut plate = BodyDef::new(Shape::Cuboid(Cuboid { half_extents })).at(Vec3::Y * (0.5 - 2e-5));
    (plate.mass, plate.material, plate.force) = (Mass::Total(PLATE_MASS as f32), material, force);
    let mut defs = vec![ground, plate];
    for i in 0..SIDE * SIDE {
        let place = Vec3::new(2.0 * (i / SIDE) as f32 - 4.0, 1.5 - 6e-5, 4.0 - 2.0 * (i % SIDE) as f32);
        let mut ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 })).at(place);
        (ball.mass, ball.material) = (Mass::Total(BALL_MASS as f32), material);
        defs.push(ball);
    }
    defs
}

fn push(direction: Vec3) -> f64 {
    let force = direction * FORCE as f32;
    let along = doubled(direction);
    let strength = FORCE * dot(along, along).sqrt();
    let balls = f64::from(SIDE * SIDE);
    let braking = 0.4 * (PLATE_MASS + balls * BALL_MASS) * G;
    let ball_force = (strength - braking) / PLATE_MASS / (3.5 / BALL_MASS + balls / PLATE_MASS);
    let ball = ball_force / BALL_MASS;
    let plate = (strength - braking - balls * ball_force) / PLATE_MASS;
    let unit = along.map(|x| x / dot(along, along).sqrt());

    let mut world = world(environment(Vec3::new(0.0, -G as f32, 0.0), 1000), &bodies(force));
    let (mut sum, mut count) = (0.0, 0.0);
    watch(&mut world, 4.0, |time, states| {
        for (state, acceleration) in [(&states[1], plate), (&states[2], ball)] {
            let velocity = doubled(state.velocity);
            let off = [0, 1, 2].map(|k| velocity[k] - unit[k] * acceleration * time);
            sum += dot(off, off);
        }
        count += 1.0;
    });
    sum / count
}
