//! Rings: hundreds of non-convex bodies fall over poles and on each other; none may go through another.
//!
//! Guendelman, Bridson, Fedkiw, *Nonconvex Rigid Bodies with Stacking* (2003), figure 1: 500 and 1000 rings over 25 poles, with the places and materials of
//! PhysBAM's `RINGS_TEST`; 30 s at 60 frames a second. The paper gives pictures and no figures. Their rings are not to be had: these are tori of
//! 1.5 m and 0.4 m and 1536 triangles, which lie up to 8 mm inside of the tori that overlaps are measured between. Besides, rings a tenth as thick as wide
//! that fall so fast that a frame takes them one and a half or three times their thickness.

use std::sync::Arc;

use forerun::Clock;
use forerun::dynamics::{BodyDef, BodyState, Environment, World};
use forerun::geometry::Vec3;
use forerun::geometry::shape::{Cylinder, Shape, mesh_make};
use forerun::timeline::check::Random;

use crate::validate::Figure;
use crate::validate::lab::{any_rotation, built_in, kinetic_energy, watch, world};
use crate::validate::linkage::{Linkage, Torus};

const SECONDS: f64 = 30.0;
const THICK: Torus = Torus { radius: 1.5, tube_radius: 0.4 };
const THIN: Torus = Torus { radius: 0.5, tube_radius: 0.05 };
/// Of the tube's radius.
const DEEPEST_MAX: f64 = 0.05;
const PERCENTILE_99_MAX: f64 = 0.02;
const ENERGY_MAX: f64 = 1e-3;
/// Of the step for a second: as fast as the second passes.
const STEP_SECONDS_MAX: f64 = 1.0;

/// 100 rings, and fast ones.
pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    come_to_rest(100, &mut figures);
    for speed in [9.0, 17.0] {
        fast(speed, &mut figures);
    }
    figures
}

/// 500 rings.
pub(crate) fn run_500() -> Vec<Figure> {
    let mut figures = Vec::new();
    come_to_rest(500, &mut figures);
    figures
}

/// 1000 rings.
pub(crate) fn run_1000() -> Vec<Figure> {
    let mut figures = Vec::new();
    come_to_rest(1000, &mut figures);
    figures
}

fn come_to_rest(count: u32, figures: &mut Vec<Figure>) {
    let (bodies, environment) = built_in(&format!("rings:{count}"));
    let mut world = world(environment, &bodies);
    let bodies = world.bodies().to_vec();
    let energy = |states: &[BodyState]| -> f64 {
        let moving = bodies.iter().zip(states).filter(|(body, _)| body.is_dynamic());
        moving.map(|(body, state)| kinetic_energy(body, state)).sum()
    };
    let mut linkage = Linkage::new(&world, THICK);
    let (mut deepest, mut peak) = (0.0f64, 0.0f64);
    let (clock, mut watching) = (Clock::system(), 0.0);
    let began = clock.now();
    watch(&mut world, SECONDS, |_, states| {
        let paused = clock.now();
        linkage.follow(states);
        deepest = linkage.overlaps().into_iter().fold(deepest, f64::max);
        peak = peak.max(energy(states));
        watching += (clock.now() - paused).as_secs_f64();
    });
    let step_seconds = ((clock.now() - began).as_secs_f64() - watching) / SECONDS;
    let mut overlaps = linkage.overlaps();
    overlaps.sort_by(f64::total_cmp);
    let part = |percentile: f64| {
        let k = (overlaps.len() as f64 * percentile) as usize;
        overlaps
            .get(k.min(overlaps.len().saturating_sub(1)))
            .map_or(0.0, |overlap| overlap / THICK.tube_radius)
    };
    let name = |what: &str| format!("{count} rings: {what}");
    through(&name, &linkage, figures);
    figures.extend([
        Figure::at_most(name("deepest overlap at rest, part of the tube's radius"), part(1.0), DEEPEST_MAX),
        Figure::at_most(
            name("99th percentile of overlaps at rest, part of the tube's radius"),
            part(0.99),
            PERCENTILE_99_MAX,
        ),
        Figure::reported(name("median of overlaps at rest, part of the tube's radius"), part(0.5)),
        Figure::reported(name("deepest overlap ever, m"), deepest),
        Figure::at_most(
            name("kinetic energy at the end, part of its peak"),
            energy(world.states()) / peak,
            ENERGY_MAX,
        ),
        Figure::time_at_most(name("time of the step for a second, s"), step_seconds, STEP_SECONDS_MAX),
    ]);
}

fn through(name: &impl Fn(&str) -> String, linkage: &Linkage, figures: &mut Vec<Figure>) {
    let (rings, poles) = (f64::from(linkage.ring_changes), f64::from(linkage.pole_changes));
    figures.push(Figure::at_most(name("links of rings made or broken"), rings, 0.0));
    figures.push(Figure::at_most(name("rings that went through a pole"), poles, 0.0));
}

/// 100 thin rings in a cloud that falls at `speed` (m/s) over 25 poles, until they have settled, turned in two ways.
fn fast(speed: f32, figures: &mut Vec<Figure>) {
    for seed in 1..=2 {
        let mut world = cloud(speed, seed);
        let mut linkage = Linkage::new(&world, THIN);
        let mut deepest = 0.0f64;
        watch(&mut world, 2.5, |_, states| {
            linkage.follow(states);
            deepest = linkage.overlaps().into_iter().fold(deepest, f64::max);
        });
        let name = |what: &str| format!("100 thin rings at {speed} m/s, cloud {seed}: {what}");
        through(&name, &linkage, figures);
        figures.push(Figure::reported(
            name("deepest overlap ever, part of the tube's radius"),
            deepest / THIN.tube_radius,
        ));
    }
}

fn cloud(speed: f32, seed: u64) -> World {
    const PITCH: f32 = 1.5;
    let mut random = Random::new(seed);
    let mut bodies = vec![BodyDef::fixed(Shape::half_space())];
    for i in 0..25 {
        let foot = Vec3::new((i % 5) as f32 - 2.0, 0.0, (i / 5) as f32 - 2.0) * 1.6;
        let pole = Shape::Cylinder(Cylinder { half_height: 1.5, radius: 0.1 });
        bodies.push(BodyDef::fixed(pole).at(foot + Vec3::Y * 1.5));
    }
    let mesh = mesh_make::torus(THIN.radius as f32, THIN.tube_radius as f32, 64, 12);
    let ring = Shape::Mesh(Arc::new(mesh.expect("a torus that is wider than thick is possible")));
    for i in 0..100 {
        let (layer, cell) = (i / 16, i % 16);
        let lattice = Vec3::new((cell % 4) as f32 - 1.5, 0.8 * layer as f32, (cell / 4) as f32 - 1.5) * PITCH;
        let shift = Vec3::new(0.2 * random.signed(), 4.2, 0.2 * random.signed());
        let mut def = BodyDef::new(ring.clone()).at(lattice + shift);
        def.pose.rotation = any_rotation(&mut random);
        def.velocity = Vec3::NEG_Y * speed;
        bodies.push(def);
    }
    world(Environment::default(), &bodies)
}
