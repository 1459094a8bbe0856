//! Measures the step of one world: time per stage, and guards on the quality that the time was paid for.

use cpu_time::ThreadTime;
use forerun::dynamics::{Observer, Stage, Unobserved, World, lanes, meter};
use forerun::{Clock, Threads};
use serde::Serialize;

use crate::bench::memory;
use crate::stats::Spread;

/// Overlap and energy are looked at every so many frames: the meters are slower than the step.
const METER_EVERY: u32 = 10;

/// Mean time of each stage. Milliseconds per frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct StageTimes {
    collisions: f64,
    velocities: f64,
    contact_graph: f64,
    contacts: f64,
    shock_propagation: f64,
    positions: f64,
}

/// What was measured on one scene; the fields are those of `bench --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Measurement {
    pub(crate) scene: String,
    pub(crate) bodies: usize,
    pub(crate) frames: u32,
    /// Frames that passed before the first measured one.
    pub(crate) settle: u32,
    pub(crate) threads: u16,
    /// The processor instructions that the kernels used.
    pub(crate) instructions: String,
    /// The first measured step, which the others leave out. Milliseconds.
    pub(crate) first_step_ms: f64,
    /// CPU time of a step on one thread, wall time on several.
    pub(crate) step_ms: Spread,
    pub(crate) stage_ms: StageTimes,
    pub(crate) body_steps_per_s: f64,
    pub(crate) overlap_max_m: f32,
    pub(crate) overlap_end_m: f32,
    /// None where the scene starts without energy above the origin.
    pub(crate) energy_max_over_initial: Option<f64>,
    pub(crate) speed_end_mean: f64,
    pub(crate) quarantined: u64,
    /// What the timeline stores for a body and a frame. None for a scene without bodies.
    pub(crate) bytes_per_body_frame: Option<f64>,
    /// What the timeline takes for a frame: the step of whoever is not at rest, finding out who that is, and storing. Milliseconds.
    pub(crate) timeline_frame_ms: Option<f64>,
    pub(crate) peak_rss_bytes: Option<u64>,
    pub(crate) state_hash: String,
}

impl StageTimes {
    /// In the order of the stages.
    pub(crate) const fn in_order(&self) -> [f64; Stage::ALL.len()] {
        [
            self.collisions,
            self.velocities,
            self.contact_graph,
            self.contacts,
            self.shock_propagation,
            self.positions,
        ]
    }
}

/// What is measured, and with what.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run<'a> {
    /// As it was typed.
    pub(crate) scene: &'a str,
    pub(crate) frames: u32,
    pub(crate) settle: u32,
    pub(crate) thread_count: u16,
    pub(crate) threads: &'a Threads,
}

impl Run<'_> {
    /// What the step's time is taken with.
    pub(super) fn stopwatch(&self) -> Stopwatch {
        if self.thread_count == 1 { Stopwatch::ThreadCpu } else { Stopwatch::Wall(Clock::system()) }
    }
}

/// Steps `world` for the frames of the run. Reports each frame's number to `progress`.
pub(crate) fn measure(mut world: World, run: &Run, progress: &dyn Fn(u32)) -> Measurement {
    let Run { scene, frames, settle, thread_count, threads } = *run;
    memory::restart_peak();
    for frame in 0..settle {
        threads.install(|| world.step(&mut Unobserved));
        progress(frame + 1);
    }
    let energy_start = meter::mechanical_energy_j(&world);
    let (mut energy_max, mut overlap_max) = (energy_start, 0.0_f32);
    let mut profile = Profile::new(run.stopwatch());
    let mut times_ms = Vec::with_capacity(frames as usize);
    let mut quarantined = 0;
    for frame in 0..frames {
        // Inside the pool: with one thread, all work of the step is then done on the thread whose time is taken.
        let (report, step_ms) = threads.install(|| profile.time(|observer| world.step(observer)));
        quarantined += u64::from(report.quarantined);
        times_ms.push(step_ms);
        if frame % METER_EVERY == 0 || frame + 1 == frames {
            energy_max = energy_max.max(meter::mechanical_energy_j(&world));
            overlap_max = overlap_max.max(meter::deepest_overlap_m(&world));
        }
        progress(settle + frame + 1);
    }
    let later = &times_ms[1..];
    let total_s = later.iter().sum::<f64>() / 1000.0;
    Measurement {
        scene: scene.to_owned(),
        bodies: world.bodies().len(),
        frames,
        settle,
        threads: thread_count,
        instructions: lanes::in_use().to_string(),
        first_step_ms: times_ms[0],
        step_ms: Spread::of(later),
        stage_ms: profile.mean_ms(frames),
        body_steps_per_s: (world.bodies().len() * later.len()) as f64 / total_s.max(1e-9),
        overlap_max_m: overlap_max,
        overlap_end_m: meter::deepest_overlap_m(&world),
        energy_max_over_initial: (energy_start > 0.0).then_some(energy_max / energy_start),
        speed_end_mean: meter::mean_speed(&world),
        quarantined,
        bytes_per_body_frame: None,
        timeline_frame_ms: None,
        peak_rss_bytes: memory::peak_bytes(),
        state_hash: format!("{:016x}", world.state_hash()),
    }
}

/// What a step's time is taken with.
#[derive(Debug)]
pub(super) enum Stopwatch {
    ThreadCpu,
    Wall(Clock),
}

impl Stopwatch {
    /// A reading of which only differences mean something, between readings on the same thread. Milliseconds.
    pub(super) fn read_ms(&self) -> f64 {
        match self {
            Stopwatch::ThreadCpu => 1000.0 * ThreadTime::now().as_duration().as_secs_f64(),
            Stopwatch::Wall(clock) => 1000.0 * clock.now().as_secs_f64(),
        }
    }
}

/// An observer that adds up the time of each stage.
#[derive(Debug)]
struct Profile {
    stopwatch: Stopwatch,
    mark_ms: f64,
    sums_ms: [f64; Stage::ALL.len()],
}

impl Profile {
    fn new(stopwatch: Stopwatch) -> Self {
        Profile { stopwatch, mark_ms: 0.0, sums_ms: [0.0; Stage::ALL.len()] }
    }

    /// Runs one step and says how long it took. Milliseconds.
    fn time<R>(&mut self, step: impl FnOnce(&mut Self) -> R) -> (R, f64) {
        let start_ms = self.stopwatch.read_ms();
        self.mark_ms = start_ms;
        let result = step(self);
        (result, self.stopwatch.read_ms() - start_ms)
    }

    fn mean_ms(&self, frames: u32) -> StageTimes {
        let [collisions, velocities, contact_graph, contacts, shock_propagation, positions] =
            self.sums_ms.map(|sum| sum / f64::from(frames));
        StageTimes { collisions, velocities, contact_graph, contacts, shock_propagation, positions }
    }
}

impl Observer for Profile {
    fn after(&mut self, stage: Stage) {
        let now_ms = self.stopwatch.read_ms();
        self.sums_ms[stage as usize] += now_ms - self.mark_ms;
        self.mark_ms = now_ms;
    }
}
