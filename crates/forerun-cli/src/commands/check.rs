//! Check: random edits on a scene, every state of every body compared with full re-simulations, for several thread counts.

use std::num::NonZeroU16;

use forerun::timeline::check::{
    CheckMoment, CheckReport, CheckSettings, FullRunError, Mismatch, check, full_run, mismatches,
};
use forerun::{BodyDef, Clock, Environment, Scene, Threads, Timeline};
use serde::Serialize;

use crate::args::CheckArgs;
use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::progress;
use crate::stats::Spread;

/// The result; the fields are those of `check --json`.
#[derive(Debug, Serialize)]
struct Verdict {
    scene: String,
    edits: u32,
    seed: u64,
    frames: u32,
    threads: Vec<u16>,
    /// Bodies times frames whose bits differ from a full run, over all thread counts.
    mismatches: u64,
    /// Body-frames truly changed by the edits.
    affected: u64,
    /// Body-frames computed for it.
    recomputed: u64,
    /// Body-frames that full re-simulations computed.
    full: u64,
    /// Wall time from an edit until all frames are true again, with the first thread count.
    edit_ms: Spread,
    /// Wall time of a full re-simulation from the edit on, with the first thread count.
    full_ms: Spread,
}

/// `forerun check`.
pub(crate) fn run(args: &CheckArgs) -> Result<(), Failure> {
    let scene = Scene::open(&args.scene)?;
    let bodies = scene.bodies()?;
    let bar = progress::bar(u64::from(args.edits) * args.threads.len() as u64, &args.scene);
    let mut first: Option<(CheckReport, Times)> = None;
    let mut plain: Option<Timeline> = None;
    let (mut mismatched, mut example) = (0, None);
    for &count in &args.threads {
        // The argument's range begins at 1.
        let count = NonZeroU16::new(count).unwrap_or(NonZeroU16::MIN);
        let threads = Threads::exactly(count)?;
        let (report, times) = threads.install(|| check_timed(&scene, &bodies, args, &|| bar.inc(1)))?;
        let run = threads.install(|| unedited(&scene, &bodies, args.frames))?;
        let across = plain.as_ref().map_or((0, None), |reference| mismatches(&run, reference));
        mismatched += report.mismatches + across.0;
        example = example.or(report.first_mismatch).or(across.1);
        first.get_or_insert((report, times));
        plain.get_or_insert(run);
    }
    bar.finish_and_clear();
    let (report, times) = first.unwrap_or_default();
    let verdict = Verdict {
        scene: args.scene.clone(),
        edits: args.edits,
        seed: args.seed,
        frames: args.frames,
        threads: args.threads.clone(),
        mismatches: mismatched,
        affected: report.affected,
        recomputed: report.recomputed,
        full: report.full,
        edit_ms: Spread::of(&times.edit_ms),
        full_ms: Spread::of(&times.full_ms),
    };
    if args.json {
        print_json(&verdict)?
    } else {
        print_verdict(&verdict)?
    }
    judge(&verdict, example)
}

/// How long each edit took, and each full re-simulation. Milliseconds.
#[derive(Debug, Default)]
struct Times {
    edit_ms: Vec<f64>,
    full_ms: Vec<f64>,
}

fn check_timed(
    scene: &Scene,
    bodies: &[BodyDef],
    args: &CheckArgs,
    edited: &(dyn Fn() + Sync),
) -> Result<(CheckReport, Times), Failure> {
    let settings =
        CheckSettings { edits: args.edits, seed: args.seed, frames: args.frames, ..CheckSettings::default() };
    let (clock, mut times) = (Clock::system(), Times::default());
    let mut began = clock.now();
    let report = check(bodies, scene.environment(), &settings, &mut |moment| {
        let passed_ms = 1000.0 * (clock.now() - began).as_secs_f64();
        match moment {
            CheckMoment::EditBegins | CheckMoment::FullBegins => began = clock.now(),
            CheckMoment::EditEnds => {
                times.edit_ms.push(passed_ms);
                edited();
            }
            CheckMoment::FullEnds => times.full_ms.push(passed_ms),
        }
    });
    match report {
        Ok(report) => Ok((report, times)),
        Err(error @ FullRunError::Start(_)) => Err(Failure::Input(format!("{}: {error}", scene.name))),
        // The timeline accepted the command: they are not of one mind, which is what is checked.
        Err(error @ FullRunError::Command(_)) => Err(Failure::Check(format!("{}: {error}", scene.name))),
    }
}

/// The scene without edits, to compare thread counts with each other.
fn unedited(scene: &Scene, bodies: &[BodyDef], frames: u32) -> Result<Timeline, Failure> {
    let environment: Environment = scene.environment();
    full_run(bodies, [], environment, frames)
        .map_err(|error| Failure::Input(format!("{}: {error}", scene.name)))
}

fn judge(verdict: &Verdict, example: Option<Mismatch>) -> Result<(), Failure> {
    match (verdict.mismatches, example) {
        (0, _) => Ok(()),
        (count, Some(example)) => Err(Failure::Check(format!(
            "{count} states differ from a full run; the first: {example}; again with `forerun check {} --edits {} --seed {} \
             --frames {}`",
            verdict.scene, verdict.edits, verdict.seed, verdict.frames
        ))),
        (count, None) => Err(Failure::Check(format!("{count} states differ from a full run"))),
    }
}

fn print_verdict(verdict: &Verdict) -> Result<(), Failure> {
    let Verdict { edit_ms, full_ms, affected, recomputed, full, .. } = verdict;
    let per = |part: u64, whole: u64| if whole == 0 { 0.0 } else { part as f64 / whole as f64 };
    print(&format!(
        "{}: {} edits, {} frames, seed {}, threads {:?}",
        verdict.scene, verdict.edits, verdict.frames, verdict.seed, verdict.threads
    ))?;
    print(&format!("  states that differ from a full run {:>12}", verdict.mismatches))?;
    print(&format!("  states truly changed               {affected:>12}"))?;
    print(&format!(
        "  states computed for it             {recomputed:>12}   {:.2} of those changed",
        per(*recomputed, *affected)
    ))?;
    print(&format!("  states of full re-simulations      {full:>12}"))?;
    print(&format!(
        "  ms per edit                {:>9.3} mean {:>9.3} median {:>9.3} max",
        edit_ms.mean, edit_ms.median, edit_ms.max
    ))?;
    print(&format!(
        "  ms per full re-simulation  {:>9.3} mean {:>9.3} median {:>9.3} max",
        full_ms.mean, full_ms.median, full_ms.max
    ))
}
