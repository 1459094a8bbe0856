//! Rounds: every engine in turn, each time in a process of its own, and what is made of all the times.

use std::fmt;

use forerun::Scene;
use serde::Serialize;

use crate::engine::Kind;
use crate::measure::{Answer, Question, Task, Times};
use crate::processes::Programs;
use crate::quality::Quality;
use crate::row;
use crate::stage::Stage;

/// What is compared.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    pub(crate) scenes: Vec<SceneAndFrames>,
    pub(crate) engines: Vec<Kind>,
    pub(crate) threads: Vec<u16>,
    pub(crate) rounds: u32,
}

/// A scene as it was typed, and how far it is run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct SceneAndFrames {
    pub(crate) scene: String,
    pub(crate) frames: u32,
}

/// One engine on one scene.
pub(crate) type Row = row::Row<Measured>;

/// One engine on one scene, over all rounds.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Measured {
    /// Of all threads of the process.
    pub(crate) cpu: StepTimes,
    pub(crate) wall: StepTimes,
    pub(crate) peak_bytes: Option<u64>,
    pub(crate) quality: Quality,
}

/// Times of a step by one clock, the first left out. Each step's time is the smallest of all rounds: every round computes the same, so what is above was the machine.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct StepTimes {
    pub(crate) first_ms: f64,
    pub(crate) mean_ms: f64,
    pub(crate) median_ms: f64,
    pub(crate) p99_ms: f64,
    pub(crate) max_ms: f64,
    /// Mean of each round by itself: how far they differ says how far to trust the others.
    pub(crate) round_means_ms: Vec<f64>,
}

impl Measured {
    /// The times that count: CPU time on one thread, where nobody can help and the clock on the wall only adds the neighbours; wall time on
    /// several, where CPU time would count threads that wait as work.
    pub(crate) fn counted(&self, threads: u16) -> &StepTimes {
        if threads == 1 { &self.cpu } else { &self.wall }
    }
}

impl Row {
    /// The times that count, if the engine can do the scene.
    pub(crate) fn times(&self) -> Option<&StepTimes> {
        self.measured().map(|measured| measured.counted(self.threads))
    }
}

/// Runs the whole plan. Scenes are opened before anything is built: a misspelt name is not to cost minutes.
pub(crate) fn run(plan: &Plan) -> Result<Vec<Row>, String> {
    let mut stages = Vec::new();
    for SceneAndFrames { scene, .. } in &plan.scenes {
        let opened = Scene::open(scene).map_err(|error| error.to_string())?;
        let stage = Stage::of(&opened)?;
        stages.push((stage.actors.len(), stage.has_moving_meshes()));
    }
    let programs = Programs::build(&plan.engines, &plan.threads)?;
    let mut rows = Vec::new();
    for (SceneAndFrames { scene, frames }, (bodies, meshes)) in plan.scenes.iter().zip(stages) {
        let fits = |kind: &&Kind| meshes || !kind.is_for_meshes();
        let kinds: Vec<Kind> = plan.engines.iter().filter(fits).copied().collect();
        let tasks = |threads: u16| -> Vec<Task> {
            let task = |kind: &Kind| Task { scene: scene.clone(), kind: *kind, frames: *frames, threads };
            kinds.iter().map(task).collect()
        };
        // Once for all thread counts: the meters take longer than the steps.
        let once = tasks(plan.threads.first().copied().unwrap_or(1));
        let qualities: Vec<_> = once.iter().map(|task| quality_of(&programs, task)).collect();
        for &threads in &plan.threads {
            let tasks = tasks(threads);
            let outcomes = compare(&programs, &tasks, &qualities, plan.rounds);
            let row = |(task, outcome)| Row::new(task, bodies, outcome);
            rows.extend(tasks.into_iter().zip(outcomes).map(row));
        }
    }
    Ok(rows)
}

/// The rounds, each beginning with another engine.
fn compare(
    programs: &Programs,
    tasks: &[Task],
    qualities: &[Result<Quality, String>],
    rounds: u32,
) -> Vec<Result<Measured, String>> {
    let mut times: Vec<Result<Vec<Times>, String>> = tasks.iter().map(|_| Ok(Vec::new())).collect();
    for round in 0..rounds as usize {
        for turn in 0..tasks.len() {
            let i = (turn + round) % tasks.len();
            if let (Ok(all), Ok(_)) = (&mut times[i], &qualities[i]) {
                eprintln!("round {} of {rounds}: {}", round + 1, tasks[i]);
                match times_of(programs, &tasks[i]) {
                    Ok(one) => all.push(one),
                    Err(why) => times[i] = Err(why),
                }
            }
        }
    }
    let joined = qualities.iter().cloned().zip(times);
    joined.map(|(quality, times)| Ok(measured(quality?, &times?))).collect()
}

impl fmt::Display for Task {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {} frames, {} threads, {}", self.scene, self.frames, self.threads, self.kind.label())
    }
}

fn quality_of(programs: &Programs, task: &Task) -> Result<Quality, String> {
    eprintln!("quality: {task}");
    match programs.ask(task, Question::Quality)? {
        Answer::Quality(quality) => Ok(quality),
        Answer::Cannot(why) => Err(why),
        _ => Err("answered something else than quality".to_owned()),
    }
}

fn times_of(programs: &Programs, task: &Task) -> Result<Times, String> {
    match programs.ask(task, Question::Times)? {
        Answer::Times(times) => Ok(times),
        Answer::Cannot(why) => Err(why),
        _ => Err("answered something else than times".to_owned()),
    }
}

fn measured(quality: Quality, rounds: &[Times]) -> Measured {
    let by = |clock: fn(&Times) -> &[f64]| step_times(&rounds.iter().map(clock).collect::<Vec<_>>());
    Measured {
        cpu: by(|times| &times.cpu_ms),
        wall: by(|times| &times.wall_ms),
        peak_bytes: rounds.iter().filter_map(|times| times.peak_bytes).min(),
        quality,
    }
}

/// Of every round the times of all steps. Milliseconds.
pub(crate) fn step_times(rounds: &[&[f64]]) -> StepTimes {
    let mean = |times: &[f64]| times.iter().sum::<f64>() / times.len().max(1) as f64;
    let later = |times: &&[f64]| mean(times.get(1..).unwrap_or_default());
    let steps = rounds.iter().map(|times| times.len()).min().unwrap_or(0);
    let smallest = |step: usize| rounds.iter().map(|times| times[step]).fold(f64::INFINITY, f64::min);
    let steps_ms: Vec<f64> = (0..steps).map(smallest).collect();
    let mut sorted = steps_ms.get(1..).unwrap_or_default().to_vec();
    sorted.sort_by(f64::total_cmp);
    StepTimes {
        first_ms: steps_ms.first().copied().unwrap_or(0.0),
        mean_ms: mean(&sorted),
        median_ms: rank(&sorted, 0.5),
        p99_ms: rank(&sorted, 0.99),
        max_ms: rank(&sorted, 1.0),
        round_means_ms: rounds.iter().map(later).collect(),
    }
}

/// Nearest rank: the smallest value that is not below the given part of all values. 0 of none.
fn rank(sorted: &[f64], part: f64) -> f64 {
    let place = (part * sorted.len() as f64).ceil() as usize;
    sorted.get(place.clamp(1, sorted.len().max(1)) - 1).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::Own;

    #[test]
    fn each_step_counts_with_its_best_round_and_the_first_stands_apart() {
        let quality = Quality {
            overlap_max_m: 0.0,
            overlap_end_m: 0.0,
            energy_max_over_initial: None,
            speed_end: 0.0,
            own: Own::Lost { count: 0 },
            not_finite: 0,
            hulls_per_mesh: 0,
        };
        let times = |cpu_ms: &[f64], wall_ms: &[f64], peak| Times {
            cpu_ms: cpu_ms.to_vec(),
            wall_ms: wall_ms.to_vec(),
            peak_bytes: Some(peak),
        };
        let rounds = [
            times(&[9.0, 1.0, 4.0, 3.0], &[9.0, 1.5, 4.5, 3.5], 70),
            times(&[8.0, 2.0, 2.0, 5.0], &[8.0, 2.5, 2.5, 5.5], 60),
        ];
        let measured = measured(quality, &rounds);
        assert_eq!(measured.peak_bytes, Some(60));
        let cpu = measured.counted(1);
        assert_eq!((cpu.first_ms, cpu.median_ms, cpu.p99_ms, cpu.max_ms), (8.0, 2.0, 3.0, 3.0));
        assert!((cpu.mean_ms - 2.0).abs() < 1e-12);
        assert!((cpu.round_means_ms[1] - 3.0).abs() < 1e-12);
        assert!((measured.counted(2).mean_ms - 2.5).abs() < 1e-12);
    }

    #[test]
    fn ranks_of_few_and_none() {
        assert_eq!((rank(&[], 0.99), rank(&[3.0], 0.5), rank(&[1.0, 2.0], 0.5)), (0.0, 3.0, 1.0));
    }
}
