//! Memory: what a state, a fork and a snapshot of 10 000 bodies cost, and whether budgets of bytes are kept (case D04).
//!
//! The worst case on purpose: 10 000 balls in free fall, so that no state is like the one before it.

use forerun::timeline::Progress;
use forerun::{BodyDef, Clock, Environment, Frame, Shape, Sphere, Timeline, TimelineSettings, Vec3};

use crate::bench::memory;
use crate::stats::Spread;
use crate::validate::Figure;

const BODIES: u32 = 10_000;
const SIDE: u32 = 100;
const MIB: f64 = 1024.0 * 1024.0;
/// Frames that the display shows.
const SHOWN: u64 = 200;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    costs(&mut figures);
    for (budget_mib, lookahead) in [(64, 30), (64, 300), (64, 3000), (256, 300), (256, 3000)] {
        budget(&mut figures, budget_mib, lookahead);
    }
    figures
}

fn falling() -> Vec<BodyDef> {
    let place = |i: u32| Vec3::new((i % SIDE) as f32, 0.0, (i / SIDE) as f32);
    let ball = Shape::Sphere(Sphere { radius: 0.25 });
    (0..BODIES).map(|i| BodyDef::new(ball.clone()).at(place(i))).collect()
}

fn timeline(settings: TimelineSettings) -> Option<Timeline> {
    Timeline::new(&falling(), Environment::default(), settings).ok()
}

/// States, forks and snapshots.
fn costs(figures: &mut Vec<Figure>) {
    let settings = TimelineSettings { lookahead: 100, ..TimelineSettings::default() };
    let Some(mut timeline) = timeline(settings) else { return };
    let first = timeline.state_bytes();
    while timeline.advance() != Progress::Idle {}
    let moving = (timeline.state_bytes() - first) as f64 / (100.0 * f64::from(BODIES));
    figures.push(Figure::at_most("bytes for a moving body and frame", moving, 64.0));

    let clock = Clock::system();
    let microseconds = |act: &mut dyn FnMut()| {
        let began = clock.now();
        act();
        1e6 * (clock.now() - began).as_secs_f64()
    };
    let mut forks = Vec::new();
    let forking: Vec<f64> = (0..200).map(|_| microseconds(&mut || forks.push(timeline.fork()))).collect();
    figures.push(Figure::time_at_most("a fork, us: median", Spread::of(&forking).median, 100.0));
    drop(forks);
    let mut snapshots = Vec::new();
    let taking: Vec<f64> =
        (0..200).map(|_| microseconds(&mut || snapshots.push(timeline.snapshot()))).collect();
    figures.push(Figure::time_at_most("a snapshot, us: median", Spread::of(&taking).median, 100.0));
}

/// A display that moves on while physics may use so much memory.
fn budget(figures: &mut Vec<Figure>, budget_mib: u32, lookahead: u32) {
    let bytes_max = f64::from(budget_mib) * MIB;
    let settings = TimelineSettings {
        lookahead,
        past: lookahead,
        bytes_max: Some(bytes_max as usize),
        ..TimelineSettings::default()
    };
    let Some(mut timeline) = timeline(settings) else { return };
    memory::restart_peak();
    let resident = memory::peak_bytes();
    let (mut most, mut deepest, mut skipped, mut expected) = (0, 0, 0_u32, Frame(1));
    for display in 0..SHOWN {
        timeline.set_display(Frame(display));
        while let Progress::Advanced(done) = timeline.advance() {
            skipped += u32::from(done.frame != expected);
            expected = done.frame.next();
            most = most.max(timeline.state_bytes());
        }
        deepest = deepest.max(timeline.stats().lookahead_frames);
    }
    let stats = timeline.stats();
    let name = |what: &str| format!("{budget_mib} MiB, lookahead {lookahead}: {what}");
    figures.push(Figure::at_most(name("states, most of the budget"), most as f64 / bytes_max, 1.05));
    figures.push(Figure::at_most(name("deepest, frames"), deepest as f64, f64::from(lookahead)));
    figures.push(Figure::at_most(name("frames lost, repeated or out of order"), f64::from(skipped), 0.0));
    figures.push(Figure::reported(name("frames ahead at the end"), stats.lookahead_frames as f64));
    figures.push(Figure::reported(name("frames of past at the end"), stats.past_frames as f64));
    let is_short = f64::from(u8::from(stats.memory_bound));
    let past = u64::from(lookahead).min(SHOWN - 1);
    let short = stats.lookahead_frames < u64::from(lookahead) || stats.past_frames < past;
    let should_be = f64::from(u8::from(short));
    figures.push(Figure::near(name("says that memory is short"), is_short, should_be, 0.0));
    if let (Some(before), Some(after)) = (resident, memory::peak_bytes()) {
        let grown = after.saturating_sub(before) as f64;
        figures.push(Figure::reported(name("resident memory added, part of the budget"), grown / bytes_max));
    }
}
