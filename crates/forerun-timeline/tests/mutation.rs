//! Mutation: with a rule of the wavefront left out, the comparison with full runs fails. So the rules are needed, and the oracle sees it.

mod scenes;

use forerun_dynamics::Environment;
use forerun_timeline::Mutation;
use forerun_timeline::check::{CheckSettings, check};

/// Body-frames that differ from full runs over all scenes and some seeds.
fn mismatches(mutation: Mutation) -> u64 {
    let mut environment = Environment::default();
    environment.settings.rest_seconds = 0.1;
    let mut count = 0;
    for (_, bodies) in scenes::all() {
        for seed in 20..24 {
            let settings =
                CheckSettings { edits: 10, seed, frames: 80, mutation, ..CheckSettings::default() };
            let report = check(&bodies, environment, &settings, &mut |_| {}).expect("bodies are possible");
            count += report.mismatches;
        }
    }
    count
}

#[test]
fn with_all_rules_nothing_differs() {
    assert_eq!(mismatches(Mutation::None), 0);
}

#[test]
fn without_the_old_island_it_differs() {
    assert!(mismatches(Mutation::NoOldIsland) > 0);
}

/// Absence is a dependency: what a body did while nobody came holds only as long as nobody comes.
#[test]
fn without_the_newcomers_it_differs() {
    assert!(mismatches(Mutation::NoNewcomers) > 0);
}

#[test]
fn without_waking_anew_it_differs() {
    assert!(mismatches(Mutation::NoWaking) > 0);
}

#[test]
fn with_unsorted_pairs_it_differs() {
    assert!(mismatches(Mutation::Unsorted) > 0);
}

#[test]
fn with_a_tolerance_it_differs() {
    assert!(mismatches(Mutation::Tolerance(1e-4)) > 0);
}
