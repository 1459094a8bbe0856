//! What can be wrong with a scene, and where: file, line, column, field, what is allowed, what to do.

use std::fmt;

/// Why a scene cannot be used.
///
/// Printed, it reads `slope.toml:12:22: bodies[1].shape.sphere.radius: must be above 0, is -1 (write a positive length in metres)`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// The file, or the name under which the scene was parsed.
    pub file: String,
    /// Where in the file; none for a scene that was made without a text.
    pub place: Option<Place>,
    /// Path of the field, as `bodies[1].shape.sphere.radius`. Empty when the file as a whole is at fault.
    pub field: String,
    /// What is wrong and what is allowed.
    pub message: String,
    /// What to do about it.
    pub remedy: String,
}

/// A place in a text. Both count from 1; a column is a character, not a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Line.
    pub line: usize,
    /// Character of the line.
    pub column: usize,
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file)?;
        if let Some(place) = self.place {
            write!(f, ":{}:{}", place.line, place.column)?;
        }
        if !self.field.is_empty() {
            write!(f, ": {}", self.field)?;
        }
        write!(f, ": {}", self.message)?;
        if self.remedy.is_empty() { Ok(()) } else { write!(f, " ({})", self.remedy) }
    }
}

impl std::error::Error for SceneError {}

/// One step from a value to a part of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// A named field.
    Field(String),
    /// An element of a list, from 0.
    Index(usize),
}

/// Where a value is in a scene, from the outside in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct FieldPath(pub(crate) Vec<Step>);

impl From<&serde_path_to_error::Path> for FieldPath {
    fn from(path: &serde_path_to_error::Path) -> Self {
        use serde_path_to_error::Segment;
        let step = |segment: &Segment| match segment {
            Segment::Seq { index } => Some(Step::Index(*index)),
            Segment::Map { key } => Some(Step::Field(key.clone())),
            Segment::Enum { variant } => Some(Step::Field(variant.clone())),
            Segment::Unknown => None,
        };
        FieldPath(path.iter().filter_map(step).collect())
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, step) in self.0.iter().enumerate() {
            match step {
                Step::Field(name) if i == 0 => write!(f, "{name}")?,
                Step::Field(name) => write!(f, ".{name}")?,
                Step::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// A mistake in a scene before anyone has looked up its line. Built at the value, completed on the way out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Fault {
    pub(crate) path: FieldPath,
    pub(crate) message: String,
    pub(crate) remedy: String,
}

impl Fault {
    pub(crate) fn new(message: impl Into<String>, remedy: impl Into<String>) -> Fault {
        Fault { path: FieldPath::default(), message: message.into(), remedy: remedy.into() }
    }

    pub(crate) fn under(mut self, step: Step) -> Fault {
        self.path.0.insert(0, step);
        self
    }
}

/// Says which part of a value a fault was found in.
pub(crate) trait Within<T> {
    fn in_field(self, name: &str) -> Result<T, Fault>;
    fn in_item(self, index: usize) -> Result<T, Fault>;
}

impl<T> Within<T> for Result<T, Fault> {
    fn in_field(self, name: &str) -> Result<T, Fault> {
        self.map_err(|fault| fault.under(Step::Field(name.to_owned())))
    }

    fn in_item(self, index: usize) -> Result<T, Fault> {
        self.map_err(|fault| fault.under(Step::Index(index)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prints_place_field_message_and_remedy() {
        let fault: Result<(), Fault> = Err(Fault::new("must be above 0, is -1", "write a length"));
        let fault = fault.in_field("radius").in_item(3).in_field("bodies").unwrap_err();
        let error = SceneError {
            file: "a.toml".into(),
            place: Some(Place { line: 7, column: 3 }),
            field: fault.path.to_string(),
            message: fault.message,
            remedy: fault.remedy,
        };
        assert_eq!(
            error.to_string(),
            "a.toml:7:3: bodies[3].radius: must be above 0, is -1 (write a length)"
        );
    }
}
