//! Scenes: the built-in ones as a list, or one of them as a file.

use forerun::scene::builtin;

use crate::args::ScenesArgs;
use crate::failure::Failure;
use crate::output::print;

/// `forerun scenes`.
pub(crate) fn run(args: &ScenesArgs) -> Result<(), Failure> {
    match &args.name {
        Some(name) => {
            let scene = builtin::scene(name)?;
            print(scene.to_toml().trim_end())
        }
        None => list(),
    }
}

fn list() -> Result<(), Failure> {
    print(&format!("{:<16} {:>6}  {:<24} {}", "SCENE", "SIZE", "THE SIZE COUNTS", "WHAT IT SHOWS"))?;
    for built_in in builtin::list() {
        let size = built_in.default_size.map_or_else(String::new, |size| size.to_string());
        let line =
            format!("{:<16} {size:>6}  {:<24} {}", built_in.name, built_in.size_counts, built_in.description);
        print(line.trim_end())?;
    }
    print(
        "\nAnother size goes behind a colon (dominoes:1000); `forerun scenes NAME` prints a scene as a file.",
    )
}
