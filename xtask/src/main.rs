//! Chores of this repository: `cargo xtask tidy`, `cargo xtask golden --bless`, `cargo xtask web`.

use std::path::Path;
use std::process::ExitCode;

mod files;
mod floors;
mod golden;
mod links;
mod map;
mod rooms;
mod tidy;
mod web;

fn main() -> ExitCode {
    // xtask lies in the root of the repository.
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["tidy"] => tidy_up(&root),
        ["golden", "--bless"] => golden::bless(&root),
        ["web"] => match web::build(&root) {
            Ok(dist) => {
                eprintln!("{}", dist.display());
                ExitCode::SUCCESS
            }
            Err(message) => {
                eprintln!("{message}");
                ExitCode::FAILURE
            }
        },
        _ => {
            eprintln!("usage: cargo xtask tidy | golden --bless | web");
            ExitCode::from(2)
        }
    }
}

fn tidy_up(root: &Path) -> ExitCode {
    match tidy::complaints(root) {
        Ok(complaints) if complaints.is_empty() => {
            eprintln!("tidy");
            ExitCode::SUCCESS
        }
        Ok(complaints) => {
            for complaint in &complaints {
                eprintln!("{complaint}");
            }
            eprintln!("{} complaints", complaints.len());
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("the repository cannot be read: {error}");
            ExitCode::FAILURE
        }
    }
}
