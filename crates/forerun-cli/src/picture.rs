//! Pictures: bodies and distance fields drawn into an image by the processor alone, so that no window system is needed.

mod camera;
mod canvas;
mod raster;
mod round;
mod shade;
mod shadow;
mod slice;

pub(crate) use camera::Camera;
pub(crate) use canvas::Canvas;
pub(crate) use forerun_viewer::tessellate::{Facet, facets};
pub(crate) use shade::{Ground, Item, View, draw, square_for};
pub(crate) use slice::draw_slices;

use forerun::Vec3;

/// Direction from the bodies to the sun.
pub(crate) const TO_SUN: Vec3 = Vec3::new(0.44, 0.79, 0.42);

/// Colours that neighbours in the list are told apart by, also with a colour-vision deficiency (after Okabe and Ito, lightened).
const PALETTE: [Vec3; 8] = [
    Vec3::new(0.90, 0.60, 0.10),
    Vec3::new(0.30, 0.65, 0.90),
    Vec3::new(0.10, 0.60, 0.45),
    Vec3::new(0.93, 0.85, 0.35),
    Vec3::new(0.15, 0.45, 0.75),
    Vec3::new(0.85, 0.40, 0.15),
    Vec3::new(0.80, 0.50, 0.70),
    Vec3::new(0.75, 0.75, 0.78),
];

/// The colour of the body with a number.
pub(crate) fn colour_of(number: u32) -> Vec3 {
    // Rows of as many bodies as there are colours are not to have columns of one colour.
    let number = number as usize;
    PALETTE[(number + 3 * (number / PALETTE.len())) % PALETTE.len()]
}

/// The colour of what does not move.
pub(crate) const FIXED_COLOUR: Vec3 = Vec3::new(0.55, 0.55, 0.52);
