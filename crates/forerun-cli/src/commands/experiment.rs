//! Experiment: runs plans and writes tables, charts and a page each.

use std::path::Path;

use forerun::dynamics::{Unobserved, meter};
use forerun::{BodyId, BodyKind, DriverKind, Playback, PlaybackSettings, Scene, world_of};

use super::run::{DISSERTATION_FRAME_SECONDS, play_with_bar};
use crate::args::{ExperimentArg, ExperimentArgs};
use crate::charts;
use crate::experiment::{self, Calibration, Figure, FigureKind, Outcome, Plan, Variant};
use crate::failure::Failure;
use crate::figures::{self, Recorded};
use crate::output::print;
use crate::results::{make_folder, write_playback, write_text};

/// How much of `meshes` the calibration looks at: to well after the first impact. Seconds.
const CALIBRATION_SECONDS: f64 = 4.0;

/// `forerun experiment`.
pub(crate) fn run(args: &ExperimentArgs) -> Result<(), Failure> {
    use ExperimentArg::{All, Dominoes, Interaction, Meshes, Stack};
    let chosen = match args.experiment {
        All => vec![Dominoes, Meshes, Interaction, Stack],
        one => vec![one],
    };
    make_folder(&args.out)?;
    for experiment in chosen {
        let (plan, note) = plan_of(experiment)?;
        let outcomes = run_plan(&plan, args, &note)?;
        summarise(&plan, &outcomes, &args.out)?;
    }
    Ok(())
}

fn plan_of(experiment: ExperimentArg) -> Result<(Plan, String), Failure> {
    let plain = |plan| Ok((plan, String::new()));
    match experiment {
        ExperimentArg::Dominoes | ExperimentArg::All => plain(experiment::dominoes(scene("dominoes:255")?)),
        ExperimentArg::Interaction => plain(experiment::interaction(scene("interaction:255")?)),
        ExperimentArg::Stack => plain(experiment::stack(scene("stack:20")?)),
        ExperimentArg::Meshes => {
            let (scene, found) =
                experiment::meshes_for_this_machine(DISSERTATION_FRAME_SECONDS, CALIBRATION_SECONDS)?;
            let note = describe(&found);
            print(&note)?;
            Ok((experiment::meshes(scene), note))
        }
    }
}

/// A built-in scene with the dissertation's frames.
fn scene(name: &str) -> Result<Scene, Failure> {
    let mut scene = Scene::open(name)?;
    scene.frame_seconds = DISSERTATION_FRAME_SECONDS;
    Ok(scene)
}

fn describe(found: &Calibration) -> String {
    let Calibration { bodies, mean_ms, impact_ms, reached } = found;
    let verdict = if *reached {
        "slow at impact, in real time in the mean"
    } else {
        "the most that stay in real time in the mean on this machine, not as slow at impact as wanted"
    };
    format!(
        "Calibrated: {bodies} meshes, {mean_ms:.1} ms a step in the mean, {impact_ms:.1} ms at impact: {verdict}."
    )
}

fn run_plan(plan: &Plan, args: &ExperimentArgs, note: &str) -> Result<Vec<Outcome>, Failure> {
    let folder = args.out.join(plan.name);
    let seconds = args.seconds.unwrap_or(plan.seconds);
    let mut outcomes = Vec::new();
    for variant in &plan.variants {
        let Variant { label, driver, slices_max } = *variant;
        let mut scene = plan.scene.clone();
        if slices_max.is_some() {
            scene.settings.slices_max = slices_max;
        }
        let settings = PlaybackSettings { driver, seconds, ..PlaybackSettings::default() };
        let variant_folder = folder.join(label.replace(' ', "_"));
        make_folder(&variant_folder)?;
        let playback = play_with_bar(&scene, &settings)?;
        write_playback(&playback, &variant_folder)?;
        let highest_m = highest_m(&scene, &playback)?;
        let overlap_max_m = overlap_max_m(&scene, driver, seconds)?;
        outcomes.push(Outcome { label, playback, highest_m, overlap_max_m });
    }
    for figure in plan.figures {
        draw(&figure, &outcomes, &folder)?;
    }
    write_text(&folder.join("report.md"), &experiment::markdown(plan, &outcomes, note))?;
    Ok(outcomes)
}

/// The deepest overlap of the frames that were played. They are computed once more, bit for bit the same; that is why the coupled driver, whose
/// steps follow the clock, and scenes with many bodies or commands are left out.
fn overlap_max_m(scene: &Scene, driver: DriverKind, seconds: f64) -> Result<Option<f32>, Failure> {
    const BODIES_MAX: usize = 64;
    if driver == DriverKind::Coupled || scene.bodies.len() > BODIES_MAX || !scene.commands.is_empty() {
        return Ok(None);
    }
    let mut world = world_of(scene)?;
    let frames = (seconds / f64::from(scene.frame_seconds)) as u32;
    let mut deepest = 0.0f32;
    for _ in 0..frames {
        world.step(&mut Unobserved);
        deepest = deepest.max(meter::deepest_overlap_m(&world));
    }
    Ok(Some(deepest))
}

/// Bodies that commands add come after those of the scene, and are not fixed in these experiments.
fn highest_m(scene: &Scene, playback: &Playback) -> Result<f32, Failure> {
    let defs = scene.bodies()?;
    let moves = |body: &BodyId| defs.get(body.0 as usize).is_none_or(|def| def.kind != BodyKind::Fixed);
    let moving = playback.last_poses.iter().filter(|(body, _)| moves(body));
    Ok(moving.map(|(_, pose)| pose.position.y).fold(f32::NEG_INFINITY, f32::max))
}

fn draw(figure: &Figure, outcomes: &[Outcome], folder: &Path) -> Result<(), Failure> {
    let recorded: Vec<Recorded> =
        outcomes.iter().map(|o| Recorded { label: o.label, rows: &o.playback.rows }).collect();
    // Every plan begins with the decoupled driver and ends with the coupled one.
    let (Some(&decoupled), Some(&coupled)) = (recorded.first(), recorded.last()) else { return Ok(()) };
    let times = || figures::times(figure.title, decoupled, Some(coupled));
    let panels = match figure.kind {
        FigureKind::Queue => vec![figures::queue(figure.title, decoupled.rows)],
        FigureKind::QueueAndLowest => vec![
            figures::queue(figure.title, decoupled.rows),
            figures::queue_at_lowest("The moment with the fewest states", decoupled.rows),
        ],
        FigureKind::Times => vec![times()],
        FigureKind::TimesAndSteps => {
            vec![times(), figures::time_steps("Shortest time step of the displayed frame", &recorded)]
        }
    };
    charts::draw(&panels, &folder.join(figure.file)).map(|_| ())
}

fn summarise(plan: &Plan, outcomes: &[Outcome], out: &Path) -> Result<(), Failure> {
    for Outcome { label, playback, .. } in outcomes {
        let report = &playback.report;
        print(&format!(
            "{:<12} {:<24} late {:>4} of {:>4}   longest {:>7.1} ms   delay {:>7.3} s   queue {} to {}",
            plan.name,
            label,
            report.late_pictures,
            report.pictures,
            report.longest_stall_ms,
            report.delay_max_s,
            report.queue_min,
            report.queue_max,
        ))?;
    }
    print(&format!("wrote {}", out.join(plan.name).join("report.md").display()))
}
