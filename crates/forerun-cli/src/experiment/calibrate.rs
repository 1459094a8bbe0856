//! Calibrate: how many meshes it takes so that this machine is too slow for them at impact, but not in the mean.

use forerun::dynamics::Unobserved;
use forerun::{Clock, Scene, StepLimits, Threads, world_of};

use crate::failure::Failure;

/// Bodies of the smallest scene.
const BODIES_MIN: u32 = 60;
/// How much the impact is to be slower than the longest step of the traditional model.
const MARGIN: f64 = 1.25;
/// Mean cost over the length of a frame, at most: the other half is for the display, and for whatever else the machine does.
const LOAD_MAX: f64 = 0.5;
const ROUNDS_MAX: u32 = 8;

/// What the calibration found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Calibration {
    pub(crate) bodies: u32,
    /// Mean of the steps. Milliseconds.
    pub(crate) mean_ms: f64,
    /// Mean of the slowest tenth of a second of steps. Milliseconds.
    pub(crate) impact_ms: f64,
    /// Whether the impact is slow enough and the mean fast enough.
    pub(crate) reached: bool,
}

/// The scene `meshes` of the right size, its frames as long as given (seconds), and what was measured on it.
pub(crate) fn meshes_for_this_machine(
    frame_seconds: f32,
    seconds: f64,
) -> Result<(Scene, Calibration), Failure> {
    let threads = Threads::all()?;
    let frame_ms = 1000.0 * f64::from(frame_seconds);
    let wanted_ms = 1000.0 * StepLimits::default().max_s * MARGIN;
    let mut bodies = BODIES_MIN;
    // The largest scene that is fast enough in the mean, and the smallest that is not.
    let (mut best, mut too_many) = (None, u32::MAX);
    for _ in 0..ROUNDS_MAX {
        let mut scene = Scene::open(&format!("meshes:{bodies}"))?;
        scene.frame_seconds = frame_seconds;
        let found = measure(&scene, bodies, &threads, (seconds / f64::from(frame_seconds)) as u32)?;
        let affordable = found.mean_ms <= LOAD_MAX * frame_ms;
        let slow_enough = found.impact_ms >= wanted_ms;
        if affordable || best.is_none() {
            best = Some((scene, Calibration { reached: affordable && slow_enough, ..found }));
        }
        if !affordable {
            too_many = bodies;
        }
        let fewest = best.as_ref().map_or(BODIES_MIN, |(_, calibration)| calibration.bodies);
        if slow_enough && affordable || too_many <= fewest.saturating_add(fewest / 10) {
            break;
        }
        // Cost grows a little faster than the number of bodies; steps of at most 2 keep the mean from running away.
        let grown = (f64::from(fewest) * (1.05 * wanted_ms / found.impact_ms).clamp(1.15, 2.0)).ceil() as u32;
        bodies = if too_many == u32::MAX { grown } else { fewest.midpoint(too_many) };
    }
    best.ok_or_else(|| Failure::Input("meshes: not even the smallest scene could be measured".to_owned()))
}

fn measure(scene: &Scene, bodies: u32, threads: &Threads, frames: u32) -> Result<Calibration, Failure> {
    // Of each frame the faster of two passes: what else runs on the machine does not slow both.
    let passes = [step_times_ms(scene, threads, frames)?, step_times_ms(scene, threads, frames)?];
    let times_ms: Vec<f64> = passes[0].iter().zip(&passes[1]).map(|(a, b)| a.min(*b)).collect();
    let window = ((0.1 / scene.frame_seconds) as usize).clamp(1, times_ms.len());
    let mean = |times: &[f64]| times.iter().sum::<f64>() / times.len() as f64;
    Ok(Calibration {
        bodies,
        mean_ms: mean(&times_ms),
        impact_ms: times_ms.windows(window).map(mean).fold(0.0, f64::max),
        reached: false,
    })
}

fn step_times_ms(scene: &Scene, threads: &Threads, frames: u32) -> Result<Vec<f64>, Failure> {
    let mut world = world_of(scene)?;
    let clock = Clock::system();
    let step_ms = |_| {
        let start = clock.now();
        threads.install(|| world.step(&mut Unobserved));
        1000.0 * (clock.now() - start).as_secs_f64()
    };
    Ok((0..frames.max(1)).map(step_ms).collect())
}
