//! Contact manifolds: known answers, and properties that hold for any two shapes.

mod common;
mod degenerate;
mod known;
mod passing;
mod random;
