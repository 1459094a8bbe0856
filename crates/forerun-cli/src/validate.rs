//! Validate: analytic cases and measurements from the literature, as a table of figures with their limits.

mod cases;

use forerun::dynamics as _;

/// One number of a case beside what it must not exceed or fall short of.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Figure {
    /// What was measured, with its unit.
    pub(crate) name: &'static str,
    /// What came out.
    pub(crate) value: f64,
    /// What was asked, in words: `<= 0.5 %`, `1.2 to 1.3`.
    pub(crate) limit: String,
    /// Whether it holds.
    pub(crate) pass: bool,
}

/// A question with a known answer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    /// Short name, as typed on the command line.
    pub(crate) id: &'static str,
    /// Does the experiment.
    pub(crate) run: fn() -> Vec<Figure>,
}
