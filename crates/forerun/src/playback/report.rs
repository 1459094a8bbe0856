//! Report: how smooth a playback was, in a dozen numbers.

use serde::Serialize;

use super::log::QueueRow;

/// A picture is late when it comes more than this many intervals after the one before.
const LATE_INTERVALS: f64 = 1.5;

/// A summary of a playback; the fields are those of `report.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Name of the scene.
    pub scene: String,
    /// `decoupled` or `coupled`.
    pub driver: String,
    /// Length of the playback. Real seconds.
    pub seconds: f64,
    /// Pictures shown.
    pub pictures: u64,
    /// Pictures that came more than 1.5 intervals after the one before.
    pub late_pictures: u64,
    /// Pictures for whose time some body had no state, so that it was shown as it last was, or for which the clock was slowed because
    /// physics was late.
    pub starved_pictures: u64,
    /// Longest time from one picture to the next. Milliseconds.
    pub longest_stall_ms: f64,
    /// Most that the time shown was behind real time. Seconds.
    pub delay_max_s: f64,
    /// Fewest states that a body had ahead of a picture when it was shown, the first picture left out. Right after a command there are fewer for
    /// a moment: see `queue_low`.
    pub queue_min: u32,
    /// Most states that a body had ahead of a picture.
    pub queue_max: u32,
    /// Fewest states that a body had ahead of a picture at any moment, also right after a command, the first picture left out. Commands of the
    /// local user act on the frame after the displayed one, so with one of those it is 0; what says whether anybody saw it is
    /// `starved_pictures`.
    pub queue_low: u32,
    /// Most slices that an island's frame was cut into, among the frames shown.
    pub slices_max: u32,
    /// States that were computed again.
    pub recomputed: u64,
    /// Bodies that were stopped because their next state was not finite, each time it happened.
    pub quarantined: u64,
    /// Commands that did nothing: their body was not there, or the result would not have been finite.
    pub ignored: u64,
}

impl Report {
    /// Sums up the rows of a playback of `fps` pictures per second. What no row has, `quarantined` and `ignored`, is left 0.
    #[must_use]
    pub fn new(scene: &str, driver: &str, fps: f64, rows: &[QueueRow]) -> Self {
        let late_ms = 1000.0 * LATE_INTERVALS / fps;
        let later = rows.get(1..).unwrap_or_default();
        let delays = rows.iter().map(delay_s);
        Report {
            scene: scene.to_owned(),
            driver: driver.to_owned(),
            seconds: rows.last().map_or(0.0, |row| row.time_real_s + 1.0 / fps),
            pictures: rows.len() as u64,
            late_pictures: count(later, |row| row.interval_ms > late_ms),
            starved_pictures: count(rows, QueueRow::is_starved),
            longest_stall_ms: later.iter().map(|row| row.interval_ms).fold(0.0, f64::max),
            delay_max_s: delays.fold(0.0, f64::max),
            queue_min: later.iter().map(|row| row.queue_min).min().unwrap_or(0),
            queue_low: later.iter().map(|row| row.queue_low).min().unwrap_or(0),
            queue_max: rows.iter().map(|row| row.queue_max).max().unwrap_or(0),
            slices_max: rows.iter().map(|row| row.slices_max).max().unwrap_or(1),
            recomputed: rows.iter().map(|row| row.recomputed).sum(),
            quarantined: 0,
            ignored: 0,
        }
    }
}

fn delay_s(row: &QueueRow) -> f64 {
    row.time_real_s - row.time_display_s
}

fn count(rows: &[QueueRow], test: impl Fn(&QueueRow) -> bool) -> u64 {
    rows.iter().filter(|row| test(row)).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn late_and_starved_pictures_are_counted_apart() {
        let row = |time_real_s: f64, interval_ms: f64, shown_s: f64, starved: u32| QueueRow {
            time_real_s,
            interval_ms,
            time_display_s: shown_s,
            starved,
            clock_rate: 1.0,
            queue_min: 10 - starved,
            queue_low: 9 - starved,
            queue_max: 100,
            slices_max: 1,
            recomputed: 3,
            ..QueueRow::default()
        };
        let rows = [
            QueueRow { queue_min: 0, ..row(0.0, 0.0, 0.0, 0) },
            row(0.04, 40.0, 0.04, 0),
            row(0.14, 100.0, 0.10, 2),
            row(0.17, 30.0, 0.10, 2),
        ];
        let report = Report::new("s", "decoupled", 25.0, &rows);
        assert_eq!((report.pictures, report.late_pictures, report.starved_pictures), (4, 1, 2));
        assert!((report.delay_max_s - 0.07).abs() < 1e-12 && (report.longest_stall_ms - 100.0).abs() < 1e-12);
        assert_eq!((report.queue_min, report.queue_max, report.recomputed), (8, 100, 12));
        assert_eq!(report.queue_low, 7);
        // A slowed clock is physics being late, too.
        let slowed = QueueRow { clock_rate: 0.7, ..rows[1] };
        assert_eq!(Report::new("s", "decoupled", 25.0, &[rows[0], slowed, rows[1]]).starved_pictures, 1);
    }
}
