//! Reading: text to scene, and what the parsers say turned into our own errors.

use serde::de::DeserializeOwned;

use crate::error::{Fault, FieldPath, Place, SceneError, Step};
use crate::scene::Scene;
use crate::source::{Format, Source, place_of};

/// Reads a scene; ranges are checked later.
pub(crate) fn read(text: &str, format: Format, source_name: &str) -> Result<Scene, SceneError> {
    let source = Source::new(source_name, text, format);
    match format {
        Format::Toml => read_toml(text, &source),
        Format::Json => read_json(text, &source),
    }
}

fn read_toml<T: DeserializeOwned>(text: &str, source: &Source) -> Result<T, SceneError> {
    let place = |error: &toml::de::Error| error.span().map(|span| place_of(text, span.start));
    let deserializer = toml::de::Deserializer::parse(text)
        .map_err(|error| source.error_at(syntax_fault(error.message()), place(&error)))?;
    serde_path_to_error::deserialize(deserializer)
        .map_err(|error| data_error(source, error.path(), error.inner().message(), place(error.inner())))
}

fn read_json<T: DeserializeOwned>(text: &str, source: &Source) -> Result<T, SceneError> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let value = serde_path_to_error::deserialize(&mut deserializer).map_err(|error| {
        let inner = error.inner();
        let place = Some(Place { line: inner.line(), column: inner.column() });
        if inner.is_data() {
            data_error(source, error.path(), &without_place(inner), place)
        } else {
            // Such as a number that is too large: the field helps to find it.
            let fault = Fault { path: FieldPath::from(error.path()), ..syntax_fault(&without_place(inner)) };
            source.error_at(fault, place)
        }
    })?;
    deserializer.end().map_err(|error| {
        let place = Some(Place { line: error.line(), column: error.column() });
        source.error_at(syntax_fault(&without_place(&error)), place)
    })?;
    Ok(value)
}

/// The message without the `at line 1 column 2` that serde_json adds.
fn without_place(error: &serde_json::Error) -> String {
    let message = error.to_string();
    message.rfind(" at line ").map_or(message.clone(), |end| message[..end].to_owned())
}

fn syntax_fault(message: &str) -> Fault {
    Fault::new(
        message.lines().collect::<Vec<_>>().join("; "),
        "correct the text here: it is not valid in this format",
    )
}

/// A value of the wrong kind, an unknown field or a missing one.
fn data_error(
    source: &Source,
    path: &serde_path_to_error::Path,
    message: &str,
    place: Option<Place>,
) -> SceneError {
    let path = FieldPath::from(path);
    let remedy = remedy(&path, message);
    let at_root = path.0.is_empty();
    let fault = Fault { path, message: message.to_owned(), remedy };
    if at_root { source.error_at(fault, place) } else { source.error(fault) }
}

fn remedy(path: &FieldPath, message: &str) -> String {
    if let Some(wrong) = message.strip_prefix("unknown field `").or(message.strip_prefix("unknown variant `"))
    {
        let mut quoted = wrong.split('`');
        let wrong = quoted.next().unwrap_or_default();
        let allowed: Vec<&str> = quoted.skip(1).step_by(2).collect();
        return match nearest(wrong, &allowed) {
            Some(name) => format!("did you mean `{name}`?"),
            None => "remove it, or take one that is named here".to_owned(),
        };
    }
    if let Some(name) = message.strip_prefix("missing field `") {
        return format!("add {} = ...", name.trim_end_matches('`'));
    }
    match path.0.last() {
        Some(Step::Field(name)) => format!("correct the value of {name}"),
        _ => "correct the value".to_owned(),
    }
}

/// The allowed name that is most like `wrong`, if one is like it.
fn nearest<'a>(wrong: &str, allowed: &[&'a str]) -> Option<&'a str> {
    let limit = (wrong.chars().count() / 3).max(1);
    let with_distance = allowed.iter().map(|name| (edits(wrong, name), *name));
    with_distance.min().filter(|(distance, _)| *distance <= limit).map(|(_, name)| name)
}

/// Least number of characters to insert, remove or replace to get from `a` to `b` (Levenshtein 1966).
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_edits() {
        assert_eq!(edits("kitten", "sitting"), 3);
        assert_eq!(edits("", "abc"), 3);
        assert_eq!(edits("same", "same"), 0);
    }

    #[test]
    fn suggests_only_what_is_similar() {
        assert_eq!(nearest("positon", &["velocity", "position"]), Some("position"));
        assert_eq!(nearest("colour", &["velocity", "position"]), None);
    }
}
