//! Rigid-body physics that runs ahead of the display.

mod driver;
mod playback;
mod staging;

pub use forerun_dynamics as dynamics;
pub use forerun_geometry as geometry;
pub use forerun_timeline as timeline;

pub use driver::{
    ChangeError, Clock, Coupled, Decoupled, DecoupledSettings, DriverError, FrameNote, Picture, StepLimits,
    Threads, ThreadsError,
};
pub use forerun_dynamics::{
    Body, BodyDef, BodyError, BodyId, BodyKind, BodyState, Environment, Mass, Material, StepSettings, World,
};
pub use forerun_geometry::shape::{Capsule, Cuboid, Cylinder, Sphere};
pub use forerun_geometry::{Pose, Quat, Shape, Vec3};
pub use forerun_scene as scene;
pub use forerun_scene::{Scene, SceneError};
pub use forerun_timeline::{
    Change, Command, CommandError, CommandKey, Frame, Snapshot, Timeline, TimelineSettings,
};
pub use playback::{
    DriverKind, Playback, PlaybackError, PlaybackSettings, QueueRow, Report, play, write_queue_csv,
};
pub use staging::{StagingError, timeline_of, world_of};
