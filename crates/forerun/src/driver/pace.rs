//! Pace: how fast display time goes when physics is late (case D07: the clock slows, it does not jump).
//!
//! Promises, for any order of calls:
//! - display time never goes back and never passes the last frame that is computed, but on purpose ([`Pace::seek`]);
//! - from picture to picture it advances by at most [`RATE_MAX`] times what passed on the caller's clock, times the speed;
//! - the rate falls smoothly, to how fast physics is, or to 0, as what is computed runs out, and rises by at most 1 in [`RECOVERY_S`].
//!
//! Lost time is made good: while display time is behind the time that was wished for it goes 5 % faster, which nobody sees, until both are
//! equal again, bit for bit. So a display is late only for as long as physics made it, and two displays on one clock meet again.

/// Fastest that lost time is made good. Display seconds per second of the caller's clock, times the speed.
const RATE_MAX: f64 = 1.05;

/// From standing to full speed. Seconds of the caller's clock.
const RECOVERY_S: f64 = 1.0;

/// The clock slows when less than this is computed ahead, at speed 1, and physics does not keep up. Seconds.
const RESERVE_S: f64 = 0.1;

/// Over what time it is seen whether physics keeps up. Seconds.
const GROWTH_S: f64 = 0.1;

/// Faster than this, in multiples of the speed, is a burst that says nothing about the next picture.
const BURST: f64 = 4.0;

/// Less than this is no lost time, but rounding. Seconds.
const HAIR_S: f64 = 1e-9;

/// What physics has computed. Seconds of display time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Supply {
    /// The oldest state kept.
    pub(super) oldest_s: f64,
    /// The last state computed.
    pub(super) horizon_s: f64,
    /// How far ahead physics may be.
    pub(super) lookahead_s: f64,
    /// Length of a frame.
    pub(super) frame_s: f64,
    /// Whether it has done all that it may: then it waits for the display, and not the display for it.
    pub(super) full: bool,
}

/// Display time and what it depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pace {
    time_s: f64,
    /// The caller's clock at the picture before; none before the first.
    real_s: Option<f64>,
    speed: f64,
    /// The time that was wished for at some time of the caller's clock: it goes on from there at one speed, without sums that round.
    wish: (f64, f64),
    /// How fast display time went last, against the caller's clock times the speed.
    rate: f64,
    /// How fast it might have gone, as far as it has recovered from the last time that physics was late.
    recovered: f64,
    /// The last state computed when the picture before was shown. Seconds.
    horizon_s: f64,
    /// How fast that went lately, in the same measure as `rate`.
    growth: f64,
}

impl Pace {
    pub(super) const fn starting_at(time_s: f64) -> Pace {
        Pace {
            time_s,
            real_s: None,
            speed: 1.0,
            wish: (0.0, time_s),
            rate: 1.0,
            recovered: 1.0,
            horizon_s: time_s,
            growth: 0.0,
        }
    }

    /// Display time T.
    pub(super) const fn time_s(&self) -> f64 {
        self.time_s
    }

    /// What display time would be if physics had never been late.
    pub(super) fn wished_s(&self) -> f64 {
        let (real_s, time_s) = self.wish;
        time_s + self.speed * (self.real_s.unwrap_or(real_s) - real_s)
    }

    /// The caller's clock at the last picture; 0 before the first.
    pub(super) fn real_s(&self) -> f64 {
        self.real_s.unwrap_or(0.0)
    }

    pub(super) const fn speed(&self) -> f64 {
        self.speed
    }

    /// 1 unless physics is late, or lost time is being made good.
    pub(super) const fn rate(&self) -> f64 {
        self.rate
    }

    /// `speed` is finite and 0 or more.
    pub(super) fn set_speed(&mut self, speed: f64) {
        self.wish(self.wished_s());
        self.speed = speed;
    }

    /// From now on, `time_s` and what follows is wished for.
    fn wish(&mut self, time_s: f64) {
        self.wish = (self.real_s.unwrap_or(0.0), time_s);
    }

    /// Goes on to the caller's time `real_s`. The first call only learns when the caller's clock began. A clock that goes back, or shows no
    /// finite number, stands still.
    pub(super) fn go_on(&mut self, real_s: f64, supply: &Supply) {
        if self.real_s.is_none() && real_s.is_finite() {
            self.real_s = Some(real_s);
            self.wish(self.time_s);
        }
        let before_s = self.real_s.unwrap_or(0.0);
        let passed_s = if real_s.is_finite() { (real_s - before_s).max(0.0) } else { 0.0 };
        if passed_s > 0.0 {
            self.real_s = Some(real_s);
        }
        // What was shown may have been forgotten in the meantime, when somebody scrubs at the very end of what is kept.
        if self.time_s < supply.oldest_s {
            self.time_s = supply.oldest_s;
            self.wish(self.wished_s().max(self.time_s));
        }
        let usual_s = self.speed * passed_s;
        if usual_s <= 0.0 {
            return;
        }
        let growth = ((supply.horizon_s - self.horizon_s) / usual_s).clamp(0.0, BURST);
        self.growth += (growth - self.growth) * (passed_s / (passed_s + GROWTH_S));
        self.horizon_s = supply.horizon_s;
        let before_s = self.time_s;
        let allowed = (self.recovered + passed_s / RECOVERY_S).min(RATE_MAX);
        let furthest_s = before_s + (allowed * usual_s).min(self.supplied_s(usual_s, supply));
        let furthest_s = furthest_s.min(supply.horizon_s).max(before_s);
        let wished_s = self.wished_s();
        let there = furthest_s >= wished_s - HAIR_S && supply.horizon_s >= wished_s;
        self.time_s = if there { wished_s } else { furthest_s };
        self.rate = (self.time_s - before_s) / usual_s;
        self.recovered = if supply.full { allowed } else { self.rate };
    }

    /// How far display time may go before physics is asked for more.
    fn supplied_s(&self, usual_s: f64, supply: &Supply) -> f64 {
        let ahead_s = (supply.horizon_s - self.time_s).max(0.0);
        if supply.full {
            return ahead_s;
        }
        let reserve_s = (RESERVE_S * self.speed).min(0.5 * supply.lookahead_s);
        // dT/dt = growth + (horizon - frame - T) / reserve, one implicit step: all speed where physics keeps up, or the reserve and a
        // picture are ahead. A frame is left, so that states which come one by one do not make it stutter; and it never goes beyond what is.
        let rate = self.growth + (ahead_s - supply.frame_s) / (reserve_s + usual_s);
        if rate >= 1.0 { ahead_s } else { ahead_s.min(rate.max(0.0) * usual_s) }
    }

    /// Display time is elsewhere from now on, on purpose: the time then shown, which is `time_s` or the nearest that is kept.
    pub(super) fn seek(&mut self, time_s: f64, supply: &Supply) -> f64 {
        self.time_s = time_s.min(supply.horizon_s).max(supply.oldest_s);
        self.wish(self.time_s);
        (self.rate, self.recovered) = (1.0, 1.0);
        self.time_s
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "times are kept to the bit where nothing is late")]
mod tests {
    use super::*;

    const FRAME_S: f64 = 1.0 / 60.0;
    const PICTURE_S: f64 = 1.0 / 60.0;

    fn supply(horizon_s: f64) -> Supply {
        Supply { oldest_s: 0.0, horizon_s, lookahead_s: 100.0 * FRAME_S, frame_s: FRAME_S, full: false }
    }

    /// Physics that computes so many frames per second but stalls in between, up to its lookahead.
    struct Physics {
        frames_per_s: f64,
        stalls_s: Vec<(f64, f64)>,
        computed: f64,
    }

    impl Physics {
        fn work(&mut self, real_s: f64, passed_s: f64, displayed_s: f64) -> Supply {
            let stalled = self.stalls_s.iter().any(|(from, to)| (*from..*to).contains(&real_s));
            let limit = (displayed_s / FRAME_S).floor() + 100.0;
            if !stalled {
                self.computed = (self.computed + self.frames_per_s * passed_s).min(limit);
            }
            let horizon = self.computed.floor();
            Supply { full: horizon >= limit, ..supply(horizon * FRAME_S) }
        }
    }

    /// Real time, display time and rate of every picture, with the laws checked on the way.
    fn played(physics: &mut Physics, seconds: f64, speed: f64) -> Vec<(f64, f64, f64)> {
        let mut pace = Pace::starting_at(0.0);
        pace.set_speed(speed);
        let pictures = (seconds / PICTURE_S) as u32;
        let mut rows = Vec::new();
        for picture in 0..pictures {
            let real_s = f64::from(picture) * PICTURE_S;
            let before_s = pace.time_s();
            let supply = physics.work(real_s, PICTURE_S, before_s);
            pace.go_on(real_s, &supply);
            let advance_s = pace.time_s() - before_s;
            assert!(advance_s >= 0.0, "picture {picture} goes back by {advance_s}");
            assert!(advance_s <= 1.05 * speed * PICTURE_S + 1e-9, "picture {picture} jumps by {advance_s}");
            assert!(pace.time_s() <= supply.horizon_s, "picture {picture} is beyond what is computed");
            rows.push((real_s, pace.time_s(), pace.rate()));
        }
        rows
    }

    #[test]
    fn with_enough_ahead_display_time_is_real_time_to_the_bit() {
        let mut physics = Physics { frames_per_s: 600.0, stalls_s: Vec::new(), computed: 100.0 };
        for (real_s, time_s, rate) in played(&mut physics, 10.0, 1.0) {
            assert_eq!(time_s, real_s, "rate {rate}");
            assert!((rate - 1.0).abs() < 1e-9, "{rate}");
        }
    }

    #[test]
    fn a_stall_slows_the_clock_smoothly_and_it_recovers_within_two_seconds() {
        let mut physics = Physics { frames_per_s: 600.0, stalls_s: vec![(5.0, 9.0)], computed: 100.0 };
        let rows = played(&mut physics, 90.0, 1.0);
        for pair in rows.windows(2) {
            // Never a quarter of the speed from one picture to the next.
            assert!((pair[1].2 - pair[0].2).abs() < 0.26, "{pair:?}");
        }
        let at = |real_s: f64| rows[(real_s / PICTURE_S) as usize];
        assert!(at(8.9).2 < 0.01, "stands still at the end of the stall: {:?}", at(8.9));
        assert!(at(11.0).2 > 0.999, "recovered: {:?}", at(11.0));
        // Nearly 3 s were lost and come back at 5 %.
        let behind_s = |row: (f64, f64, f64)| row.0 - row.1;
        assert!(behind_s(at(11.0)) > 2.0, "{:?}", at(11.0));
        assert!((behind_s(at(11.0)) - behind_s(at(31.0)) - 1.0).abs() < 1e-6, "{:?}", at(31.0));
        assert!(behind_s(at(89.9)).abs() < 1e-9, "{:?}", at(89.9));
    }

    #[test]
    fn physics_that_is_always_too_slow_gives_slow_motion_and_no_stutter() {
        let mut physics = Physics { frames_per_s: 48.0, stalls_s: Vec::new(), computed: 0.0 };
        let rows = played(&mut physics, 30.0, 1.0);
        for row in &rows[600..] {
            assert!((0.7..0.9).contains(&row.2), "{row:?}");
        }
    }

    #[test]
    fn an_empty_queue_at_the_start_is_no_jump() {
        let mut physics = Physics { frames_per_s: 200.0, stalls_s: Vec::new(), computed: 0.0 };
        let rows = played(&mut physics, 20.0, 1.0);
        assert!(rows[119].2 > 0.999, "{:?}", rows[119]);
        assert!((rows[1100].0 - rows[1100].1).abs() < 1e-9, "{:?}", rows[1100]);
    }

    #[test]
    fn ten_times_as_fast_and_a_pause_are_the_callers_wish() {
        let mut physics = Physics { frames_per_s: 3000.0, stalls_s: Vec::new(), computed: 100.0 };
        let rows = played(&mut physics, 5.0, 10.0);
        let last = rows[rows.len() - 1];
        assert!((last.1 - 10.0 * last.0).abs() < 0.5 && last.2 > 0.999, "{last:?}");
        let mut physics = Physics { frames_per_s: 3000.0, stalls_s: Vec::new(), computed: 100.0 };
        assert!(played(&mut physics, 1.0, 0.0).iter().all(|row| row.1 == 0.0));
    }

    #[test]
    fn a_pause_makes_nothing_good_and_loses_nothing() {
        let mut pace = Pace::starting_at(0.0);
        pace.go_on(0.0, &supply(0.0));
        pace.go_on(0.5, &supply(0.0));
        assert_eq!((pace.time_s(), pace.wished_s()), (0.0, 0.5));
        pace.set_speed(0.0);
        pace.go_on(9.0, &supply(9.0));
        assert_eq!((pace.time_s(), pace.wished_s()), (0.0, 0.5));
    }

    #[test]
    fn a_lookahead_of_one_frame_is_enough_to_go_on() {
        let mut pace = Pace::starting_at(0.0);
        for picture in 0..600 {
            let displayed = (pace.time_s() / FRAME_S + 1e-9).floor();
            let lookahead_s = FRAME_S;
            let horizon_s = (displayed + 1.0) * FRAME_S;
            pace.go_on(f64::from(picture) * 0.016, &Supply { lookahead_s, full: true, ..supply(horizon_s) });
        }
        assert!(pace.time_s() > 599.0 * 0.016 - 2.0 * FRAME_S, "{pace:?}");
    }

    #[test]
    fn the_first_call_sets_the_clock_and_a_clock_that_goes_back_stands_still() {
        let mut pace = Pace::starting_at(2.0);
        pace.go_on(1e6, &supply(9.0));
        assert_eq!(pace.time_s(), 2.0);
        for (real_s, time_s) in [(1e6 + 0.25, 2.25), (1e6, 2.25), (f64::NAN, 2.25), (1e6 + 0.5, 2.5)] {
            pace.go_on(real_s, &supply(9.0));
            assert_eq!(pace.time_s(), time_s);
        }
    }

    #[test]
    fn seeking_goes_to_what_is_kept() {
        let mut pace = Pace::starting_at(0.0);
        let kept = Supply { oldest_s: 3.0, ..supply(5.0) };
        for (asked, found) in [(4.0, 4.0), (1.0, 3.0), (9.0, 5.0), (3.5, 3.5)] {
            assert_eq!(pace.seek(asked, &kept), found);
            assert_eq!(pace.wished_s(), found);
        }
    }
}
