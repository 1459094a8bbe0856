//! Properties that hold for any two convex shapes, tried on thousands of random pairs.

use forerun_geometry::contact::contact_manifolds;
use forerun_geometry::{ContactPoint, Manifold, Motion, Placed, Pose, Shape, Vec3};

use crate::common::{
    Random, brute_separation, capsule, cuboid, cylinder, hull, manifolds, octahedron, off_surface,
    separation_along, sphere, tetrahedron,
};

const TRIES: usize = 2000;
const MARGIN: f32 = 0.1;

/// One of the engine's preferences may keep an axis that is worse by this. Metres.
const PREFERENCE: f32 = 4.5e-3;

const KINDS: [&str; 6] = ["sphere", "capsule", "cuboid", "cylinder", "hull", "half-space"];

fn make(kind: &str, random: &mut Random) -> Shape {
    let mut size = || random.between(0.1, 0.6);
    match kind {
        "sphere" => sphere(size()),
        "capsule" => capsule(size(), 0.5 * size()),
        "cuboid" => cuboid(size(), size(), size()),
        "cylinder" => cylinder(size(), size()),
        "half-space" => Shape::HalfSpace,
        _ => {
            let size = size();
            match (size * 1000.0) as u32 % 3 {
                0 => octahedron(size),
                1 => tetrahedron(size * 1.5),
                _ => {
                    let spread = size * 0.8;
                    let mut corners = Vec::new();
                    for k in 0..6 {
                        let (sine, cosine) = libm::sincosf(k as f32);
                        corners.push(Vec3::new(cosine * spread, -size, sine * spread));
                        corners.push(Vec3::new(cosine * spread, size, sine * spread));
                    }
                    hull(&corners)
                }
            }
        }
    }
}

#[derive(Debug)]
/// Two shapes that overlap, touch or are a little apart, in any attitude.
struct Pair {
    a: Shape,
    b: Shape,
    pose_a: Pose,
    pose_b: Pose,
}

impl Pair {
    fn new(kinds: (&str, &str), random: &mut Random) -> Pair {
        let (a, b) = (make(kinds.0, random), make(kinds.1, random));
        let pose_a = Pose::new(random.vector(2.0), random.rotation());
        let rotation = random.rotation();
        let far = Pose::new(pose_a.position, rotation);
        // Along a random direction, from a little overlap (mostly) to a little gap.
        let direction = if a == Shape::HalfSpace { pose_a.rotation * Vec3::Y } else { random.direction() };
        let touching =
            if b == Shape::HalfSpace { 0.0 } else { -separation_along((&a, pose_a), (&b, far), direction) };
        let apart = touching + random.between(-0.15, 0.08);
        let pose_b = Pose::new(pose_a.position + direction * apart, rotation);
        Pair { a, b, pose_a, pose_b }
    }

    fn manifold(&self) -> Option<Manifold> {
        let found = manifolds((&self.a, self.pose_a), (&self.b, self.pose_b), MARGIN);
        assert!(found.len() <= 1);
        found.first().copied()
    }

    fn swapped(&self) -> Option<Manifold> {
        let found = manifolds((&self.b, self.pose_b), (&self.a, self.pose_a), MARGIN);
        found.first().copied()
    }

    fn along(&self, normal: Vec3) -> f32 {
        separation_along((&self.a, self.pose_a), (&self.b, self.pose_b), normal)
    }
}

fn for_each_pair_kind(mut check: impl FnMut((&str, &str), &mut Random)) {
    for (i, first) in KINDS.iter().enumerate() {
        for second in &KINDS[i..] {
            if (*first, *second) != ("half-space", "half-space") {
                check((first, second), &mut Random(17 + i as u64));
            }
        }
    }
}

fn deepest(manifold: &Manifold) -> ContactPoint {
    let mut best = manifold.points[0];
    for point in manifold.points() {
        if point.separation < best.separation {
            best = *point;
        }
    }
    best
}

#[test]
fn points_lie_on_both_surfaces_and_normals_are_unit() {
    for_each_pair_kind(|kinds, random| {
        let mut found = 0;
        for _ in 0..TRIES {
            let pair = Pair::new(kinds, random);
            let Some(manifold) = pair.manifold() else { continue };
            found += 1;
            assert!((1..=4).contains(&manifold.count));
            assert!((manifold.normal.length() - 1.0).abs() < 1.0e-5);
            for point in manifold.points() {
                assert!(point.position.is_finite() && point.separation < MARGIN);
                assert!((point.normal.length() - 1.0).abs() < 1.0e-5);
                let half = point.normal * (0.5 * point.separation);
                let on_a = off_surface(&pair.a, &pair.pose_a, point.position - half, point.normal);
                let on_b = off_surface(&pair.b, &pair.pose_b, point.position + half, -point.normal);
                let off = on_a.abs().max(on_b.abs());
                // Edges that run alongside each other, not quite parallel, are nearest a little off the normal; the
                // edges of two cuboids that only pass each other at some distance may be nearest far off it.
                let allowed =
                    if point.separation < 0.0 || kinds != ("cuboid", "cuboid") { 0.01 } else { 0.1 };
                assert!(off < allowed, "{kinds:?}: off by {on_a} and {on_b}\n{pair:?}\n{manifold:?}");
            }
        }
        assert!(found > TRIES / 2, "{kinds:?}: only {found} of {TRIES} pairs have a manifold");
    });
}

#[test]
fn the_other_order_gives_the_mirror_image() {
    for_each_pair_kind(|kinds, random| {
        let mut other_axis = 0;
        for _ in 0..TRIES {
            let pair = Pair::new(kinds, random);
            let (there, back) = (pair.manifold(), pair.swapped());
            assert_eq!(
                there.is_some(),
                back.is_some(),
                "{kinds:?}: only one order finds a manifold\n{pair:?}"
            );
            let (Some(there), Some(back)) = (there, back) else { continue };
            // A tie goes to the first shape's face: then the axes differ, but neither is better.
            if there.normal.dot(back.normal) > -0.9999 {
                other_axis += 1;
                continue;
            }
            let difference = (there.deepest() - back.deepest()).abs();
            assert!(difference < 2.0e-5, "{kinds:?}: {difference}\n{pair:?}\n{there:?}\n{back:?}");
        }
        assert!(
            other_axis <= TRIES / 100,
            "{kinds:?}: {other_axis} pairs have another axis in the other order"
        );
    });
}

#[test]
fn moving_both_moves_the_manifold() {
    for_each_pair_kind(|kinds, random| {
        let mut strayed = 0;
        for _ in 0..TRIES {
            let pair = Pair::new(kinds, random);
            let by = Pose::new(random.vector(2.0), random.rotation());
            let moved = Pair {
                a: pair.a.clone(),
                b: pair.b.clone(),
                pose_a: by * pair.pose_a,
                pose_b: by * pair.pose_b,
            };
            let (Some(here), Some(there)) = (pair.manifold(), moved.manifold()) else { continue };
            let turned = (by.rotation * here.normal).dot(there.normal);
            let deeper = (here.deepest() - there.deepest()).abs();
            let expected = by.transform_point(deepest(&here).position);
            let off = |point: &ContactPoint| (point.position - expected).length();
            let nearest = there.points().iter().map(off).fold(f32::INFINITY, f32::min);
            if turned < 0.9999 || deeper > 2.0e-5 || nearest > 1.0e-2 {
                strayed += 1;
            }
        }
        assert!(strayed <= TRIES / 200, "{kinds:?}: {strayed} manifolds did not follow");
    });
}

#[test]
fn depth_and_distance_agree_with_brute_force() {
    for_each_pair_kind(|kinds, random| {
        if kinds.0 == "half-space" || kinds.1 == "half-space" {
            return;
        }
        // Two cuboids: edges at less than 6 degrees span no axis, and corners that pass each other are not met.
        let cuboids = kinds == ("cuboid", "cuboid");
        let allowed = if cuboids { 0.015 } else { PREFERENCE };
        for _ in 0..TRIES / 5 {
            let pair = Pair::new(kinds, random);
            let (truth, _) = brute_separation((&pair.a, pair.pose_a), (&pair.b, pair.pose_b));
            let Some(manifold) = pair.manifold() else {
                assert!(truth > MARGIN - 1.0e-3 || (cuboids && truth > 0.0), "{truth}\n{pair:?}");
                continue;
            };
            let error = (manifold.deepest() - truth).abs();
            assert!(error < allowed, "{kinds:?}: {error}, truth {truth}\n{pair:?}\n{manifold:?}");
            // Two rods side by side have a normal for each end.
            if kinds != ("capsule", "capsule") {
                let loss = truth - pair.along(manifold.normal);
                assert!(loss < allowed, "{kinds:?}: axis worse by {loss}\n{pair:?}\n{manifold:?}");
            }
        }
    });
}

#[test]
fn cuboids_about_to_meet_at_a_corner_are_met_there() {
    let mut random = Random(99);
    let (mut met, mut missed) = (0, 0);
    for _ in 0..TRIES {
        let pair = Pair::new(("cuboid", "cuboid"), &mut random);
        let (truth, direction) = brute_separation((&pair.a, pair.pose_a), (&pair.b, pair.pose_b));
        if pair.manifold().is_some() || truth > 0.9 * MARGIN {
            continue;
        }
        let mut place = [(&pair.a, pair.pose_a), (&pair.b, pair.pose_b)].map(|(shape, pose)| Placed {
            shape,
            pose,
            motion: Motion::default(),
        });
        for (towards, expected) in [(1.1, true), (0.9, false), (-1.0, false)] {
            place[1].motion.linear = direction * (-truth * towards);
            let mut out = Vec::new();
            contact_manifolds(&place[0], &place[1], MARGIN, &mut out);
            assert_eq!(!out.is_empty(), expected, "moving by {towards} of the distance\n{pair:?}");
            if let Some(manifold) = out.first() {
                assert!((manifold.deepest() - truth).abs() < 1.0e-3);
                met += 1;
            } else {
                missed += 1;
            }
        }
    }
    assert!(met > 10 && missed == 2 * met, "{met} met, {missed} not");
}
