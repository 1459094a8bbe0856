//! Floors: a crate depends on lower floors only.

use crate::tidy::Complaint;

/// Every crate of ours and its floor.
const FLOORS: [(&str, u32); 12] = [
    ("forerun-lanes", 0),
    ("forerun-geometry", 1),
    ("forerun-dynamics", 2),
    ("forerun-timeline", 3),
    ("forerun-scene", 3),
    ("forerun", 4),
    ("forerun-cli", 6),
    ("forerun-viewer", 5),
    ("forerun-python", 5),
    ("forerun-wasm", 5),
    ("forerun-web", 6),
    ("forerun-web-pack", 0),
];

/// Complains about a `Cargo.toml` that depends on its own or a higher floor. Tests may look up: `dev-dependencies` are free.
pub(crate) fn check(path: &str, manifest: &str) -> Vec<Complaint> {
    let table: toml::Table = match manifest.parse() {
        Ok(table) => table,
        Err(error) => return vec![Complaint::new(path, format!("is not TOML: {}", error.message()))],
    };
    let name = table.get("package").and_then(|package| package.get("name")).and_then(toml::Value::as_str);
    let Some(name) = name.filter(|name| name.starts_with("forerun")) else { return Vec::new() };
    let Some(own) = floor_of(name) else {
        let message = format!("{name} has no floor yet: give it one in FLOORS of the xtask");
        return vec![Complaint::new(path, message)];
    };
    let mut complaints = Vec::new();
    for dependency in dependencies(&table).filter(|dependency| dependency.starts_with("forerun")) {
        match floor_of(dependency) {
            Some(floor) if floor < own => {}
            Some(floor) => {
                let message = format!(
                    "{name} (floor {own}) depends on {dependency} (floor {floor}): only lower floors"
                );
                complaints.push(Complaint::new(path, message));
            }
            None => complaints.push(Complaint::new(path, format!("{dependency} has no floor"))),
        }
    }
    complaints
}

fn floor_of(name: &str) -> Option<u32> {
    FLOORS.iter().find(|(crate_name, _)| *crate_name == name).map(|(_, floor)| *floor)
}

/// Names of all dependencies, those of single targets too.
fn dependencies(table: &toml::Table) -> impl Iterator<Item = &str> {
    let of_targets = table.get("target").and_then(toml::Value::as_table).into_iter();
    let of_targets = of_targets.flat_map(|targets| targets.values().filter_map(toml::Value::as_table));
    std::iter::once(table).chain(of_targets).flat_map(|table| {
        let lists = ["dependencies", "build-dependencies"].map(|name| table.get(name));
        lists
            .into_iter()
            .flatten()
            .filter_map(toml::Value::as_table)
            .flat_map(|list| list.keys().map(String::as_str))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complaints(name: &str, rest: &str) -> usize {
        check("crates/x/Cargo.toml", &format!("[package]\nname = \"{name}\"\n{rest}")).len()
    }

    #[test]
    fn only_lower_floors_are_allowed() {
        assert_eq!(
            complaints("forerun-dynamics", "[dependencies]\nforerun-geometry.workspace = true\nglam = \"1\""),
            0
        );
        assert_eq!(complaints("forerun-geometry", "[dependencies]\nforerun-dynamics.workspace = true"), 1);
        assert_eq!(complaints("forerun-scene", "[dependencies]\nforerun-timeline.workspace = true"), 1);
        assert_eq!(
            complaints("forerun-scene", "[target.'cfg(unix)'.build-dependencies]\nforerun = \"1\""),
            1
        );
        assert_eq!(complaints("forerun-dynamics", "[dev-dependencies]\nforerun-scene.workspace = true"), 0);
    }

    #[test]
    fn every_crate_of_ours_has_a_floor() {
        assert_eq!(complaints("forerun-attic", ""), 1);
        assert_eq!(complaints("xtask", "[dependencies]\nforerun-attic = \"1\""), 0);
    }
}
