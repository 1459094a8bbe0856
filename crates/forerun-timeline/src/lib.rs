//! Simulation states over time: tracks, commands, incremental re-simulation, sampling.
//!
//! ```
//! use forerun_dynamics::{BodyDef, BodyId, Environment};
//! use forerun_geometry::{Vec3, shape::{Cuboid, Shape}};
//! use forerun_timeline::{Change, Frame, Progress, Timeline, TimelineSettings};
//!
//! let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
//! let bodies = [BodyDef::fixed(Shape::HalfSpace), BodyDef::new(cube).at(Vec3::new(0.0, 2.0, 0.0))];
//! let mut timeline = Timeline::new(&bodies, Environment::default(), TimelineSettings::default())?;
//! // Run ahead of the display until the lookahead is full.
//! while timeline.advance() != Progress::Idle {}
//! assert_eq!(timeline.horizon(), Frame(100));
//! // Change what has been computed already: only what the change reaches is computed again.
//! let impulse = Vec3::new(2000.0, 0.0, 0.0);
//! timeline.change(Frame(30), Change::Push { body: BodyId(1), impulse, at_point: None })?;
//! assert_eq!(timeline.valid_to(), Frame(29));
//! while timeline.advance() != Progress::Idle {}
//! // The display samples a snapshot at its own times.
//! let shown = timeline.snapshot().sample(BodyId(1), 1.234).expect("the body is there");
//! assert!(shown.pose.position.x > 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The story of a frame: [`hearing`](Timeline::submit) marks what a command puts out of date (`stale`), the wavefront takes the earliest
//! frame that has something out of date, finds the closed group of bodies it affects (`affected`), does their step, lets the commands of
//! the next frame act (`commanding`), and stores what came out (`frame_table`). What differs from before is out of date in the next frame.
//!
//! *Architecture invariant:* for every body and every frame up to [`Timeline::valid_to`], the timeline equals a full
//! simulation with the same commands, bit for bit, whatever the order in which commands arrived, the number of threads, and
//! how often anything was re-simulated.
//!
//! *Architecture invariant:* this crate knows no physics and reads no clock.

mod activity;
mod affected;
mod areas;
pub mod check;
pub mod command;
mod command_log;
mod commanding;
mod contact_event;
mod contact_listener;
mod definitions;
mod effect;
mod fork;
pub mod frame;
mod frame_table;
mod hearing;
mod inspect;
mod marks;
mod memory;
mod order;
pub mod parts;
mod preview;
mod query;
mod random_change;
mod reference;
mod sample;
mod shared_list;
pub mod snapshot;
pub mod snapshot_delta;
mod snapshot_difference;
mod stale;
mod state_hash;
mod stats;
mod still;
mod tables;
pub mod timeline;
mod touch_table;
mod wavefront;

#[doc(hidden)]
pub use affected::Mutation;
pub use areas::Area;
pub use command::{Change, Command, CommandError, CommandKey};
pub use contact_event::{ContactEvent, ContactKind};
pub use contact_listener::{ContactListener, ContactNotice, LateEdits, ListenerSettings};
pub use forerun_dynamics::Touch;
pub use fork::Difference;
pub use frame::Frame;
pub use inspect::{FrameInspection, InspectedArea};
pub use order::Order;
pub use parts::{Keep, PartsError, TimelineParts};
pub use preview::{Preview, PreviewRun, Previewed, Trail};
pub use query::BodyHit;
pub use snapshot::{Certainty, Sample, Snapshot};
pub use snapshot_delta::{DeltaError, SnapshotDelta};
pub use stats::{Advance, Counters, Edit, Stats};
pub use still::StillBody;
pub use timeline::{Progress, Timeline, TimelineError, TimelineSettings};
