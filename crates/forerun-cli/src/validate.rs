//! Validate: analytic cases and measurements from the literature, as figures with their limits.

mod cases;

pub(crate) use cases::CASES;

/// One number of a case beside what is asked of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Figure {
    /// What was measured, with its unit.
    pub(crate) name: &'static str,
    /// What came out.
    pub(crate) value: f64,
    /// What is asked, in words: `at most 0.5`, `1.2 to 1.3`.
    pub(crate) limit: String,
    /// Whether it holds.
    pub(crate) pass: bool,
}

impl Figure {
    /// A number that is not to exceed a limit.
    pub(crate) fn at_most(name: &'static str, value: f64, limit: f64) -> Self {
        Figure { name, value, limit: format!("at most {limit}"), pass: value <= limit }
    }

    /// A number that is to be within a tolerance of another.
    pub(crate) fn near(name: &'static str, value: f64, expected: f64, tolerance: f64) -> Self {
        let pass = (value - expected).abs() <= tolerance;
        Figure { name, value, limit: format!("{expected:.6} ± {tolerance}"), pass }
    }
}

/// A question with a known answer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    /// Short name, as typed on the command line.
    pub(crate) id: &'static str,
    /// Does the experiment.
    pub(crate) run: fn() -> Vec<Figure>,
}
