//! The map: paths that ARCHITECTURE.md names exist.

use crate::files::File;
use crate::tidy::Complaint;

/// The file with the map.
pub(crate) const FILE: &str = "ARCHITECTURE.md";

/// Endings of what is meant as a file even without a folder in front.
const ENDINGS: [&str; 5] = [".rs", ".toml", ".md", ".py", ".ts"];

/// Complains about paths in backticks that lead nowhere.
pub(crate) fn check(text: &str, files: &[File]) -> Vec<Complaint> {
    let mut complaints = Vec::new();
    for (i, line) in text.lines().enumerate() {
        // Every other piece between backticks is inside of them.
        for quoted in line.split('`').skip(1).step_by(2) {
            if is_path(quoted) && !exists(quoted, files) {
                let message = format!("names `{quoted}`, which does not exist");
                complaints.push(Complaint::new(format!("{FILE}:{}", i + 1), message));
            }
        }
    }
    complaints
}

fn is_path(quoted: &str) -> bool {
    let of_a_path = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
    let relative =
        !quoted.starts_with('/') && quoted.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '.');
    let named = quoted.contains('/') || ENDINGS.iter().any(|ending| quoted.ends_with(ending));
    relative && named && quoted.chars().all(of_a_path) && quoted.contains(|c: char| c.is_ascii_lowercase())
}

/// A path is a file, a folder, or the end of one: `solver/rows.rs` and `step.rs` are enough where they are clear.
fn exists(path: &str, files: &[File]) -> bool {
    let path = path.trim_end_matches('/');
    let inside = format!("/{path}/");
    files.iter().any(|file| {
        let file = format!("/{}", file.path);
        file.ends_with(inside.trim_end_matches('/')) || file.contains(&inside)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dead_paths_are_named_with_their_line() {
        let files =
            ["crates/a/src/step.rs", "docs/b.md"].map(|path| File { path: path.to_owned(), bytes: 0 });
        let map = "See `crates/a/src/step.rs`, `step.rs`, `docs/`, `a/src`.\n\
                   `step` and `Vec<f32>` and `a / b` and `MIT/APACHE 2` are no paths.\n\
                   But `crates/b` and `tep.rs` are gone.\n";
        let complaints = check(map, &files);
        let messages: Vec<String> = complaints.iter().map(ToString::to_string).collect();
        assert_eq!(
            messages,
            [
                "ARCHITECTURE.md:3: names `crates/b`, which does not exist",
                "ARCHITECTURE.md:3: names `tep.rs`, which does not exist",
            ]
        );
    }
}
