//! Spinning ball: dropped on the floor, friction at the impact turns spin into speed.
//!
//! PhysBAM, Bounce_Friction_Example and Rolling_Friction_Example: g = 9.8 m/s², radius 1 m, dropped by 9 m with a spin of 10 rad/s, restitution 0.5.
//! With friction 0.8 the impact sticks: 2/7 of the spin is left. With 0.05 it slides: the speed is μ (1 + e) v.
//! A mesh of the ball is held to the limits of the ball.

use forerun::dynamics::{BodyDef, BodyState, Material};
use forerun::geometry::shape::{Sphere, mesh_make};
use forerun::geometry::{Shape, Vec3};

use crate::validate::Figure;
use crate::validate::lab::{GRAVITY_98, environment, watch, world};

const G: f64 = 9.8;
const RADIUS: f32 = 1.0;
const DROP: f64 = 9.0;
const SPIN: f64 = 10.0;
const RESTITUTION: f64 = 0.5;
const SECONDS: f64 = 15.0;
/// The rate at which the limit is meant, and the limit as a part; at the other rate figures are reported.
const JUDGED_RATE: u32 = 240;
const OFF: f64 = 0.03;
/// An icosphere of 2420 triangles.
const MESH_PARTS: u32 = 11;

/// Speed along -z, spin about -x and speed upwards.
#[derive(Clone, Copy, Debug)]
struct After {
    tangential: f64,
    spin: f64,
    rebound: f64,
}

pub(crate) fn run() -> Vec<Figure> {
    // A fixed radius and number of parts, within the ranges that the maker names.
    let mesh = mesh_make::ball(RADIUS, MESH_PARTS).expect("a ball of 2420 triangles is possible");
    let shapes = [("sphere", Shape::Sphere(Sphere { radius: RADIUS })), ("mesh sphere", mesh.into())];
    let mut figures = Vec::new();
    for rate in [60, JUDGED_RATE] {
        for (name, shape) in &shapes {
            for friction in [0.8, 0.05] {
                drop_ball(name, shape, friction, rate, &mut figures);
            }
        }
    }
    figures
}

/// What the formulas say of the first impact.
fn expected(friction: f64) -> After {
    let speed = (2.0 * G * DROP).sqrt();
    let sliding = friction * (1.0 + RESTITUTION) * speed;
    let sticking = 2.0 / 7.0 * SPIN * f64::from(RADIUS);
    let tangential = sliding.min(sticking);
    After { tangential, spin: SPIN - 2.5 * tangential / f64::from(RADIUS), rebound: RESTITUTION * speed }
}

fn drop_ball(name: &str, shape: &Shape, friction: f64, rate: u32, figures: &mut Vec<Figure>) {
    let material = Material::new(friction as f32, RESTITUTION as f32);
    let mut ground = BodyDef::fixed(Shape::half_space());
    ground.material = material;
    let mut ball = BodyDef::new(shape.clone()).at(Vec3::new(-4.0, DROP as f32 + RADIUS, 0.0));
    ball.angular_velocity = Vec3::new(-SPIN as f32, 0.0, 0.0);
    ball.material = material;
    let mut world = world(environment(GRAVITY_98, rate), &[ground, ball]);
    let mut first: Option<After> = None;
    watch(&mut world, SECONDS, |_, states| {
        if first.is_none() && states[1].velocity.y > 0.0 {
            first = Some(measure(&states[1]));
        }
    });
    let nothing = After { tangential: f64::NAN, spin: f64::NAN, rebound: f64::NAN };
    let (after, expected) = (first.unwrap_or(nothing), expected(friction));
    let last = measure(&world.states()[1]);
    let name = |what: &str| format!("{name}, friction {friction}, 1/{rate}: {what}");
    let pairs = [
        ("speed along the floor off, part", after.tangential, expected.tangential),
        ("spin off, part", after.spin, expected.spin),
        ("rebound off, part", after.rebound, expected.rebound),
    ];
    for (what, value, expected) in pairs {
        let off = (value / expected - 1.0).abs();
        figures.push(if rate == JUDGED_RATE {
            Figure::at_most(name(what), off, OFF)
        } else {
            Figure::reported(name(what), off)
        });
    }
    figures.push(Figure::reported(name("speed along the floor after 15 s, m/s"), last.tangential));
    figures.push(Figure::reported(name("spin after 15 s, rad/s"), last.spin));
}

/// The rebound is the speed that the ball had when it left the floor, whatever it has lost since within the frame.
fn measure(state: &BodyState) -> After {
    let (v, height) = (f64::from(state.velocity.y), f64::from(state.position.y - RADIUS));
    After {
        tangential: -f64::from(state.velocity.z),
        spin: -f64::from(state.angular_velocity.x),
        rebound: (v * v + 2.0 * G * height.max(0.0)).sqrt(),
    }
}
