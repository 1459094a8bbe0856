//! Golden: records the hashes that the step gives now.

use std::path::Path;
use std::process::{Command, ExitCode};

/// Runs the test of recorded hashes so that it writes instead of comparing.
pub(crate) fn bless(root: &Path) -> ExitCode {
    let test = ["test", "--quiet", "--package", "forerun-dynamics", "--test", "golden"];
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    match Command::new(cargo).args(test).current_dir(root).env("FORERUN_BLESS", "1").status() {
        Ok(status) if status.success() => {
            eprintln!("recorded; now say why they moved: CHANGELOG.md, under Determinism, and in the commit");
            ExitCode::SUCCESS
        }
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("cargo cannot be started: {error}");
            ExitCode::FAILURE
        }
    }
}
