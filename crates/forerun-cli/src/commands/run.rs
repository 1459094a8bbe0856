//! Run: one scene, one driver, against the clock.

use std::num::NonZeroU16;
use std::path::{Path, PathBuf};

use forerun::{Clock, DriverKind, Playback, PlaybackSettings, Report, Scene, play};

use crate::args::{DriverArg, RunArgs};
use crate::baking::open_scene;
use crate::charts;
use crate::failure::Failure;
use crate::figures::{self, Recorded};
use crate::output::{print, print_json};
use crate::progress;
use crate::results::{make_folder, write_playback};

/// Length of the dissertation's experiments. Seconds.
pub(crate) const DISSERTATION_SECONDS: f64 = 30.0;
/// Length of a frame in the dissertation's experiments. Seconds.
pub(crate) const DISSERTATION_FRAME_SECONDS: f32 = 0.030;

/// `forerun run`.
pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let scene = open_scene(&args.scene)?;
    let settings = PlaybackSettings {
        driver: match args.driver {
            DriverArg::Decoupled => DriverKind::Decoupled,
            DriverArg::Coupled => DriverKind::Coupled,
        },
        seconds: args.seconds.unwrap_or(f64::from(scene.seconds)),
        fps: args.fps,
        lookahead: args.lookahead,
        threads: args.threads.and_then(NonZeroU16::new),
        record: args.record.clone(),
        ..PlaybackSettings::default()
    };
    // Before the playback: an hour of it is not to end in a folder that cannot be made.
    if let Some(folder) = &args.out {
        make_folder(folder)?;
    }
    let playback = play_with_bar(&scene, &settings)?;
    let mut files = match &args.out {
        Some(folder) => write_files(&playback, folder)?,
        None => Vec::new(),
    };
    files.extend(args.record.clone());
    if args.json { print_json(&playback.report) } else { print_result(&playback.report, &files) }
}

/// `forerun` alone: the dominoes in a window; where none can open, the dissertation's first experiment, decoupled.
pub(crate) fn main_job() -> Result<(), Failure> {
    let Err(no_window) = super::view::open_first() else { return Ok(()) };
    print(&format!("{no_window}; running without one"))?;
    let mut scene = Scene::open("dominoes:255")?;
    scene.frame_seconds = DISSERTATION_FRAME_SECONDS;
    let settings = PlaybackSettings { seconds: DISSERTATION_SECONDS, ..PlaybackSettings::default() };
    let folder = Path::new("forerun-output").join("dominoes");
    make_folder(&folder)?;
    print("255 dominoes in a spiral, physics ahead of the display, 30 s in real time")?;
    let playback = play_with_bar(&scene, &settings)?;
    let files = write_files(&playback, &folder)?;
    print_result(&playback.report, &files)?;
    print(
        "\nNext: `forerun experiment all` sets the traditional model beside it; `forerun --help` lists the rest.",
    )
}

/// Plays a scene with a progress bar where there is a terminal.
pub(crate) fn play_with_bar(scene: &Scene, settings: &PlaybackSettings) -> Result<Playback, Failure> {
    let label = format!("{}, {}", scene.name, settings.driver.name());
    let bar = progress::bar((1000.0 * settings.seconds) as u64, &label);
    let playback = play(scene, settings, &Clock::system(), &mut |row| {
        bar.set_position((1000.0 * row.time_real_s) as u64);
    });
    bar.finish_and_clear();
    Ok(playback?)
}

fn write_files(playback: &Playback, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    write_playback(playback, folder)?;
    let Report { scene, driver, .. } = &playback.report;
    let recorded = Recorded { label: driver, rows: &playback.rows };
    let first = match driver.as_str() {
        // The traditional model has no queue; what varies is its time step.
        "coupled" => {
            let title = format!("{scene}, {driver}: time step");
            charts::draw(&[figures::time_steps(&title, &[recorded])], &folder.join("time_step"))?
        }
        _ => {
            let title = format!("{scene}, {driver}: states in the queue");
            charts::draw(&[figures::queue(&title, recorded.rows)], &folder.join("queue"))?
        }
    };
    let times = figures::times(&format!("{scene}, {driver}: time shown and computed"), recorded, None);
    let mut files = vec![folder.join("queue.csv"), folder.join("report.json")];
    files.extend(first);
    files.extend(charts::draw(&[times], &folder.join("time"))?);
    Ok(files)
}

fn print_result(report: &Report, files: &[PathBuf]) -> Result<(), Failure> {
    print(&format!(
        "{}, {}: {} pictures in {:.1} s",
        report.scene, report.driver, report.pictures, report.seconds
    ))?;
    print(&format!("  late pictures                {:>8}", report.late_pictures))?;
    print(&format!("  starved pictures             {:>8}", report.starved_pictures))?;
    print(&format!("  longest time between two     {:>8.1} ms", report.longest_stall_ms))?;
    print(&format!("  largest delay to real time   {:>8.1} ms", 1000.0 * report.delay_max_s))?;
    print(&format!("  states in the queue          {:>8} to {}", report.queue_min, report.queue_max))?;
    print(&format!("  most slices of a frame       {:>8}", report.slices_max))?;
    print(&format!("  states computed again        {:>8}", report.recomputed))?;
    for (what, count) in
        [("states that were not finite", report.quarantined), ("commands that did nothing", report.ignored)]
    {
        if count > 0 {
            print(&format!("  {what:<28} {count:>8}"))?;
        }
    }
    files.iter().try_for_each(|file| print(&format!("wrote {}", file.display())))
}
