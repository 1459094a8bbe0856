//! Selective is full re-simulation, bit for bit: 200 random edits on each of six scenes, with 1, 2 and 4 threads.

use std::num::NonZeroU16;

use forerun::Threads;
use forerun::timeline::check::{CheckReport, CheckSettings, check};

use crate::validate::Figure;
use crate::validate::lab::built_in;

const EDITS: u32 = 200;
const THREADS: [u16; 3] = [1, 2, 4];
/// The scenes, and the frames that are computed, kept and compared: fewer where all bodies are one island.
const SCENES: [(&str, u32); 6] = [
    ("many_pyramids", 120),
    ("domino_lines:40", 300),
    ("rings:100", 300),
    ("break", 600),
    ("large_pyramid", 40),
    ("swing", 300),
];

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    for (name, frames) in SCENES {
        for threads in THREADS {
            let title = format!("{name}, {EDITS} edits, {frames} frames, threads {threads}");
            let Some(report) = checked(name, frames, threads) else {
                // Nothing was shown, which is no agreement.
                figures.push(Figure::at_least(format!("{title}: comparisons made"), 0.0, 1.0));
                continue;
            };
            let (wrong, affected) = (report.mismatches as f64, report.affected as f64);
            figures.push(Figure::at_most(format!("{title}: states that differ"), wrong, 0.0));
            let ratio = report.recomputed as f64 / affected;
            figures.push(Figure::reported(format!("{title}: computed over changed"), ratio));
        }
    }
    figures
}

fn checked(name: &str, frames: u32, threads: u16) -> Option<CheckReport> {
    let (bodies, environment) = built_in(name);
    // Other edits for each thread count.
    let seed = u64::from(threads);
    let settings =
        CheckSettings { edits: EDITS, seed, frames, compare_every: 20, ..CheckSettings::default() };
    let threads = Threads::exactly(NonZeroU16::new(threads)?).ok()?;
    threads.install(|| check(&bodies, environment, &settings, &mut |_| {})).ok()
}
