//! Bench: the step on scenes, with guards on the quality that its time was paid for.

mod energy;
mod measure;
mod memory;
mod overlap;

pub(crate) use measure::{Measurement, measure};
