//! The rigid-body step, after Guendelman, Bridson, Fedkiw: *Nonconvex Rigid Bodies with Stacking* (2003) and
//! section 2.4 of the dissertation.
//!
//! *Architecture invariant:* the step is memoryless. The next states of an island are a pure function of its bodies, their
//! states, and the environment. No cache outlives a step; the same input gives the same bits for any thread count.
//!
//! *Architecture invariant:* the step cannot fail. It reports ([`StepReport`]); it does not return `Result`.

pub mod body;
pub mod body_def;
pub mod bounds;
pub mod broad_phase;
mod carried;
mod close_up;
pub mod detection;
pub mod halfway;
pub mod inspect;
pub mod meter;
pub mod narrow_phase;
mod plan;
mod run;
mod scratch;
pub mod settings;
mod slices;
mod solver;
pub mod stage;
pub mod state;
pub mod step;
mod stillness;
pub mod touch;
pub mod world;

/// Eight numbers at a time: what the kernels are written in, and the choice of the instruction set that they use.
pub use forerun_lanes as lanes;

pub use body::{Body, BodyId, BodyKind, Material, Spring};
pub use body_def::{BodyDef, BodyError, Mass};
pub use inspect::{InspectedBody, InspectedContact, InspectedIsland, InspectedPoint, Inspection, inspect};
pub use scratch::StepScratch;
pub use settings::{Environment, EnvironmentError, ShockPropagation, StepSettings};
pub use stage::{Observer, Stage, Unobserved};
pub use state::BodyState;
pub use step::{Group, Member, StepReport};
pub use touch::{Touch, Touches};
pub use world::World;
