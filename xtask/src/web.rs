//! Web: the page's static files, from its crate.

use std::path::{Path, PathBuf};
use std::process::Command;

/// What the physics' lanes are in browsers.
const FLAGS: &str = "-C target-feature=+simd128";

/// Builds `web/dist`: WebAssembly, JavaScript and the page, for any file server.
pub(crate) fn build(root: &Path) -> Result<PathBuf, String> {
    let web = root.join("web");
    let manifest = web.join("Cargo.toml");
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| web.join("target"), PathBuf::from);
    let cargo = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO"));
        command.args(arguments).arg("--manifest-path").arg(&manifest).arg("--target-dir").arg(&target);
        command.args(["--release", "--locked"]);
        command
    };
    run(cargo(&["build", "--target", "wasm32-unknown-unknown"]).env("RUSTFLAGS", FLAGS))?;
    let dist = web.join("dist");
    let wasm = target.join("wasm32-unknown-unknown/release/forerun_web.wasm");
    let mut pack = cargo(&["run", "--package", "forerun-web-pack"]);
    run(pack.arg("--").args([&wasm, &web.join("static"), &dist]))?;
    Ok(dist)
}

fn run(command: &mut Command) -> Result<(), String> {
    let status = command.status().map_err(|error| format!("{command:?}: {error}"))?;
    if status.success() {
        return Ok(());
    }
    Err(format!(
        "{command:?} ended with {status}; the target is added by `rustup target add wasm32-unknown-unknown`"
    ))
}
