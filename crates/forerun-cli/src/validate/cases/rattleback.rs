//! Rattleback: a stone whose axes of inertia are askew to its surface reverses its spin one way round, and not the other.
//!
//! Kane and Levinson, *Realistic mathematical modeling of the rattleback* (1982), in the numbers of the Supercomputing Challenge's report 038 (1999-00); theory: Kondo and Nakanishi, arXiv 1704.06717.
//! An ellipsoid with semi-axes of 0.2, 0.03 and 0.02 m, 1 kg, its centre of mass 1 cm below its middle; 1 ms, friction 1. The ellipsoid is a
//! mesh, finest where it touches: its normals are a third of a degree apart there.

use forerun::dynamics::{BodyDef, BodyState, Mass, Material, World};
use forerun::geometry::shape::Mesh;
use forerun::geometry::{Quat, Shape, Vec3};

use crate::validate::Figure;
use crate::validate::lab::{dot, doubled, environment, length, mechanical_energy, rotated, watch, world};

const G: f64 = 9.81;
/// Along the stone, up and across. Metres
const SEMI_AXES: [f64; 3] = [0.2, 0.02, 0.03];
const CENTRE: f64 = -0.01;
/// About the centre of mass along these axes, and the product of inertia of the first and the third. kg m²
const MOMENTS: [f64; 3] = [2e-4, 1.7e-3, 1.6e-3];
const PRODUCT: f64 = 2e-5;
const RATE: u32 = 1000;
const SECONDS: f64 = 5.0;
const STAYS_ABOVE: f64 = 3.0;
const ENERGY_MAX: f64 = 0.005;
const LIFT_MAX: f64 = 1e-4;

pub(crate) fn run() -> Vec<Figure> {
    let shape = stone();
    let mut figures = Vec::new();
    for spin in [-5.0, 5.0] {
        spun(&shape, spin, &mut figures);
    }
    figures
}

/// The ellipsoid: rings around its lowest point, closest together there.
fn stone() -> Shape {
    const SECTORS: u32 = 64;
    let mut angles: Vec<f64> = (1..=30).map(|i| 0.5 * f64::from(i)).collect();
    angles.extend((1..=16).map(|i| 15.0 + 10.0 * f64::from(i)));
    let point = |polar: f64, azimuth: f64| {
        let (sin, cos) = polar.to_radians().sin_cos();
        let (sin_azimuth, cos_azimuth) = azimuth.sin_cos();
        let [a, b, c] = SEMI_AXES;
        Vec3::new((a * sin * cos_azimuth) as f32, (-b * cos) as f32, (c * sin * sin_azimuth) as f32)
    };
    let mut corners = vec![point(0.0, 0.0)];
    for angle in &angles {
        for sector in 0..SECTORS {
            corners.push(point(*angle, f64::from(sector) * std::f64::consts::TAU / f64::from(SECTORS)));
        }
    }
    let top = corners.len() as u32;
    corners.push(point(180.0, 0.0));
    let rings = angles.len() as u32;
    let at = |ring: u32, sector: u32| 1 + ring * SECTORS + sector % SECTORS;
    let mut triangles = Vec::new();
    for sector in 0..SECTORS {
        triangles.push([0, at(0, sector), at(0, sector + 1)]);
        for ring in 1..rings {
            let (a, b) = (at(ring - 1, sector), at(ring - 1, sector + 1));
            let (c, d) = (at(ring, sector), at(ring, sector + 1));
            triangles.extend([[a, c, d], [a, d, b]]);
        }
        triangles.push([top, at(rings - 1, sector + 1), at(rings - 1, sector)]);
    }
    Mesh::new(corners, triangles).expect("an ellipsoid is a closed mesh").into()
}

fn turn(axis: Vec3, angle: f64) -> Quat {
    let (sin, cos) = (0.5 * angle).sin_cos();
    let axis = axis * sin as f32;
    Quat::from_xyzw(axis.x, axis.y, axis.z, cos as f32)
}

/// How high the middle of the ellipsoid is when it touches the ground. Metres
fn support(rotation: Quat) -> f64 {
    let [x, y, z, w] = rotation.to_array().map(f64::from);
    let up = rotated([-x, -y, -z, w], [0.0, 1.0, 0.0]);
    length([0, 1, 2].map(|k| SEMI_AXES[k] * up[k]))
}

fn def(shape: &Shape, spin: f64) -> BodyDef {
    let mut def = BodyDef::new(shape.clone());
    // The principal axes: the first and the third are turned towards each other about y.
    let angle = 0.5 * (2.0 * PRODUCT).atan2(MOMENTS[2] - MOMENTS[0]);
    let (half, middle) = (
        (0.25 * (MOMENTS[2] - MOMENTS[0]).powi(2) + PRODUCT * PRODUCT).sqrt(),
        0.5 * (MOMENTS[0] + MOMENTS[2]),
    );
    let inertia = Vec3::new((middle - half) as f32, MOMENTS[1] as f32, (middle + half) as f32);
    def.mass = Mass::Given {
        mass: 1.0,
        centre: Vec3::Y * CENTRE as f32,
        inertia,
        principal_rotation: turn(Vec3::Y, angle),
    };
    def.material = Material::new(1.0, 0.0);
    let half_degree = 0.5f64.to_radians();
    def.pose.rotation = turn(Vec3::X, half_degree) * turn(Vec3::Z, half_degree);
    def.pose.position.y = support(def.pose.rotation) as f32;
    def.angular_velocity = Vec3::Y * spin as f32;
    // The point that touches does not move.
    let [x, y, z, w] = def.pose.rotation.to_array().map(f64::from);
    let up = rotated([-x, -y, -z, w], [0.0, 1.0, 0.0]);
    let reach = support(def.pose.rotation);
    let lowest = [0, 1, 2].map(|k| -SEMI_AXES[k] * SEMI_AXES[k] * up[k] / reach);
    let from_contact = rotated([x, y, z, w], [-lowest[0], CENTRE - lowest[1], -lowest[2]]);
    let from_contact = Vec3::new(from_contact[0] as f32, from_contact[1] as f32, from_contact[2] as f32);
    def.velocity = def.angular_velocity.cross(from_contact);
    def
}

/// How far the ellipsoid is above the ground. Metres
fn lift(world_body: &forerun::dynamics::Body, state: &BodyState) -> f64 {
    let pose = world_body.own_pose(state);
    f64::from(pose.position.y) - support(pose.rotation)
}

fn spun(shape: &Shape, spin: f64, figures: &mut Vec<Figure>) {
    let mut ground = BodyDef::fixed(Shape::half_space());
    ground.material = Material::new(1.0, 0.0);
    let gravity = Vec3::new(0.0, -G as f32, 0.0);
    let mut world: World = world(environment(gravity, RATE), &[ground, def(shape, spin)]);
    let bodies = world.bodies().to_vec();
    let weight = G / f64::from(bodies[1].inverse_mass);
    let lowest = weight * (SEMI_AXES[1] + CENTRE);
    let energy = |states: &[BodyState]| mechanical_energy(&bodies, states, G) - lowest;
    let start = energy(world.states());
    let (mut growth, mut lifted, mut reversed, mut sum) = (0.0f64, 0.0f64, None, 0.0);
    let mut means = Vec::new();
    let mut frame = 0u32;
    watch(&mut world, SECONDS, |time, states| {
        growth = growth.max(energy(states) / start - 1.0);
        lifted = lifted.max(lift(&bodies[1], &states[1]));
        sum += dot(doubled(states[1].angular_velocity), [0.0, 1.0, 0.0]);
        frame += 1;
        if frame.is_multiple_of(RATE / 4) {
            let mean = sum / f64::from(RATE / 4);
            if mean * spin < 0.0 && reversed.is_none() {
                reversed = Some(time);
            }
            means.push(mean);
            sum = 0.0;
        }
    });
    let name = |what: &str| format!("{spin} rad/s: {what}");
    for second in [1, 2, 3, 4] {
        let title = name(&format!("spin, mean of the quarter before {second} s, rad/s"));
        figures.push(Figure::reported(title, means[4 * second - 1]));
    }
    if spin < 0.0 {
        // Never is later than the end.
        let reversal = reversed.unwrap_or(2.0 * SECONDS);
        figures.push(Figure::near(name("time of the reversal, s"), reversal, 3.25, 1.75));
    } else {
        let least = means[..16].iter().copied().fold(f64::MAX, f64::min);
        figures.push(Figure::at_least(name("least spin up to 4 s, rad/s"), least, STAYS_ABOVE));
    }
    figures.push(Figure::at_most(name("most growth of the energy, part"), growth, ENERGY_MAX));
    figures.push(Figure::at_most(name("lift above the ground, m"), lifted, LIFT_MAX));
}
