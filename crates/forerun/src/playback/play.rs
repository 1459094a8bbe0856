//! Play: one scene, one driver, a fixed number of pictures per second of real time.

use std::time::Duration;

use forerun_scene::Scene;

use super::log::QueueRow;
use super::report::Report;
use super::settings::{PlaybackError, PlaybackSettings};
use super::show::Show;
use crate::driver::Clock;
use crate::{BodyId, Pose};

/// What was recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Playback {
    /// One row per picture.
    pub rows: Vec<QueueRow>,
    /// The sum of them.
    pub report: Report,
    /// Where the bodies were in the last picture, in the order of their names.
    pub last_poses: Vec<(BodyId, Pose)>,
}

/// Plays `scene` against `clock`. The scene's commands are played as a user's: the driver does not know of them before their time.
///
/// A picture is due every 1/fps seconds. One that comes late moves the next ones: nobody catches up by showing two at once.
///
/// # Errors
/// When a setting is out of its range, the scene is not possible, or the driver fails on the way.
pub fn play(
    scene: &Scene,
    settings: &PlaybackSettings,
    clock: &Clock,
    on_picture: &mut dyn FnMut(&QueueRow),
) -> Result<Playback, PlaybackError> {
    settings.check()?;
    let mut show = Show::new(scene, settings, clock)?;
    let interval = Duration::from_secs_f64(1.0 / settings.fps);
    let length = Duration::from_secs_f64(settings.seconds);
    let start = clock.now();
    let (mut due, mut rows) = (Duration::ZERO, Vec::<QueueRow>::new());
    // Half an interval is left off, so that rounding does not add a picture at the very end.
    while due + interval / 2 < length {
        clock.wait_until(start + due);
        // The first picture is of time 0, however long it took to get here.
        let began = if rows.is_empty() { Duration::ZERO } else { clock.now() - start };
        let mut row = show.picture(began)?;
        let shown = clock.now() - start;
        row.time_real_s = shown.as_secs_f64();
        row.wait_ms = 1000.0 * (shown - began).as_secs_f64();
        row.interval_ms = rows.last().map_or(0.0, |last| 1000.0 * (row.time_real_s - last.time_real_s));
        on_picture(&row);
        rows.push(row);
        due = (due + interval).max(clock.now() - start);
    }
    let report = Report {
        quarantined: show.quarantined(),
        ignored: show.ignored(),
        ..Report::new(&scene.name, settings.driver.name(), settings.fps, &rows)
    };
    let last_poses = show.poses();
    show.finish()?;
    Ok(Playback { rows, report, last_poses })
}
