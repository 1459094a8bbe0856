//! Speculative contacts: found for what will hit, not for what will pass.

use forerun_geometry::contact::contact_manifolds;
use forerun_geometry::{Manifold, Motion, Placed, Pose, Shape, Vec3};

use crate::common::{Random, at, capsule, cube_hull, cuboid, cylinder, octahedron, separation_along, sphere};

/// The manifold of a shape at rest and one that is about to move by `linear`.
fn ahead(a: (&Shape, Pose), b: (&Shape, Pose), linear: Vec3) -> Option<Manifold> {
    let rest = Placed { shape: a.0, pose: a.1, motion: Motion::default() };
    let moving = Placed { shape: b.0, pose: b.1, motion: Motion { linear, ..Motion::default() } };
    let mut out = Vec::new();
    contact_manifolds(&rest, &moving, 1.2 * linear.length(), &mut out);
    out.first().copied()
}

#[test]
fn a_ball_that_flies_past_a_corner_is_not_stopped() {
    let ball = sphere(0.1);
    for block in [cuboid(0.5, 0.5, 0.5), cube_hull(0.5), cylinder(0.5, 0.5)] {
        // It comes down at 45 degrees, over the edge at x = 0.5, and misses it by 3 cm.
        let along = Vec3::new(1.0, -1.0, 0.0) * 0.3;
        let edge = Vec3::new(0.5, 0.5, 0.0);
        let start = |miss: f32| edge + Vec3::new(1.0, 1.0, 0.0).normalize() * (0.1 + miss) - along * 0.5;
        let placed = |miss: f32| Pose::from_position(start(miss));
        assert!(ahead((&block, Pose::IDENTITY), (&ball, placed(0.03)), along).is_none(), "{block:?}");
        assert!(ahead((&block, Pose::IDENTITY), (&ball, placed(-0.03)), along).is_some(), "{block:?}");
    }
}

#[test]
fn what_will_hit_is_seen_before() {
    // Positions at the end of the move overlap, so they do hit: a contact must be there and keep them apart.
    let shapes = [
        sphere(0.3),
        capsule(0.2, 0.2),
        cuboid(0.3, 0.2, 0.4),
        cylinder(0.2, 0.3),
        cube_hull(0.3),
        octahedron(0.4),
    ];
    let mut random = Random(41);
    for a in &shapes {
        for b in &shapes {
            for _ in 0..300 {
                let (pose_a, rotation) = (Pose::new(Vec3::ZERO, random.rotation()), random.rotation());
                let end = Pose::new(random.vector(0.3), rotation);
                let linear = random.direction() * 0.8;
                let start = Pose::new(end.position - linear, rotation);
                let overlap = |pose: Pose| {
                    let found = crate::common::manifolds((a, pose_a), (b, pose), 0.0);
                    found.first().map_or(0.0, Manifold::deepest)
                };
                if overlap(start) < 0.0 || overlap(end) > -0.02 {
                    continue;
                }
                let manifold = ahead((a, pose_a), (b, start), linear);
                let normal = manifold.map(|manifold| manifold.normal);
                assert!(normal.is_some(), "{a:?} {b:?} {pose_a:?} {start:?} {linear:?}");
            }
        }
    }
}

#[test]
fn a_contact_that_is_not_reached_is_kept() {
    let (block, ball) = (cuboid(0.5, 0.5, 0.5), sphere(0.1));
    let found = ahead((&block, Pose::IDENTITY), (&ball, at(0.0, 0.65, 0.0)), Vec3::new(0.2, -0.01, 0.0));
    let separation = found.map_or(0.0, |manifold| manifold.deepest());
    let truth = separation_along((&block, Pose::IDENTITY), (&ball, at(0.0, 0.65, 0.0)), Vec3::Y);
    assert!((separation - truth).abs() < 1.0e-6);
}
