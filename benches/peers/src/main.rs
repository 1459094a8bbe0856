//! Peers: the project's scenes on forerun and on other engines, side by side.
//!
//! The program that is started asks copies of itself, one engine and one round at a time (`measure`), and makes tables of the answers: engines side by
//! side (`summary`), and everything (`table`).

#[cfg(feature = "engines")]
mod box3d;
mod engine;
mod forerun;
#[cfg(feature = "engines")]
mod jolt;
mod measure;
mod native;
#[cfg(feature = "engines")]
mod parts;
mod quality;
#[cfg(feature = "engines")]
mod rapier;
mod rounds;
mod sets;
mod stage;
mod summary;
mod table;

use std::fs;
use std::process::ExitCode;

use clap::Parser;
use serde::Serialize;

use crate::engine::Kind;
use crate::measure::Task;
use crate::rounds::{Plan, Row, SceneAndFrames};

/// Run scenes on forerun, Rapier, Box3D and Jolt, in turn, and print them side by side as Markdown.
#[derive(Debug, Parser)]
#[command(name = "peers")]
struct Args {
    /// Built-in name, with sizes if wanted (dominoes:1000), or a TOML or JSON file; @FRAMES behind it for another length (dominoes@1800); `all` for the nine that we compare by
    #[arg(required = true)]
    scenes: Vec<String>,
    /// Engines to compare
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = Kind::ALL)]
    engines: Vec<Kind>,
    /// Thread counts: CPU time counts on one, wall time on more
    #[arg(long, value_delimiter = ',', default_value = "1,2", value_parser = clap::value_parser!(u16).range(1..=256))]
    threads: Vec<u16>,
    /// How often each engine runs each scene
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,
    /// Frames to step
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    frames: u32,
    /// Print the result as JSON and nothing else
    #[arg(long)]
    json: bool,
    /// Be one of the processes: run one engine once, and print what it took
    #[arg(long, value_enum, hide = true)]
    one: Option<Kind>,
    /// With --one: look at the quality instead of the time
    #[arg(long, hide = true, requires = "one")]
    quality: bool,
}

/// The fields of `--json`.
#[derive(Debug, Serialize)]
struct Report {
    machine: String,
    builds: String,
    rounds: u32,
    rows: Vec<Row>,
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
    let scenes = args.scenes.iter().map(|typed| scenes_and_frames(typed, args.frames));
    let scenes = scenes.collect::<Result<Vec<_>, _>>()?.concat();
    if let (Some(kind), [first, ..]) = (args.one, scenes.as_slice()) {
        let SceneAndFrames { scene, frames } = first.clone();
        let task = Task { scene, kind, frames, threads: args.threads.first().copied().unwrap_or(1) };
        let answer = if args.quality { measure::quality(&task) } else { measure::times(&task) };
        // On a line of its own, whatever an engine printed before.
        println!("\n{}", serde_json::to_string(&answer).map_err(|error| error.to_string())?);
        return Ok(());
    }
    let load = load_average();
    let plan =
        Plan { scenes, engines: args.engines.clone(), threads: args.threads.clone(), rounds: args.rounds };
    let rows = rounds::run(&plan)?;
    let machine = format!("{}; load {load} before, {} after", machine(), load_average());
    let builds = format!("forerun built plainly; {}", native::describe());
    if args.json {
        let report = Report { machine, builds, rounds: args.rounds, rows };
        println!("{}", serde_json::to_string_pretty(&report).map_err(|error| error.to_string())?);
    } else {
        println!("{machine}; {} rounds; {builds}\n\n{}", args.rounds, summary::markdown(&rows));
        println!("Everything:\n\n{}", table::markdown(&rows));
    }
    Ok(())
}

/// `dominoes:1000@600` is 600 frames of `dominoes:1000`; `all` is the set, each scene with frames of its own.
fn scenes_and_frames(typed: &str, frames: u32) -> Result<Vec<SceneAndFrames>, String> {
    if typed == sets::ALL {
        let of = |entry: sets::Entry| SceneAndFrames { scene: entry.scene.to_owned(), frames: entry.frames };
        return Ok(sets::SCENES.map(of).to_vec());
    }
    let Some((scene, own)) = typed.rsplit_once('@') else {
        return Ok(vec![SceneAndFrames { scene: typed.to_owned(), frames }]);
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
        let parsed = |typed| scenes_and_frames(typed, 300);
        let one = |scene: &str, frames| Ok(vec![SceneAndFrames { scene: scene.to_owned(), frames }]);
        assert_eq!(parsed("rain:5000"), one("rain:5000", 300));
        assert_eq!(parsed("dominoes@1800"), one("dominoes", 1800));
        assert!(parsed("dominoes@x").is_err() && parsed("dominoes@1").is_err());
        assert_eq!(parsed("all").map(|scenes| scenes.len()), Ok(9));
    }

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory as _;
        Args::command().debug_assert();
    }
}
