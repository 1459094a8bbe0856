//! Cases: the registry. A new case is a room beside this one and a row here.

use super::{Case, Figure};

mod arch;
mod ball_cube;
mod block_on_slope;
mod bouncing_balls;
mod capstone;
mod card_house;
mod degenerate;
mod euler_disc;
mod free_fall;
mod free_rotation;
mod friction_directions;
mod kapla;
mod newton_chain;
mod nut;
mod off_centre_impact;
mod plank;
mod rattleback;
mod rings;
mod rolling_down;
mod rolling_plate;
mod sampling;
mod spinning_ball;
mod swing;
mod timeline_bits;
mod timeline_containment;
mod timeline_cost;
mod timeline_cutoff;
mod timeline_memory;
mod timeline_scrub;
mod tori;
mod towers;
mod turntable;

/// All cases, in the order in which they are run.
pub(crate) const CASES: &[Case] = &[
    short("free_fall", free_fall::run),
    short("block_on_slope", block_on_slope::run),
    short("rolling_plate", rolling_plate::run),
    short("rolling_down", rolling_down::run),
    short("friction_directions", friction_directions::run),
    short("bouncing_balls", bouncing_balls::run),
    short("free_rotation", free_rotation::run),
    short("off_centre_impact", off_centre_impact::run),
    short("spinning_ball", spinning_ball::run),
    short("euler_disc", euler_disc::run),
    short("rattleback", rattleback::run),
    short("swing", swing::run),
    short("turntable", turntable::run),
    short("newton_chain", newton_chain::run),
    short("kapla", kapla::run),
    short("ball_cube", ball_cube::run),
    short("elastic_ball_cube", ball_cube::run_elastic),
    short("towers", towers::run),
    short("card_house", card_house::run),
    short("arch", arch::run),
    short("capstone", capstone::run),
    short("plank", plank::run),
    short("degenerate", degenerate::run),
    short("rings", rings::run),
    short("tori", tori::run),
    short("nut", nut::run),
    long("nut_long", nut::run_long),
    long("kapla_long", kapla::run_long),
    long("rings_500", rings::run_500),
    long("rings_1000", rings::run_1000),
    long("tori_long", tori::run_long),
    short("sampling", sampling::run),
    short("timeline_cutoff", timeline_cutoff::run),
    short("timeline_containment", timeline_containment::run),
    long("timeline_cost", timeline_cost::run),
    long("timeline_memory", timeline_memory::run),
    long("timeline_scrub", timeline_scrub::run),
    long("timeline_bits", timeline_bits::run),
];

const fn short(id: &'static str, run: fn() -> Vec<Figure>) -> Case {
    Case { id, run, long: false }
}

const fn long(id: &'static str, run: fn() -> Vec<Figure>) -> Case {
    Case { id, run, long: true }
}

#[cfg(test)]
mod tests {
    use super::super::Verdict;
    use super::super::known_misses::{KNOWN_MISSES, Miss};
    use super::*;

    fn misses() -> Vec<(&'static str, Figure)> {
        let mut misses = Vec::new();
        for case in CASES.iter().filter(|case| !case.long) {
            let figures = (case.run)();
            assert!(!figures.is_empty(), "{} measures nothing", case.id);
            misses.extend(figures.into_iter().filter(|f| f.verdict == Verdict::Miss).map(|f| (case.id, f)));
        }
        misses
    }

    #[test]
    fn every_figure_holds_its_limit_or_is_a_known_miss() {
        let misses = misses();
        let known = |case: &str, figure: &Figure| Miss::of(case, &figure.name);
        let new: Vec<_> = misses.iter().filter(|(case, figure)| known(case, figure).is_none()).collect();
        assert!(new.is_empty(), "these held their limits before: {new:#?}");
        let mended = KNOWN_MISSES
            .iter()
            .filter(|known| !misses.iter().any(|(case, figure)| known.covers(case, &figure.name)));
        let mended: Vec<_> = mended.collect();
        assert!(mended.is_empty(), "these hold their limits now, take them off the table: {mended:#?}");
        let has_grown = |(case, figure): &&(&str, Figure)| {
            known(case, figure).is_some_and(|known| known.has_grown(figure))
        };
        let grown: Vec<_> = misses.iter().filter(has_grown).collect();
        assert!(grown.is_empty(), "these miss their limits by much more than the table says: {grown:#?}");
    }
}
