//! What part of time the strip shows, and the ruler over it.

use three_d::egui::Rangef;

/// The shortest part of time that is shown. Seconds.
const SPAN_MIN_S: f64 = 0.2;
/// The shortest that is shown when all of it is: the beginning of a scene does not race over the strip. Seconds.
const WHOLE_MIN_S: f64 = 10.0;
/// Where display time is held when it would leave: part of the strip.
const FOLLOW_AT: f64 = 0.6;

/// A part of time over a row of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// Time at the left end. Seconds.
    pub(super) start_s: f64,
    /// Time at the right end. Seconds.
    pub(super) end_s: f64,
    /// The left and the right end. Points.
    pub(super) x: Rangef,
}

impl Scale {
    /// Where a time is. Points.
    pub(super) fn x_of(&self, time_s: f64) -> f32 {
        let part = (time_s - self.start_s) / (self.end_s - self.start_s);
        // Far outside is as good as a little outside, and can be drawn.
        self.x.min + part.clamp(-1.0, 2.0) as f32 * self.x.span()
    }

    /// Which time is there. Seconds.
    pub(super) fn time_of(&self, x: f32) -> f64 {
        let part = f64::from(x - self.x.min) / f64::from(self.x.span().max(1.0));
        self.start_s + part * (self.end_s - self.start_s)
    }

    /// Marks of the ruler at least `apart` points from each other: their times, and the decimals that their numbers need.
    pub(super) fn ticks(&self, apart: f32) -> (Vec<f64>, usize) {
        let step_s =
            nice_step(f64::from(apart) / f64::from(self.x.span().max(1.0)) * (self.end_s - self.start_s));
        let first = (self.start_s / step_s).ceil().max(0.0) as i64;
        let last = (self.end_s / step_s).floor() as i64;
        let decimals = if step_s < 0.0999 { 2 } else { usize::from(step_s < 0.999) };
        ((first..=last).map(|i| i as f64 * step_s).collect(), decimals)
    }
}

/// The first of 0.01, 0.02, 0.05, 0.1 ... 5, 10, 30, 60, 120, 300, 600, 1800, 3600 s that is at least as long.
fn nice_step(at_least_s: f64) -> f64 {
    const STEPS_S: [f64; 18] = [
        0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1800.0,
        3600.0, 36_000.0,
    ];
    STEPS_S.into_iter().find(|step_s| *step_s >= at_least_s).unwrap_or(360_000.0)
}

/// Which part of time is shown: all that is kept, or a part that the user chose with the wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Zoom {
    /// Start and length in seconds, when it is a part.
    part: Option<(f64, f64)>,
}

/// From the oldest frame that is kept to the horizon, and display time. Seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kept {
    /// The oldest frame.
    pub(super) oldest_s: f64,
    /// The last frame.
    pub(super) horizon_s: f64,
    /// Display time.
    pub(super) shown_s: f64,
}

impl Zoom {
    /// What is shown over these points.
    pub(super) fn scale(&self, kept: Kept, x: Rangef) -> Scale {
        let (start_s, span_s) = self.part.unwrap_or_else(|| whole(kept));
        Scale { start_s, end_s: start_s + span_s, x }
    }

    /// Shows all that is kept.
    pub(super) fn reset(&mut self) {
        self.part = None;
    }

    /// Shows a part shorter by a factor above 1, or longer by one below; the time at `fixed_s` stays where it is.
    pub(super) fn zoom(&mut self, factor: f64, fixed_s: f64, kept: Kept) {
        let (start_s, span_s) = self.part.unwrap_or_else(|| whole(kept));
        let (all_start_s, all_span_s) = whole(kept);
        let shorter_s = (span_s / factor).max(SPAN_MIN_S);
        if shorter_s >= all_span_s {
            return self.reset();
        }
        let start_s = fixed_s - (fixed_s - start_s) * shorter_s / span_s;
        let last_s = all_start_s + all_span_s - shorter_s;
        self.part = Some((start_s.clamp(all_start_s, last_s), shorter_s));
    }

    /// Moves the part that is shown. Seconds.
    pub(super) fn pan(&mut self, by_s: f64, kept: Kept) {
        if let Some((start_s, span_s)) = &mut self.part {
            let (all_start_s, all_span_s) = whole(kept);
            *start_s =
                (*start_s + by_s).clamp(all_start_s, (all_start_s + all_span_s - *span_s).max(all_start_s));
        }
    }

    /// Keeps display time in what is shown.
    pub(super) fn follow(&mut self, kept: Kept) {
        if let Some((start_s, span_s)) = &mut self.part {
            let at = (kept.shown_s - *start_s) / *span_s;
            if at > FOLLOW_AT && at < 1.5 {
                *start_s = kept.shown_s - FOLLOW_AT * *span_s;
            } else if !(0.0..=1.0).contains(&at) {
                *start_s = kept.shown_s - 0.3 * *span_s;
            }
        }
    }
}

/// Start and length of all that is kept; the end goes on in leaps, so that the strip stands still between them.
fn whole(kept: Kept) -> (f64, f64) {
    let span_s = (kept.horizon_s - kept.oldest_s).max(WHOLE_MIN_S * 0.9);
    let leap_s = nice_step(span_s / 5.0);
    let end_s = ((kept.oldest_s + span_s) / leap_s + 0.1).ceil() * leap_s;
    (kept.oldest_s, end_s - kept.oldest_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEPT: Kept = Kept { oldest_s: 0.0, horizon_s: 30.0, shown_s: 28.0 };

    fn scale(zoom: &Zoom) -> Scale {
        zoom.scale(KEPT, Rangef::new(100.0, 1100.0))
    }

    #[test]
    fn places_and_times_go_both_ways() {
        let scale = scale(&Zoom::default());
        for time_s in [0.0, 1.5, 29.9] {
            assert!((scale.time_of(scale.x_of(time_s)) - time_s).abs() < 1e-3);
        }
    }

    #[test]
    fn the_wheel_keeps_what_is_under_it_and_ends_at_the_whole() {
        let mut zoom = Zoom::default();
        let x = scale(&zoom).x_of(12.0);
        for _ in 0..3 {
            zoom.zoom(1.5, 12.0, KEPT);
            assert!((scale(&zoom).x_of(12.0) - x).abs() < 0.01);
        }
        for _ in 0..3 {
            zoom.zoom(1.0 / 1.6, 12.0, KEPT);
        }
        assert_eq!(zoom, Zoom::default());
        for _ in 0..200 {
            zoom.zoom(1.5, 12.0, KEPT);
        }
        let shown = scale(&zoom);
        assert!((shown.end_s - shown.start_s - SPAN_MIN_S).abs() < 1e-9);
    }

    #[test]
    fn display_time_does_not_leave_a_part() {
        let mut zoom = Zoom::default();
        zoom.zoom(6.0, 2.0, KEPT);
        zoom.follow(KEPT);
        let shown = scale(&zoom);
        assert!(shown.start_s < KEPT.shown_s && KEPT.shown_s < shown.end_s);
    }

    #[test]
    fn rulers_are_neither_empty_nor_crowded() {
        for span_s in [0.2, 1.0, 7.0, 33.0, 600.0, 36_000.0] {
            let scale = Scale { start_s: 3.0, end_s: 3.0 + span_s, x: Rangef::new(0.0, 1000.0) };
            let (ticks, _) = scale.ticks(70.0);
            assert!((3..=15).contains(&ticks.len()), "{span_s} s: {} ticks", ticks.len());
        }
    }
}
