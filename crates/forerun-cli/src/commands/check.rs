//! Check: random edits on a scene, every state of every body compared with full re-simulations, for several thread counts; and what an
//! edit costs beside one.

use std::num::NonZeroU16;

use forerun::timeline::check::{
    CheckMoment, CheckReport, CheckSettings, FullRunError, Mismatch, check, full_run, mismatches,
};
use forerun::{BodyDef, Clock, Environment, Scene, Threads, Timeline};
use serde::Serialize;

use crate::args::CheckArgs;
use crate::baking::open_scene;
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
    settle: u32,
    display_step: u32,
    compare_every: u32,
    threads: Vec<u16>,
    /// Bodies times frames whose bits differ from a full run, over all thread counts.
    mismatches: u64,
    /// Body-frames truly changed by the edits.
    affected: u64,
    /// Body-frames computed for it.
    recomputed: u64,
    /// Body-frames that a full re-simulation from each edit on would compute.
    full: u64,
    /// Recomputed for each affected; 0 when none was affected.
    computed_per_affected: f64,
    /// Wall time from an edit until all frames are true again, with the first thread count.
    edit_ms: Spread,
    /// Wall time of a full re-simulation of the same frames, with the first thread count. Measured when `compare_every` is 1, else from
    /// its time for a frame of those that were computed at once.
    full_ms: Spread,
    /// The middle one of how many times cheaper, in wall time, each edit is than a full re-simulation of the same frames.
    speed_up_median: f64,
    /// The least of them.
    speed_up_min: f64,
}

/// `forerun check`.
pub(crate) fn run(args: &CheckArgs) -> Result<(), Failure> {
    let scene = open_scene(&args.scene)?;
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
        mismatched += report.mismatches;
        example = example.or(report.first_mismatch);
        first.get_or_insert((report, times));
        // Nothing to compare with for a single thread count.
        if args.threads.len() > 1 {
            let run =
                threads.install(|| unedited(&scene, &bodies, args.settle.saturating_add(args.frames)))?;
            let (count, first) = mismatches(&run, plain.as_ref().unwrap_or(&run));
            mismatched += count;
            example = example.or(first);
            plain.get_or_insert(run);
        }
    }
    bar.finish_and_clear();
    let (report, times) = first.unwrap_or_default();
    let verdict = verdict(args, mismatched, &report, &times);
    if args.json {
        print_json(&verdict)?
    } else {
        print_verdict(&verdict)?
    }
    judge(&verdict, example)
}

fn verdict(args: &CheckArgs, mismatches: u64, report: &CheckReport, times: &Times) -> Verdict {
    let speed_ups: Vec<f64> =
        times.edit_ms.iter().zip(&times.full_ms).map(|(edit, full)| full / edit).collect();
    let CheckReport { affected, recomputed, full, .. } = *report;
    Verdict {
        scene: args.scene.clone(),
        edits: args.edits,
        seed: args.seed,
        frames: args.frames,
        settle: args.settle,
        display_step: args.display_step,
        compare_every: args.compare_every,
        threads: args.threads.clone(),
        mismatches,
        affected,
        recomputed,
        full,
        computed_per_affected: if affected == 0 { 0.0 } else { recomputed as f64 / affected as f64 },
        edit_ms: Spread::of(&times.edit_ms),
        full_ms: Spread::of(&times.full_ms),
        speed_up_median: Spread::of(&speed_ups).median,
        speed_up_min: speed_ups.iter().copied().reduce(f64::min).unwrap_or(0.0),
    }
}

/// How long each edit took, and a full re-simulation of the same frames. Milliseconds.
#[derive(Debug, Default)]
struct Times {
    edit_ms: Vec<f64>,
    full_ms: Vec<f64>,
    /// Frames of the edits that the reference has not heard of yet.
    waiting: Vec<u64>,
}

impl Times {
    fn add(&mut self, moment: CheckMoment, passed_ms: f64) {
        match moment {
            CheckMoment::EditEnds { frames } if frames > 0 => {
                self.edit_ms.push(passed_ms);
                self.waiting.push(frames);
            }
            CheckMoment::FullEnds { frames } => {
                let share = |part: u64| passed_ms * part as f64 / frames.max(1) as f64;
                self.full_ms.extend(self.waiting.drain(..).map(share));
            }
            _ => {}
        }
    }
}

fn check_timed(
    scene: &Scene,
    bodies: &[BodyDef],
    args: &CheckArgs,
    edited: &(dyn Fn() + Sync),
) -> Result<(CheckReport, Times), Failure> {
    let settings = CheckSettings {
        edits: args.edits,
        seed: args.seed,
        frames: args.frames,
        settle: args.settle,
        display_step: args.display_step,
        compare_every: args.compare_every,
        ..CheckSettings::default()
    };
    let (clock, mut times) = (Clock::system(), Times::default());
    let mut began = clock.now();
    let report = check(bodies, scene.environment(), &settings, &mut |moment| {
        let now = clock.now();
        times.add(moment, 1000.0 * (now - began).as_secs_f64());
        if let CheckMoment::EditEnds { .. } = moment {
            edited();
        }
        began = now;
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
            "{count} states differ from a full run; the first: {example}; again with `{}`",
            command(verdict)
        ))),
        (count, None) => Err(Failure::Check(format!("{count} states differ from a full run"))),
    }
}

/// What does the same again.
fn command(verdict: &Verdict) -> String {
    let Verdict { scene, edits, seed, frames, settle, display_step, compare_every, .. } = verdict;
    let mut command = format!("forerun check {scene} --edits {edits} --seed {seed} --frames {frames}");
    for (option, value, usual) in
        [("settle", settle, 0), ("display-step", display_step, 0), ("compare-every", compare_every, 1)]
    {
        if *value != usual {
            command.push_str(&format!(" --{option} {value}"));
        }
    }
    command
}

fn print_verdict(verdict: &Verdict) -> Result<(), Failure> {
    let Verdict { edit_ms, full_ms, affected, recomputed, full, mismatches, .. } = verdict;
    print(&format!("{}, threads {:?}", command(verdict), verdict.threads))?;
    print(&match mismatches {
        0 => "  every state of every body has the bits of a full run".to_owned(),
        count => format!("  {count} states of bodies DIFFER from a full run"),
    })?;
    print(&format!(
        "  the edits changed {affected} states; {recomputed} were computed for it, {:.2} for each; full re-simulations: {full}",
        verdict.computed_per_affected
    ))?;
    if *affected == 0 {
        print("  no edit changed anything: this shows little; try more --edits, or another --seed")?;
    } else {
        print(&format!(
            "  in the median an edit is {} than a full re-simulation of the same frames; the dearest is {}",
            cheaper(verdict.speed_up_median),
            cheaper(verdict.speed_up_min)
        ))?;
    }
    for (what, ms) in [("edit", edit_ms), ("full re-simulation", full_ms)] {
        print(&format!(
            "  ms per {what:<18} {:>10.3} mean {:>10.3} median {:>10.3} max",
            ms.mean, ms.median, ms.max
        ))?;
    }
    Ok(())
}

/// How much cheaper what takes `speed_up` times less time is.
fn cheaper(speed_up: f64) -> String {
    if speed_up >= 1.0 {
        format!("{speed_up:.1} times cheaper")
    } else {
        format!("{:.1} times dearer", 1.0 / speed_up.max(1e-9))
    }
}
