//! Rigid-body physics that runs ahead of the display.
//!
//! A physics thread computes future states and stores them in a timeline; the display samples that timeline at its own
//! clock and never waits. When something changes, only the states that the change can reach are computed again, and they come
//! out bit for bit as if everything had been. It grew out of J. F. Galante, *Animação Baseada em Física com Simulação
//! Desacoplada* (MSc dissertation, COPPE/UFRJ, 2009).
//!
//! # The smallest program
//!
//! Build a stack, let physics run ahead, look at any moment, change something:
//!
//! ```
//! use forerun::{BodyDef, BodyId, Change, Environment, Frame, Shape, Cuboid, Timeline, TimelineSettings, Vec3};
//! use forerun::timeline::Progress;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let ground = BodyDef::fixed(Shape::HalfSpace);
//! let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
//! let boxes = (0..3).map(|i| BodyDef::new(cube.clone()).at(Vec3::Y * (0.5 + i as f32)));
//! let bodies: Vec<BodyDef> = std::iter::once(ground).chain(boxes).collect();
//!
//! let mut timeline = Timeline::new(&bodies, Environment::default(), TimelineSettings::default())?;
//! while timeline.advance() != Progress::Idle {} // 100 frames ahead of the display
//! let top = BodyId(3);
//! let standing = timeline.snapshot().sample(top, 0.75).ok_or("no such body")?;
//! assert!((standing.pose.position.y - 2.5).abs() < 0.01);
//!
//! timeline.change(Frame(30), Change::Push { body: top, impulse: Vec3::X * 4000.0, at_point: None })?;
//! while timeline.advance() != Progress::Idle {} // only what the push can reach
//! let pushed = timeline.snapshot().sample(top, 0.75).ok_or("no such body")?;
//! assert!(pushed.pose.position.x > 0.1);
//! # Ok(())
//! # }
//! ```
//!
//! # With a display
//!
//! [`Decoupled`] does the running ahead in a thread of its own; the display asks it for a [`Picture`] and never waits:
//!
//! ```
//! use forerun::{Clock, Decoupled, DecoupledSettings, Scene, Threads, TimelineSettings, timeline_of};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scene = Scene::open("dominoes:20")?;
//! let timeline = timeline_of(&scene, TimelineSettings::default())?;
//! let mut physics = Decoupled::start(timeline, DecoupledSettings::new(Threads::all()?))?;
//! let clock = Clock::system();
//! let mut samples = Vec::new();
//! for _ in 0..3 {
//!     let picture = physics.show(clock.now().as_secs_f64())?;
//!     physics.sample_all(&picture, &mut samples);
//!     for (body, sample) in &samples {
//!         // draw(body, sample.pose)
//! #       let _ = (body, sample);
//!     }
//! }
//! assert_eq!(samples.len(), 21); // the ground and 20 dominoes
//! # Ok(())
//! # }
//! ```
//!
//! # Floors
//!
//! An import never points up: [`geometry`] (shapes, contact between two), [`dynamics`] (bodies, the step), [`timeline`] (states over
//! frames, commands), [`scene`] (files, built-in scenes), and here the drivers, which alone start threads of their own and read a clock.

mod driver;
mod playback;
pub mod recording;
mod staging;

pub use forerun_dynamics as dynamics;
pub use forerun_geometry as geometry;
pub use forerun_scene as scene;
pub use forerun_timeline as timeline;

pub use driver::{
    AdoptError, Answer, Answered, Blending, ChangeError, Clock, Coupled, Courier, Decoupled,
    DecoupledSettings, DriverError, Fork, FrameNote, Hinder, InquiryError, Offset, Picture, Question,
    Refusal, RemoteError, RemotePhysics, RemoteSettings, StageTimes, StepLimits, Threads, ThreadsError,
    Ticket,
};
pub use forerun_dynamics::{
    Body, BodyDef, BodyError, BodyId, BodyKind, BodyState, Environment, EnvironmentError, InspectedBody,
    InspectedContact, InspectedIsland, InspectedPoint, Inspection, Mass, Material, Spring, Stage,
    StepSettings, World,
};
pub use forerun_geometry::shape::{Capsule, Cuboid, Cylinder, Sphere};
pub use forerun_geometry::{Aabb, Pose, Quat, Ray, Shape, Vec3};
pub use forerun_scene::{Scene, SceneError};
pub use forerun_timeline::{
    BodyHit, Certainty, Change, Command, CommandError, CommandKey, ContactEvent, ContactKind,
    ContactListener, ContactNotice, Difference, Edit, Frame, FrameInspection, InspectedArea, Keep, LateEdits,
    ListenerSettings, Order, Preview, PreviewRun, Previewed, Sample, Snapshot, Stats, Timeline,
    TimelineSettings, Touch, Trail,
};
pub use playback::{
    DriverKind, Playback, PlaybackError, PlaybackSettings, QueueRow, Report, play, write_queue_csv,
};
pub use recording::{Recorder, Recording, RecordingError, load_timeline, save_timeline};
pub use staging::{StagingError, timeline_of, world_of};
