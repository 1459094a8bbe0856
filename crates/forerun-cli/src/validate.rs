//! Validate: analytic cases and measurements from the literature, as figures with their limits.

mod cases;
mod facets;
mod gauge;
mod known_misses;
mod lab;
mod linkage;
mod timelines;

use std::fmt;

pub(crate) use cases::CASES;
use known_misses::Miss;

/// One number of a case beside what is asked of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Figure {
    /// What was measured, with its unit.
    pub(crate) name: String,
    /// What came out.
    pub(crate) value: f64,
    /// What is asked of it.
    pub(crate) limit: Limit,
    /// Whether it holds.
    pub(crate) verdict: Verdict,
}

/// What is asked of a figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Limit {
    AtMost(f64),
    AtLeast(f64),
    Near { expected: f64, tolerance: f64 },
    Nothing,
}

impl Limit {
    /// By how much a value misses the limit; 0 or less where it holds.
    pub(crate) fn shortfall(self, value: f64) -> f64 {
        match self {
            Limit::AtMost(limit) => value - limit,
            Limit::AtLeast(limit) => limit - value,
            Limit::Near { expected, tolerance } => (value - expected).abs() - tolerance,
            Limit::Nothing => f64::NEG_INFINITY,
        }
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Limit::AtMost(limit) => write!(f, "at most {limit}"),
            Limit::AtLeast(limit) => write!(f, "at least {limit}"),
            Limit::Near { expected, tolerance } => write!(f, "{expected:.6} ± {tolerance:.6}"),
            Limit::Nothing => write!(f, "reported"),
        }
    }
}

/// What became of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// It is within its limit.
    Pass,
    /// It is not.
    Miss,
    /// It has no limit.
    Reported,
    /// It is a time: whether it holds says something about this machine, and decides nothing.
    Timed {
        /// Whether it holds here and now.
        holds: bool,
    },
}

impl Verdict {
    fn of(holds: bool) -> Self {
        if holds { Verdict::Pass } else { Verdict::Miss }
    }

    /// Whether it is one of the figures that pass or miss.
    pub(crate) fn counts(self) -> bool {
        matches!(self, Verdict::Pass | Verdict::Miss)
    }

    /// The word in the JSON object.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Verdict::Pass => "pass",
            Verdict::Miss => "miss",
            Verdict::Reported => "reported",
            Verdict::Timed { holds: true } => "in_time",
            Verdict::Timed { holds: false } => "too_slow",
        }
    }

    /// The word in the table.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Verdict::Pass => "pass",
            Verdict::Miss => "miss",
            Verdict::Reported => "",
            Verdict::Timed { holds: true } => "holds here",
            Verdict::Timed { holds: false } => "too slow here",
        }
    }
}

impl Figure {
    fn judged(name: impl Into<String>, value: f64, limit: Limit) -> Self {
        // Not "not short": what is not a number misses.
        let verdict = Verdict::of(limit.shortfall(value) <= 0.0);
        Figure { name: name.into(), value, limit, verdict }
    }

    /// A number that is not to exceed a limit.
    pub(crate) fn at_most(name: impl Into<String>, value: f64, limit: f64) -> Self {
        Figure::judged(name, value, Limit::AtMost(limit))
    }

    /// A number that is to reach a limit.
    pub(crate) fn at_least(name: impl Into<String>, value: f64, limit: f64) -> Self {
        Figure::judged(name, value, Limit::AtLeast(limit))
    }

    /// A number that is to be within a tolerance of another.
    pub(crate) fn near(name: impl Into<String>, value: f64, expected: f64, tolerance: f64) -> Self {
        Figure::judged(name, value, Limit::Near { expected, tolerance })
    }

    /// A number that nothing is asked of.
    pub(crate) fn reported(name: impl Into<String>, value: f64) -> Self {
        Figure { name: name.into(), value, limit: Limit::Nothing, verdict: Verdict::Reported }
    }

    /// A time that is not to exceed a limit.
    pub(crate) fn time_at_most(name: impl Into<String>, value: f64, limit: f64) -> Self {
        let verdict = Verdict::Timed { holds: value <= limit };
        Figure { verdict, ..Figure::at_most(name, value, limit) }
    }

    /// Why it misses its limit, as far as that is known; none of one that is not known to.
    pub(crate) fn cause(&self, case: &str) -> Option<String> {
        let known = if self.verdict == Verdict::Miss { Miss::of(case, &self.name) } else { None };
        known.map(|known| known.says(self))
    }

    /// The value with as many digits as are of use.
    pub(crate) fn digits(&self) -> String {
        let size = self.value.abs();
        if size > 0.0 && !(1e-3..1e6).contains(&size) {
            format!("{:.3e}", self.value)
        } else {
            format!("{:.6}", self.value)
        }
    }
}

/// A question with a known answer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    /// Short name, as typed on the command line.
    pub(crate) id: &'static str,
    /// Does the experiment.
    pub(crate) run: fn() -> Vec<Figure>,
    /// Whether it takes so long (more than ten seconds) that it is run only when it is named.
    pub(crate) long: bool,
}
