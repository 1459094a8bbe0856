//! Mesh run: one engine on a scene where meshes move, in a process of its own: what its shapes cost, how long its steps take, and what they are worth
//! against the meshes as they are.
//!
//! Motions are kept while the steps are timed and looked at afterwards, so that looking costs no step its caches.

use std::path::Path;
use std::time::Duration;

use cpu_time::ProcessTime;
use forerun::{Clock, Scene, Shape, Vec3};
use serde::{Deserialize, Serialize};

use crate::engine::{self, Engine, Motion};
use crate::heap;
use crate::links::{LinkCount, Links};
use crate::measure::{Task, Times, on_its_threads, open};
use crate::nut::{Nut, NutCount};
use crate::overlap::TrueBodies;
use crate::places::{self, PlaceCount};
use crate::quality::{Meter, Own};
use crate::shapes::{self, Fit};
use crate::stage::Stage;

/// Overlap is looked at every so many frames, and at the last.
const LOOK_EVERY: usize = 2;

/// What is asked beyond a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extent {
    /// Everything.
    All,
    /// Times only: the rest is the same every time.
    Times,
    /// Nothing but the heap that the world takes with boxes in the place of meshes.
    HeapOfBoxes,
}

/// What a process answers, as a line of JSON.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct MeshAnswer {
    /// CPU time for making the shapes and the world from triangles. Milliseconds.
    pub(crate) setup_ms: f64,
    /// Different meshes.
    pub(crate) meshes: usize,
    /// What the engine's shapes are, against the meshes; none when not asked for.
    pub(crate) fit: Option<Fit>,
    /// What the heap holds for the world before the first step. Bytes.
    pub(crate) heap_bytes: Option<u64>,
    /// As many steps as there was time for.
    pub(crate) times: Times,
    /// None when not asked for.
    pub(crate) worth: Option<Worth>,
}

/// What the steps were worth.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Worth {
    /// Deepest overlap of two bodies, measured against the true meshes, at any time looked at. Metres.
    pub(crate) overlap_max_m: f32,
    /// The same after the last step.
    pub(crate) overlap_end_m: f32,
    /// Mean speed of the dynamic bodies at the end. m/s.
    pub(crate) speed_end: f64,
    /// Bodies that fell through the ground or out of their box.
    pub(crate) lost: usize,
    /// Bodies whose motion was not finite at the end.
    pub(crate) not_finite: usize,
    /// Of scenes with rings.
    pub(crate) links: Option<LinkCount>,
    /// Of a scene with a nut on a bolt.
    pub(crate) nut: Option<NutCount>,
    pub(crate) places: PlaceCount,
}

/// With what it is done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Means<'a> {
    /// CPU time that the steps may take in all.
    pub(crate) limit: Duration,
    /// Where the hulls of meshes are kept from process to process.
    pub(crate) folder: Option<&'a Path>,
}

/// Steps until the frames are done or the time is over.
pub(crate) fn run(task: &Task, extent: Extent, means: Means<'_>) -> Result<MeshAnswer, String> {
    on_its_threads(task, || {
        let made = make(task, extent, means.folder)?;
        let Made { mut world, setup_ms, meshes, fit, heap_bytes } = made;
        let frames = if extent == Extent::HeapOfBoxes { 0 } else { task.frames };
        let (times, motions) = step(&mut *world, frames, means.limit)?;
        drop(world);
        let worth = if extent == Extent::All { Some(worth(&open(&task.scene)?, &motions)?) } else { None };
        Ok(MeshAnswer { setup_ms, meshes, fit, heap_bytes, times, worth })
    })
}

/// A world, and what it took.
struct Made {
    world: Box<dyn Engine>,
    setup_ms: f64,
    meshes: usize,
    fit: Option<Fit>,
    heap_bytes: Option<u64>,
}

fn make(task: &Task, extent: Extent, folder: Option<&Path>) -> Result<Made, String> {
    let heap_before = heap::in_use();
    let mut stage = Stage::of(&open(&task.scene)?)?;
    let meshes = shapes::moving(&stage);
    let count = shapes::different(&stage);
    let (mut setup_ms, mut fit) = (0.0, None);
    if extent == Extent::HeapOfBoxes {
        put_boxes(&mut stage)?;
    } else {
        setup_ms += shapes::prepare(task.kind, &mut stage, &meshes, folder)?;
        if extent == Extent::All {
            fit = Some(shapes::fit(task.kind, &stage, &meshes)?);
        }
    }
    let start = ProcessTime::now();
    let world = engine::build(task.kind, &stage, task.threads)?;
    setup_ms += 1000.0 * start.elapsed().as_secs_f64();
    // What is left is the engine's own, and what it shares of ours.
    drop((stage, meshes));
    let heap_bytes = heap::in_use().zip(heap_before).map(|(now, before)| now.saturating_sub(before));
    Ok(Made { world, setup_ms, meshes: count, fit, heap_bytes })
}

/// A small box in the place of every mesh.
fn put_boxes(stage: &mut Stage) -> Result<(), String> {
    let small = Shape::cuboid(Vec3::splat(0.01)).map_err(|error| error.to_string())?;
    for actor in &mut stage.actors {
        if matches!(actor.def.shape, Shape::Mesh(_)) {
            actor.def.shape = small.clone();
        }
    }
    Ok(())
}

/// Steps and takes the time of each step; the motions after each.
fn step(world: &mut dyn Engine, frames: u32, limit: Duration) -> Result<(Times, Vec<Vec<Motion>>), String> {
    let clock = Clock::system();
    let start = ProcessTime::now();
    let count = frames as usize;
    let (mut cpu_ms, mut wall_ms) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let mut motions = Vec::with_capacity(count);
    while cpu_ms.len() < count && start.elapsed() < limit {
        let (wall_start, cpu_start) = (clock.now(), ProcessTime::now());
        world.step()?;
        let (cpu, wall) = (cpu_start.elapsed(), clock.now() - wall_start);
        cpu_ms.push(1000.0 * cpu.as_secs_f64());
        wall_ms.push(1000.0 * wall.as_secs_f64());
        motions.push(world.motions());
    }
    Ok((Times { cpu_ms, wall_ms, peak_bytes: None }, motions))
}

fn worth(scene: &Scene, motions: &[Vec<Motion>]) -> Result<Worth, String> {
    let stage = Stage::of(scene)?;
    let bodies = TrueBodies::of(&stage);
    let mut links = Links::of(scene, &stage);
    let mut nut = Nut::of(scene, &stage);
    let mut meter = Meter::new(scene)?;
    let (mut overlap_max_m, mut overlap_end_m) = (0.0_f32, 0.0);
    for (frame, motions_now) in motions.iter().enumerate() {
        links.look_at(motions_now);
        if let Some(nut) = &mut nut {
            nut.look_at(motions_now);
        }
        let is_last = frame + 1 == motions.len();
        if is_last || frame.is_multiple_of(LOOK_EVERY) {
            overlap_end_m = bodies.deepest_m(motions_now);
            overlap_max_m = overlap_max_m.max(overlap_end_m);
        }
        if is_last {
            meter.look_at(motions_now);
        }
    }
    let at_end = meter.finish(0);
    Ok(Worth {
        overlap_max_m,
        overlap_end_m,
        speed_end: at_end.speed_end,
        lost: if let Own::Lost { count } = at_end.own { count } else { 0 },
        not_finite: at_end.not_finite,
        links: links.finish(),
        nut: nut.map(|nut| nut.finish()),
        places: motions.last().map(|end| places::at_end(scene, &stage, end)).unwrap_or_default(),
    })
}
