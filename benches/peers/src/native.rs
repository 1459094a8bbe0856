//! Native: this program once more, with the other engines, built for the processor at hand.
//!
//! Ours is measured in the plain build that runs this; the others get every instruction that the machine has, and the whole program's optimisation.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// Flags of the second build.
const RUSTFLAGS: &str = "-Ctarget-cpu=native";
const CFLAGS: &str = "-march=native";
const LTO: &str = "fat";

/// How the other engines were built, in words.
pub(crate) fn describe() -> String {
    format!("the others built with {RUSTFLAGS} (LTO {LTO}) and {CFLAGS}, Rapier in 8 lanes")
}

/// Builds, unless it is there already, and says where the program lies. `threaded`: with Rapier's loops over threads.
pub(crate) fn build(threaded: Threaded) -> Result<PathBuf, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let target = folder.join("target").join("native");
    let (feature, name) = match threaded {
        Threaded::No => ("engines", "peers-1"),
        Threaded::Yes => ("rapier-threads", "peers-n"),
    };
    eprintln!("building the other engines for this processor ({feature}) ...");
    let status = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["build", "--release", "--quiet", "--locked", "--features", feature])
        .arg("--manifest-path")
        .arg(folder.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(&target)
        .env("RUSTFLAGS", RUSTFLAGS)
        .env("CFLAGS", CFLAGS)
        .env("CXXFLAGS", CFLAGS)
        .env("CARGO_PROFILE_RELEASE_LTO", LTO)
        .status()
        .map_err(|error| format!("cargo cannot be started: {error}"))?;
    if !status.success() {
        return Err("the other engines cannot be built: they need cmake, a C++ compiler and libclang \
                    (Debian: cmake g++ libclang-dev); or ask for --engines forerun"
            .to_owned());
    }
    let program = target.join(name).with_extension(env::consts::EXE_EXTENSION);
    let built = target.join("release").join("peers").with_extension(env::consts::EXE_EXTENSION);
    // The next build puts its own in the same place.
    fs::copy(&built, &program).map_err(|error| format!("{} cannot be copied: {error}", built.display()))?;
    Ok(program)
}

/// Whether Rapier shares its loops out to threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Threaded {
    No,
    Yes,
}
