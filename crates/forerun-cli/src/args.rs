//! Arguments: what was typed, checked for range.

use std::path::PathBuf;

mod drawing;

pub(crate) use drawing::{MeshArgs, RenderArgs, UpArg, ViewArgs};

use clap::{Args, Parser, Subcommand, ValueEnum};

/// Rigid-body physics that runs ahead of the display.
///
/// Without a command: 255 dominoes in the viewer; where no window can open, the same for 30 seconds against the clock, with charts in
/// forerun-output.
#[derive(Debug, Parser)]
#[command(name = "forerun", version)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Watch, throw, drag, scrub and look ahead: the interactive viewer
    View(ViewArgs),
    /// Play a scene against the clock; write queue.csv, report.json and charts
    Run(RunArgs),
    /// Compute a recording again and compare it with its hashes, or save what can be read of a damaged one
    Replay(ReplayArgs),
    /// Repeat an experiment of the dissertation, decoupled beside coupled
    Experiment(ExperimentArgs),
    /// List the built-in scenes, or print one as a file
    Scenes(ScenesArgs),
    /// Edit a scene at random and compare every state with a full re-simulation, bit for bit (its own commands are left out)
    Check(CheckArgs),
    /// Measure the step on scenes, and the quality that its time was paid for (their commands are left out)
    Bench(BenchArgs),
    /// Compare with formulas and measurements from the literature
    Validate(ValidateArgs),
    /// Show a scene for minutes while it is edited and its physics stalls; watch the display, memory and every bit
    Soak(SoakArgs),
    /// Tell everything about a mesh file: triangles, repairs, mass, distance field; draw it and slices of its field
    Mesh(MeshArgs),
    /// Run a scene and draw it at a time, or as a film, without a window
    Render(RenderArgs),
    /// Write a simulation as an animated glTF file (not there yet)
    Bake(BakeArgs),
}

const SCENE_HELP: &str =
    "Built-in name, with sizes if wanted (dominoes, dominoes:1000), or a TOML or JSON file";

/// Who steps the physics, and when.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DriverArg {
    /// Physics runs ahead in a thread of its own
    Decoupled,
    /// Step, then show: the traditional model
    Coupled,
}

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    #[arg(help = SCENE_HELP)]
    pub(crate) scene: String,
    /// Length in seconds of real time [default: the scene's]
    #[arg(long, value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) seconds: Option<f64>,
    /// Who steps the physics
    #[arg(long, value_enum, default_value = "decoupled")]
    pub(crate) driver: DriverArg,
    /// Pictures per second
    #[arg(long, default_value = "30", value_parser = fps, allow_negative_numbers = true)]
    pub(crate) fps: f64,
    /// Most frames that physics is ahead of the display
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) lookahead: u32,
    /// Threads of the physics [default: one per core]
    #[arg(long, value_parser = threads())]
    pub(crate) threads: Option<u16>,
    /// Folder for queue.csv, report.json and charts
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
    /// File to record the session in, for `forerun replay`
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    /// Print the report as JSON and nothing else
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ReplayArgs {
    /// A file that `forerun run SCENE --record FILE` or `save_timeline` wrote
    pub(crate) file: PathBuf,
    /// Threads of the physics [default: one per core]
    #[arg(long, value_parser = threads(), conflicts_with = "recover")]
    pub(crate) threads: Option<u16>,
    /// Do not replay: write the part of FILE that can be read to this file
    #[arg(long, value_name = "OUT")]
    pub(crate) recover: Option<PathBuf>,
    /// Print the result as JSON and nothing else
    #[arg(long)]
    pub(crate) json: bool,
}

/// The dissertation's experiments (its chapter 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ExperimentArg {
    /// 255 dominoes in a spiral: figures 5.2 and 5.3
    Dominoes,
    /// Complex meshes that fall in a heap: figures 5.5 and 5.6
    Meshes,
    /// Dominoes, and a body added at 10 s: figures 5.8 and 5.9
    Interaction,
    /// A stack of 20, with and without return in time: figures 5.12 and 5.13
    Stack,
    /// All four
    All,
}

#[derive(Debug, Args)]
pub(crate) struct ExperimentArgs {
    /// Which experiment
    #[arg(value_enum)]
    pub(crate) experiment: ExperimentArg,
    /// Folder for the results; each experiment gets one of its own inside
    #[arg(long, default_value = "forerun-experiments")]
    pub(crate) out: PathBuf,
    /// Length in seconds of real time [default: as in the dissertation's figures]
    #[arg(long, value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) seconds: Option<f64>,
}

#[derive(Debug, Args)]
pub(crate) struct ScenesArgs {
    /// The scene to print, with sizes if wanted (pyramid:10)
    pub(crate) name: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    #[arg(help = SCENE_HELP)]
    pub(crate) scene: String,
    /// Random edits
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) edits: u32,
    /// Seed of the edits
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Frames that are kept and compared
    #[arg(long, default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) frames: u32,
    /// Frames that pass before the first edit, so that the scene can come to rest
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub(crate) settle: u32,
    /// Frames that the display moves on after each edit
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=10_000))]
    pub(crate) display_step: u32,
    /// Edits after which the reference computes, and everything is compared: more take less time
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) compare_every: u32,
    /// Thread counts to compare, like 1,2,4
    #[arg(long, value_delimiter = ',', default_value = "1,2", value_parser = threads())]
    pub(crate) threads: Vec<u16>,
    /// Print the result as JSON and nothing else
    #[arg(long)]
    pub(crate) json: bool,
}

/// In what form kernels are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum InstructionsArg {
    /// Plain arrays, as on any processor
    Portable,
    /// Four numbers at a time, twice
    Sse2,
    /// Eight numbers at a time
    Avx2,
    /// Eight at a time, with more registers
    Avx512,
}

#[derive(Debug, Args)]
pub(crate) struct BenchArgs {
    #[arg(required = true, help = SCENE_HELP)]
    pub(crate) scenes: Vec<String>,
    /// Frames to step
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    pub(crate) frames: u32,
    /// Threads of the physics
    #[arg(long, default_value_t = 1, value_parser = threads())]
    pub(crate) threads: u16,
    /// Frames that pass before the first measured one, so that the scene can come to rest
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub(crate) settle: u32,
    /// Let nothing come to rest, to compare with engines whose sleep is off
    #[arg(long)]
    pub(crate) awake: bool,
    /// Processor instructions that the kernels may use at most; the results are the same [default: the fastest there are]
    #[arg(long, value_enum)]
    pub(crate) instructions: Option<InstructionsArg>,
    /// Draw where the time goes, by stage, to FILE as SVG and as PNG, whatever its ending
    #[arg(long, value_name = "FILE")]
    pub(crate) chart: Option<PathBuf>,
    /// Print the result as JSON and nothing else
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ValidateArgs {
    /// Cases to run; a name that does not exist lists them all [default: all that take less than ten seconds]
    pub(crate) cases: Vec<String>,
    /// Exit with code 1 when a figure misses its limit
    #[arg(long)]
    pub(crate) strict: bool,
    /// Print the result as JSON and nothing else
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct BakeArgs {
    #[arg(help = SCENE_HELP)]
    pub(crate) scene: String,
    /// The file to write
    #[arg(short, long)]
    pub(crate) output: PathBuf,
    /// Length in seconds of simulated time
    #[arg(long, default_value = "10", value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) seconds: f64,
}

#[derive(Debug, Args)]
pub(crate) struct SoakArgs {
    #[arg(default_value = "islands:10", help = SCENE_HELP)]
    pub(crate) scene: String,
    /// Length in seconds of real time
    #[arg(long, default_value = "600", value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) seconds: f64,
    /// Pictures per second
    #[arg(long, default_value = "60", value_parser = fps, allow_negative_numbers = true)]
    pub(crate) fps: f64,
    /// Random edits per second
    #[arg(long, default_value = "2", value_parser = rate, allow_negative_numbers = true)]
    pub(crate) edits_per_second: f64,
    /// Drag a body all the time, with a command at every picture
    #[arg(long)]
    pub(crate) drag: bool,
    /// Longest stall of the physics in seconds, 0 for none
    #[arg(long, default_value = "2", value_parser = rate, allow_negative_numbers = true)]
    pub(crate) stall: f64,
    /// Seconds from one stall to the next, in the mean
    #[arg(long, default_value = "15", value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) stall_every: f64,
    /// Milliseconds that every computed frame takes longer
    #[arg(long, default_value = "0", value_parser = milliseconds, allow_negative_numbers = true)]
    pub(crate) slow_ms: f64,
    /// Most frames that physics is ahead of the display
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) lookahead: u32,
    /// Frames that are ahead before the first picture
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    pub(crate) prefill: u32,
    /// Threads beside it that only keep processors busy
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=256))]
    pub(crate) hogs: u16,
    /// Threads of the physics [default: one per core]
    #[arg(long, value_parser = threads())]
    pub(crate) threads: Option<u16>,
    /// Seed of edits and stalls
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Print the result as JSON and nothing else
    #[arg(long)]
    pub(crate) json: bool,
}

fn threads() -> clap::builder::RangedI64ValueParser<u16> {
    clap::value_parser!(u16).range(1..=256)
}

fn seconds(text: &str) -> Result<f64, String> {
    number_in(text, 0.1, 86_400.0)
}

fn fps(text: &str) -> Result<f64, String> {
    number_in(text, 1.0, 1000.0)
}

fn rate(text: &str) -> Result<f64, String> {
    number_in(text, 0.0, 1000.0)
}

fn milliseconds(text: &str) -> Result<f64, String> {
    number_in(text, 0.0, 10_000.0)
}

fn number_in(text: &str, min: f64, max: f64) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("give a number from {min} to {max}"))?;
    if (min..=max).contains(&value) { Ok(value) } else { Err(format!("give a number from {min} to {max}")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory as _;
        Cli::command().debug_assert();
    }

    #[test]
    fn numbers_out_of_range_are_refused_with_the_range() {
        assert_eq!(seconds("30"), Ok(30.0));
        for bad in ["0", "-1", "nan", "inf", "abc"] {
            assert_eq!(seconds(bad), Err("give a number from 0.1 to 86400".into()), "{bad}");
        }
    }
}
