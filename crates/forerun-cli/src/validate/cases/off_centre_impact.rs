//! Off-centre impact: a ball hits a free rod beside its centre, with restitution 0.5 and without friction.
//!
//! Textbook: j = (1 + e) v / (1/m₁ + 1/m₂ + d²/I). The rod also as a distance field, and an L-shaped body that is not convex.

use forerun::dynamics::{BodyDef, Mass, Material, World};
use forerun::geometry::shape::{Cuboid, Mesh, Sphere, mesh_make};
use forerun::geometry::{Shape, Vec3};

use crate::validate::Figure;
use crate::validate::lab::{angular_momentum, environment, length, momentum, watch, world};

const RATE: u32 = 240;
const SPEED: f64 = 2.0;
const RESTITUTION: f64 = 0.5;
const ROD_HALF: Vec3 = Vec3::new(0.5, 0.05, 0.05);
const ROD_MASS: f32 = 2.0;
const BALL_RADIUS: f32 = 0.1;
const GAP: f32 = 0.1;
const CONSERVED: f64 = 1e-5;

/// What is hit from below, at x = `at` and y = `face`, by a ball that comes along +y.
struct Target {
    name: &'static str,
    shape: Shape,
    at: f32,
    face: f32,
    /// What the velocities may be off, as a part.
    off: f64,
}

pub(crate) fn run() -> Vec<Figure> {
    // Fixed sizes, within the ranges that the makers name.
    let rod: Mesh = mesh_make::cuboid(ROD_HALF).expect("a box is possible");
    let angle: Mesh = mesh_make::angle(1.0, 0.2, 0.1).expect("an angle is possible");
    let targets = [
        Target {
            name: "rod",
            shape: Shape::Cuboid(Cuboid { half_extents: ROD_HALF }),
            at: 0.4,
            face: -0.05,
            off: 0.005,
        },
        Target { name: "mesh rod", shape: rod.into(), at: 0.4, face: -0.05, off: 0.03 },
        Target { name: "mesh angle", shape: angle.into(), at: 0.8, face: 0.0, off: 0.03 },
    ];
    let mut figures = Vec::new();
    for target in &targets {
        hit(target, &mut figures);
    }
    figures
}

fn hit(target: &Target, figures: &mut Vec<Figure>) {
    let material = Material::new(0.0, RESTITUTION as f32);
    let mut struck = BodyDef::new(target.shape.clone());
    struck.mass = Mass::Total(ROD_MASS);
    struck.material = material;
    let start = Vec3::new(target.at, target.face - GAP - BALL_RADIUS, 0.0);
    let mut ball = BodyDef::new(Shape::Sphere(Sphere { radius: BALL_RADIUS })).at(start);
    ball.velocity = Vec3::new(0.0, SPEED as f32, 0.0);
    ball.mass = Mass::Total(1.0);
    ball.material = material;

    let mut world = world(environment(Vec3::ZERO, RATE), &[struck, ball]);
    let centre = world.states()[0].position;
    let moment = 1.0 / f64::from(inverse_moment_about_z(&world));
    let arm = f64::from(target.at - centre.x);
    let impulse = (1.0 + RESTITUTION) * SPEED / (1.0 + 1.0 / f64::from(ROD_MASS) + arm * arm / moment);
    let before = totals(&world);
    // The gap closes after 0.05 s.
    watch(&mut world, 0.1, |_, _| {});
    let after = totals(&world);

    let (rod, ball) = (world.states()[0], world.states()[1]);
    let pairs = [
        ("ball, m/s", f64::from(ball.velocity.y), SPEED - impulse),
        ("struck body, m/s", f64::from(rod.velocity.y), impulse / f64::from(ROD_MASS)),
        ("spin, rad/s", f64::from(rod.angular_velocity.z), impulse * arm / moment),
    ];
    for (what, value, expected) in pairs {
        figures.push(Figure::near(
            format!("{}: {what}", target.name),
            value,
            expected,
            target.off * expected.abs(),
        ));
    }
    for (what, a, b) in [("momentum", before.0, after.0), ("angular momentum", before.1, after.1)] {
        let change = length([0, 1, 2].map(|k| b[k] - a[k])) / length(a);
        figures.push(Figure::at_most(format!("{}: change of {what}, part", target.name), change, CONSERVED));
    }
}

/// Inverse moment of inertia of the first body about z: one of its principal axes, whichever it is.
fn inverse_moment_about_z(world: &World) -> f32 {
    let (body, state) = (&world.bodies()[0], &world.states()[0]);
    let z = state.rotation.conjugate() * Vec3::Z;
    (z * z).dot(body.inverse_inertia)
}

/// Momentum and angular momentum (about the origin) of all bodies.
fn totals(world: &World) -> ([f64; 3], [f64; 3]) {
    let mut sums = ([0.0; 3], [0.0; 3]);
    for (body, state) in world.bodies().iter().zip(world.states()) {
        let (p, l) = (momentum(body, state), angular_momentum(body, state));
        for k in 0..3 {
            sums.0[k] += p[k];
            sums.1[k] += l[k];
        }
    }
    sums
}
