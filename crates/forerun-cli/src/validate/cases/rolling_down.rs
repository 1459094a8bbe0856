//! Rolling down: spheres, cylinders and rings on an incline, rolling or slipping.
//!
//! Textbook; the set-up and the fall of the rolling sphere, -(5/14) g t² sin², are those of PhysBAM's Sphere_Incline: g = 9.8 m/s², radius 1 m,
//! slopes of 4.5, 9 and 18 degrees, 5 s.

use forerun::dynamics::{BodyDef, Mass, Material};
use forerun::geometry::shape::{Cylinder, Sphere, mesh_make};
use forerun::geometry::{Quat, Shape, Vec3};

use crate::validate::Figure;
use crate::validate::lab::{GRAVITY_98, Slope, environment, watch, world};

const G: f64 = 9.8;
const SECONDS: f64 = 5.0;
/// From then on the slip ratio is judged: before, both speeds are small. Seconds.
const ROLLS_AFTER: f64 = 0.1;
/// The rate at which the limits are meant; at the other the figures are reported.
const JUDGED_RATE: u32 = 240;
/// An icosphere of 2420 triangles.
const MESH_PARTS: u32 = 11;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Roller {
    Sphere,
    Mesh,
    Cylinder,
    Ring,
}

impl Roller {
    const ALL: [Roller; 4] = [Roller::Sphere, Roller::Mesh, Roller::Cylinder, Roller::Ring];

    fn name(self) -> &'static str {
        match self {
            Roller::Sphere => "sphere",
            Roller::Mesh => "mesh sphere",
            Roller::Cylinder => "cylinder",
            Roller::Ring => "ring",
        }
    }

    /// I / (m r²)
    fn inertia(self) -> f64 {
        match self {
            Roller::Sphere | Roller::Mesh => 0.4,
            Roller::Cylinder => 0.5,
            Roller::Ring => 1.0,
        }
    }

    /// What the fall and the slip may be off, as parts.
    fn limits(self) -> (f64, f64) {
        if self == Roller::Mesh { (0.03, 0.02) } else { (0.01, 0.005) }
    }

    /// The roller on a slope, its axis level.
    fn def(self, slope: Slope, material: Material) -> BodyDef {
        let shape = match self {
            Roller::Sphere => Shape::Sphere(Sphere { radius: 1.0 }),
            Roller::Mesh => {
                // A fixed radius and number of parts, within the ranges that the maker names.
                mesh_make::ball(1.0, MESH_PARTS).expect("a ball of 2420 triangles is possible").into()
            }
            Roller::Cylinder | Roller::Ring => Shape::Cylinder(Cylinder { half_height: 1.0, radius: 1.0 }),
        };
        let mut def = BodyDef::new(shape);
        let half = std::f32::consts::FRAC_1_SQRT_2;
        let level = match self {
            Roller::Sphere | Roller::Mesh => Quat::IDENTITY,
            Roller::Cylinder | Roller::Ring => Quat::from_xyzw(half, 0.0, 0.0, half),
        };
        def.pose = slope.pose(Vec3::new(0.0, 1.0, 0.0), level);
        def.material = material;
        def.mass = Mass::Total(1.0);
        if self == Roller::Ring {
            def.mass = Mass::Given {
                mass: 1.0,
                centre: Vec3::ZERO,
                inertia: Vec3::new(0.5, 1.0, 0.5),
                principal_rotation: Quat::IDENTITY,
            };
        }
        def
    }
}

/// How a roller has moved after [`SECONDS`].
#[derive(Clone, Copy, Debug, Default)]
struct Rolled {
    /// Metres, downwards.
    fall: f64,
    /// Worst |ω r / v - 1|.
    slip: f64,
    /// rad/s
    spin: f64,
}

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for rate in [60, JUDGED_RATE] {
        for roller in Roller::ALL {
            for degrees in [4.5, 9.0, 18.0] {
                rolling(roller, degrees, rate, &mut figures);
            }
        }
        for roller in [Roller::Sphere, Roller::Mesh] {
            slipping(roller, rate, &mut figures);
        }
    }
    figures
}

fn roll(roller: Roller, slope: Slope, friction: f32, rate: u32) -> Rolled {
    let material = Material::new(friction, 0.0);
    let mut ground = slope.ground();
    ground.material = material;
    let start = roller.def(slope, material);
    let mut world = world(environment(GRAVITY_98, rate), &[ground, start.clone()]);
    let mut rolled = Rolled::default();
    watch(&mut world, SECONDS, |time, states| {
        let state = &states[1];
        let [speed, ..] = slope.local(state.velocity);
        rolled.spin = -f64::from(state.angular_velocity.z);
        if time > ROLLS_AFTER {
            rolled.slip = rolled.slip.max((rolled.spin / speed - 1.0).abs());
        }
        rolled.fall = f64::from(start.pose.position.y) - f64::from(state.position.y);
    });
    rolled
}

/// A figure that has a limit at the judged rate only.
fn judged(rate: u32, name: String, value: f64, limit: f64) -> Figure {
    if rate == JUDGED_RATE { Figure::at_most(name, value, limit) } else { Figure::reported(name, value) }
}

/// Friction 1: a = g sin / (1 + I / m r²), without slip.
fn rolling(roller: Roller, degrees: f64, rate: u32, figures: &mut Vec<Figure>) {
    let slope = Slope::degrees(degrees);
    let rolled = roll(roller, slope, 1.0, rate);
    let fall = 0.5 * G * slope.sin() * slope.sin() / (1.0 + roller.inertia()) * SECONDS * SECONDS;
    let (fall_off, slip_off) = roller.limits();
    let name = |what: &str| format!("{}, {degrees}°, 1/{rate}: {what}", roller.name());
    figures.extend([
        judged(rate, name("fall off, part"), (rolled.fall / fall - 1.0).abs(), fall_off),
        judged(rate, name("slip, part"), rolled.slip, slip_off),
    ]);
}

/// Friction 0.05 on 18 degrees: a = g (sin - μ cos), and the spin grows by 5 μ g cos / 2 r.
fn slipping(roller: Roller, rate: u32, figures: &mut Vec<Figure>) {
    let slope = Slope::degrees(18.0);
    let rolled = roll(roller, slope, 0.05, rate);
    let fall = 0.5 * G * (slope.sin() - 0.05 * slope.cos()) * slope.sin() * SECONDS * SECONDS;
    let spin = 2.5 * 0.05 * G * slope.cos() * SECONDS;
    let (fall_off, _) = roller.limits();
    let name = |what: &str| format!("{}, slipping, 1/{rate}: {what}", roller.name());
    figures.extend([
        judged(rate, name("fall off, part"), (rolled.fall / fall - 1.0).abs(), fall_off),
        Figure::reported(name("spin off, part"), rolled.spin / spin - 1.0),
    ]);
}
