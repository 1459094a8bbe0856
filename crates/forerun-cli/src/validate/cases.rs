//! Cases: the registry. A new case is a room beside this one and a row here.

use super::Case;

mod block_on_slope;
mod bouncing_balls;
mod euler_disc;
mod free_fall;
mod free_rotation;
mod newton_chain;
mod off_centre_impact;
mod rolling_down;
mod sampling;
mod spinning_ball;

/// All cases, in the order in which they are run.
pub(crate) const CASES: &[Case] = &[
    Case { id: "free_fall", run: free_fall::run },
    Case { id: "block_on_slope", run: block_on_slope::run },
    Case { id: "rolling_down", run: rolling_down::run },
    Case { id: "bouncing_balls", run: bouncing_balls::run },
    Case { id: "free_rotation", run: free_rotation::run },
    Case { id: "off_centre_impact", run: off_centre_impact::run },
    Case { id: "spinning_ball", run: spinning_ball::run },
    Case { id: "euler_disc", run: euler_disc::run },
    Case { id: "newton_chain", run: newton_chain::run },
    Case { id: "sampling", run: sampling::run },
];

#[cfg(test)]
mod tests {
    use super::super::known_misses::KNOWN_MISSES;
    use super::super::{Figure, Verdict};
    use super::*;

    fn misses() -> Vec<(&'static str, Figure)> {
        let mut misses = Vec::new();
        for case in CASES {
            let figures = (case.run)();
            assert!(!figures.is_empty(), "{} measures nothing", case.id);
            misses.extend(figures.into_iter().filter(|f| f.verdict == Verdict::Miss).map(|f| (case.id, f)));
        }
        misses
    }

    #[test]
    fn every_figure_holds_its_limit_or_is_a_known_miss() {
        let misses = misses();
        let known =
            |case: &str, figure: &Figure| KNOWN_MISSES.iter().any(|known| known.covers(case, &figure.name));
        let new: Vec<_> = misses.iter().filter(|(case, figure)| !known(case, figure)).collect();
        assert!(new.is_empty(), "these held their limits before: {new:#?}");
        let mended = KNOWN_MISSES
            .iter()
            .filter(|known| !misses.iter().any(|(case, figure)| known.covers(case, &figure.name)));
        let mended: Vec<_> = mended.collect();
        assert!(mended.is_empty(), "these hold their limits now, take them off the table: {mended:#?}");
    }
}
