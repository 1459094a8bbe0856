//! Contact manifolds: known answers, and properties that hold for any two shapes.

mod common;
mod known;
mod random;
