//! Report: an experiment as a page of Markdown that puts the drivers beside each other.

use std::fmt::Write as _;

use forerun::{Playback, Report};

use super::plan::{Figure, Plan};

/// A finished run of a variant.
pub(crate) struct Outcome {
    pub(crate) label: &'static str,
    pub(crate) playback: Playback,
    /// Height of the highest body that is not fixed, at the end. Metres.
    pub(crate) highest_m: f32,
    /// Deepest overlap of any two bodies in any frame, where it was measured. Metres.
    pub(crate) overlap_max_m: Option<f32>,
}

/// One row of the table: its name and what it says of a run.
type Row = (&'static str, fn(&Outcome) -> String);

const ROWS: [Row; 13] = [
    ("pictures", |o| o.playback.report.pictures.to_string()),
    ("late pictures (over 1.5 intervals after the one before)", |o| {
        o.playback.report.late_pictures.to_string()
    }),
    ("longest time between two pictures, ms", |o| format!("{:.1}", o.playback.report.longest_stall_ms)),
    ("starved pictures (a body had no state for the time)", |o| {
        o.playback.report.starved_pictures.to_string()
    }),
    ("delay against real time, largest, s", |o| format!("{:.3}", o.playback.report.delay_max_s)),
    ("delay against real time at the end, s", |o| format!("{:.3}", delay_end_s(&o.playback))),
    ("states in the queue, fewest to most", |o| queue(&o.playback.report)),
    ("most slices of a frame", |o| o.playback.report.slices_max.to_string()),
    ("shortest time step, ms", |o| format!("{:.2}", shortest_step_ms(&o.playback))),
    ("states computed", |o| o.playback.rows.iter().map(|row| row.computed).sum::<u64>().to_string()),
    ("states computed again", |o| o.playback.report.recomputed.to_string()),
    ("centre of the highest body at the end, m", |o| format!("{:.3}", o.highest_m)),
    ("deepest overlap in any frame, mm", |o| match o.overlap_max_m {
        Some(overlap) => format!("{:.1}", 1000.0 * overlap),
        None => "not measured".to_owned(),
    }),
];

/// The page of one experiment. `note` is a line of its own, or empty.
pub(crate) fn markdown(plan: &Plan, outcomes: &[Outcome], note: &str) -> String {
    let mut page = String::new();
    let scene = &plan.scene;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    // Writing to a String cannot fail.
    let _ = writeln!(page, "# Experiment: {}\n\n{}\n", plan.name, plan.question);
    let _ = writeln!(
        page,
        "{} bodies, frames of {:.0} ms, at most 100 states ahead, 30 pictures per second, {cores} cores.",
        scene.bodies.len(),
        1000.0 * scene.frame_seconds,
    );
    if !note.is_empty() {
        let _ = writeln!(page, "{note}");
    }
    page.push_str("\n| |");
    outcomes.iter().for_each(|o| page.push_str(&format!(" {} |", o.label)));
    page.push_str("\n|---|");
    outcomes.iter().for_each(|_| page.push_str("---:|"));
    page.push('\n');
    for (name, cell) in ROWS {
        let _ = write!(page, "| {name} |");
        outcomes.iter().for_each(|o| page.push_str(&format!(" {} |", cell(o))));
        page.push('\n');
    }
    for Figure { file, title, .. } in plan.figures {
        let _ = write!(page, "\n![{title}]({file}.svg)\n");
    }
    page
}

fn delay_end_s(playback: &Playback) -> f64 {
    playback.rows.last().map_or(0.0, |row| row.time_real_s - row.time_display_s)
}

/// The coupled driver has no queue: what it computes is shown at once.
fn queue(report: &Report) -> String {
    if report.queue_max == 0 {
        "none".to_owned()
    } else {
        format!("{} to {}", report.queue_min, report.queue_max)
    }
}

fn shortest_step_ms(playback: &Playback) -> f64 {
    let later = playback.rows.get(1..).unwrap_or_default();
    let shortest = later.iter().map(|row| row.time_step_s).fold(f64::INFINITY, f64::min);
    if shortest.is_finite() { 1000.0 * shortest } else { 0.0 }
}
