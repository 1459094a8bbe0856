//! The text that a scene came from: finds the line and column of a field when an error needs them.
//!
//! Nothing here runs for a scene without mistakes, so that large scenes are read at full speed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::value::RawValue;
use toml::de::{DeTable, DeValue};

use crate::error::{Fault, FieldPath, Place, SceneError, Step};

/// How a scene is written down. The schema is the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// TOML 1.0.
    Toml,
    /// JSON.
    Json,
}

impl Format {
    /// The format that a file's name ends in: `.toml` or `.json`, in any case.
    #[must_use]
    pub fn of(path: &Path) -> Option<Format> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "toml" => Some(Format::Toml),
            "json" => Some(Format::Json),
            _ => None,
        }
    }
}

/// Where a scene came from; nothing for one that was made in memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Source {
    /// File name for messages. Mesh files are looked for beside it.
    name: String,
    text: Option<(Arc<str>, Format)>,
}

impl Source {
    /// Without a text: errors have no line.
    pub(crate) fn named(name: &str) -> Source {
        Source { name: name.to_owned(), text: None }
    }

    pub(crate) fn new(name: &str, text: &str, format: Format) -> Source {
        Source { name: name.to_owned(), text: Some((Arc::from(text), format)) }
    }

    /// The folder that relative file names start from.
    pub(crate) fn folder(&self) -> PathBuf {
        Path::new(&self.name).parent().map(Path::to_path_buf).unwrap_or_default()
    }

    /// Completes a fault with file, line and column.
    pub(crate) fn error(&self, fault: Fault) -> SceneError {
        let place = self.text.as_ref().map(|(text, format)| {
            let offset = match format {
                Format::Toml => offset_in_toml(text, &fault.path),
                Format::Json => offset_in_json(text, &fault.path),
            };
            place_of(text, offset)
        });
        self.error_at(fault, place)
    }

    /// Completes a fault whose place is known.
    pub(crate) fn error_at(&self, fault: Fault, place: Option<Place>) -> SceneError {
        SceneError {
            file: self.name.clone(),
            place,
            field: fault.path.to_string(),
            message: fault.message,
            remedy: fault.remedy,
        }
    }
}

/// Line and column of a byte of a text.
pub(crate) fn place_of(text: &str, offset: usize) -> Place {
    let mut end = offset.min(text.len());
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    let before = &text[..end];
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    Place { line: before.matches('\n').count() + 1, column: before[line_start..].chars().count() + 1 }
}

/// Byte at which the value at `path` begins, or the deepest value on the way to it that exists.
fn offset_in_toml(text: &str, path: &FieldPath) -> usize {
    let Ok(root) = DeTable::parse(text) else { return 0 };
    let Some((Step::Field(first), rest)) = path.0.split_first() else { return 0 };
    let Some(mut value) = root.get_ref().get(first.as_str()) else { return 0 };
    let mut offset = value.span().start;
    for step in rest {
        let next = match (step, value.get_ref()) {
            (Step::Field(name), DeValue::Table(table)) => table.get(name.as_str()),
            (Step::Index(index), DeValue::Array(array)) => array.get(*index),
            _ => None,
        };
        let Some(next) = next else { break };
        value = next;
        offset = value.span().start;
    }
    offset
}

/// The same in JSON: each value is a slice of the text, and where a slice begins says where the value is.
fn offset_in_json(text: &str, path: &FieldPath) -> usize {
    let Ok(mut value) = serde_json::from_str::<&RawValue>(text) else { return 0 };
    for step in &path.0 {
        let next = match step {
            Step::Field(name) => {
                let fields: Result<BTreeMap<String, &RawValue>, _> = serde_json::from_str(value.get());
                fields.ok().and_then(|fields| fields.get(name).copied())
            }
            Step::Index(index) => {
                let items: Result<Vec<&RawValue>, _> = serde_json::from_str(value.get());
                items.ok().and_then(|items| items.get(*index).copied())
            }
        };
        let Some(next) = next else { break };
        value = next;
    }
    value.get().as_ptr() as usize - text.as_ptr() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path() -> FieldPath {
        FieldPath(vec![Step::Field("bodies".into()), Step::Index(1), Step::Field("radius".into())])
    }

    #[test]
    fn finds_the_line_and_column_in_toml() {
        let text = "# é\n[[bodies]]\nradius = 1\n[[bodies]]\nname = 'ü'\nradius = -2\n";
        assert_eq!(place_of(text, offset_in_toml(text, &path())), Place { line: 6, column: 10 });
    }

    #[test]
    fn finds_the_line_and_column_in_json() {
        let text = "{ \"bodies\": [\n  { \"radius\": 1 },\n  { \"name\": \"ü\", \"radius\": -2 } ] }";
        assert_eq!(place_of(text, offset_in_json(text, &path())), Place { line: 3, column: 28 });
    }

    #[test]
    fn a_field_that_is_missing_is_reported_at_its_owner() {
        let text = "{\n\"bodies\": [ {},\n {} ] }";
        assert_eq!(place_of(text, offset_in_json(text, &path())), Place { line: 3, column: 2 });
    }
}
