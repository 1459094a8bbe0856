//! Bench: the step on scenes, with guards on the quality that its time was paid for.

mod energy;
mod measure;
mod memory;
mod overlap;
mod storage;

pub(crate) use measure::{Measurement, Run, measure};
pub(crate) use overlap::deepest_m as overlap_m;
pub(crate) use storage::bytes_per_body_frame;
