//! Links: what the pages of Markdown point to exists.

use crate::files::File;
use crate::tidy::Complaint;

/// The pages that are looked at.
pub(crate) const PAGES: [&str; 3] = ["README.md", "CONTRIBUTING.md", "benches/README.md"];

/// Complains about relative links and pictures that lead nowhere. Other sites and places within a page are not looked at.
pub(crate) fn check(page: &str, text: &str, files: &[File]) -> Vec<Complaint> {
    let folder = page.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut complaints = Vec::new();
    for (i, line) in text.lines().enumerate() {
        // Every piece after the first begins with where a link or a picture leads.
        for piece in line.split("](").skip(1) {
            let target = piece.split([')', ' ', '#']).next().unwrap_or_default();
            if target.is_empty() || target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            if !resolved(folder, target).is_some_and(|path| exists(&path, files)) {
                let message = format!("links to {target}, which does not exist");
                complaints.push(Complaint::new(format!("{page}:{}", i + 1), message));
            }
        }
    }
    complaints
}

/// A path from the root; none when it leaves the repository.
fn resolved(folder: &str, target: &str) -> Option<String> {
    let mut path: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in target.split('/').filter(|part| !part.is_empty() && *part != ".") {
        if part == ".." {
            path.pop()?;
        } else {
            path.push(part);
        }
    }
    Some(path.join("/"))
}

/// Whether it is a file or a folder.
fn exists(path: &str, files: &[File]) -> bool {
    let inside = format!("{path}/");
    files.iter().any(|file| file.path == path || file.path.starts_with(&inside))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dead_links_and_pictures_are_named_with_their_line() {
        let files = ["docs/format.md", "docs/pictures/queue.svg", "benches/README.md"]
            .map(|path| File { path: path.to_owned(), bytes: 0 });
        let text = "![A queue](docs/pictures/queue.svg) and [a page](docs/format.md#bodies), [here](#here)\n\
                    [a site](https://example.org/x) [pictures](docs/pictures/)\n\
                    ![gone](docs/pictures/times.svg) [gone too](../docs/format.md) [part](docs/form)\n";
        let places = |page: &str| -> Vec<String> {
            check(page, text, &files).iter().map(ToString::to_string).collect()
        };
        assert_eq!(
            places("README.md"),
            [
                "README.md:3: links to docs/pictures/times.svg, which does not exist",
                "README.md:3: links to ../docs/format.md, which does not exist",
                "README.md:3: links to docs/form, which does not exist",
            ]
        );
        // From a folder the same links lead elsewhere.
        let from_benches = places("benches/README.md");
        assert_eq!(from_benches.len(), 5, "{from_benches:?}");
        assert!(!from_benches.iter().any(|complaint| complaint.contains("../docs/format.md")));
    }
}
