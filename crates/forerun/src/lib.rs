//! Rigid-body physics that runs ahead of the display.

mod driver;
mod playback;

pub use forerun_dynamics as dynamics;
pub use forerun_geometry as geometry;
pub use forerun_timeline as timeline;

pub use driver::{
    Clock, Coupled, Decoupled, DecoupledSettings, DriverError, FrameNote, Picture, StepLimits, Threads, ThreadsError,
};
pub use forerun_dynamics::{
    Body, BodyDef, BodyError, BodyId, BodyKind, BodyState, Environment, Mass, Material, StepSettings, World,
};
pub use forerun_geometry::shape::{Capsule, Cuboid, Cylinder, Sphere};
pub use forerun_geometry::{Pose, Quat, Shape, Vec3};
pub use forerun_timeline::{Change, Command, CommandError, CommandKey, Frame, Snapshot, Timeline, TimelineSettings};
pub use playback::{QueueRow, Report, write_queue_csv};
