//! Queue log: one row per displayed picture, as in the dissertation's figures 5.2 to 5.13.

use std::io::{self, Write};

/// What was so when one picture was shown. The column of a field in `queue.csv` has the field's name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct QueueRow {
    /// Real time since the start. Seconds.
    pub time_real_s: f64,
    /// The time that the picture shows. Seconds; behind real time when physics was late.
    pub time_display_s: f64,
    /// How far the physics was computed: T_F, the earliest horizon of a body. Seconds.
    pub time_physics_s: f64,
    /// The same right after a command came since the picture before, when some states had just gone out of date; else the same.
    pub time_physics_low_s: f64,
    /// Fewest states that a body had ahead of the picture.
    pub queue_min: u32,
    /// Most states that a body had ahead of the picture.
    pub queue_max: u32,
    /// The fewest right after a command came since the picture before; else the same as `queue_min`.
    pub queue_low: u32,
    /// Bodies whose state for the display time was not stored or known to be out of date, so that they were shown as they last were.
    pub starved: u32,
    /// Most slices that an island of the displayed frame was cut into (the dissertation's return in time); 1 when none was.
    pub slices_max: u32,
    /// Shortest time step of the displayed frame: its length over `slices_max`. Seconds.
    pub time_step_s: f64,
    /// Areas in which a body moved at the displayed frame.
    pub areas_active: u32,
    /// States computed since the picture before, first time or again.
    pub computed: u64,
    /// States among them that had been computed before.
    pub recomputed: u64,
    /// Time from the start of the picture before to the start of this one. Milliseconds.
    pub interval_ms: f64,
    /// Time that the display spent on physics for this picture: T_C of the coupled driver, sampling for the decoupled. Milliseconds.
    pub wait_ms: f64,
    /// How fast display time went since the picture before, against real time: below 1 where physics was late and the clock was slowed,
    /// at most 1.05 where lost time is made good; 1 for the coupled driver, which has no clock of its own.
    pub clock_rate: f64,
}

impl QueueRow {
    /// The header of `queue.csv`.
    pub const HEADER: &str = "time_real_s,time_display_s,time_physics_s,queue_min,queue_max,slices_max,areas_active,recomputed,\
                              computed,starved,time_step_s,queue_low,time_physics_low_s,interval_ms,wait_ms,clock_rate";

    /// Whether physics was late for this picture: a body had no state for its time, or the clock was slowed to wait for one.
    #[must_use]
    pub fn is_starved(&self) -> bool {
        // Less is rounding.
        const FULL_RATE: f64 = 1.0 - 1e-6;
        self.starved > 0 || self.clock_rate < FULL_RATE
    }

    fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        write!(out, "{:.6},{:.6},{:.6},", self.time_real_s, self.time_display_s, self.time_physics_s)?;
        write!(out, "{},{},{},", self.queue_min, self.queue_max, self.slices_max)?;
        write!(out, "{},{},{},{},", self.areas_active, self.recomputed, self.computed, self.starved)?;
        write!(out, "{:.6},{},{:.6},", self.time_step_s, self.queue_low, self.time_physics_low_s)?;
        writeln!(out, "{:.3},{:.3},{:.4}", self.interval_ms, self.wait_ms, self.clock_rate)
    }
}

/// Writes `queue.csv`: a header and one line per picture.
///
/// # Errors
/// When `out` cannot be written to.
pub fn write_queue_csv(rows: &[QueueRow], out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "{}", QueueRow::HEADER)?;
    rows.iter().try_for_each(|row| row.write_csv(out))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_has_as_many_fields_as_the_header() {
        let row = QueueRow { time_real_s: 0.5, queue_max: 100, ..QueueRow::default() };
        let mut out = Vec::new();
        write_queue_csv(&[row, row], &mut out).expect("a Vec takes everything");
        let text = String::from_utf8(out).expect("digits and commas");
        let fields: Vec<usize> = text.lines().map(|line| line.split(',').count()).collect();
        assert_eq!(fields, [16, 16, 16]);
        assert!(
            text.lines().nth(1).is_some_and(|line| line.starts_with("0.500000,0.000000,0.000000,0,100,"))
        );
    }
}
