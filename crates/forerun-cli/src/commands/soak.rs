//! Soak: a scene that is edited and whose physics stalls, for minutes; exit code 1 when the display shows it or a bit is wrong.

use std::num::NonZeroU16;

use forerun::Clock;
use serde::Serialize;

use crate::args::SoakArgs;
use crate::baking::open_scene;
use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::progress;
use crate::soak::{Lateness, Seen, SoakSettings, Soaked, soak};

/// Memory may grow by this much. MiB per minute.
const SLOPE_MAX: f64 = 1.0;
/// Memory is watched after this part of the time.
const WARM_PART: f64 = 0.2;
/// A slope over less than this says nothing. Seconds.
const SLOPE_SECONDS_MIN: f64 = 300.0;

/// The result; the fields are those of `soak --json`.
#[derive(Debug, Serialize)]
struct Verdict {
    scene: String,
    bodies: u64,
    seconds: f64,
    fps: f64,
    seed: u64,
    edits: u64,
    orders: crate::soak::Edits,
    refused: u64,
    commands: u64,
    stalls: u64,
    stalled_s: f64,
    /// Frames that physics worked on: new ones, and again for edits.
    frames_ahead: u64,
    frames_again: u64,
    /// Late are intervals over 2/fps.
    intervals: Lateness,
    /// Late pictures that neither a want of processors nor the sleeper beside it explains.
    late_ours: u64,
    /// The same of a thread that only sleeps.
    sleeper: Lateness,
    /// Time spent in show and `sample_all`; late are those over 1/fps.
    work: Lateness,
    /// Processor time of the display thread from picture to picture, with what the soak does there; late are those over 1/fps.
    ran: Lateness,
    seen: Seen,
    rss_warm_mib: Option<f64>,
    rss_end_mib: Option<f64>,
    rss_slope_mib_per_min: Option<f64>,
    /// The stored states among it.
    states_end_mib: Option<f64>,
    states_slope_mib_per_min: Option<f64>,
    frames_compared: u64,
    mismatches: u64,
    failed: Vec<String>,
}

/// `forerun soak`.
pub(crate) fn run(args: &SoakArgs) -> Result<(), Failure> {
    let scene = open_scene(&args.scene)?;
    let settings = SoakSettings {
        seconds: args.seconds,
        fps: args.fps,
        edits_per_second: args.edits_per_second,
        drag: args.drag,
        stall_s: args.stall,
        stall_every_s: args.stall_every,
        slow_s: 0.001 * args.slow_ms,
        lookahead: args.lookahead,
        prefill: args.prefill,
        hogs: args.hogs,
        threads: args.threads.and_then(NonZeroU16::new),
        seed: args.seed,
    };
    let bar = progress::bar((1000.0 * args.seconds) as u64, &args.scene);
    let soaked = soak(&scene, &settings, &Clock::system(), &mut |shown_s| {
        bar.set_position((1000.0 * shown_s) as u64);
    })?;
    bar.finish_and_clear();
    let verdict = verdict(args, &soaked);
    if args.json {
        print_json(&verdict)?
    } else {
        print_verdict(&verdict)?
    }
    match (verdict.failed.is_empty(), soaked.first_mismatch) {
        (true, _) => Ok(()),
        (false, None) => Err(Failure::Check(verdict.failed.join("; "))),
        (false, Some(first)) => {
            Err(Failure::Check(format!("{}; the first wrong state: {first}", verdict.failed.join("; "))))
        }
    }
}

fn verdict(args: &SoakArgs, soaked: &Soaked) -> Verdict {
    let warm: Vec<(f64, f64)> =
        soaked.memory.iter().copied().filter(|(at_s, _)| *at_s >= WARM_PART * args.seconds).collect();
    let states: Vec<(f64, f64)> =
        soaked.states.iter().copied().filter(|(at_s, _)| *at_s >= WARM_PART * args.seconds).collect();
    let states_slope = slope(&states).filter(|_| args.seconds >= SLOPE_SECONDS_MIN);
    let slope = slope(&warm).filter(|_| args.seconds >= SLOPE_SECONDS_MIN);
    let Soaked { seen, edits, .. } = soaked;
    let all =
        [edits.local, edits.late, edits.ahead, edits.retracted, edits.replaced, edits.undone, edits.redone];
    let mut failed = Vec::new();
    let mut hold = |held: bool, what: String| {
        if !held {
            failed.push(what);
        }
    };
    hold(soaked.late_ours == 0, format!("{} late pictures", soaked.late_ours));
    hold(seen.backward_steps == 0, format!("{} steps back in time", seen.backward_steps));
    hold(seen.forward_jumps == 0, format!("{} jumps in time", seen.forward_jumps));
    hold(
        seen.teleports == 0,
        format!("{} bodies jumped, the farthest {} m", seen.teleports, seen.teleport_max_m),
    );
    hold(
        slope.is_none_or(|s| s < SLOPE_MAX),
        format!("memory grows by {:.2} MiB a minute", slope.unwrap_or(0.0)),
    );
    hold(soaked.mismatches == 0, format!("{} states differ from a full run", soaked.mismatches));
    Verdict {
        scene: args.scene.clone(),
        bodies: soaked.bodies,
        seconds: args.seconds,
        fps: args.fps,
        seed: args.seed,
        edits: all.iter().sum(),
        orders: *edits,
        refused: soaked.refused,
        commands: soaked.commands,
        stalls: soaked.stalls,
        stalled_s: soaked.stalled_s,
        frames_ahead: soaked.frames_ahead,
        frames_again: soaked.frames_again,
        intervals: soaked.pictures,
        late_ours: soaked.late_ours,
        sleeper: soaked.sleeper,
        work: soaked.work,
        ran: soaked.ran,
        seen: *seen,
        rss_warm_mib: warm.first().map(|(_, mib)| *mib),
        rss_end_mib: warm.last().map(|(_, mib)| *mib),
        rss_slope_mib_per_min: slope,
        states_end_mib: states.last().map(|(_, mib)| *mib),
        states_slope_mib_per_min: states_slope,
        frames_compared: soaked.frames_compared,
        mismatches: soaked.mismatches,
        failed,
    }
}

/// The slope of the straight line through times (seconds) and values that has the smallest squares of errors. Per minute.
fn slope(values: &[(f64, f64)]) -> Option<f64> {
    let count = values.len() as f64;
    let (x, y) = values.iter().fold((0.0, 0.0), |(x, y), value| (x + value.0 / count, y + value.1 / count));
    let (over, under) = values.iter().fold((0.0, 0.0), |(o, u), value| {
        (o + (value.0 - x) * (value.1 - y), u + (value.0 - x) * (value.0 - x))
    });
    (under > 0.0).then(|| 60.0 * over / under)
}

fn print_verdict(verdict: &Verdict) -> Result<(), Failure> {
    let Verdict { seen, intervals, sleeper, work, ran, .. } = verdict;
    print(&format!(
        "{}: {} bodies, {:.0} s at {} pictures per second, {} edits, {} stalls of {:.1} s together, seed {}",
        verdict.scene,
        verdict.bodies,
        verdict.seconds,
        verdict.fps,
        verdict.edits,
        verdict.stalls,
        verdict.stalled_s,
        verdict.seed
    ))?;
    let lateness = |name: &str, of: &Lateness| {
        print(&format!(
            "  {name:<34} {:>8} late   {:>8.2} ms p99.9   {:>8.2} ms longest",
            of.late, of.interval_p999_ms, of.interval_max_ms
        ))
    };
    lateness("from picture to picture", intervals)?;
    lateness("a thread that only sleeps", sleeper)?;
    lateness("until a picture could be drawn", work)?;
    lateness("processor time of it all", ran)?;
    let line = |name: &str, value: String| print(&format!("  {name:<34} {value:>8}"));
    line("late pictures of our making", verdict.late_ours.to_string())?;
    line("steps back in time", seen.backward_steps.to_string())?;
    line("jumps in time, of bodies", format!("{}, {}", seen.forward_jumps, seen.teleports))?;
    line("pictures with a slowed clock", format!("{}, slowest {:.3}", seen.slowed_pictures, seen.rate_min))?;
    line("longest recovery", format!("{:.2} s", seen.recovery_max_s))?;
    line(
        "behind real time, at most, at last",
        format!("{:.2} s, {:.2} s", seen.delay_max_s, seen.delay_end_s),
    )?;
    line("frames computed, again", format!("{}, {}", verdict.frames_ahead, verdict.frames_again))?;
    line("fewest frames ahead", seen.ahead_min.map_or_else(|| "-".to_owned(), |frames| frames.to_string()))?;
    line(
        "pushes seen, within 2 pictures, at most",
        format!("{}, {}, {} pictures", seen.pushes_seen, seen.pushes_in_two, seen.push_pictures_max),
    )?;
    if verdict.orders.dragged > 0 {
        let late = format!("{} of {}", seen.dragged_late, verdict.orders.dragged);
        line("pictures with the dragged body late", late)?;
    }
    line("bodies shown late, blended", format!("{}, {}", seen.late_bodies, seen.blended_bodies))?;
    line("drawn off the truth, at most", format!("{:.3} m", seen.off_max_m))?;
    let mib = |value: Option<f64>| value.map_or_else(|| "unknown".to_owned(), |mib| format!("{mib:.2}"));
    line(
        "memory warm, end, slope a minute",
        format!(
            "{}, {}, {} MiB",
            mib(verdict.rss_warm_mib),
            mib(verdict.rss_end_mib),
            mib(verdict.rss_slope_mib_per_min)
        ),
    )?;
    line(
        "of it states, end, slope a minute",
        format!("{}, {} MiB", mib(verdict.states_end_mib), mib(verdict.states_slope_mib_per_min)),
    )?;
    line("frames compared with a full run", verdict.frames_compared.to_string())?;
    line("states that differ", verdict.mismatches.to_string())?;
    print(&match verdict.failed.as_slice() {
        [] => "  all of it holds".to_owned(),
        failed => format!("  FAILED: {}", failed.join("; ")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_of_a_line_is_found() {
        let values: Vec<(f64, f64)> = (0..100).map(|i| (f64::from(i), 50.0 + 0.5 * f64::from(i))).collect();
        assert!(slope(&values).is_some_and(|slope| (slope - 30.0).abs() < 1e-9));
        assert_eq!(slope(&values[..1]), None);
    }
}
