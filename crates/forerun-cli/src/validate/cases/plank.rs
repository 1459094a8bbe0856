//! Plank: seven cubes settle on a plank over an edge until a box of 100 kg, 38 m/s fast, makes it a catapult.
//!
//! PhysBAM, Plank_Test (Guendelman, Bridson, Fedkiw 2003): g = 9.8 m/s², 20 s. The original stops bodies at 20 m/s; here they are not.

use std::ops::Range;

use crate::validate::Figure;
use crate::validate::gauge::Gauge;
use crate::validate::lab::{angle_between, built_in, doubled, environment, mechanical_energy, watch, world};

const G: f64 = 9.8;
/// Frames a second; the first is judged.
const RATES: [u32; 2] = [60, 240];
const PLANK: usize = 2;
const CUBES: Range<usize> = 3..10;
const BEFORE_IMPACT: f64 = 3.6;
/// The box lands on the plank at 3.78 s. Seconds
const IMPACT: Range<f64> = 3.7..4.0;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for rate in RATES {
        catapult(rate, &mut figures);
    }
    figures
}

fn catapult(rate: u32, figures: &mut Vec<Figure>) {
    let (defs, scene_environment) = built_in("plank");
    let mut world = world(environment(scene_environment.gravity, rate), &defs);
    let (gauge, bodies) = (Gauge::new(&world), world.bodies().to_vec());
    let start = mechanical_energy(&bodies, world.states(), G);
    let (mut tilt, mut excess, mut launch) = (0.0f64, 0.0f64, 0.0f64);
    let (mut at_impact, mut otherwise) = (0.0f64, 0.0f64);
    watch(&mut world, 20.0, |time, states| {
        if time < BEFORE_IMPACT {
            let up = doubled(states[PLANK].rotation * forerun::geometry::Vec3::Y);
            tilt = tilt.max(angle_between(up, [0.0, 1.0, 0.0]));
        }
        excess = excess.max(mechanical_energy(&bodies, states, G) / start - 1.0);
        let deepest = gauge.deepest(states);
        if IMPACT.contains(&time) {
            at_impact = at_impact.max(deepest);
        } else {
            otherwise = otherwise.max(deepest);
        }
        if time > IMPACT.start {
            let heights = states[CUBES].iter().map(|cube| f64::from(cube.position.y));
            launch = heights.fold(launch, f64::max);
        }
    });
    let name = |what: &str| format!("1/{rate}: {what}");
    let judged = |what: &str, value: f64, limit: f64| {
        if rate == RATES[0] {
            Figure::at_most(name(what), value, limit)
        } else {
            Figure::reported(name(what), value)
        }
    };
    figures.extend([
        judged("tilt of the plank before the impact, degrees", tilt, 3.0),
        judged("most excess of energy, part", excess, 0.01),
        judged("deepest overlap at the impact, m", at_impact, 0.1),
        judged("deepest overlap otherwise, m", otherwise, 0.01),
        Figure::reported(name("highest cube after the impact, m"), launch),
    ]);
}
