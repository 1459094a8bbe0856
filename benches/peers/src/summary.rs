//! Summary: a line a scene with the engines side by side: the time on one thread, on several, and what it was paid for.

use std::fmt::Write as _;

use crate::engine::Kind;
use crate::quality::Quality;
use crate::rounds::{Measured, Row};
use crate::row::Outcome;
use crate::sets;

/// A small difference in overlap is nobody's merit. Metres.
const SAME_OVERLAP_M: f32 = 1e-3;
/// A small difference in how a scene stands at the end is nobody's merit. Metres.
const SAME_PLACE_M: f32 = 2e-3;
/// What mechanical energy may rise to, over that at the start.
const ENERGY_MOST: f64 = 1.0001;

/// Markdown tables: one a thread count, one of the quality.
pub(crate) fn markdown(rows: &[Row]) -> String {
    let mut threads: Vec<u16> = rows.iter().map(|row| row.threads).collect();
    threads.sort_unstable();
    threads.dedup();
    let side_by_side = Side { rows, kinds: kinds(rows) };
    let mut text = String::new();
    for count in threads {
        text += &if count == 1 { side_by_side.one_thread() } else { side_by_side.several(count) };
        text.push('\n');
    }
    text + &side_by_side.quality()
}

/// Those that were run, ours first.
fn kinds(rows: &[Row]) -> Vec<Kind> {
    let mut kinds: Vec<Kind> = rows.iter().map(|row| row.kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    kinds
}

struct Side<'a> {
    rows: &'a [Row],
    kinds: Vec<Kind>,
}

impl Side<'_> {
    fn one_thread(&self) -> String {
        let mut text = format!(
            "One thread, CPU milliseconds a step: mean / p99 / first step.\n\n{}",
            self.head("ours / best | goal | our first step / mean")
        );
        for scene in self.scenes() {
            let cells = self.cells(scene, 1, |row, m| {
                let t = m.counted(row.threads);
                format!("{} / {} / {}", short(t.mean_ms), short(t.p99_ms), short(t.first_ms))
            });
            let first = self.ours(scene, 1).and_then(Row::times).map(|t| t.first_ms / t.mean_ms);
            let goal = sets::goal(scene).map_or_else(|| "-".to_owned(), |goal| format!("{goal}"));
            let ends = format!("{} | {goal} | {}", self.ratio(scene, 1), times(first));
            line(&mut text, &self.title(scene), &cells, &ends);
        }
        text
    }

    fn several(&self, threads: u16) -> String {
        let mut text = format!(
            "{threads} threads, wall milliseconds a step: mean / p99 (CPU); how many times faster than on one thread, wall over wall.\n\n{}",
            self.head("ours / best")
        );
        for scene in self.scenes() {
            let cells = self.cells(scene, threads, |row, m| {
                let alone = self.row(scene, row.kind, 1).and_then(Row::measured);
                let gain = alone.map(|alone| alone.wall.mean_ms / m.wall.mean_ms);
                let (wall, cpu) = (&m.wall, &m.cpu);
                format!(
                    "{} / {} ({}); {}",
                    short(wall.mean_ms),
                    short(wall.p99_ms),
                    short(cpu.mean_ms),
                    times(gain)
                )
            });
            line(&mut text, &self.title(scene), &cells, &self.ratio(scene, threads));
        }
        text
    }

    fn quality(&self) -> String {
        let mut text = format!(
            "Overlap at worst / at the end, millimetres; most mechanical energy over the first; the scene's own.\n\n{}",
            self.head("ours against the best of each")
        );
        for scene in self.scenes() {
            let Some(threads) = self.rows.iter().find(|row| row.scene == scene).map(|row| row.threads) else {
                continue;
            };
            let cells = self.cells(scene, threads, |_, m| {
                let q = &m.quality;
                let energy = q.energy_max_over_initial.map_or_else(String::new, |e| format!("; {e:.4}"));
                let (worst, end) = (1000.0 * q.overlap_max_m, 1000.0 * q.overlap_end_m);
                format!("{worst:.1} / {end:.1}{energy}; {}", q.own_text())
            });
            let ours = self.ours(scene, threads).and_then(Row::measured);
            let peers: Vec<&Quality> = self.peers(scene, threads).map(|m| &m.quality).collect();
            let verdict = ours.map_or_else(|| "-".to_owned(), |ours| verdict(&ours.quality, &peers));
            line(&mut text, &self.title(scene), &cells, &verdict);
        }
        text
    }

    fn head(&self, ends: &str) -> String {
        let names: Vec<String> = self.kinds.iter().map(|kind| kind.label()).collect();
        let rule = "---|".repeat(1 + names.len() + ends.split('|').count());
        format!("| scene | {} | {ends} |\n|{rule}\n", names.join(" | "))
    }

    /// In the order in which they were run.
    fn scenes(&self) -> Vec<&str> {
        let mut scenes: Vec<&str> = Vec::new();
        for row in self.rows {
            if !scenes.contains(&row.scene.as_str()) {
                scenes.push(&row.scene);
            }
        }
        scenes
    }

    fn title(&self, scene: &str) -> String {
        let row = self.rows.iter().find(|row| row.scene == scene);
        row.map_or_else(String::new, |row| format!("{scene}, {} frames", row.frames))
    }

    fn row(&self, scene: &str, kind: Kind, threads: u16) -> Option<&Row> {
        self.rows.iter().find(|row| row.scene == scene && row.kind == kind && row.threads == threads)
    }

    fn ours(&self, scene: &str, threads: u16) -> Option<&Row> {
        self.row(scene, Kind::Forerun, threads)
    }

    fn peers(&self, scene: &str, threads: u16) -> impl Iterator<Item = &Measured> {
        let others = self.kinds.iter().filter(|kind| **kind != Kind::Forerun);
        others.filter_map(move |kind| self.row(scene, *kind, threads)?.measured())
    }

    /// A cell for each engine.
    fn cells(&self, scene: &str, threads: u16, cell: impl Fn(&Row, &Measured) -> String) -> Vec<String> {
        let of = |kind: &Kind| match self.row(scene, *kind, threads) {
            None => "-".to_owned(),
            Some(row) => match &row.outcome {
                Outcome::Measured(measured) => cell(row, measured),
                Outcome::Cannot(why) => format!("cannot: {why}"),
            },
        };
        self.kinds.iter().map(of).collect()
    }

    fn ratio(&self, scene: &str, threads: u16) -> String {
        let best = self.peers(scene, threads).map(|m| m.counted(threads).mean_ms).min_by(f64::total_cmp);
        let ours = self.ours(scene, threads).and_then(Row::times);
        match (ours, best) {
            (Some(ours), Some(best)) => format!("**{:.2}**", ours.mean_ms / best),
            _ => "-".to_owned(),
        }
    }
}

fn line(text: &mut String, title: &str, cells: &[String], ends: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "| {title} | {} | {ends} |", cells.join(" | "));
}

/// Three digits that mean something.
fn short(ms: f64) -> String {
    let decimals = if ms < 1.0 { 3 } else { usize::from(ms < 10.0) + usize::from(ms < 100.0) };
    format!("{ms:.decimals$}")
}

fn times(factor: Option<f64>) -> String {
    factor.map_or_else(|| "-".to_owned(), |factor| format!("{factor:.2} x"))
}

/// Where ours is worse than the best of the others; "holds" when it is nowhere.
fn verdict(ours: &Quality, peers: &[&Quality]) -> String {
    let mut worse = Vec::new();
    let best = |value: fn(&Quality) -> f32| peers.iter().map(|q| value(q)).fold(f32::INFINITY, f32::min);
    if ours.overlap_max_m > best(|q| q.overlap_max_m) + SAME_OVERLAP_M {
        worse.push("overlap at worst");
    }
    if ours.overlap_end_m > best(|q| q.overlap_end_m) + SAME_OVERLAP_M {
        worse.push("overlap at the end");
    }
    if ours.energy_max_over_initial.is_some_and(|part| part > ENERGY_MOST) {
        worse.push("energy");
    }
    if ours.own_badness() > best(Quality::own_badness) + SAME_PLACE_M {
        worse.push("the scene's own");
    }
    if ours.not_finite > 0 {
        worse.push("not finite");
    }
    if worse.is_empty() { "holds".to_owned() } else { format!("worse: {}", worse.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Task;
    use crate::quality::Own;
    use crate::rounds::StepTimes;

    fn row(kind: Kind, threads: u16, mean_ms: f64, overlap_max_m: f32) -> Row {
        let times = |mean_ms: f64| StepTimes {
            first_ms: 3.0 * mean_ms,
            mean_ms,
            median_ms: mean_ms,
            p99_ms: 2.0 * mean_ms,
            max_ms: 2.0 * mean_ms,
            round_means_ms: vec![mean_ms],
        };
        let quality = Quality {
            overlap_max_m,
            overlap_end_m: 0.0,
            energy_max_over_initial: Some(1.0),
            speed_end: 0.0,
            own: Own::Lost { count: 0 },
            not_finite: 0,
            hulls_per_mesh: 0,
        };
        let task = Task { scene: "islands".to_owned(), kind, frames: 10, threads };
        let (cpu, wall) = (times(mean_ms), times(mean_ms + 1.0));
        Row::new(task, 3, Ok(Measured { cpu, wall, peak_bytes: None, quality }))
    }

    #[test]
    fn scenes_are_lines_and_engines_columns() {
        let rows = [
            row(Kind::Forerun, 1, 2.0, 0.003),
            row(Kind::Box3d, 1, 4.0, 0.001),
            row(Kind::Jolt, 1, 8.0, 0.003),
            row(Kind::Forerun, 2, 1.0, 0.003),
            row(Kind::Box3d, 2, 3.0, 0.001),
        ];
        let text = markdown(&rows);
        let lines: Vec<&str> = text.lines().filter(|line| line.contains("| islands, 10 frames |")).collect();
        // CPU time on one thread, 2 over 4; wall time on two, (1 + 1) over (3 + 1); from wall 3 to wall 2.
        assert!(
            lines[0].contains("| 2.00 / 4.00 / 6.00 |") && lines[0].ends_with("| **0.50** | 0.5 | 3.00 x |")
        );
        assert!(
            lines[1].contains("| 2.00 / 4.00 (1.00); 1.50 x |") && lines[1].ends_with("| - | **0.50** |")
        );
        assert!(lines[2].ends_with("| worse: overlap at worst |"), "{}", lines[2]);
        let columns = |line: &str| line.matches('|').count();
        let heads = text.lines().filter(|line| line.starts_with("| scene"));
        assert!(heads.zip(&lines).all(|(head, line)| columns(head) == columns(line)), "{text}");
    }
}
