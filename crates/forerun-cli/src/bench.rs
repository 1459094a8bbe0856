//! Bench: the step on scenes, with guards on the quality that its time was paid for.

mod measure;
pub(crate) mod memory;
mod storage;

pub(crate) use measure::{Measurement, Run, measure};
pub(crate) use storage::bytes_per_body_frame;
