//! The solver: one batch of islands through the stages of a frame, or of a slice of one.
#![allow(
    clippy::needless_range_loop,
    reason = "kernels walk several short arrays side by side; the index is the point"
)]

mod arrange;
mod blocks;
mod bodies;
mod classes;
mod collisions;
mod contact_graph;
mod descent;
mod ends;
mod energy_guard;
mod flight;
mod impulses;
mod islands;
mod load;
mod manifolds;
mod overlap;
mod points;
mod poses;
mod positions;
mod prepare;
mod pressure;
mod rest;
mod rotation;
mod rows;
mod shared;
mod shares;
mod shock;
mod sides;
mod spring;
mod standing;
mod substep;
mod sweep;
mod team;
mod velocities;
mod warm_start;

mod batch;

pub(crate) use batch::{Batch, Ends, is_mesh};
pub(crate) use flight::fly;
pub(crate) use islands::Roots;
pub(crate) use rest::rest_after_slices;
pub(crate) use rotation::{times_inverse_inertia, turned};
pub(crate) use spring::pull;
