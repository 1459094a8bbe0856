//! Bodies of triangles behave like the primitives that they look like, and stand on what they stand on.

use std::collections::BTreeSet;

use forerun_dynamics::{BodyDef, Mass, World};
use forerun_geometry::shape::mesh_make;
use forerun_geometry::{Quat, Shape, Vec3};

mod common;
use common::{cuboid, ground, run, turned, world_of};

fn block(half_extents: Vec3, position: Vec3) -> BodyDef {
    let mesh = mesh_make::cuboid(half_extents).expect("sizes are above 0");
    BodyDef::new(mesh.into()).at(position)
}

/// How far a body's own y axis leans from the vertical: 0 upright, 1 lying.
fn lean(world: &World, body: usize) -> f32 {
    1.0 - (world.states()[body].rotation * Vec3::Y).y
}

#[test]
fn a_stack_of_mesh_cubes_stands_however_they_are_turned() {
    for yaw in [0.0, 0.3, std::f32::consts::FRAC_PI_4] {
        let mut defs = vec![ground()];
        for i in 0..10 {
            let at = Vec3::Y * (0.5 + i as f32);
            // Every second one is turned, and every third a primitive box.
            let cube = if i % 3 == 2 { cuboid(Vec3::splat(0.5), at) } else { block(Vec3::splat(0.5), at) };
            defs.push(turned(cube, yaw * (i % 2) as f32));
        }
        let mut world = world_of(&defs);
        run(&mut world, 300);
        for i in 1..=10 {
            let state = &world.states()[i];
            let aside = Vec3::new(state.position.x, 0.0, state.position.z).length();
            assert!(aside < 0.005, "cube {i} of a stack turned by {yaw} is {aside} m aside");
            assert!((state.position.y - (i as f32 - 0.5)).abs() < 0.02, "cube {i} is at {}", state.position);
            assert!(lean(&world, i) < 1e-4 && state.velocity.length() < 0.01, "cube {i}: {state:?}");
        }
    }
}

#[test]
fn dominoes_of_triangles_fall_like_boxes() {
    let half = Vec3::new(0.1, 0.5, 0.25);
    let falls = |make: fn(Vec3, Vec3) -> BodyDef| {
        let mut defs = vec![ground()];
        defs.extend((0..12).map(|i| make(half, Vec3::new(0.5 * i as f32, 0.5, 0.0))));
        // About its lower edge, fast enough to get over it.
        defs[1].angular_velocity = Vec3::NEG_Z * 2.0;
        defs[1].velocity = Vec3::X;
        let mut world = world_of(&defs);
        (0..600).find(|_| {
            run(&mut world, 1);
            lean(&world, 12) > 0.1
        })
    };
    let (boxes, meshes) = (falls(cuboid), falls(block));
    let (boxes, meshes): (u32, u32) = (boxes.expect("boxes fall"), meshes.expect("meshes fall"));
    // The wave is a quarter slower than that of boxes: it runs just above the speed at which it would die out.
    assert!(boxes.abs_diff(meshes) <= boxes / 3, "after {boxes} frames as boxes, {meshes} as meshes");
}

/// The surface of cells of the given size, as a closed mesh. No two cells may share an edge or a corner alone.
fn of_cells(cells: &BTreeSet<[i32; 3]>, size: f32) -> Shape {
    let mut corners = Vec::new();
    for cell in cells {
        for axis in 0..3 {
            for (side, step) in [(0, -1), (1, 1)] {
                let mut next = *cell;
                next[axis] += step;
                if cells.contains(&next) {
                    continue;
                }
                let corner = |a: i32, b: i32| {
                    let mut at = *cell;
                    at[axis] += side;
                    at[(axis + 1) % 3] += a;
                    at[(axis + 2) % 3] += b;
                    Vec3::from_array(at.map(|c| c as f32 * size))
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                corners.extend(if side == 1 { [a, b, c, a, c, d] } else { [a, c, b, a, d, c] });
            }
        }
    }
    let triangles = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Shape::mesh(corners, triangles).expect("cells have a closed surface")
}

/// A chair 0.5 m wide and deep on four legs, from 0 to 1 m along x and z in cells of 0.1 m, and 0.9 m high.
fn chair() -> Shape {
    let mut cells = BTreeSet::new();
    for x in 0..5 {
        for z in 0..5 {
            let is_leg = (x == 0 || x == 4) && (z == 0 || z == 4);
            cells.extend((0..4).filter(|_| is_leg).map(|y| [x, y, z]));
            cells.insert([x, 4, z]);
            cells.extend((5..9).filter(|_| z == 0).map(|y| [x, y, z]));
        }
    }
    of_cells(&cells, 0.1)
}

#[test]
fn a_chair_tips_only_where_its_middle_is_not_above_its_legs() {
    let floors = [
        ground(),
        BodyDef { kind: forerun_dynamics::BodyKind::Fixed, ..block(Vec3::new(3.0, 1.0, 3.0), Vec3::NEG_Y) },
    ];
    for floor in floors {
        for (inside, stands) in [(0.01, true), (-0.01, false)] {
            let centre = Vec3::new(0.25, 0.5, inside);
            let mut def = BodyDef::new(chair()).at(Vec3::new(0.1, 0.0, 0.2));
            def.mass = Mass::Given {
                mass: 5.0,
                centre,
                inertia: Vec3::splat(0.4),
                principal_rotation: Quat::IDENTITY,
            };
            let mut world = world_of(&[floor.clone(), def]);
            run(&mut world, 300);
            let lean = lean(&world, 1);
            assert!(
                stands == (lean < 1e-3),
                "its middle {inside} m from the edge of its support: leans by {lean}"
            );
        }
    }
}
