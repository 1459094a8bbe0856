//! What numbers are allowed: the checks that all parts of a scene share.

use crate::error::{Fault, Within};

/// Names longer than this are typing accidents.
const NAME_CHARACTERS_MAX: usize = 100;

pub(crate) fn finite(value: f32, field: &str) -> Result<(), Fault> {
    check(value.is_finite(), value, "a finite number", field)
}

pub(crate) fn above_zero(value: f32, field: &str) -> Result<(), Fault> {
    check(value > 0.0 && value.is_finite(), value, "above 0", field)
}

pub(crate) fn above_zero_to(value: f32, high: f32, field: &str) -> Result<(), Fault> {
    check(value > 0.0 && value <= high, value, &format!("above 0 and at most {high}"), field)
}

pub(crate) fn zero_or_more(value: f32, field: &str) -> Result<(), Fault> {
    check(value >= 0.0 && value.is_finite(), value, "0 or more", field)
}

pub(crate) fn between(value: f32, (low, high): (f32, f32), field: &str) -> Result<(), Fault> {
    check((low..=high).contains(&value), value, &format!("from {low} to {high}"), field)
}

/// Three finite numbers.
pub(crate) fn vector(value: [f32; 3], field: &str) -> Result<(), Fault> {
    each(value, field, |x| x.is_finite(), "a finite number")
}

/// Three numbers above 0.
pub(crate) fn vector_above_zero(value: [f32; 3], field: &str) -> Result<(), Fault> {
    each(value, field, |x| x > 0.0 && x.is_finite(), "above 0")
}

/// A name that can stand in a table, a message and a file name.
pub(crate) fn name(value: &str, field: &str) -> Result<(), Fault> {
    if !value.trim().is_empty() && value.chars().count() <= NAME_CHARACTERS_MAX {
        return Ok(());
    }
    let message = format!("must be a name of 1 to {NAME_CHARACTERS_MAX} characters, is \"{value}\"");
    Err(Fault::new(message, "give it a short name or leave the field out")).in_field(field)
}

fn each<const N: usize>(
    value: [f32; N],
    field: &str,
    allowed: fn(f32) -> bool,
    expected: &str,
) -> Result<(), Fault> {
    for (i, x) in value.into_iter().enumerate() {
        if !allowed(x) {
            return Err(out_of_range(x, expected)).in_item(i).in_field(field);
        }
    }
    Ok(())
}

fn check(allowed: bool, value: f32, expected: &str, field: &str) -> Result<(), Fault> {
    if allowed { Ok(()) } else { Err(out_of_range(value, expected)).in_field(field) }
}

fn out_of_range(value: impl std::fmt::Display, expected: &str) -> Fault {
    Fault::new(format!("must be {expected}, is {value}"), format!("write a number that is {expected}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_is_not_a_number_passes() {
        for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(finite(x, "f").is_err());
            assert!(above_zero(x, "f").is_err());
            assert!(zero_or_more(x, "f").is_err());
            assert!(between(x, (0.0, 1.0), "f").is_err());
            assert!(vector([0.0, x, 0.0], "f").is_err());
        }
    }

    #[test]
    fn ends_of_ranges_belong_to_them() {
        assert!(between(1.0, (0.0, 1.0), "f").is_ok());
        assert!(zero_or_more(0.0, "f").is_ok());
        assert!(above_zero(0.0, "f").is_err());
    }

    #[test]
    fn a_component_is_named_by_its_index() {
        let fault = vector_above_zero([1.0, 1.0, -1.0], "half_extents").unwrap_err();
        assert_eq!(fault.path.to_string(), "half_extents[2]");
    }
}
