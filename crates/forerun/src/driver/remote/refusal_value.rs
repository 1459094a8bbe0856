//! Refusal value: what the physics did not do, as it is in a message, and back.

use forerun_timeline::{CommandError, Frame};
use serde::{Deserialize, Serialize};

use crate::driver::refusal::Refusal;
use crate::recording::orders::{KeyValue, key_of, key_value};
use crate::{BodyError, BodyId};

/// Fields that errors name. An error of a field that is not among them names it in its message.
const FIELDS: [&str; 34] = [
    "angular_velocity",
    "at_point",
    "centre",
    "density",
    "force",
    "friction",
    "gravity",
    "gravity_scale",
    "half_extents",
    "half_height",
    "impulse",
    "inertia",
    "mass",
    "material.friction",
    "material.restitution",
    "material.static_friction",
    "mesh",
    "pose.position",
    "pose.rotation",
    "position",
    "principal_rotation",
    "radius",
    "restitution",
    "rotation",
    "scale",
    "shape",
    "spring.anchor",
    "spring.damping_ratio",
    "spring.frequency_hz",
    "spring.target",
    "static_friction",
    "torque",
    "velocity",
    "vertices",
];

/// What stands for a field that is not among them.
const OTHER_FIELD: &str = "number";

/// As [`Refusal`]. Forks are not adopted from elsewhere.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum RefusalValue {
    Submit(KeyValue, ErrorValue),
    Retract(KeyValue, ErrorValue),
    Replace(KeyValue, ErrorValue),
    Undo(ErrorValue),
    Redo(ErrorValue),
}

/// As [`CommandError`].
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum ErrorValue {
    TooOld(u64, u64),
    DuplicateKey(KeyValue),
    UnknownCommand(KeyValue),
    NothingToUndo,
    NothingToRedo,
    UnknownBody(u32),
    BodyExists(u32),
    Body(String, String),
    Number(String, String),
}

pub(super) fn refusal_value(refusal: &Refusal) -> Option<RefusalValue> {
    Some(match refusal {
        Refusal::Submit(key, error) => RefusalValue::Submit(key_value(key), error_value(error)),
        Refusal::Retract(key, error) => RefusalValue::Retract(key_value(key), error_value(error)),
        Refusal::Replace(key, error) => RefusalValue::Replace(key_value(key), error_value(error)),
        Refusal::Undo(error) => RefusalValue::Undo(error_value(error)),
        Refusal::Redo(error) => RefusalValue::Redo(error_value(error)),
        Refusal::Adopt(_) => return None,
    })
}

pub(super) fn refusal_of(value: RefusalValue) -> Refusal {
    match value {
        RefusalValue::Submit(key, error) => Refusal::Submit(key_of(key), error_of(error)),
        RefusalValue::Retract(key, error) => Refusal::Retract(key_of(key), error_of(error)),
        RefusalValue::Replace(key, error) => Refusal::Replace(key_of(key), error_of(error)),
        RefusalValue::Undo(error) => Refusal::Undo(error_of(error)),
        RefusalValue::Redo(error) => Refusal::Redo(error_of(error)),
    }
}

pub(super) fn error_value(error: &CommandError) -> ErrorValue {
    match error {
        CommandError::TooOld { frame, oldest } => ErrorValue::TooOld(frame.0, oldest.0),
        CommandError::DuplicateKey(key) => ErrorValue::DuplicateKey(key_value(key)),
        CommandError::UnknownCommand(key) => ErrorValue::UnknownCommand(key_value(key)),
        CommandError::NothingToUndo => ErrorValue::NothingToUndo,
        CommandError::NothingToRedo => ErrorValue::NothingToRedo,
        CommandError::UnknownBody(body) => ErrorValue::UnknownBody(body.0),
        CommandError::BodyExists(body) => ErrorValue::BodyExists(body.0),
        CommandError::Body(error) => ErrorValue::Body(error.field.to_owned(), error.message.clone()),
        CommandError::Number { field, message } => ErrorValue::Number((*field).to_owned(), message.clone()),
    }
}

pub(super) fn error_of(value: ErrorValue) -> CommandError {
    match value {
        ErrorValue::TooOld(frame, oldest) => {
            CommandError::TooOld { frame: Frame(frame), oldest: Frame(oldest) }
        }
        ErrorValue::DuplicateKey(key) => CommandError::DuplicateKey(key_of(key)),
        ErrorValue::UnknownCommand(key) => CommandError::UnknownCommand(key_of(key)),
        ErrorValue::NothingToUndo => CommandError::NothingToUndo,
        ErrorValue::NothingToRedo => CommandError::NothingToRedo,
        ErrorValue::UnknownBody(body) => CommandError::UnknownBody(BodyId(body)),
        ErrorValue::BodyExists(body) => CommandError::BodyExists(BodyId(body)),
        ErrorValue::Body(field, message) => {
            let (field, message) = known_field(&field, message);
            CommandError::Body(BodyError { field, message })
        }
        ErrorValue::Number(field, message) => {
            let (field, message) = known_field(&field, message);
            CommandError::Number { field, message }
        }
    }
}

fn known_field(field: &str, message: String) -> (&'static str, String) {
    match FIELDS.iter().find(|known| **known == field) {
        Some(known) => (known, message),
        None => (OTHER_FIELD, format!("{field}: {message}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CommandKey;

    #[test]
    fn refusals_come_back() {
        let key = CommandKey { frame: Frame(7), source: 2, sequence: 9 };
        let body = BodyError { field: "radius", message: "must be above 0".to_owned() };
        let number = CommandError::Number { field: "spring.target", message: "must be finite".to_owned() };
        let refusals = [
            Refusal::Submit(key, CommandError::TooOld { frame: Frame(3), oldest: Frame(5) }),
            Refusal::Submit(key, CommandError::DuplicateKey(key)),
            Refusal::Submit(key, CommandError::Body(body)),
            Refusal::Retract(key, CommandError::UnknownCommand(key)),
            Refusal::Replace(key, number),
            Refusal::Replace(key, CommandError::UnknownBody(BodyId(3))),
            Refusal::Replace(key, CommandError::BodyExists(BodyId(4))),
            Refusal::Undo(CommandError::NothingToUndo),
            Refusal::Redo(CommandError::NothingToRedo),
        ];
        for refusal in refusals {
            assert_eq!(refusal_value(&refusal).map(refusal_of), Some(refusal));
        }
        let strange = ErrorValue::Number("flavour".to_owned(), "must be sweet".to_owned());
        assert_eq!(error_of(strange).to_string(), "number: flavour: must be sweet");
    }
}
