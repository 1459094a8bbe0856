//! Meshes from formulas, for scenes, tests and play.
//!
//! Promise: closed (but for [`Terrain`]), wound counter-clockwise seen from outside, nothing for [`Mesh::new`] to mend; no surface cuts itself, and no triangle is a
//! sliver where the parameters suit each other. All are centred on the origin unless they say otherwise. Counts out of range, and
//! lengths that do not go together, are errors that name the parameter.

use std::ops::RangeInclusive;

use super::{Mesh, ShapeError, positive};

mod ball;
mod bowl;
mod cells;
mod gear;
mod jack;
mod knot;
mod letter;
mod link;
mod mug;
mod outline;
mod revolution;
mod surface;
mod surface_net;
mod terrain;
mod thread;

pub use ball::{Ball, ball};
pub use bowl::Bowl;
pub use cells::{Chair, angle, cuboid, frame};
pub use gear::Gear;
pub use jack::Jack;
pub use knot::TorusKnot;
pub use letter::Letter;
pub use link::Link;
pub use mug::Mug;
pub use revolution::{Torus, ring, torus};
pub use terrain::Terrain;
pub use thread::{Bolt, Grip, Nut, Thread};

/// Most segments or sides that a maker accepts.
const FINEST: u32 = 1024;

fn count(field: &'static str, value: u32, range: RangeInclusive<u32>) -> Result<(), ShapeError> {
    if range.contains(&value) {
        Ok(())
    } else {
        Err(ShapeError::new(field, format!("must be from {} to {}, is {value}", range.start(), range.end())))
    }
}

/// A length above 0 and below another, or below what another leaves (`what` says which).
fn below(field: &'static str, value: f32, limit: f32, what: &str) -> Result<(), ShapeError> {
    if value > 0.0 && value < limit {
        Ok(())
    } else {
        Err(ShapeError::new(field, format!("must be above 0 and below {what} ({limit}), is {value}")))
    }
}

/// Two lengths, the first above the second and the second above 0.
fn larger(
    (field, value): (&'static str, f32),
    (other, limit): (&'static str, f32),
) -> Result<(), ShapeError> {
    positive(other, limit)?;
    positive(field, value)?;
    if value > limit {
        Ok(())
    } else {
        Err(ShapeError::new(field, format!("must be above {other} ({limit}), is {value}")))
    }
}

#[cfg(test)]
mod tests;
