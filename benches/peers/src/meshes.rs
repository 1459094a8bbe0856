//! Meshes: the scenes where meshes move, on every engine, and one table of what its shapes cost, how long its steps take and what they are worth.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;
use std::{env, fs, process};

use forerun::Scene;
use serde::Serialize;

use crate::engine::Kind;
use crate::links::LinkCount;
use crate::measure::{Answer, Question, Task};
use crate::mesh_run::{MeshAnswer, Worth};
use crate::processes::Programs;
use crate::rounds::{SceneAndFrames, StepTimes, step_times};
use crate::row::{self, Outcome};
use crate::shapes::Fit;

/// What is compared.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    pub(crate) scenes: Vec<SceneAndFrames>,
    pub(crate) engines: Vec<Kind>,
    pub(crate) rounds: u32,
    /// CPU time that the steps of an engine on a scene may take in all.
    pub(crate) limit: Duration,
}

/// One engine on one scene.
pub(crate) type Row = row::Row<Measured>;

/// One engine on one scene, over all rounds.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Measured {
    /// CPU time for making the shapes and the world from triangles. Milliseconds.
    pub(crate) setup_ms: f64,
    /// More heap than with boxes in the place of meshes, for each different mesh. Bytes.
    pub(crate) bytes_per_mesh: Option<f64>,
    /// CPU time of the steps.
    pub(crate) steps: StepTimes,
    /// As many as there was time for.
    pub(crate) frames_done: u32,
    pub(crate) fit: Fit,
    pub(crate) worth: Worth,
}

/// A folder of this process for the hulls that its children share, gone with it.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Result<Self, String> {
        let path = env::temp_dir().join(format!("forerun-peers-{}", process::id()));
        fs::create_dir_all(&path).map_err(|error| format!("{} cannot be made: {error}", path.display()))?;
        Ok(Folder(path))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // What cannot be removed is left to the system: it is a temporary folder.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Runs the whole plan, every engine in turn in processes of its own. Scenes are opened before anything is built: a misspelt name is not to cost
/// minutes.
pub(crate) fn run(plan: &Plan) -> Result<Vec<Row>, String> {
    let count = |typed: &SceneAndFrames| Scene::open(&typed.scene).map(|scene| scene.bodies.len());
    let counts: Result<Vec<usize>, _> = plan.scenes.iter().map(count).collect();
    let counts = counts.map_err(|error| error.to_string())?;
    let programs = Programs::build(&plan.engines, &[1])?;
    let folder = Folder::new()?;
    let mut rows = Vec::new();
    for (SceneAndFrames { scene, frames }, bodies) in plan.scenes.iter().zip(counts) {
        for kind in &plan.engines {
            let task = Task { scene: scene.clone(), kind: *kind, frames: *frames, threads: 1 };
            eprintln!("{task}");
            let outcome = measure(&programs, &task, plan, &folder.0);
            rows.push(Row::new(task, bodies, outcome));
        }
    }
    Ok(rows)
}

fn measure(programs: &Programs, task: &Task, plan: &Plan, folder: &Path) -> Result<Measured, String> {
    // Steps have a limit of their own, but of CPU time; setting up and looking need some time too.
    let patience = 5 * plan.limit + Duration::from_secs(90);
    let ask = |question: Question| -> Result<MeshAnswer, String> {
        let folder = folder.to_string_lossy().into_owned();
        let words =
            ["--limit".to_owned(), plan.limit.as_secs_f64().to_string(), "--hulls".to_owned(), folder];
        match programs.ask_within(task, question, patience, &words)? {
            Answer::Mesh(answer) => Ok(*answer),
            Answer::Cannot(why) => Err(why),
            _ => Err("answered something else than meshes".to_owned()),
        }
    };
    let first = ask(Question::Mesh)?;
    let boxes = ask(Question::HeapOfBoxes)?;
    let more = (1..plan.rounds).map(|_| ask(Question::MeshTimes)).collect::<Result<Vec<_>, _>>()?;
    let all = || std::iter::once(&first).chain(&more);
    let rounds: Vec<&[f64]> = all().map(|answer| answer.times.cpu_ms.as_slice()).collect();
    let heaps = first.heap_bytes.zip(boxes.heap_bytes);
    let (Some(fit), Some(worth)) = (first.fit, first.worth.clone()) else {
        return Err("answered with less than was asked".to_owned());
    };
    Ok(Measured {
        setup_ms: all().map(|answer| answer.setup_ms).fold(f64::INFINITY, f64::min),
        bytes_per_mesh: heaps
            .map(|(with, without)| (with as f64 - without as f64) / first.meshes.max(1) as f64),
        steps: step_times(&rounds),
        frames_done: first.times.cpu_ms.len() as u32,
        fit,
        worth,
    })
}

/// The table, a line an engine and scene.
pub(crate) fn markdown(rows: &[Row]) -> String {
    let mut text = String::from(
        "| scene | engine | setup ms | hulls (corners) | KiB a mesh | off mm | opening | mean ms | p99 | first | overlap mm: worst / end | end speed mm/s | what became of it |\n\
         |---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---|\n",
    );
    for row in rows {
        let cells = match &row.outcome {
            Outcome::Measured(measured) => cells(row, measured, rows),
            Outcome::Cannot(why) => format!("cannot: {why}{}", " |".repeat(10)),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| {}, {} frames | {} | {cells} |", row.scene, row.frames, row.engine);
    }
    text
}

fn cells(row: &Row, m: &Measured, rows: &[Row]) -> String {
    let mm = |metres: f32| format!("{:.1}", 1000.0 * metres);
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    let cut = (m.fit.hulls > 0).then(|| format!("{} ({})", m.fit.hulls, m.fit.corners));
    let part =
        ratio(row, m, rows).map_or_else(String::new, |ratio| format!(" (**{ratio:.2}** of the best other)"));
    let mut became = outcome(&m.worth);
    if m.frames_done < row.frames {
        became = format!("stopped after {} frames for its time; {became}", m.frames_done);
    }
    [
        format!("{:.0}", m.setup_ms),
        or_dash(cut),
        or_dash(m.bytes_per_mesh.map(|bytes| format!("{:.0}", bytes / 1024.0))),
        mm(m.fit.off_m),
        or_dash(m.fit.opening.map(|opening| format!("{:.0} %", 100.0 * opening))),
        format!("{:.3}{part}", m.steps.mean_ms),
        format!("{:.3}", m.steps.p99_ms),
        format!("{:.3}", m.steps.first_ms),
        format!("{} / {}", mm(m.worth.overlap_max_m), mm(m.worth.overlap_end_m)),
        format!("{:.1}", 1000.0 * m.worth.speed_end),
        became,
    ]
    .join(" | ")
}

/// Our mean over that of the fastest other engine that did all frames. None but for us.
fn ratio(row: &Row, ours: &Measured, rows: &[Row]) -> Option<f64> {
    let others = rows.iter().filter(|other| other.scene == row.scene && other.kind != Kind::Forerun);
    let done = others.filter_map(|other| other.measured().filter(|m| m.frames_done == other.frames));
    let means = done.map(|m| m.steps.mean_ms);
    let best = means.min_by(f64::total_cmp)?;
    (row.kind == Kind::Forerun).then_some(ours.steps.mean_ms / best)
}

/// What became of the scene, in words.
fn outcome(worth: &Worth) -> String {
    let mut words = worth.links.as_ref().map_or_else(Vec::new, of_links);
    if let Some(nut) = worth.nut {
        words.push(format!("{:.2} turns, {:.1} mm down", nut.turns, 1000.0 * nut.down_m));
    }
    let [at_start, still] = worth.places.hanging;
    if at_start > 0 {
        words.push(format!("{still} of {at_start} hang"));
    }
    if let Some([all, inside]) = worth.places.in_bowl {
        words.push(format!("{inside} of {all} in the bowl"));
    }
    words.push(format!("{} lost", worth.lost));
    if worth.not_finite > 0 {
        words.push(format!("{} not finite", worth.not_finite));
    }
    words.join(", ")
}

fn of_links(links: &LinkCount) -> Vec<String> {
    let mut words = Vec::new();
    let [at_start, still] = links.linked;
    if at_start > 0 {
        words.push(format!("{still} of {at_start} links hold"));
    }
    if links.poles > 0 {
        words.push(format!(
            "{} of {} rings round poles, {} on top",
            links.threaded, links.rings, links.on_top
        ));
        words.push(format!("poles passed through {} times", links.poles_passed));
    }
    words.push(format!("links changed {} times", links.links_changed));
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::places::PlaceCount;

    fn task(kind: Kind) -> Task {
        Task { scene: "chain".to_owned(), kind, frames: 3, threads: 1 }
    }

    fn row(kind: Kind, mean_ms: f64, frames_done: u32) -> Row {
        let times = vec![9.0, mean_ms, mean_ms];
        let worth = Worth {
            overlap_max_m: 0.02,
            overlap_end_m: 0.004,
            speed_end: 0.0,
            lost: 1,
            not_finite: 0,
            links: Some(LinkCount { rings: 9, linked: [8, 7], links_changed: 1, ..LinkCount::default() }),
            nut: None,
            places: PlaceCount { hanging: [4, 3], in_bowl: None },
        };
        let measured = Measured {
            setup_ms: 12.0,
            bytes_per_mesh: Some(2048.0),
            steps: step_times(&[&times]),
            frames_done,
            fit: Fit { hulls: 11, corners: 700, off_m: 0.01, opening: Some(0.98) },
            worth,
        };
        Row::new(task(kind), 9, Ok(measured))
    }

    #[test]
    fn a_line_says_what_was_measured_and_who_was_faster() {
        let mut rows =
            vec![row(Kind::Forerun, 1.0, 3), row(Kind::Rapier, 2.0, 3), row(Kind::RapierTriangles, 0.5, 2)];
        rows.push(Row::new(task(Kind::Jolt), 9, Err("it fell over".to_owned())));
        let text = markdown(&rows);
        let lines: Vec<&str> = text.lines().skip(2).collect();
        // The one that did not do all frames is not the best.
        assert!(lines[0].contains("| 1.000 (**0.50** of the best other) |"), "{}", lines[0]);
        assert!(
            lines[0].contains("| 12 | 11 (700) | 2 | 10.0 | 98 % |") && lines[0].contains("| 20.0 / 4.0 |")
        );
        assert!(
            lines[0].ends_with("| 7 of 8 links hold, links changed 1 times, 3 of 4 hang, 1 lost |"),
            "{}",
            lines[0]
        );
        assert!(lines[2].contains("stopped after 2 frames") && lines[3].contains("cannot: it fell over"));
        let columns = |line: &str| line.matches('|').count();
        assert!(text.lines().all(|line| columns(line) == columns(lines[0])), "{text}");
    }
}
