//! Replay: a recording computed again and compared with its hashes, or what can be read of a damaged one.

use std::num::NonZeroU16;
use std::path::Path;

use forerun::recording::{Event, Recording, RecordingFault, Replay};
use forerun::{RecordingError, Threads};
use serde::Serialize;

use crate::args::ReplayArgs;
use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::progress;

/// The result; the fields are those of `replay --json`.
#[derive(Debug, Serialize)]
struct Verdict {
    file: String,
    /// Bodies at the start.
    bodies: usize,
    /// Orders that were obeyed again.
    orders: u64,
    /// Orders that were refused now.
    refused: u64,
    /// The last frame that was computed.
    frames: u64,
    threads: u16,
    /// Hashes that were compared.
    hashes: u64,
    /// Hashes that are different.
    differences: u64,
    /// The first frame whose hash is different.
    first_difference: Option<Difference>,
    /// Of the last frame that was compared, in this replay.
    state_hash: Option<String>,
}

#[derive(Clone, Debug, Serialize)]
struct Difference {
    frame: u64,
    recorded: String,
    found: Option<String>,
}

/// What was saved of a damaged file; the fields are those of `replay --recover OUT --json`.
#[derive(Debug, Serialize)]
struct Salvage {
    file: String,
    out: String,
    /// Orders that were saved.
    orders: usize,
    /// Hashes that were saved.
    hashes: usize,
    /// Where the first record begins that is lost, if any is. Bytes.
    lost_from: Option<u64>,
    /// What is wrong with it.
    fault: Option<String>,
}

/// `forerun replay`.
pub(crate) fn run(args: &ReplayArgs) -> Result<(), Failure> {
    match &args.recover {
        Some(out) => recover(&args.file, out, args.json),
        None => replay(args),
    }
}

fn replay(args: &ReplayArgs) -> Result<(), Failure> {
    let file = args.file.display().to_string();
    let recording = Recording::read(&args.file)?;
    let cores =
        || std::thread::available_parallelism().ok().and_then(|cores| u16::try_from(cores.get()).ok());
    let count = args.threads.or_else(cores).and_then(NonZeroU16::new).unwrap_or(NonZeroU16::MIN);
    let threads = Threads::exactly(count)?;
    let last = recording.events.iter().filter_map(|event| match event {
        Event::Mark(mark) => Some(mark.frame.0),
        _ => None,
    });
    let bar = progress::bar(last.max().unwrap_or(0), &file);
    let replayed = threads.install(|| recording.replay(&mut |frame| bar.set_position(frame.0)));
    bar.finish_and_clear();
    let replayed = replayed.map_err(|error| RecordingError { file: args.file.clone(), ..error })?;
    let verdict = verdict(file, &recording, &replayed, count.get());
    if args.json {
        print_json(&verdict)?;
    } else {
        print_verdict(&verdict)?;
    }
    match &verdict.first_difference {
        None => Ok(()),
        Some(first) => Err(Failure::Check(format!(
            "{}: {} of {} hashes are different, the first at frame {}: recorded {}, found {}",
            verdict.file,
            verdict.differences,
            verdict.hashes,
            first.frame,
            first.recorded,
            first.found.as_deref().unwrap_or("none")
        ))),
    }
}

fn verdict(file: String, recording: &Recording, replay: &Replay, threads: u16) -> Verdict {
    let hex = |hash: u64| format!("{hash:016x}");
    Verdict {
        file,
        bodies: recording.start.names.iter().filter(|name| name.body.is_some()).count(),
        orders: replay.orders,
        refused: replay.refused,
        frames: replay.last.0,
        threads,
        hashes: replay.marks,
        differences: replay.differences.len() as u64,
        first_difference: replay.differences.first().map(|difference| Difference {
            frame: difference.mark.frame.0,
            recorded: hex(difference.mark.hash),
            found: difference.found.map(hex),
        }),
        state_hash: replay.hash.map(hex),
    }
}

fn print_verdict(verdict: &Verdict) -> Result<(), Failure> {
    let Verdict { bodies, orders, refused, frames, threads, hashes, differences, .. } = verdict;
    print(&format!("{}: {bodies} bodies, {frames} frames, {threads} threads", verdict.file))?;
    print(&format!("  orders obeyed again          {orders:>8}"))?;
    if *refused > 0 {
        print(&format!("  orders refused               {refused:>8}"))?;
    }
    print(&format!("  hashes compared              {hashes:>8}"))?;
    print(&format!("  hashes that are different    {differences:>8}"))?;
    print(&format!("  hash of the last             {}", verdict.state_hash.as_deref().unwrap_or("none")))
}

fn recover(file: &Path, out: &Path, json: bool) -> Result<(), Failure> {
    let recovered = Recording::recover(file).map_err(|error| match error.fault {
        RecordingFault::Cut | RecordingFault::Corrupt(_) => Failure::Input(format!(
            "{}: nothing can be recovered: the damage at byte {} is in the start, which has the bodies",
            file.display(),
            error.offset
        )),
        _ => error.into(),
    })?;
    recovered.recording.write(out)?;
    let events = &recovered.recording.events;
    let orders = events.iter().filter(|event| matches!(event, Event::Order(_))).count();
    let hashes = events.iter().filter(|event| matches!(event, Event::Mark(_))).count();
    let salvage = Salvage {
        file: file.display().to_string(),
        out: out.display().to_string(),
        orders,
        hashes,
        lost_from: recovered.lost.as_ref().map(|error| error.offset),
        fault: recovered.lost.as_ref().map(RecordingError::to_string),
    };
    if json {
        return print_json(&salvage);
    }
    match &recovered.lost {
        Some(error) => {
            let length = std::fs::metadata(file).map_or(0, |metadata| metadata.len());
            let lost = length.saturating_sub(error.offset);
            match lost {
                0 => print(&format!(
                    "{}: broke off after {length} bytes; all of them can be read",
                    salvage.file
                ))?,
                _ => print(&format!("{}: the last {lost} of {length} bytes cannot be read", salvage.file))?,
            }
        }
        None => print(&format!("{}: is whole", salvage.file))?,
    }
    print(&format!("wrote {}: {orders} orders and {hashes} hashes", salvage.out))
}
