//! Ball cube: 216 balls without friction collapse; how much they overlap, and, if elastic, whether they keep their energy.
//!
//! SimBenchmark, *666* and *elastic 666* (leggedrobotics). Metric of the first: mean over frames of the sum of squared overlaps. Published at
//! 1 ms: RaiSim 1.35e-4 m², ODE 1.55e-4, DART 2.82e-4, MuJoCo 9.5e-2, Bullet 0.382; at 10 ms: RaiSim 1.53e-2, ODE 1.61e-2, MuJoCo 0.934, Bullet 37.4.
//! Metric of the second: mean square of the error of the energy. Published at 1 ms: RaiSim 8.37 J², ODE 112, Bullet 4.15e4, DART 3.47e5.

use forerun::dynamics::{BodyState, StepSettings, World};

use crate::validate::Figure;
use crate::validate::lab::{built_in, dot, doubled, mechanical_energy, watch, world};

const RADIUS: f64 = 0.1;
const G: f64 = 9.81;
const SECONDS: f64 = 10.0;
/// From then on the cube has settled. Seconds
const SETTLED: f64 = 5.0;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for (rate, limit) in [(1000, Some(1.6e-4)), (100, Some(1.7e-2)), (60, None)] {
        collapse(rate, limit, &mut figures);
    }
    figures
}

/// The elastic cube.
pub(crate) fn run_elastic() -> Vec<Figure> {
    let mut figures = Vec::new();
    for rate in [1000, 250, 100] {
        bounce(rate, &mut figures);
    }
    figures
}

fn at_rate(scene: &str, rate: u32) -> World {
    let (bodies, mut environment) = built_in(scene);
    environment.settings = StepSettings { frame_seconds: 1.0 / rate as f32, ..environment.settings };
    world(environment, &bodies)
}

/// Sum of the squares of all overlaps (m²), and the deepest of two balls (m).
fn overlaps(states: &[BodyState]) -> (f64, f64) {
    let centres: Vec<[f64; 3]> = states[1..].iter().map(|state| doubled(state.position)).collect();
    let (mut sum, mut deepest) = (0.0, 0.0f64);
    for (i, a) in centres.iter().enumerate() {
        let below = (RADIUS - a[1]).max(0.0);
        sum += below * below;
        for b in &centres[..i] {
            let apart = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
            let squared = dot(apart, apart);
            if squared < 4.0 * RADIUS * RADIUS {
                let depth = 2.0 * RADIUS - squared.sqrt();
                sum += depth * depth;
                deepest = deepest.max(depth);
            }
        }
    }
    (sum, deepest)
}

fn collapse(rate: u32, limit: Option<f64>, figures: &mut Vec<Figure>) {
    let mut world = at_rate("ball_cube", rate);
    let (mut sum, mut count, mut deepest, mut settled) = (0.0, 0.0, 0.0f64, 0.0f64);
    watch(&mut world, SECONDS, |time, states| {
        let (squares, depth) = overlaps(states);
        sum += squares;
        count += 1.0;
        deepest = deepest.max(depth);
        if time >= SETTLED {
            settled = settled.max(depth);
        }
    });
    let name = |what: &str| format!("1/{rate}: {what}");
    let metric = name("mean sum of squared overlaps, m²");
    figures.push(match limit {
        Some(limit) => Figure::at_most(metric, sum / count, limit),
        None => Figure::reported(metric, sum / count),
    });
    let part = name("deepest overlap of two balls once settled, part of 2 r");
    figures.push(match limit {
        Some(_) => Figure::reported(part, settled / (2.0 * RADIUS)),
        None => Figure::at_most(part, settled / (2.0 * RADIUS), 0.02),
    });
    figures.push(Figure::reported(name("deepest overlap of two balls, m"), deepest));
}

fn bounce(rate: u32, figures: &mut Vec<Figure>) {
    let mut world = at_rate("elastic_ball_cube", rate);
    let bodies = world.bodies().to_vec();
    let start = mechanical_energy(&bodies, world.states(), G);
    let (mut squares, mut count, mut growth) = (0.0, 0.0, 0.0f64);
    watch(&mut world, SECONDS, |_, states| {
        let energy = mechanical_energy(&bodies, states, G);
        squares += (energy - start) * (energy - start);
        count += 1.0;
        growth = growth.max(energy / start - 1.0);
    });
    let error: f64 = squares / count;
    let name = |what: &str| format!("1/{rate}: {what}");
    let metric = name("mean square error of the energy, J²");
    if rate == 1000 {
        figures.extend([
            Figure::at_most(metric, error, 112.0),
            Figure::at_most(name("the same against the target, J²"), error, 8.4),
        ]);
    } else {
        figures.push(Figure::reported(metric, error));
    }
    figures.push(Figure::reported(name("relative root mean square"), error.sqrt() / start));
    let most = name("most growth of the energy, part");
    figures.push(if rate == 250 {
        Figure::at_most(most, growth, 0.01)
    } else {
        Figure::reported(most, growth)
    });
}
