//! Contact with meshes gives the same bits in whatever instructions, and in whatever memory, it is found.

use forerun_geometry::contact::{ContactScratch, contact_manifolds};
use forerun_geometry::shape::mesh_make;
use forerun_geometry::{Manifold, Motion, Placed, Pose, Quat, Shape, Vec3};
use forerun_lanes::{InstructionSet, limit_to};

/// Every 32 bits of it.
fn bits(manifolds: &[Manifold]) -> Vec<u32> {
    let vector = |v: Vec3| v.to_array().map(f32::to_bits);
    let of_points = |m: &Manifold| -> Vec<u32> {
        let points = m.points().iter();
        points
            .flat_map(|p| [vector(p.position), vector(p.normal), [p.separation.to_bits(); 3]])
            .flatten()
            .collect()
    };
    manifolds.iter().flat_map(|m| vector(m.normal).into_iter().chain(of_points(m))).collect()
}

fn shapes() -> Vec<Shape> {
    let corners: Vec<Vec3> = (0..14_u32).map(|i| numbers(i * 37 + 5).normalize() * 0.4).collect();
    vec![
        mesh_make::torus(0.5, 0.2, 24, 8).expect("a ring").into(),
        mesh_make::frame(Vec3::new(0.5, 0.05, 0.4), 0.1).expect("a frame").into(),
        Shape::half_space(),
        Shape::sphere(0.3).expect("a ball"),
        Shape::capsule(0.3, 0.15).expect("a capsule"),
        Shape::cuboid(Vec3::new(0.3, 0.25, 0.2)).expect("a box"),
        Shape::cylinder(0.3, 0.2).expect("a cylinder"),
        Shape::hull(&corners).expect("a rock"),
    ]
}

fn numbers(i: u32) -> Vec3 {
    let part = |k: u32| ((i * 7919 + i * i % 613 * k * 104_729) % 2003) as f32 / 2003.0 * 2.0 - 1.0;
    Vec3::new(part(1), part(2), part(3))
}

/// The manifolds of many pairs, at least one of each a mesh, half of them fast.
fn all(mut manifolds_of: impl FnMut(&Placed, &Placed, f32) -> Vec<Manifold>) -> Vec<Vec<u32>> {
    let shapes = shapes();
    let mut found = Vec::new();
    for i in 0..1200_u32 {
        let (a, b) = (i as usize % 2, i as usize / 2 % shapes.len());
        let (a, b) = if i % 5 < 3 { (a, b) } else { (b, a) };
        let turned = |k: u32| {
            let v = numbers(i + k);
            Quat::from_xyzw(v.x, v.y, v.z, numbers(i + k + 1).x + 1.5).normalize()
        };
        let fast = if i % 4 < 2 { 0.0 } else { 0.2 };
        let motion =
            Motion { linear: numbers(i + 11) * fast, angular: numbers(i + 12) * fast, about: Vec3::ZERO };
        let first = Placed { shape: &shapes[a], pose: Pose::new(numbers(i) * 0.7, turned(3)), motion };
        let second =
            Placed { shape: &shapes[b], pose: Pose::new(Vec3::ZERO, turned(7)), motion: Motion::default() };
        found.push(bits(&manifolds_of(&first, &second, 0.02 + fast)));
    }
    found
}

fn in_new_memory(first: &Placed, second: &Placed, margin: f32) -> Vec<Manifold> {
    let mut manifolds = Vec::new();
    contact_manifolds(first, second, margin, &mut manifolds);
    manifolds
}

#[test]
fn instructions_and_memory_change_no_bit() {
    limit_to(InstructionSet::Portable);
    let expected = all(in_new_memory);
    let touching = expected.iter().filter(|bits| !bits.is_empty()).count();
    assert!(touching > 300, "only {touching} pairs touch");
    for set in InstructionSet::ALL {
        if limit_to(set) != set {
            continue;
        }
        let mut scratch = ContactScratch::default();
        let in_old_memory = |first: &Placed, second: &Placed, margin: f32| {
            let mut manifolds = Vec::new();
            scratch.contact_manifolds(first, second, margin, &mut manifolds);
            manifolds
        };
        assert!(all(in_old_memory) == expected, "{set} differs from plain arrays, or old memory from new");
    }
}
