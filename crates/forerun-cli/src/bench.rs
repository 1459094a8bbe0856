//! Bench: the step on scenes, with guards on the quality that its time was paid for.

mod chart;
mod measure;
pub(crate) mod memory;
mod storage;

pub(crate) use chart::draw_stages;
pub(crate) use measure::{Measurement, Run, measure};
pub(crate) use storage::add_storage;
