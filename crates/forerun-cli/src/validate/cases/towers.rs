//! Towers: 40 cubes dropped or laid on each other, 30 layers of planks, a pyramid of 5 cm cubes.
//!
//! Box3D's samples *Box Stack*, *Jenga Stack* and *Tiny Pyramid*, with its gravity of 10 m/s² and friction of 0.6; it has rolling resistance besides,
//! which there is none of here.

use forerun::dynamics::{BodyState, World};

use crate::validate::Figure;
use crate::validate::gauge::Gauge;
use crate::validate::lab::{built_in, fastest, moved, turned, watch, world, worst};

/// At the end nothing may be faster. m/s
const STILL: f64 = 0.001;
/// A body that has turned by more has fallen. Degrees
const FALLEN: f64 = 10.0;
/// Frames between two measurements of the overlap.
const GAUGED_EVERY: u32 = 30;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    falling(&mut figures);
    touching(&mut figures);
    planks(&mut figures);
    tiny(&mut figures);
    figures
}

/// What was seen of a scene.
struct Seen {
    first: Vec<BodyState>,
    last: Vec<BodyState>,
    /// Seconds after which nothing was faster than [`STILL`].
    still_after: f64,
    /// Metres, over the whole run and at its end.
    deepest: f64,
    deepest_at_end: f64,
}

fn see(scene: &str, seconds: f64) -> Seen {
    let (bodies, environment) = built_in(scene);
    let mut world: World = world(environment, &bodies);
    let (gauge, first) = (Gauge::new(&world), world.states().to_vec());
    let (mut frame, mut deepest, mut still_after) = (0u32, 0.0f64, 0.0);
    watch(&mut world, seconds, |time, states| {
        frame += 1;
        if frame.is_multiple_of(GAUGED_EVERY) {
            deepest = deepest.max(gauge.deepest(states));
        }
        if fastest(states) > STILL {
            still_after = time;
        }
    });
    let last = world.states().to_vec();
    let deepest_at_end = gauge.deepest(&last);
    Seen { first, last, still_after, deepest, deepest_at_end }
}

impl Seen {
    /// How many bodies have turned by more than [`FALLEN`].
    fn fallen(&self) -> f64 {
        self.first.iter().zip(&self.last).filter(|(a, b)| turned(a, b) > FALLEN).count() as f64
    }

    /// How much lower than `height` the last body is. Metres
    fn top_below(&self, height: f64) -> f64 {
        self.last.last().map_or(f64::NAN, |top| height - f64::from(top.position.y))
    }

    /// How far the last body is from where it was, seen from above. Metres
    fn top_drift(&self) -> f64 {
        let (Some(a), Some(b)) = (self.first.last(), self.last.last()) else { return f64::NAN };
        f64::from(b.position.x - a.position.x).hypot(f64::from(b.position.z - a.position.z))
    }

    fn quiet(&self, name: &str) -> [Figure; 2] {
        [
            Figure::at_most(format!("{name}: fastest body at the end, m/s"), fastest(&self.last), STILL),
            Figure::reported(format!("{name}: time until nothing moves, s"), self.still_after),
        ]
    }
}

/// (a) 40 cubes that fall together.
fn falling(figures: &mut Vec<Figure>) {
    let seen = see("falling_tower", 30.0);
    let name = "(a) 40 cubes, falling";
    figures.extend([
        Figure::at_most(format!("{name}: cubes that have fallen over"), seen.fallen(), 0.0),
        Figure::at_most(
            format!("{name}: top cube lower than on a whole tower, m"),
            seen.top_below(39.5),
            0.5,
        ),
        Figure::reported(format!("{name}: drift of the top cube, m"), seen.top_drift()),
        Figure::at_most(format!("{name}: deepest overlap at the end, m"), seen.deepest_at_end, 0.01),
        Figure::reported(format!("{name}: deepest overlap, m"), seen.deepest),
    ]);
    figures.extend(seen.quiet(name));
}

/// (a') 40 cubes that touch.
fn touching(figures: &mut Vec<Figure>) {
    let seen = see("tower", 120.0);
    let name = "(a') 40 cubes, touching";
    figures.extend([
        Figure::at_most(format!("{name}: drift of the top cube, m"), seen.top_drift(), 0.02),
        Figure::at_most(format!("{name}: loss of height, m"), seen.top_below(39.5), 0.4),
        Figure::at_most(format!("{name}: deepest overlap, m"), seen.deepest, 0.01),
    ]);
    figures.extend(seen.quiet(name));
}

/// (b) 30 layers of two planks. The lowest begin 5 cm deep in the ground, so that the overlap is judged at the end.
fn planks(figures: &mut Vec<Figure>) {
    let seen = see("jenga", 30.0);
    let name = "(b) 30 layers of planks";
    // The middle of the highest layer, when all lie on each other: 29 layers of 0.2 m below it.
    figures.extend([
        Figure::at_most(format!("{name}: planks that have fallen over"), seen.fallen(), 0.0),
        Figure::at_most(
            format!("{name}: top plank lower than on a whole tower, m"),
            seen.top_below(5.9),
            0.1,
        ),
        Figure::reported(format!("{name}: drift of the top plank, m"), seen.top_drift()),
        Figure::at_most(format!("{name}: deepest overlap at the end, m"), seen.deepest_at_end, 0.002),
    ]);
    figures.extend(seen.quiet(name));
}

/// (c) A pyramid of 30 rows of 5 cm cubes.
fn tiny(figures: &mut Vec<Figure>) {
    let seen = see("tiny_pyramid", 30.0);
    let name = "(c) 5 cm cubes";
    figures.extend([
        Figure::at_most(format!("{name}: cubes that have fallen over"), seen.fallen(), 0.0),
        Figure::at_most(
            format!("{name}: top cube lower than on a whole pyramid, m"),
            seen.top_below(1.475),
            0.025,
        ),
        Figure::at_most(format!("{name}: deepest overlap, part of a cube"), seen.deepest / 0.05, 0.05),
        Figure::reported(format!("{name}: largest displacement, m"), worst(&seen.first, &seen.last, moved)),
    ]);
    figures.extend(seen.quiet(name));
}
