//! Experiment: the four experiments of the dissertation's chapter 5, each decoupled and coupled.

mod calibrate;
mod plan;
mod report;

pub(crate) use calibrate::{Calibration, meshes_for_this_machine};
pub(crate) use plan::{Figure, FigureKind, Plan, Variant, dominoes, interaction, meshes, stack};
pub(crate) use report::{Outcome, markdown};
