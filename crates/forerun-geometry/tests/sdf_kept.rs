//! Meshes from kept bytes, and from any number of threads.
#![allow(dead_code, reason = "each test uses some of the common meshes")]

use std::sync::atomic::{AtomicUsize, Ordering};

use forerun_geometry::sdf::KeptError;
use forerun_geometry::shape::{Enclosure, Inside, Mesh, MeshDraft, MeshError, MeshOptions};
use forerun_geometry::{Quat, Vec3};

#[path = "common/meshes.rs"]
mod meshes;
use meshes::Triangles;

fn draft((vertices, triangles): Triangles) -> MeshDraft {
    MeshDraft::new(vertices, triangles, MeshOptions::default()).expect("a closed mesh")
}

fn bake(draft: &MeshDraft) -> Mesh {
    draft.bake(&|_, _| {}).expect("a closed mesh")
}

#[test]
fn a_mesh_from_kept_bytes_is_the_mesh_that_was_baked() {
    let draft = draft(meshes::torus(0.5, 0.2, 24, 12));
    let baked = bake(&draft);
    let restored = draft.restore(&baked.baked_bytes()).expect("its own bytes");
    assert!(restored == baked);
    assert_eq!(draft.key().to_string().len(), 32);
    let (vertices, mut triangles) = meshes::l_shape();
    triangles.pop();
    let options = MeshOptions { inside: Inside::Optional, ..MeshOptions::default() };
    let sheet = MeshDraft::new(vertices, triangles, options).expect("anything goes");
    let open = bake(&sheet);
    assert!(!open.has_inside() && sheet.restore(&open.baked_bytes()) == Ok(open));
}

#[test]
fn bytes_that_are_damaged_or_of_another_mesh_are_refused() {
    let draft = draft(meshes::cuboid(Vec3::new(0.6, 0.3, 0.2)));
    let bytes = bake(&draft).baked_bytes();
    for length in 0..bytes.len() {
        assert!(draft.restore(&bytes[..length]).is_err(), "cut after {length} bytes");
    }
    for place in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[place] ^= 0x41;
        assert!(draft.restore(&changed).is_err(), "byte {place} changed");
    }
    let (vertices, triangles) = meshes::cuboid(Vec3::new(0.6, 0.3, 0.201));
    let other = MeshDraft::new(vertices.clone(), triangles.clone(), MeshOptions::default()).unwrap();
    assert_eq!(other.restore(&bytes), Err(KeptError::OtherMesh));
    let options = MeshOptions { cell: Some(0.05), ..MeshOptions::default() };
    let finer = MeshDraft::new(vertices, triangles, options).unwrap();
    assert_eq!(finer.restore(&bake(&other).baked_bytes()), Err(KeptError::OtherMesh));
    assert_eq!(draft.restore(b"forerun"), Err(KeptError::OtherVersion));
}

#[test]
fn the_number_of_threads_does_not_show() {
    // Tilted, so that the box around it is mostly empty.
    let mut ring = meshes::torus(1.0, 0.08, 64, 12);
    let tilt = Quat::from_rotation_arc(Vec3::Y, Vec3::new(0.6, 0.64, 0.48));
    ring.0.iter_mut().for_each(|v| *v = tilt * *v);
    // With a hole, and crossed by a ball: mended.
    let mended = |(mut vertices, mut triangles): Triangles, ball: f32, at: Vec3| {
        triangles.remove(50);
        let (count, ball) = (vertices.len() as u32, meshes::sphere(ball, 24, 12));
        vertices.extend(ball.0.iter().map(|v| *v + at));
        triangles.extend(ball.1.iter().map(|t| t.map(|i| i + count)));
        (vertices, triangles)
    };
    let dense_mended = mended(meshes::torus(0.5, 0.2, 48, 16), 0.25, Vec3::X * 0.6);
    let blocks_mended = mended(ring.clone(), 0.12, tilt * Vec3::X * 1.05);
    let cases = [
        (meshes::torus(0.5, 0.2, 48, 16), Enclosure::Closed, false),
        (ring, Enclosure::Closed, true),
        (dense_mended, Enclosure::Mended, false),
        (blocks_mended, Enclosure::Mended, true),
    ];
    for (case, (triangles, enclosure, in_blocks)) in cases.into_iter().enumerate() {
        let draft = draft(triangles);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| bake(&draft))
        };
        let one = on(1);
        let field = one.collider().field.as_ref().expect("an inside");
        let dense = (field.bounds().half_extents() * 2.0 / field.cell()).to_array().iter().product::<f32>();
        assert_eq!((one.enclosure, field.bytes() < dense as usize), (enclosure, in_blocks), "case {case}");
        let one = one.baked_bytes();
        assert!(one == on(2).baked_bytes() && one == on(4).baked_bytes(), "case {case}");
    }
}

#[test]
fn progress_is_told_to_the_end() {
    let (calls, last) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let observe = |done: usize, total: usize| {
        assert!(done >= 1 && done <= total);
        calls.fetch_add(1, Ordering::Relaxed);
        last.fetch_max(done, Ordering::Relaxed);
        assert!(total > 10);
    };
    draft(meshes::sphere(0.5, 24, 12)).bake(&observe).expect("a closed mesh");
    assert_eq!(calls.into_inner(), last.into_inner());
}

#[test]
fn a_wished_cell_size_is_met_and_nonsense_refused() {
    let (vertices, triangles) = meshes::sphere(0.5, 24, 12);
    let with = |cell| {
        let options = MeshOptions { cell: Some(cell), ..MeshOptions::default() };
        MeshDraft::new(vertices.clone(), triangles.clone(), options)
    };
    let mesh = bake(&with(0.02).expect("a size"));
    let cell = mesh.collider().field.as_ref().expect("a closed mesh").cell();
    assert!((0.015..=0.0202).contains(&cell), "{cell}");
    for nonsense in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(with(nonsense), Err(MeshError::Cell { .. })));
    }
    // Far finer than memory allows.
    let fine = bake(&with(1e-30).expect("a size"));
    assert!(fine.collider().bytes() < 4 << 20);
}
