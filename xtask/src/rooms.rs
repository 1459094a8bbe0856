//! Rooms: files short enough to be read at once, each with a caption.

use crate::tidy::Complaint;

/// Lines of the longest room.
const LINES_MAX: usize = 400;

/// Marks of unfinished work. In two parts each, or this list would complain about itself.
const MARKS: [&str; 3] = [concat!("TO", "DO"), concat!("FIX", "ME"), concat!("XX", "X")];

/// Words that a mark needs behind it to be an explanation.
const WORDS_MIN: usize = 4;

/// Complains about a room that is too long or has no caption.
pub(crate) fn check(path: &str, text: &str) -> Vec<Complaint> {
    let mut complaints = Vec::new();
    let lines = text.lines().count();
    if lines > LINES_MAX {
        let message = format!("has {lines} lines, a room has at most {LINES_MAX}: make two of it");
        complaints.push(Complaint::new(path, message));
    }
    let caption = text.lines().next().and_then(|line| line.strip_prefix("//! ")).map(str::trim);
    if caption.is_none_or(str::is_empty) {
        let message = "must open with a line `//! ` that says what the room is for";
        complaints.push(Complaint::new(format!("{path}:1"), message));
    }
    complaints
}

/// Complains about marks of unfinished work that do not say what is missing and why.
pub(crate) fn check_marks(path: &str, text: &str) -> Vec<Complaint> {
    let mut complaints = Vec::new();
    for (i, line) in text.lines().enumerate() {
        for mark in MARKS {
            let Some((before, after)) = line.split_once(mark) else { continue };
            let inside_a_word = before.ends_with(|c: char| c.is_alphanumeric() || c == '_')
                || after.starts_with(|c: char| c.is_alphanumeric() || c == '_');
            if !inside_a_word && after.split_whitespace().count() < WORDS_MIN {
                let message = format!("{mark} without an explanation: say what is missing and why, or do it");
                complaints.push(Complaint::new(format!("{path}:{}", i + 1), message));
            }
        }
    }
    complaints
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_rooms_and_rooms_without_a_caption_are_named() {
        let good = "//! Says what it is for.\n".to_owned();
        assert!(check("a.rs", &good).is_empty());
        assert_eq!(check("a.rs", &(good + &"x\n".repeat(LINES_MAX))).len(), 1);
        assert_eq!(check("a.rs", "use std::fmt;\n").len(), 1);
        assert_eq!(check("a.rs", "//! \n").len(), 1);
        assert_eq!(check("a.rs", "").len(), 1);
    }

    #[test]
    fn marks_need_an_explanation() {
        let mark = MARKS[0];
        let lines =
            format!("fine\n// {mark}\n// {mark}: later\n// {mark}: rays miss open meshes, see issue 12\n");
        let complaints = check_marks("a.rs", &lines);
        let places: Vec<&str> = complaints.iter().map(|c| c.place.as_str()).collect();
        assert_eq!(places, ["a.rs:2", "a.rs:3"]);
        assert!(check_marks("a.rs", &format!("let {mark}S = 1;")).is_empty());
    }
}
