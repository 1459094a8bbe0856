//! Kapla: a tower of 102 loose blocks, which is stable and has to stand.
//!
//! SimBenchmark, *kapla* (leggedrobotics): blocks of 10 kg, frames of 10 ms, up to 600 s; the tower has collapsed when the centre of its last block
//! is below 1 m. Published frames until then, of 60000: RaiSim 25 to 60000 (10 to 1000 iterations), Bullet 24 to 55058, ODE 40 to 6453, MuJoCo 218 to
//! 3397, DART 17 to 19.

use forerun::dynamics::{Material, StepSettings};

use crate::validate::Figure;
use crate::validate::gauge::Gauge;
use crate::validate::lab::{built_in, moved, watch, world, worst};

const COLLAPSED_BELOW: f32 = 1.0;
const MOVED_MAX: f64 = 0.005;
/// Frames between two measurements of the overlap.
const GAUGED_EVERY: u32 = 50;

/// Whether bodies may come to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rest {
    /// As the default settings have it.
    Default,
    /// Never: what the solver does with the tower alone.
    Off,
}

/// 60 s, with the friction of the case and with the default.
pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    tower(0.8, Rest::Default, 60.0, &mut figures);
    tower(0.5, Rest::Default, 60.0, &mut figures);
    tower(0.8, Rest::Off, 60.0, &mut figures);
    figures
}

/// 600 s.
pub(crate) fn run_long() -> Vec<Figure> {
    let mut figures = Vec::new();
    tower(0.8, Rest::Default, 600.0, &mut figures);
    tower(0.8, Rest::Off, 600.0, &mut figures);
    figures
}

fn tower(friction: f32, rest: Rest, seconds: f64, figures: &mut Vec<Figure>) {
    let (mut bodies, mut environment) = built_in("kapla");
    for body in &mut bodies {
        body.material = Material::new(friction, 0.0);
    }
    if rest == Rest::Off {
        environment.settings = StepSettings { rest_seconds: 0.0, ..environment.settings };
    }
    let mut world = world(environment, &bodies);
    let (gauge, first) = (Gauge::new(&world), world.states().to_vec());
    let (mut frame, mut stood, mut deepest) = (0u32, 0u32, 0.0f64);
    watch(&mut world, seconds, |_, states| {
        let up = states.last().is_some_and(|last| last.position.y >= COLLAPSED_BELOW);
        if up && stood == frame {
            stood += 1;
        }
        frame += 1;
        if frame.is_multiple_of(GAUGED_EVERY) {
            deepest = deepest.max(gauge.deepest(states));
        }
    });
    let moved = worst(&first, world.states(), moved);
    let resting = if rest == Rest::Off { ", never at rest" } else { "" };
    let name = |what: &str| format!("friction {friction}{resting}, {seconds} s: {what}");
    let judged = friction > 0.7 && rest == Rest::Default;
    let all = f64::from(frame);
    let (stood_name, moved_name) = (name("frames until it collapses"), name("largest displacement, m"));
    figures.extend(if judged {
        [Figure::at_least(stood_name, f64::from(stood), all), Figure::at_most(moved_name, moved, MOVED_MAX)]
    } else {
        [Figure::reported(stood_name, f64::from(stood)), Figure::reported(moved_name, moved)]
    });
    figures.push(Figure::reported(name("deepest overlap, m"), deepest));
}
