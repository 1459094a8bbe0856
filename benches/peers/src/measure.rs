//! Measure: one engine on one scene in a process of its own: either its times and memory, or its quality. The two never mix: a meter between two
//! steps empties the caches of the second.

use std::fs;
use std::num::NonZeroU16;

use cpu_time::ProcessTime;
use forerun::{Clock, Scene, Threads};
use serde::{Deserialize, Serialize};

use crate::engine::{self, Kind};
use crate::mesh_run::MeshAnswer;
use crate::quality::{Meter, Quality};
use crate::stage::Stage;

/// What a process is asked for.
#[derive(Clone, Debug)]
pub(crate) struct Task {
    pub(crate) scene: String,
    pub(crate) kind: Kind,
    pub(crate) frames: u32,
    pub(crate) threads: u16,
}

/// What about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Question {
    Times,
    Quality,
    /// What its meshes cost and are worth.
    Mesh,
    /// Of that, what differs from round to round.
    MeshTimes,
    /// Of that, the heap with boxes in the place of meshes.
    HeapOfBoxes,
}

/// What it answers, as a line of JSON.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Answer {
    Times(Times),
    Quality(Quality),
    Mesh(Box<MeshAnswer>),
    /// The engine cannot do this scene, and why.
    Cannot(String),
}

/// Time of every step, by two clocks, and memory.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Times {
    /// CPU time of all threads of the process, so that none can hide; the first step is the first. Milliseconds.
    pub(crate) cpu_ms: Vec<f64>,
    /// How long the steps took for whoever waits for them. Milliseconds.
    pub(crate) wall_ms: Vec<f64>,
    /// Most memory that was resident from before the engine's world was built. Bytes.
    pub(crate) peak_bytes: Option<u64>,
}

/// Steps and takes the time of each step.
pub(crate) fn times(task: &Task) -> Answer {
    let run = || {
        let mut stage = Stage::of(&open(&task.scene)?)?;
        engine::prepare(task.kind, &mut stage, None)?;
        restart_peak();
        let mut world = engine::build(task.kind, &stage, task.threads)?;
        let clock = Clock::system();
        let count = task.frames as usize;
        let (mut cpu_ms, mut wall_ms) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for _ in 0..task.frames {
            let (wall_start, cpu_start) = (clock.now(), ProcessTime::now());
            world.step()?;
            let (cpu, wall) = (cpu_start.elapsed(), clock.now() - wall_start);
            cpu_ms.push(1000.0 * cpu.as_secs_f64());
            wall_ms.push(1000.0 * wall.as_secs_f64());
        }
        Ok(Times { cpu_ms, wall_ms, peak_bytes: peak_bytes() })
    };
    on_its_threads(task, run).map_or_else(Answer::Cannot, Answer::Times)
}

/// Steps and looks at the poses.
pub(crate) fn quality(task: &Task) -> Answer {
    let run = || {
        let scene = open(&task.scene)?;
        let mut meter = Meter::new(&scene)?;
        let mut stage = Stage::of(&scene)?;
        let hulls = engine::prepare(task.kind, &mut stage, None)?.hulls;
        let mut world = engine::build(task.kind, &stage, task.threads)?;
        for frame in 0..task.frames {
            world.step()?;
            if Meter::is_due(frame, task.frames) {
                meter.look_at(&world.motions());
            }
        }
        Ok(meter.finish(hulls))
    };
    on_its_threads(task, run).map_or_else(Answer::Cannot, Answer::Quality)
}

/// Runs all of a task within one pool, so that no step pays for being handed over. Box3D and Jolt have threads of their own; to them it is just a thread.
pub(crate) fn on_its_threads<T: Send>(
    task: &Task,
    run: impl FnOnce() -> Result<T, String> + Send,
) -> Result<T, String> {
    let count = NonZeroU16::new(task.threads).unwrap_or(NonZeroU16::MIN);
    Threads::exactly(count).map_err(|error| error.to_string())?.install(run)
}

pub(crate) fn open(scene: &str) -> Result<Scene, String> {
    Scene::open(scene).map_err(|error| error.to_string())
}

/// Lets the peak start again from what is in use now. Linux only; elsewhere there is no peak to tell.
fn restart_peak() {
    let _ = fs::write("/proc/self/clear_refs", "5");
}

fn peak_bytes() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}
