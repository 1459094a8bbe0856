//! Card house: five levels of cards 2 mm thick, which stand by friction alone.
//!
//! PEEL, *CardHouse*, and Box3D's sample of it: cards of 10 g, friction 0.7. Box3D does not pass it at this thickness, by its own comment. It begins with cards
//! some millimetres apart and some millimetres in the ground: it has to settle, not to explode.

use forerun::dynamics::StepSettings;

use crate::validate::Figure;
use crate::validate::gauge::Gauge;
use crate::validate::lab::{built_in, fastest, moved, turned, watch, world};

const MOVED_MAX: f64 = 0.03;
const TURNED_MAX: f64 = 5.0;
const SPEED_MAX: f64 = 0.5;
const CARDS: f64 = 40.0;
/// Frames a second; the first is judged.
const RATES: [u32; 2] = [240, 60];

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for rate in RATES {
        house(rate, &mut figures);
    }
    figures
}

fn house(rate: u32, figures: &mut Vec<Figure>) {
    let (bodies, mut environment) = built_in("card_house");
    environment.settings = StepSettings { frame_seconds: 1.0 / rate as f32, ..environment.settings };
    let mut world = world(environment, &bodies);
    let (gauge, first) = (Gauge::new(&world), world.states().to_vec());
    let (mut speed, mut stands_until) = (0.0f64, 0.0);
    watch(&mut world, 10.0, |time, states| {
        speed = speed.max(fastest(states));
        if first.iter().zip(states).all(|(a, b)| moved(a, b) <= MOVED_MAX && turned(a, b) <= TURNED_MAX) {
            stands_until = time;
        }
    });
    let last = world.states();
    let pairs = || first.iter().zip(last).skip(1);
    let in_place = pairs().filter(|(a, b)| moved(a, b) <= MOVED_MAX && turned(a, b) <= TURNED_MAX).count();
    let name = |what: &str| format!("1/{rate}: {what}");
    let (in_place_name, speed_name) = (name("cards in place after 10 s"), name("fastest card ever, m/s"));
    figures.extend(if rate == RATES[0] {
        [
            Figure::at_least(in_place_name, in_place as f64, CARDS),
            Figure::at_most(speed_name, speed, SPEED_MAX),
        ]
    } else {
        [Figure::reported(in_place_name, in_place as f64), Figure::reported(speed_name, speed)]
    });
    figures.extend([
        Figure::reported(
            name("largest displacement, m"),
            pairs().map(|(a, b)| moved(a, b)).fold(0.0, f64::max),
        ),
        Figure::reported(
            name("largest turn, degrees"),
            pairs().map(|(a, b)| turned(a, b)).fold(0.0, f64::max),
        ),
        Figure::reported(name("all in place until, s"), stands_until),
        Figure::reported(name("deepest overlap at the end, m"), gauge.deepest(last)),
    ]);
}
