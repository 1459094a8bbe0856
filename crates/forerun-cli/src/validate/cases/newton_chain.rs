//! Newton's chain: a row of balls passes momentum on.
//!
//! PhysBAM, Billiard_Ball_Example and Standard_Tests 3: five balls of radius 1 m, a sixth comes at 20 m/s. With small gaps the pairs collide one after
//! the other: the last ball leaves with ((1 + e) / 2)⁵ of the speed. Without gaps the answer depends on the model.

use forerun::dynamics::{BodyDef, Material, World};
use forerun::geometry::shape::Sphere;
use forerun::geometry::{Shape, Vec3};

use crate::validate::Figure;
use crate::validate::lab::{GRAVITY_98, environment, kinetic_energy, momentum, watch, world};

const RATES: [u32; 3] = [60, 240, 1000];
/// The rate at which the limits are meant; at the others the figures are reported, apart from conservation.
const JUDGED_RATE: u32 = 240;
const SPEED: f64 = 20.0;
const RADIUS: f32 = 1.0;
const BALLS: usize = 5;
const LAST_OFF: f64 = 0.01;
const RESIDUAL_MAX: f64 = 0.02;
const MOMENTUM_OFF: f64 = 1e-5;
const ENERGY_GAIN: f64 = 1e-3;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for rate in RATES {
        for restitution in [1.0, 0.9] {
            chain(0.02, restitution, rate, &mut figures);
            chain(0.0, restitution, rate, &mut figures);
        }
        billiards(rate, &mut figures);
    }
    figures
}

/// The cue ball, then the row, `gap` apart (metres), all moving along x.
fn row(gap: f32, y: f32, materials: [Material; 2]) -> Vec<BodyDef> {
    let ball = |x: f32, material: Material| {
        let mut def = BodyDef::new(Shape::Sphere(Sphere { radius: RADIUS })).at(Vec3::new(x, y, 0.0));
        def.material = material;
        def
    };
    let mut cue = ball(-30.0, materials[0]);
    cue.velocity.x = SPEED as f32;
    let mut defs = vec![cue];
    defs.extend((0..BALLS).map(|i| ball(-4.0 + i as f32 * (2.0 * RADIUS + gap), materials[1])));
    defs
}

/// Momentum along x (kg m/s) and kinetic energy (J) of all bodies but the first `skip`.
fn totals(world: &World, skip: usize) -> (f64, f64) {
    let bodies = world.bodies().iter().zip(world.states()).skip(skip);
    bodies.fold((0.0, 0.0), |(p, e), (b, s)| (p + momentum(b, s)[0], e + kinetic_energy(b, s)))
}

/// No gravity, no friction.
fn chain(gap: f32, restitution: f64, rate: u32, figures: &mut Vec<Figure>) {
    let material = Material::new(0.0, restitution as f32);
    let mut world = world(environment(Vec3::ZERO, rate), &row(gap, 0.0, [material; 2]));
    let start = totals(&world, 0);
    watch(&mut world, 10.0, |_, _| {});
    let end = totals(&world, 0);
    let speeds: Vec<f64> = world.states().iter().map(|s| f64::from(s.velocity.x) / SPEED).collect();
    let last = speeds[BALLS];
    let residual = speeds[..BALLS].iter().fold(0.0, |worst: f64, v| worst.max(v.abs()));
    let gapped = gap > 0.0;
    let kind = if gapped { "gapped" } else { "touching" };
    let name = |what: &str| format!("{kind}, e {restitution}, 1/{rate}: {what}");
    let judged = gapped && rate == JUDGED_RATE;
    let limited = |judged: bool, what: &str, value: f64, limit: f64| {
        if judged { Figure::at_most(name(what), value, limit) } else { Figure::reported(name(what), value) }
    };
    figures.push(Figure::reported(name("last ball, part of the speed"), last));
    if gapped {
        let expected = (0.5 * (1.0 + restitution)).powi(BALLS as i32);
        figures.push(limited(judged, "last ball off, part", (last / expected - 1.0).abs(), LAST_OFF));
    }
    let elastic = restitution >= 1.0;
    figures.push(limited(judged && elastic, "most of the others, part of the speed", residual, RESIDUAL_MAX));
    figures.push(Figure::at_most(
        name("change of momentum, part"),
        (end.0 / start.0 - 1.0).abs(),
        MOMENTUM_OFF,
    ));
    figures.push(Figure::at_most(name("gain of energy, part"), end.1 / start.1 - 1.0, ENERGY_GAIN));
}

/// On a table with friction: the cue ball slides, then rolls at 5/7 of its speed after 19.99 m, before it hits the row at 24 m.
fn billiards(rate: u32, figures: &mut Vec<Figure>) {
    // Geometric means with the table: 0.5 for the cue ball, 0.3 for the others.
    let materials = [Material::new(0.5, 0.9), Material::new(0.18, 0.9)];
    let mut ground = BodyDef::fixed(Shape::half_space());
    ground.material = Material::new(0.5, 0.0);
    let mut defs = vec![ground];
    defs.extend(row(0.0, RADIUS, materials));
    let mut world = world(environment(GRAVITY_98, rate), &defs);
    let start = totals(&world, 1);
    let (mut speed, mut spin, mut gain) = (0.0, 0.0, f64::MIN);
    let bodies = world.bodies().to_vec();
    watch(&mut world, 10.0, |_, states| {
        if states[1].position.x < -6.2 {
            (speed, spin) = (f64::from(states[1].velocity.x), -f64::from(states[1].angular_velocity.z));
        }
        let energy: f64 = bodies.iter().zip(states).skip(1).map(|(b, s)| kinetic_energy(b, s)).sum();
        gain = gain.max(energy / start.1 - 1.0);
    });
    let name = |what: &str| format!("billiards, 1/{rate}: {what}");
    let rolling = SPEED * 5.0 / 7.0;
    let last = f64::from(world.states()[BALLS + 1].velocity.x);
    figures.extend([
        Figure::reported(name("speed before the impact off, part"), speed / rolling - 1.0),
        Figure::reported(name("slip before the impact, part"), spin * f64::from(RADIUS) / speed - 1.0),
        Figure::reported(name("last ball after 10 s, m/s"), last),
        Figure::at_most(name("gain of energy, part"), gain, ENERGY_GAIN),
    ]);
}
