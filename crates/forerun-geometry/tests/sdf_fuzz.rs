//! Triangles that were made up: no panic, a clear answer, and what was made is sound.

use forerun_geometry::shape::{Enclosure, Inside, Mesh, MeshDraft, MeshOptions};
use forerun_geometry::{Shape, Vec3};
use proptest::prelude::*;

/// What must hold of every mesh.
fn check(mesh: &Mesh) {
    let field = mesh.collider().field.as_ref();
    assert_eq!(mesh.has_inside(), field.is_some());
    assert!(!mesh.repairs.to_string().is_empty());
    if let Some(field) = field {
        let bounds = mesh.bounds();
        for corner in [bounds.min, bounds.max, bounds.centre()] {
            let (distance, gradient) = field.distance_and_gradient(corner);
            assert!(distance.is_finite() && gradient.is_finite());
        }
        let size = bounds.half_extents().length();
        assert!(field.error().distance.max <= 2.0 * size, "{:?}", field.error());
    }
    let mass = Shape::from(mesh.clone()).mass_properties(1000.0);
    assert!(mass.mass.is_finite() && mass.mass >= 0.0 && mass.centre.is_finite());
    assert!(mass.principal_inertia.is_finite());
}

/// `size`: about that of the whole. Metres.
fn make(vertices: &[Vec3], triangles: &[[u32; 3]], size: f32) {
    for inside in [Inside::Needed, Inside::Optional] {
        // As fine as thin walls ask for would take long.
        let options = MeshOptions { inside, cell: Some(0.05 * size) };
        let made = MeshDraft::new(vertices.to_vec(), triangles.to_vec(), options);
        match made.and_then(|draft| Ok((draft.bake(&|_, _| {})?, draft))) {
            Ok((mesh, draft)) => {
                check(&mesh);
                assert!(draft.restore(&mesh.baked_bytes()) == Ok(mesh));
            }
            Err(error) => assert!(error.to_string().len() > 20, "{error}"),
        }
    }
}

fn position() -> impl Strategy<Value = Vec3> {
    // Few values: many corners in a line or a plane, many walls that touch.
    let number = || prop_oneof![3 => (-3_i8..=3).prop_map(f32::from), 1 => -3.0_f32..3.0];
    (number(), number(), number()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

/// Corners of a box and its triangles.
fn cuboid(low: Vec3, size: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corner = |k: u32| low + size * Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32);
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    ((0..8).map(corner).collect(), triangles.collect())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn soups_do_no_harm(
        vertices in prop::collection::vec(position(), 3..14),
        picks in prop::collection::vec([0_u32..14, 0..14, 0..14], 1..40),
        scale in prop_oneof![Just(1.0_f32), Just(1e-20), Just(1e18), Just(2e5), Just(3e-4)],
    ) {
        let count = vertices.len() as u32;
        let triangles: Vec<[u32; 3]> = picks.iter().map(|t| t.map(|i| i % count)).collect();
        make(&vertices.iter().map(|v| *v * scale).collect::<Vec<_>>(), &triangles, 6.0 * scale);
    }

    #[test]
    fn boxes_in_any_disorder_do_no_harm(
        boxes in prop::collection::vec((position(), position()), 1..4),
        flips in prop::collection::vec(any::<prop::sample::Index>(), 0..6),
        drops in prop::collection::vec(any::<prop::sample::Index>(), 0..3),
    ) {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for (low, size) in boxes {
            let (v, t) = cuboid(low, size.abs() + Vec3::splat(0.1));
            let first = vertices.len() as u32;
            vertices.extend(v);
            triangles.extend(t.iter().map(|t| t.map(|i| i + first)));
        }
        for flip in flips {
            let t = flip.index(triangles.len());
            triangles[t].swap(0, 1);
        }
        for drop in drops {
            triangles.remove(drop.index(triangles.len()));
        }
        make(&vertices, &triangles, 6.0);
    }

    #[test]
    fn boxes_that_overlap_hold_what_one_of_them_holds(
        boxes in prop::collection::vec((position(), position()), 1..4),
        flips in prop::collection::vec(any::<prop::sample::Index>(), 0..6),
    ) {
        let boxes: Vec<(Vec3, Vec3)> =
            boxes.into_iter().map(|(low, size)| (low, size.abs() + Vec3::splat(0.5))).collect();
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for (low, size) in &boxes {
            let (v, t) = cuboid(*low, *size);
            let first = vertices.len() as u32;
            vertices.extend(v);
            triangles.extend(t.iter().map(|t| t.map(|i| i + first)));
        }
        for flip in flips {
            let t = flip.index(triangles.len());
            triangles[t].swap(0, 1);
        }
        // Corners of two boxes at one place hang the boxes together; what is flipped there may be told otherwise.
        let options = MeshOptions { inside: Inside::Needed, cell: Some(0.15) };
        let mesh = MeshDraft::new(vertices, triangles, options).and_then(|draft| draft.bake(&|_, _| {}));
        prop_assume!(mesh.as_ref().is_ok_and(|m| m.repairs.welded_vertices == 0));
        let mesh = mesh.expect("it was just asked");
        prop_assert!(mesh.enclosure != Enclosure::Open);
        let field = mesh.collider().field.as_ref().expect("an inside");
        let bounds = field.bounds();
        for k in 0..1000_u32 {
            let part = |prime: u32| ((k * prime) % 1009) as f32 / 1009.0;
            let p = bounds.min + (bounds.max - bounds.min) * Vec3::new(part(613), part(271), part(97));
            let inner = boxes.iter().map(|(low, size)| (p - *low).min(*low + *size - p).min_element());
            let depth = inner.fold(f32::NEG_INFINITY, f32::max);
            if depth.abs() > 1.5 * field.cell() {
                let distance = field.distance_and_gradient(p).0;
                prop_assert_eq!(distance < 0.0, depth > 0.0, "{} at {}, {} deep", distance, p, depth);
            }
        }
    }
}
