//! The areas against brute force.

use forerun_geometry::{Aabb, Vec3};

use super::*;

fn random(seed: u64) -> impl FnMut(f32) -> f32 {
    let mut state = seed;
    move |scale| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        scale * ((state >> 40) as f32 / (1u64 << 24) as f32)
    }
}

fn check(bounds: &[Bound], name: &str) {
    let reference = overlapping_pairs_by_force(bounds);
    assert!(overlapping_pairs(bounds) == reference, "{name}: {} pairs", reference.len());
}

#[test]
fn areas_find_what_brute_force_finds() {
    for seed in 0..40 {
        let mut r = random(seed);
        let spread = [3.0, 30.0, 300.0, 3e6][seed as usize % 4];
        let bounds: Vec<Bound> = (0..300)
            .map(|i| {
                let centre = Vec3::new(r(spread), r(0.2 * spread), r(spread));
                let half = Vec3::new(r(1.0), r(1.0), r(1.0)) * if i % 50 == 0 { 40.0 } else { 1.0 };
                Bound { aabb: Aabb::from_centre(centre, half), dynamic: i % 7 != 0 }
            })
            .chain([Bound {
                aabb: Aabb { min: Vec3::NEG_INFINITY, max: Vec3::new(f32::INFINITY, 0.5, f32::INFINITY) },
                dynamic: false,
            }])
            .collect();
        check(&bounds, &format!("seed {seed}"));
    }
}

/// Sizes over six powers of ten, half of them static, thousands at a time, here and far away.
#[test]
fn thousands_of_all_sizes() {
    for (seed, far) in [(1, 0.0), (2, 1e6), (3, -1e6), (4, 1e9)] {
        let mut r = random(seed);
        let size = |r: &mut dyn FnMut(f32) -> f32| {
            let scale = [1e-3, 0.1, 1.0, 1.0, 1.0, 10.0, 1000.0][r(6.99) as usize];
            Vec3::new(r(scale), r(scale), r(scale))
        };
        let bounds: Vec<Bound> = (0..3000)
            .map(|i| {
                let half = size(&mut r);
                let centre = Vec3::new(far + r(60.0), r(4.0), r(60.0) - far);
                Bound { aabb: Aabb::from_centre(centre, half), dynamic: i % 2 == 0 }
            })
            .collect();
        check(&bounds, &format!("at {far} m"));
    }
}

/// Equal boxes side by side: borders of areas and of bounds fall together.
#[test]
fn a_lattice_of_boxes_that_touch() {
    for edge in [0.1, 1.0, 3.0] {
        let bounds: Vec<Bound> = (0..17 * 17 * 9)
            .map(|i| {
                let at = Vec3::new((i % 17) as f32, (i / 17 % 17) as f32, (i / 289) as f32) * edge;
                Bound { aabb: Aabb { min: at, max: at + Vec3::splat(edge) }, dynamic: i % 3 != 0 }
            })
            .collect();
        check(&bounds, &format!("edge {edge}"));
    }
}

#[test]
fn everybody_at_one_point() {
    let bounds: Vec<Bound> = (0..700)
        .map(|i| Bound {
            aabb: Aabb::from_centre(Vec3::splat(7.0), Vec3::splat(0.1 * (i % 5) as f32)),
            dynamic: i % 2 == 0,
        })
        .collect();
    check(&bounds, "one point");
}

#[test]
fn more_bounds_than_one_task_sweeps() {
    let mut r = random(9);
    let bounds: Vec<Bound> = (0..9000)
        .map(|_| {
            let centre = Vec3::new(r(40.0), r(10.0), r(40.0));
            Bound { aabb: Aabb::from_centre(centre, Vec3::splat(0.4)), dynamic: true }
        })
        .collect();
    check(&bounds, "9000");
}

#[test]
fn the_memory_of_an_earlier_search_changes_nothing() {
    let mut search = BroadPhase::default();
    let mut pairs = Vec::new();
    for (seed, count) in [(1, 500), (2, 30), (3, 900), (4, 0), (5, 60)] {
        let mut r = random(seed);
        let bounds: Vec<Bound> = (0..count)
            .map(|i| {
                let centre = Vec3::new(r(9.0), r(9.0), r(9.0));
                let half = if i % 9 == 0 { 5.0 } else { r(0.5) };
                Bound { aabb: Aabb::from_centre(centre, Vec3::splat(half)), dynamic: i % 4 != 0 }
            })
            .collect();
        search.overlapping_pairs(&bounds, &mut pairs);
        assert_eq!(pairs, overlapping_pairs_by_force(&bounds), "{count}");
    }
}

#[test]
fn bounds_that_are_no_numbers_or_at_infinity_do_not_hang() {
    let mut bounds = vec![Bound { aabb: Aabb::from_centre(Vec3::ZERO, Vec3::ONE), dynamic: true }; 90];
    let wrong = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30, f32::MAX];
    for (i, bad) in wrong.into_iter().enumerate() {
        bounds[7 * i].aabb = Aabb::from_centre(Vec3::splat(bad), Vec3::ONE);
        bounds[7 * i + 1].aabb.min.y = bad;
        bounds[7 * i + 2].aabb.max.z = bad;
    }
    check(&bounds, "some");
    for bad in wrong {
        check(
            &vec![Bound { aabb: Aabb::from_centre(Vec3::splat(bad), Vec3::ONE), dynamic: true }; 90],
            "all",
        );
        let mut half = bounds.clone();
        half.iter_mut().for_each(|b| b.aabb.min.x = bad);
        check(&half, "along x");
    }
}
