//! Turntable: a cube on a disc slips when the disc spins faster than friction allows, and not before.
//!
//! After rigid-ipc's *turntable* fixtures: a disc of radius 2 m, a cube of 0.25 m at 1.5 m. It slips at √(μ g / r); g = 9.8 m/s².

use forerun::dynamics::{BodyDef, BodyKind, BodyState, Material, Unobserved, World};
use forerun::geometry::shape::{Cuboid, Cylinder};
use forerun::geometry::{Shape, Vec3};

use crate::validate::Figure;
use crate::validate::lab::{GRAVITY_98, doubled, environment, length, rotated, world};

const G: f64 = 9.8;
const RADIUS: f64 = 1.5;
/// How fast the disc's spin grows. rad/s²
const RAMP: f64 = 0.05;
/// The cube has slipped once it is so far from where it was on the disc. Metres
const SLIPPED: f64 = 1e-3;
/// Frames a second and what the spin at the slip may be off, as a part.
const RATES: [(u32, f64); 2] = [(60, 0.06), (240, 0.03)];
const CREEP_MAX: f64 = 2e-3;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for (rate, off) in RATES {
        for friction in [0.1, 0.5, 1.0] {
            let expected = (friction * G / RADIUS).sqrt();
            let spin = spin_at_slip(friction, expected, rate);
            let name = format!("friction {friction}, 1/{rate}: spin at which it has slipped by 1 mm, rad/s");
            figures.push(Figure::near(name, spin, expected, off * expected));
        }
        let name = format!("friction 0.5, 1/{rate}: creep in 20 s at 1.6 rad/s, m");
        figures.push(Figure::at_most(name, creep(rate), CREEP_MAX));
    }
    figures
}

fn table(friction: f64, rate: u32) -> World {
    let material = Material::new(friction as f32, 0.0);
    let mut disc = BodyDef::new(Shape::Cylinder(Cylinder { half_height: 0.05, radius: 2.0 }));
    disc.kind = BodyKind::Kinematic;
    disc.pose.position.y = -0.05;
    disc.material = material;
    let mut cube = BodyDef::new(Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.125) })).at(Vec3::new(
        RADIUS as f32,
        0.125,
        0.0,
    ));
    cube.material = material;
    world(environment(GRAVITY_98, rate), &[disc, cube])
}

/// Where the cube is on the disc.
fn on_disc(states: &[BodyState]) -> [f64; 3] {
    let [x, y, z, w] = states[0].rotation.to_array().map(f64::from);
    rotated([-x, -y, -z, w], doubled(states[1].position))
}

/// How far the cube is from where it was on the disc. Metres
fn slip(first: [f64; 3], states: &[BodyState]) -> f64 {
    let now = on_disc(states);
    length([now[0] - first[0], 0.0, now[2] - first[2]])
}

/// The spin of the disc when the cube has slipped. Twice what is expected if it never does.
fn spin_at_slip(friction: f64, expected: f64, rate: u32) -> f64 {
    let mut world = table(friction, rate);
    let first = on_disc(world.states());
    let frames = (2.0 * expected / RAMP * f64::from(rate)) as u32;
    for frame in 1..=frames {
        let spin = RAMP * f64::from(frame) / f64::from(rate);
        world.states_mut()[0].angular_velocity = Vec3::Y * spin as f32;
        world.step(&mut Unobserved);
        if slip(first, world.states()) > SLIPPED {
            return spin;
        }
    }
    2.0 * expected
}

/// How far the cube wanders in 20 s on a disc that is too slow for it to slip. Metres
fn creep(rate: u32) -> f64 {
    let mut world = table(0.5, rate);
    let spin = Vec3::Y * 1.6;
    for state in world.states_mut() {
        state.angular_velocity = spin;
    }
    let cube = &mut world.states_mut()[1];
    cube.velocity = spin.cross(cube.position);
    let first = on_disc(world.states());
    let mut most = 0.0f64;
    for _ in 0..20 * rate {
        world.step(&mut Unobserved);
        most = most.max(slip(first, world.states()));
    }
    most
}
