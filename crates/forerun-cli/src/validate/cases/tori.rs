//! Tori: heaps of fat rings that fall on each other come to exact rest, whichever way they were turned.

use forerun::timeline::check::Random;

use crate::validate::Figure;
use crate::validate::facets::Facets;
use crate::validate::lab::{any_rotation, built_in, watch, world};
use crate::validate::linkage::{Linkage, Torus};

const TORUS: Torus = Torus { radius: 0.5, tube_radius: 0.2 };
const SECONDS: f64 = 30.0;
/// Some start inside of each other; by then the first have landed. Seconds
const APART_AFTER: f64 = 0.6;
const IMPACT_MAX: f64 = 0.03;
const REST_MAX: f64 = 0.008;

/// 50 tori, three ways.
pub(crate) fn run() -> Vec<Figure> {
    heaps(50, 3)
}

/// 50 and 200 tori, ten ways.
pub(crate) fn run_long() -> Vec<Figure> {
    let mut figures = heaps(50, 10);
    figures.extend(heaps(200, 10));
    figures
}

/// Drops `count` tori, turned at random in so many ways.
fn heaps(count: u32, ways: u64) -> Vec<Figure> {
    let (mut awake, mut changes, mut seconds) = (0, 0, Vec::new());
    let (mut impact, mut rest, mut rest_overlaps) = (0.0f64, 0.0f64, Vec::new());
    let mut true_rest = 0.0f64;
    for way in 1..=ways {
        let heap = heap(count, way);
        awake += heap.awake;
        changes += heap.changes;
        seconds.push(heap.seconds);
        impact = impact.max(heap.impact);
        rest = heap.overlaps.iter().copied().fold(rest, f64::max);
        true_rest = true_rest.max(heap.true_overlap);
        rest_overlaps.extend(heap.overlaps);
    }
    let mean = rest_overlaps.iter().sum::<f64>() / (rest_overlaps.len() as f64).max(1.0);
    let name = |what: &str| format!("{count} tori, {ways} ways: {what}");
    vec![
        Figure::at_most(name("not at rest after 30 s"), f64::from(awake), 0.0),
        Figure::reported(name("longest time until all rest, s"), seconds.iter().copied().fold(0.0, f64::max)),
        Figure::reported(name("mean time until all rest, s"), seconds.iter().sum::<f64>() / ways as f64),
        Figure::at_most(name("links made or broken"), f64::from(changes), 0.0),
        Figure::at_most(name("deepest overlap, m"), impact, IMPACT_MAX),
        Figure::at_most(name("deepest overlap at rest, m"), rest, REST_MAX),
        Figure::reported(name("mean overlap at rest, m"), mean),
        Figure::at_most(name("deepest overlap of the meshes at rest, m"), true_rest, REST_MAX),
    ]
}

/// How a heap fared.
struct Heap {
    /// Bodies that had not come to rest at the end.
    awake: u32,
    /// When all had. Seconds
    seconds: f64,
    /// Links made or broken.
    changes: u32,
    /// Deepest overlap once all are apart. Metres
    impact: f64,
    /// Of tori, at the end. Metres
    overlaps: Vec<f64>,
    /// Deepest of the meshes, which lie within the tori, at the end. Metres
    true_overlap: f64,
}

fn heap(count: u32, way: u64) -> Heap {
    let (mut bodies, environment) = built_in(&format!("tori:{count}"));
    let mut random = Random::new(way);
    for body in &mut bodies[1..] {
        body.pose.rotation = any_rotation(&mut random);
    }
    let mut world = world(environment, &bodies);
    let mut linkage = Linkage::new(&world, TORUS);
    let full = environment.settings.rest_frames();
    let (mut impact, mut seconds) = (0.0f64, SECONDS);
    watch(&mut world, SECONDS, |time, states| {
        if states[1..].iter().any(|state| state.rest <= full) {
            seconds = SECONDS;
        } else {
            seconds = seconds.min(time);
        }
        if seconds == SECONDS {
            linkage.follow(states);
            if time > APART_AFTER {
                impact = linkage.overlaps().into_iter().fold(impact, f64::max);
            }
        }
    });
    let awake = world.states()[1..].iter().filter(|state| state.rest <= full).count() as u32;
    let true_overlap = Facets::new(&world, TORUS).deepest(world.states());
    Heap { awake, seconds, changes: linkage.ring_changes, impact, overlaps: linkage.overlaps(), true_overlap }
}
