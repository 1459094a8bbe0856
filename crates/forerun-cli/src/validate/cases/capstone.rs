//! Capstone: cubes of 100, 200 and 300 times the mass fall on pyramids of light cubes.
//!
//! Box3D's sample *HighMassRatio1* and PEEL's *HighMassRatio*: pyramids of ten rows of 2 m cubes of density 1, gravity 10 m/s², friction 0.6; the top cube is
//! dropped by 2 m.

use std::ops::Range;

use forerun::dynamics::BodyState;

use crate::validate::Figure;
use crate::validate::gauge::Gauge;
use crate::validate::lab::{built_in, watch, world};

const ROWS: usize = 10;
const CUBES: usize = 55;
const EDGE: f64 = 2.0;
const SECONDS: f64 = 30.0;
const OVERLAP_PART_MAX: f64 = 0.03;
const LOSS_PART_MAX: f64 = 0.02;

pub(crate) fn run() -> Vec<Figure> {
    let (bodies, environment) = built_in("capstone");
    let mut world = world(environment, &bodies);
    let (gauge, first) = (Gauge::new(&world), world.states().to_vec());
    let mut deepest = 0.0f64;
    let mut stands_until = [0.0; 3];
    watch(&mut world, SECONDS, |time, states| {
        deepest = deepest.max(gauge.deepest(states));
        for (pyramid, until) in stands_until.iter_mut().enumerate() {
            if loss(&first, states, pyramid) <= LOSS_PART_MAX {
                *until = time;
            }
        }
    });
    let last = world.states();
    let mut figures = Vec::new();
    for (pyramid, until) in stands_until.into_iter().enumerate() {
        let name = |what: &str| format!("{} : 1: {what}", 100 * (pyramid + 1));
        let top = 1 + CUBES * (pyramid + 1) - 1;
        let height = EDGE * (ROWS as f64 - 0.5);
        let fallen = height - f64::from(last[top].position.y);
        figures.extend([
            Figure::at_most(name("top cube lower than on a whole pyramid, m"), fallen, 0.5 * EDGE),
            Figure::at_most(
                name("most loss of height of a row, part"),
                loss(&first, last, pyramid),
                LOSS_PART_MAX,
            ),
            Figure::reported(name("rows at their height until, s"), until),
        ]);
    }
    figures.push(Figure::at_most("deepest overlap, part of a cube", deepest / EDGE, OVERLAP_PART_MAX));
    figures.push(Figure::reported("deepest overlap at the end, m", gauge.deepest(last)));
    figures
}

/// The most that a cube of one of the nine lower rows is lower than at first, as a part of its first height.
fn loss(first: &[BodyState], now: &[BodyState], pyramid: usize) -> f64 {
    let cubes: Range<usize> = 1 + CUBES * pyramid..CUBES * (pyramid + 1);
    let part = |i: usize| {
        let (before, after) = (f64::from(first[i].position.y), f64::from(now[i].position.y));
        (before - after) / (before + 0.5 * EDGE)
    };
    cubes.map(part).fold(0.0, f64::max)
}
