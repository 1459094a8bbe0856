//! Letters A to Z as solid blocks.

use glam::DVec2;

use super::outline::Outline;
use super::{ShapeError, below};
use crate::shape::{TriangleList, positive};

/// A capital letter as a solid, upright in the x-y plane and read from +z; the middle of its box is the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Letter {
    /// `A` to `Z`.
    pub letter: char,
    /// From foot to top; a stroke is a fifth of it wide. Metres, above 0.
    pub height: f32,
    /// Thickness along z. Metres, above 0 and at most 10 times `height`.
    pub depth: f32,
}

impl Letter {
    /// Whether it can be made.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        if text_of(self.letter).is_none() {
            return Err(ShapeError::new("letter", format!("must be one of A to Z, is {:?}", self.letter)));
        }
        positive("height", self.height)?;
        below("depth", self.depth, 10.0 * self.height, "10 times height")
    }

    /// Its surface.
    ///
    /// # Errors
    /// As [`Letter::check`].
    pub fn triangles(&self) -> Result<TriangleList, ShapeError> {
        self.check()?;
        let mut lines = self.lines();
        let corners = || lines.iter().flatten();
        let low = corners().fold(DVec2::INFINITY, |m, p| m.min(*p));
        let high = corners().fold(DVec2::NEG_INFINITY, |m, p| m.max(*p));
        let middle = 0.5 * (low + high);
        lines.iter_mut().flatten().for_each(|p| *p -= middle);
        let outline = Outline { border: lines.remove(0), holes: lines, web: Vec::new() };
        Ok(outline.extrude(0.5 * f64::from(self.depth), |place| place))
    }

    /// The outline and the holes in it. Metres, from the lower left corner.
    fn lines(&self) -> Vec<Vec<DVec2>> {
        let tenth = 0.1 * f64::from(self.height);
        let digit = |c: u8| f64::from(char::from(c).to_digit(16).unwrap_or_default());
        let point = |corner: &str| match corner.as_bytes() {
            [x, y] => Some(DVec2::new(digit(*x), digit(*y)) * tenth),
            _ => None,
        };
        let line = |text: &str| text.split(' ').filter_map(point).collect();
        text_of(self.letter).map_or(Vec::new(), |text| text.split(" / ").map(line).collect())
    }
}

fn text_of(letter: char) -> Option<&'static str> {
    let index = u32::from(letter).checked_sub(u32::from('A'))?;
    LETTERS.get(index as usize).copied()
}

/// From A to Z: the corners of the outline, and after each slash those of a hole; x and y in tenths of the height as two hexadecimal digits.
/// A stroke is 2 wide.
const LETTERS: [&str; 26] = [
    "00 20 23 63 60 80 88 6A 2A 08 / 25 65 67 58 38 27",
    "00 60 82 84 75 86 88 6A 0A / 22 52 63 54 24 / 26 56 67 58 28",
    "20 60 82 83 63 52 32 23 27 38 58 67 87 88 6A 2A 08 02",
    "00 60 82 88 6A 0A / 22 52 63 67 58 28",
    "00 80 82 22 24 64 66 26 28 88 8A 0A",
    "00 20 24 64 66 26 28 88 8A 0A",
    "20 60 82 86 46 44 64 63 52 32 23 27 38 58 67 87 88 6A 2A 08 02",
    "00 20 24 64 60 80 8A 6A 66 26 2A 0A",
    "00 20 2A 0A",
    "20 60 82 8A 6A 63 52 32 23 24 04 02",
    "00 20 24 60 90 45 9A 6A 26 2A 0A",
    "00 80 82 22 2A 0A",
    "00 20 26 52 86 80 A0 AA 8A 56 2A 0A",
    "00 20 26 60 80 8A 6A 64 2A 0A",
    "20 60 82 88 6A 2A 08 02 / 32 52 63 67 58 38 27 23",
    "00 20 24 64 86 88 6A 0A / 26 56 67 58 28",
    "20 90 82 88 6A 2A 08 02 / 32 52 63 67 58 38 27 23",
    "00 20 24 44 60 80 64 86 88 6A 0A / 26 56 67 58 28",
    "20 60 82 84 66 26 28 58 67 87 88 6A 2A 08 06 24 64 62 32 23 03 02",
    "30 50 58 88 8A 0A 08 38",
    "20 60 82 8A 6A 63 52 32 23 2A 0A 02",
    "30 50 8A 6A 43 2A 0A",
    "00 20 54 80 A0 AA 8A 84 58 24 2A 0A",
    "00 20 43 60 80 55 8A 6A 47 2A 0A 35",
    "30 50 54 8A 6A 46 2A 0A 34",
    "00 80 82 32 88 8A 0A 08 58 02",
];
