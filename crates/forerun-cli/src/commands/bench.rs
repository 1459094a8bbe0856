//! Bench: measures scenes one after the other; a Markdown table for people, one JSON object for programs.

use std::num::NonZeroU16;

use forerun::dynamics::lanes::{self, InstructionSet};
use forerun::{Threads, TimelineSettings, timeline_of, world_of};
use serde::Serialize;

use crate::args::{BenchArgs, InstructionsArg};
use crate::baking::open_scene;
use crate::bench::{Measurement, Run, add_storage, draw_stages, measure};
use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::progress;

#[derive(Serialize)]
struct BenchReport {
    scenes: Vec<Measurement>,
}

/// `forerun bench`.
pub(crate) fn run(args: &BenchArgs) -> Result<(), Failure> {
    if let Some(most) = args.instructions {
        limit_instructions(most)?;
    }
    // The argument's range begins at 1.
    let count = NonZeroU16::new(args.threads).unwrap_or(NonZeroU16::MIN);
    let threads = Threads::exactly(count)?;
    // All scenes are opened first: a misspelt name is not to cost the measurements before it.
    let mut scenes = args.scenes.iter().map(|typed| open_scene(typed)).collect::<Result<Vec<_>, _>>()?;
    if args.awake {
        scenes.iter_mut().for_each(|scene| scene.settings.rest_seconds = Some(0.0));
    }
    let mut measured = Vec::new();
    for (typed, scene) in args.scenes.iter().zip(&scenes) {
        let bar = progress::bar(u64::from(args.settle) + u64::from(args.frames), typed);
        let BenchArgs { frames, settle, threads: thread_count, .. } = *args;
        let run = Run { scene: typed, frames, settle, thread_count, threads: &threads };
        let mut measurement = measure(world_of(scene)?, &run, &|frame| bar.set_position(u64::from(frame)));
        let timeline = timeline_of(scene, TimelineSettings { past: 0, ..TimelineSettings::default() })?;
        add_storage(&mut measurement, timeline, &run);
        bar.finish_and_clear();
        measured.push(measurement);
    }
    if let Some(file) = &args.chart {
        draw_stages(&measured, file)?;
    }
    if args.json { print_json(&BenchReport { scenes: measured }) } else { print_tables(&measured) }
}

fn limit_instructions(most: InstructionsArg) -> Result<(), Failure> {
    let most = match most {
        InstructionsArg::Portable => InstructionSet::Portable,
        InstructionsArg::Sse2 => InstructionSet::Sse2,
        InstructionsArg::Avx2 => InstructionSet::Avx2,
        InstructionsArg::Avx512 => InstructionSet::Avx512,
    };
    let chosen = lanes::limit_to(most);
    if chosen == most {
        return Ok(());
    }
    Err(Failure::Input(format!("--instructions: this processor has no {most}; ask for {chosen} or less")))
}

fn print_tables(measured: &[Measurement]) -> Result<(), Failure> {
    print(&format!("kernels: {}\n", lanes::in_use()))?;
    print(
        "| scene | bodies | frames | threads | mean ms | median ms | p99 ms | max ms | first ms | first/mean | body-steps/s | ns/body |",
    )?;
    print("|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|")?;
    for m in measured {
        let (step, rate) = (m.step_ms, m.body_steps_per_s / 1e6);
        print(&format!(
            "| {} | {} | {} | {} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {:.2} | {rate:.2} M | {:.0} |",
            m.scene,
            m.bodies,
            m.frames,
            m.threads,
            step.mean,
            step.median,
            step.p99,
            step.max,
            m.first_step_ms,
            m.first_step_ms / step.mean.max(1e-9),
            1000.0 / rate
        ))?;
    }
    print(
        "\n| scene | collisions | velocities | contact graph | contacts | shock propagation | positions |",
    )?;
    print("|---|---:|---:|---:|---:|---:|---:|")?;
    for m in measured {
        let cells: Vec<String> = m.stage_ms.in_order().iter().map(|ms| format!("{ms:.3}")).collect();
        print(&format!("| {} | {} |", m.scene, cells.join(" | ")))?;
    }
    print(
        "\n| scene | overlap max mm | at end mm | energy max/first | end speed m/s | timeline ms/frame | B/body/frame | peak MiB | peak B/body | state hash |",
    )?;
    print("|---|---:|---:|---:|---:|---:|---:|---:|---:|---|")?;
    measured.iter().try_for_each(print_guards)
}

fn print_guards(m: &Measurement) -> Result<(), Failure> {
    let or_dash = |value: Option<f64>, decimals: usize| {
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
    };
    print(&format!(
        "| {} | {:.2} | {:.2} | {} | {:.4} | {} | {} | {} | {} | {} |",
        m.scene,
        1000.0 * m.overlap_max_m,
        1000.0 * m.overlap_end_m,
        or_dash(m.energy_max_over_initial, 5),
        m.speed_end_mean,
        or_dash(m.timeline_frame_ms, 3),
        or_dash(m.bytes_per_body_frame, 1),
        or_dash(m.peak_rss_bytes.map(|bytes| bytes as f64 / 1024.0 / 1024.0), 1),
        or_dash(m.peak_rss_bytes.map(|bytes| bytes as f64 / m.bodies.max(1) as f64), 0),
        m.state_hash,
    ))
}
