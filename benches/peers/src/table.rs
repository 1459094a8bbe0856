//! Table: the rows as one Markdown table, every engine on a line of its own.

use std::fmt::Write as _;

use crate::engine::Kind;
use crate::rounds::{Measured, Row, StepTimes};
use crate::row::Outcome;

/// The table. In our rows the column `ours / best` compares with the fastest other engine on the same scene and threads.
pub(crate) fn markdown(rows: &[Row]) -> String {
    let mut text = String::from(
        "| scene | threads | engine | mean ms | median | p99 | max | first | ours / best | overlap mm: worst / end | energy, most / first | end speed mm/s | the scene's own | peak MiB | rounds |\n\
         |---|---:|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---|---:|---:|\n",
    );
    for row in rows {
        let cells = match &row.outcome {
            Outcome::Measured(measured) => measured_cells(row, measured, rows),
            Outcome::Cannot(why) => format!("cannot: {why}{}", " |".repeat(11)),
        };
        let scene = format!("{} ({} bodies, {} frames)", row.scene, row.bodies, row.frames);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| {scene} | {} | {}{} | {cells} |", row.threads, row.engine, hulls(row));
    }
    text
}

/// How finely moving meshes were cut for the engine: it decides much of its time.
fn hulls(row: &Row) -> String {
    match row.measured().map(|m| m.quality.hulls_per_mesh) {
        None | Some(0) => String::new(),
        Some(hulls) => format!(", {hulls} hulls a mesh"),
    }
}

fn measured_cells(row: &Row, m: &Measured, rows: &[Row]) -> String {
    let (q, t) = (&m.quality, m.counted(row.threads));
    let mm = |metres: f32| format!("{:.1}", 1000.0 * metres);
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    [
        format!("{:.3}", t.mean_ms),
        format!("{:.3}", t.median_ms),
        format!("{:.3}", t.p99_ms),
        format!("{:.3}", t.max_ms),
        format!("{:.3}", t.first_ms),
        or_dash(ratio(row, t, rows)),
        format!("{} / {}", mm(q.overlap_max_m), mm(q.overlap_end_m)),
        or_dash(q.energy_max_over_initial.map(|part| format!("{part:.5}"))),
        format!("{:.2}", 1000.0 * q.speed_end),
        q.own_text(),
        or_dash(m.peak_bytes.map(|bytes| format!("{:.0}", bytes as f64 / 1_048_576.0))),
        format!("+{:.0} %", 100.0 * unrest(t)),
    ]
    .join(" | ")
}

/// Our mean over the best other's, and the same for the luckiest and unluckiest pair of rounds. None but for us.
fn ratio(row: &Row, ours: &StepTimes, rows: &[Row]) -> Option<String> {
    if row.kind != Kind::Forerun {
        return None;
    }
    let peers = rows.iter().filter(|other| {
        other.kind != Kind::Forerun && other.scene == row.scene && other.threads == row.threads
    });
    let best = peers.filter_map(Row::times).min_by(|a, b| a.mean_ms.total_cmp(&b.mean_ms))?;
    let rounds = ours.round_means_ms.iter().zip(&best.round_means_ms).map(|(our, peer)| our / peer);
    let (low, high) = rounds.fold((f64::INFINITY, 0.0_f64), |(low, high), r| (low.min(r), high.max(r)));
    Some(format!("**{:.2}** ({low:.2}-{high:.2})", ours.mean_ms / best.mean_ms))
}

/// How much slower the slowest round was than the fastest, as a part of the fastest.
fn unrest(m: &StepTimes) -> f64 {
    let fastest = m.round_means_ms.iter().copied().fold(f64::INFINITY, f64::min);
    let slowest = m.round_means_ms.iter().copied().fold(0.0, f64::max);
    slowest / fastest - 1.0
}
