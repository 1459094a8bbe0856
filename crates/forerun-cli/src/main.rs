//! The `forerun` command: run, check, bench, compare and draw scenes, and look at meshes.
//!
//! Parse, then do; every error meets here and becomes an exit code: 0 fine, 1 a check failed, 2 wrong usage or bad input.

mod args;
mod baking;
mod bench;
mod cache;
mod charts;
mod commands;
mod experiment;
mod failure;
mod figures;
mod output;
mod picture;
mod progress;
mod results;
mod soak;
mod stats;
mod validate;

use std::process::ExitCode;

use clap::Parser as _;

use args::{Cli, Command};
use failure::Failure;

fn main() -> ExitCode {
    match run(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let message = failure.to_string();
            if !message.is_empty() {
                eprintln!("forerun: {message}");
            }
            failure.exit_code()
        }
    }
}

fn run(cli: Cli) -> Result<(), Failure> {
    match cli.command {
        None => commands::run::main_job(),
        Some(Command::Run(args)) => commands::run::run(&args),
        Some(Command::Replay(args)) => commands::replay::run(&args),
        Some(Command::Experiment(args)) => commands::experiment::run(&args),
        Some(Command::Scenes(args)) => commands::scenes::run(&args),
        Some(Command::Check(args)) => commands::check::run(&args),
        Some(Command::Bench(args)) => commands::bench::run(&args),
        Some(Command::Validate(args)) => commands::validate::run(&args),
        Some(Command::Soak(args)) => commands::soak::run(&args),
        Some(Command::Mesh(args)) => commands::mesh::run(&args),
        Some(Command::Render(args)) => commands::render::run(&args),
        Some(Command::View(args)) => commands::view::run(&args),
        Some(Command::Bake(_)) => Err(Failure::not_there_yet("bake")),
    }
}
