//! Statistics of a list of times.

use serde::Serialize;

/// Mean, median, 99th percentile and largest of some times. Milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Spread {
    pub(crate) mean: f64,
    pub(crate) median: f64,
    pub(crate) p99: f64,
    pub(crate) max: f64,
}

impl Spread {
    /// Of an empty list all are 0.
    pub(crate) fn of(times_ms: &[f64]) -> Self {
        let mut sorted = times_ms.to_vec();
        sorted.sort_by(f64::total_cmp);
        let Some(&max) = sorted.last() else { return Spread::default() };
        Spread {
            mean: sorted.iter().sum::<f64>() / sorted.len() as f64,
            median: rank(&sorted, 0.5),
            p99: rank(&sorted, 0.99),
            max,
        }
    }
}

/// Nearest rank: the smallest value that is not below the given part of all values.
fn rank(sorted: &[f64], part: f64) -> f64 {
    let place = (part * sorted.len() as f64).ceil() as usize;
    sorted[place.clamp(1, sorted.len()) - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_values_of_the_list() {
        let times: Vec<f64> = (1..=200).rev().map(f64::from).collect();
        assert_eq!(Spread::of(&times), Spread { mean: 100.5, median: 100.0, p99: 198.0, max: 200.0 });
        assert_eq!(Spread::of(&[3.0]), Spread { mean: 3.0, median: 3.0, p99: 3.0, max: 3.0 });
        assert_eq!(Spread::of(&[]), Spread::default());
    }
}
