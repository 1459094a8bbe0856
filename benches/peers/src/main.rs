//! Peers: the project's scenes on forerun and on other engines, side by side.
//!
//! The program that is started asks copies of itself, one engine and one round at a time (`measure`), and makes tables of the answers: engines side by
//! side (`summary`), and everything (`table`).

#[cfg(feature = "engines")]
mod box3d;
mod engine;
mod forerun;
mod heap;
#[cfg(feature = "engines")]
mod jolt;
mod links;
mod measure;
mod mesh_run;
mod meshes;
mod native;
mod nut;
mod overlap;
#[cfg(feature = "engines")]
mod parts;
mod places;
mod processes;
mod quality;
#[cfg(feature = "engines")]
mod rapier;
mod rounds;
mod row;
mod sets;
mod shapes;
mod stage;
mod summary;
mod surface;
mod table;
mod true_mesh;

use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use serde::Serialize;

use crate::engine::Kind;
use crate::measure::{Answer, Question, Task};
use crate::mesh_run::{Extent, Means};
use crate::rounds::{Plan, SceneAndFrames};

/// Of a scene that is in no set.
const FRAMES: u32 = 300;

/// Run scenes on forerun, Rapier, Box3D and Jolt, in turn, and print them side by side as Markdown.
#[derive(Debug, Parser)]
#[command(name = "peers")]
struct Args {
    /// Built-in name, with sizes if wanted (dominoes:1000), or a TOML or JSON file; @FRAMES behind it for another length (dominoes@1800); `all` for the nine that we compare by; `meshes`, alone or before others, for those where meshes move and a table of their own
    #[arg(required = true)]
    scenes: Vec<String>,
    /// Engines to compare [default: all, but those with fine hulls only after `meshes`]
    #[arg(long, value_enum, value_delimiter = ',')]
    engines: Vec<Kind>,
    /// Thread counts: CPU time counts on one, wall time on more; `meshes` are run on one
    #[arg(long, value_delimiter = ',', default_value = "1,2", value_parser = clap::value_parser!(u16).range(1..=256))]
    threads: Vec<u16>,
    /// How often each engine runs each scene [default: 3, of `meshes` 1]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: Option<u32>,
    /// Frames to step [default: 300, of a set's scenes their own]
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    frames: Option<u32>,
    /// Seconds of CPU time that the steps of an engine on a scene of `meshes` may take in all
    #[arg(long, default_value_t = 10.0, value_parser = seconds)]
    limit: f64,
    /// Print the result as JSON and nothing else
    #[arg(long)]
    json: bool,
    /// Be one of the processes: run one engine once, and print what it took
    #[arg(long, value_enum, hide = true)]
    one: Option<Kind>,
    /// With --one: what to tell of it
    #[arg(long, value_enum, hide = true, default_value_t = Question::Times)]
    ask: Question,
    /// With --one: folder where the hulls of meshes are kept from process to process
    #[arg(long, hide = true)]
    hulls: Option<PathBuf>,
}

/// The fields of `--json`.
#[derive(Debug, Serialize)]
struct Report<R> {
    machine: String,
    builds: String,
    rounds: u32,
    rows: Vec<R>,
}

/// More than none.
fn seconds(typed: &str) -> Result<f64, String> {
    match typed.parse() {
        Ok(seconds) if seconds > 0.0 && seconds <= 86_400.0 => Ok(seconds),
        _ => Err("must be a number above 0, at most 86400".to_owned()),
    }
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args) -> Result<(), String> {
    let meshes = args.scenes.first().is_some_and(|first| first == sets::MESHES);
    let typed: &[String] = if meshes && args.scenes.len() > 1 { &args.scenes[1..] } else { &args.scenes };
    let scenes = typed.iter().map(|typed| scenes_and_frames(typed, args.frames));
    let scenes = scenes.collect::<Result<Vec<_>, _>>()?.concat();
    if let (Some(kind), [first, ..]) = (args.one, scenes.as_slice()) {
        let SceneAndFrames { scene, frames } = first.clone();
        let task = Task { scene, kind, frames, threads: args.threads.first().copied().unwrap_or(1) };
        // On a line of its own, whatever an engine printed before.
        println!("\n{}", serde_json::to_string(&answer(args, &task)).map_err(|error| error.to_string())?);
        return Ok(());
    }
    let load = load_average();
    let usual: &[Kind] = if meshes { &Kind::ALL } else { &Kind::USUAL };
    let engines = if args.engines.is_empty() { usual.to_vec() } else { args.engines.clone() };
    if meshes {
        let rounds = args.rounds.unwrap_or(1);
        let plan = meshes::Plan { scenes, engines, rounds, limit: Duration::from_secs_f64(args.limit) };
        let rows = meshes::run(&plan)?;
        return print(args, &load, rounds, rows, meshes::markdown);
    }
    let rounds = args.rounds.unwrap_or(3);
    let plan = Plan { scenes, engines, threads: args.threads.clone(), rounds };
    let rows = rounds::run(&plan)?;
    print(args, &load, rounds, rows, |rows| {
        format!("{}\nEverything:\n\n{}", summary::markdown(rows), table::markdown(rows))
    })
}

/// What one process tells.
fn answer(args: &Args, task: &Task) -> Answer {
    let means = Means { limit: Duration::from_secs_f64(args.limit), folder: args.hulls.as_deref() };
    let mesh = |extent| {
        mesh_run::run(task, extent, means)
            .map_or_else(Answer::Cannot, |answer| Answer::Mesh(Box::new(answer)))
    };
    match args.ask {
        Question::Times => measure::times(task),
        Question::Quality => measure::quality(task),
        Question::Mesh => mesh(Extent::All),
        Question::MeshTimes => mesh(Extent::Times),
        Question::HeapOfBoxes => mesh(Extent::HeapOfBoxes),
    }
}

/// The machine, and the rows as tables or as JSON.
fn print<R: Serialize>(
    args: &Args,
    load: &str,
    rounds: u32,
    rows: Vec<R>,
    tables: impl FnOnce(&[R]) -> String,
) -> Result<(), String> {
    let machine = format!("{}; load {load} before, {} after", machine(), load_average());
    let builds = format!("forerun built plainly; {}", native::describe());
    if args.json {
        let report = Report { machine, builds, rounds, rows };
        println!("{}", serde_json::to_string_pretty(&report).map_err(|error| error.to_string())?);
    } else {
        println!("{machine}; {rounds} rounds; {builds}\n\n{}", tables(&rows));
    }
    Ok(())
}

/// `dominoes:1000@600` is 600 frames of `dominoes:1000`; `all` and `meshes` are sets, each scene with frames of its own.
fn scenes_and_frames(typed: &str, frames: Option<u32>) -> Result<Vec<SceneAndFrames>, String> {
    if let Some(set) = sets::named(typed) {
        let of = |entry: &sets::Entry| SceneAndFrames {
            scene: entry.scene.to_owned(),
            frames: frames.unwrap_or(entry.frames),
        };
        return Ok(set.iter().map(of).collect());
    }
    let Some((scene, own)) = typed.rsplit_once('@') else {
        return Ok(vec![SceneAndFrames { scene: typed.to_owned(), frames: frames.unwrap_or(FRAMES) }]);
    };
    match own.parse() {
        Ok(frames) if frames >= 2 => Ok(vec![SceneAndFrames { scene: scene.to_owned(), frames }]),
        _ => Err(format!("\"{typed}\": behind @ stands a whole number of frames, 2 or more")),
    }
}

/// Processor and how many cores it shows. Linux only.
fn machine() -> String {
    let cpu = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpu.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let model = model.map_or("unknown processor", |(_, model)| model);
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    format!("{model}, {cores} cores")
}

/// How many threads wanted to run in the last minute. Linux only.
fn load_average() -> String {
    let text = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    text.split(' ').next().filter(|load| !load.is_empty()).unwrap_or("unknown").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_may_stand_behind_a_scene() {
        let parsed = |typed| scenes_and_frames(typed, None);
        let one = |scene: &str, frames| Ok(vec![SceneAndFrames { scene: scene.to_owned(), frames }]);
        assert_eq!(parsed("rain:5000"), one("rain:5000", 300));
        assert_eq!(parsed("dominoes@1800"), one("dominoes", 1800));
        assert!(parsed("dominoes@x").is_err() && parsed("dominoes@1").is_err());
        assert_eq!(parsed("all").map(|scenes| scenes.len()), Ok(9));
        let mesh_scenes = scenes_and_frames("meshes", Some(20)).unwrap();
        assert!(mesh_scenes.len() > 2 && mesh_scenes.iter().all(|scene| scene.frames == 20));
    }

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory as _;
        Args::command().debug_assert();
    }
}
