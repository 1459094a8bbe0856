//! Scenes of meshes that our own makers make: mugs on hooks, a bowl of all sorts, chairs, letters, gears, hills.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use forerun_geometry::{Quat, Vec3};

use super::noise::Noise;
use super::parts::{cube, cuboid, cylinder, ground, mesh, sphere, turn};
use super::piles::{centred, scattered, square_side};
use crate::mesh::{
    BowlEntry, ChairEntry, GearEntry, JackEntry, LetterEntry, MugEntry, TerrainEntry, TorusEntry,
    TorusKnotEntry,
};
use crate::shape::CapsuleEntry;
use crate::{BodyEntry, MeshEntry, PartEntry, RotationEntry, Scene, ShapeEntry};

const MUG: MugEntry = MugEntry {
    radius: 0.4,
    height: 0.9,
    thickness: 0.06,
    handle_radius: 0.06,
    handle_reach: 0.28,
    segments: 48,
};

fn with_mesh(scene: &mut Scene, name: &str, entry: impl Into<MeshEntry>) {
    scene.meshes.insert(name.to_owned(), entry.into());
}

/// Mugs hang by their handles on the hooks of a board; as many fall on them.
pub(super) fn mugs(count: u32) -> Scene {
    const COLUMN: f32 = 1.4;
    const ROW: f32 = 1.5;
    let mut scene =
        Scene::new("mugs", "Mugs hang by their handles on hooks; as many again fall on them from above.");
    with_mesh(&mut scene, "mug", MUG);
    scene.put(ground());
    let hooks = count.div_ceil(2);
    let columns = square_side(hooks);
    let rows = hooks.div_ceil(columns);
    let (half_width, half_height) = (0.5 * COLUMN * columns as f32 + 0.3, 0.5 * ROW * rows as f32 + 0.5);
    scene.put(cuboid(half_width, half_height, 0.1).fixed().at(Vec3::new(0.0, half_height, -0.1)));
    for i in 0..hooks {
        let foot = Vec3::new(COLUMN * centred(i % columns, columns), 1.3 + ROW * (i / columns) as f32, 0.0);
        scene.put(hook().at(foot));
        // The handle stands up, its bow a centimetre above the peg; it is widest a little above the middle of the mug.
        let bow = Vec3::new(-0.52 * MUG.height, MUG.radius + MUG.handle_reach - MUG.handle_radius, 0.0);
        let place = foot + Vec3::new(0.0, PEG_RADIUS + 0.01, 0.5) - bow;
        scene.put(mesh("mug").at(place).turned(turn(Vec3::Z, FRAC_PI_2)));
    }
    let mut noise = Noise::new(31);
    for i in 0..count - hooks {
        let (column, row) = (i % columns, i / columns);
        let x = COLUMN * centred(column, columns) + noise.about_zero(0.1);
        // Neighbours half a row apart, so that none meet before they fall.
        let y = 2.0 * half_height + 1.0 + 1.6 * (row as f32 + 0.5 * (column % 2) as f32);
        let turned = noise.rotation();
        let middle = turned * Vec3::new(0.5 * MUG.handle_reach, 0.5 * MUG.height, 0.0);
        let place = Vec3::new(x, y, noise.between(0.6, 1.0)) - middle;
        scene.put(mesh("mug").at(place).turned(turned));
    }
    scene
}

/// Radius of a peg of the board.
const PEG_RADIUS: f32 = 0.05;

/// A peg along z from the origin, its end turned up.
fn hook() -> BodyEntry {
    const HALF_LENGTH: f32 = 0.45;
    let rod = |half_height: f32, position: [f32; 3], rotation: Option<Quat>| PartEntry {
        shape: ShapeEntry::Capsule(CapsuleEntry { half_height, radius: PEG_RADIUS }),
        position,
        rotation: rotation.map(|q| RotationEntry::Quaternion(q.to_array())),
    };
    let peg = rod(HALF_LENGTH, [0.0, 0.0, HALF_LENGTH], Some(turn(Vec3::X, FRAC_PI_2)));
    let tip = rod(0.06, [0.0, 0.06, 2.0 * HALF_LENGTH], None);
    BodyEntry::new(ShapeEntry::Compound(vec![peg, tip])).fixed()
}

/// Six kinds of meshes of about a metre, for [`toy`].
fn toy_meshes(scene: &mut Scene) {
    with_mesh(scene, "gear", GearEntry { teeth: 12, module: 0.08, half_width: 0.12, bore: 0.15 });
    with_mesh(scene, "jack", JackEntry { reach: 0.5, arm_radius: 0.09, knob_radius: 0.12, cells: 24 });
    let knot = TorusKnotEntry {
        p: 2,
        q: 3,
        radius: 0.35,
        winding_radius: 0.16,
        tube_radius: 0.075,
        segments: 128,
        sides: 10,
    };
    with_mesh(scene, "knot", knot);
    with_mesh(scene, "letter", LetterEntry { letter: 'R', height: 0.9, depth: 0.25 });
    with_mesh(scene, "mug", MeshEntry { scale: 0.75, ..MUG.into() });
    with_mesh(scene, "ring", TorusEntry { radius: 0.4, tube_radius: 0.13, segments: 36, sides: 12 });
}

/// The `i`th of a mixture: meshes of [`toy_meshes`], balls and boxes in turn.
fn toy(i: u32) -> BodyEntry {
    match i % 8 {
        0 => mesh("gear"),
        1 => mesh("jack"),
        2 => sphere(0.3),
        3 => mesh("knot"),
        4 => mesh("letter"),
        5 => mesh("mug"),
        6 => cube(0.3),
        _ => mesh("ring"),
    }
}

/// All sorts of things fall into a bowl that stands on the ground.
pub(super) fn bowl(count: u32) -> Scene {
    let mut scene = Scene::new(
        "bowl",
        "Gears, jacks, knots, letters, mugs, rings, balls and boxes fall into a bowl that stands on the ground.",
    );
    scene.seconds = 20.0;
    toy_meshes(&mut scene);
    // As much larger as there is more to hold.
    let mut scale = 1.0;
    while 60.0 * scale * scale * scale < count as f32 {
        scale *= 1.25;
    }
    let bowl = BowlEntry { radius: 4.0, foot_radius: 1.8, height: 2.4, thickness: 0.3, segments: 96 };
    with_mesh(&mut scene, "bowl", MeshEntry { scale, ..bowl.into() });
    scene.put(ground());
    scene.put(mesh("bowl").named("bowl"));
    let mut noise = Noise::new(37);
    let side = square_side((9.0 * scale * scale) as u32);
    for i in 0..count {
        let (layer, cell) = (i / (side * side), i % (side * side));
        let place = scattered(cell, (side, 1.4), &mut noise).with_y(1.5 * scale + 1.4 * layer as f32);
        scene.put(toy(i).at(place).turned(noise.rotation()));
    }
    scene
}

/// Chairs fall on a heap.
pub(super) fn chairs(count: u32) -> Scene {
    let mut scene =
        Scene::new("chairs", "Chairs, turned at random, fall on a heap and lock into each other.");
    let chair = ChairEntry { width: 0.5, depth: 0.5, seat_height: 0.5, height: 1.0, bar: 0.06 };
    with_mesh(&mut scene, "chair", chair);
    scene.put(ground());
    let mut noise = Noise::new(41);
    for i in 0..count {
        let (layer, cell) = (i / 9, i % 9);
        let place = scattered(cell, (3, 1.45), &mut noise).with_y(0.8 + 1.25 * layer as f32);
        let turned = noise.rotation();
        let place = place - turned * (Vec3::Y * (0.5 * chair.height));
        scene.put(mesh("chair").of_density(600.0).at(place).turned(turned));
    }
    scene
}

/// Words fall, letter by letter.
pub(super) fn letters(count: u32) -> Scene {
    const WORD: [&str; 7] = ["F", "O", "R", "E", "R", "U", "N"];
    let mut scene = Scene::new("letters", "Letters fall word by word, and lie as they may.");
    for (name, letter) in [("F", 'F'), ("O", 'O'), ("R", 'R'), ("E", 'E'), ("U", 'U'), ("N", 'N')] {
        with_mesh(&mut scene, name, LetterEntry { letter, height: 1.0, depth: 0.3 });
    }
    scene.put(ground());
    let mut noise = Noise::new(43);
    for i in 0..count {
        let (line, column) = (i / 7, i % 7);
        let place = Vec3::new(centred(column, 7), 0.6 + 1.3 * line as f32, noise.about_zero(0.3));
        let tilt = turn(Vec3::X, noise.about_zero(0.3)) * turn(Vec3::Y, noise.about_zero(0.5));
        // The first word only falls over.
        let tilt = if line == 0 { Quat::IDENTITY } else { tilt.normalize() };
        scene.put(mesh(WORD[column as usize]).at(place).turned(tilt));
    }
    scene
}

/// Gears lie on the ground round pegs, each in mesh with the next; the first is turned.
pub(super) fn gears(count: u32) -> Scene {
    const MODULE: f32 = 0.2;
    const HALF_WIDTH: f32 = 0.25;
    const BORE: f32 = 0.4;
    const TEETH: [u32; 3] = [12, 20, 15];
    let mut scene = Scene::new(
        "gears",
        "Gears lie round pegs, each in mesh with the next: the first is turned, and by their teeth all turn.",
    );
    for teeth in TEETH {
        let gear = GearEntry { teeth, module: MODULE, half_width: HALF_WIDTH, bore: BORE };
        with_mesh(&mut scene, &format!("{teeth} teeth"), gear);
    }
    scene.put(ground().surface(0.1, 0.0));
    let (mut place, mut angle) = (Vec3::Y * HALF_WIDTH, 0.0);
    for i in 0..count {
        let teeth = TEETH[i as usize % TEETH.len()];
        scene.put(
            cylinder(BORE - 0.02, HALF_WIDTH + 0.05).surface(0.1, 0.0).fixed().at(place + Vec3::Y * 0.05),
        );
        let gear = mesh(&format!("{teeth} teeth")).surface(0.1, 0.0).at(place).turned(turn(Vec3::Y, angle));
        scene.put(if i == 0 { gear.named("driver").kinematic().spinning(Vec3::Y) } else { gear });
        // The next lies to the left or right of the way, in turn, its gap where this one has a tooth (each by its number of teeth).
        let next = TEETH[(i + 1) as usize % TEETH.len()];
        let heading = if i % 2 == 0 { 0.5 } else { -0.5 };
        let (sin, cos) = libm::sincosf(heading);
        place += Vec3::new(cos, 0.0, -sin) * (0.5 * MODULE * (teeth + next) as f32);
        let phase = (heading - angle) * teeth as f32 / TAU;
        angle = heading + PI - TAU * (0.5 - phase) / next as f32;
    }
    scene
}

/// All sorts of things fall on hills.
pub(super) fn hills(count: u32) -> Scene {
    let mut scene = Scene::new(
        "hills",
        "Gears, jacks, knots, letters, mugs, rings, balls and boxes fall on hills: an open mesh.",
    );
    toy_meshes(&mut scene);
    let side = square_side(count);
    let half_width = (1.0 * side as f32).max(10.0);
    let cells = (4.0 * half_width) as u32;
    let terrain = TerrainEntry { half_width, height: 3.0, hill: 7.0, cells, seed: 1 };
    with_mesh(&mut scene, "hills", MeshEntry { open: true, ..terrain.into() });
    scene.put(mesh("hills").named("hills").fixed());
    let mut noise = Noise::new(47);
    for i in 0..count {
        let place = scattered(i, (side, 1.6), &mut noise).with_y(noise.between(4.0, 6.0));
        // Each row begins with another kind.
        scene.put(toy(i + i / side).at(place).turned(noise.rotation()));
    }
    scene
}

#[cfg(test)]
mod tests {
    use forerun_dynamics::BodyKind;
    use forerun_geometry::Shape;

    use super::*;

    #[test]
    fn nothing_overlaps_at_the_start() {
        // Their usual sizes.
        for scene in [mugs(40), bowl(60), chairs(50), letters(42), gears(8), hills(60)] {
            let bodies = scene.bodies().unwrap();
            let mut overlaps = Vec::new();
            for (i, a) in bodies.iter().enumerate() {
                for (j, b) in bodies[..i].iter().enumerate() {
                    // Things may lie on the ground, and hooks stick in their board.
                    let lies = matches!(a.shape, Shape::HalfSpace) || matches!(b.shape, Shape::HalfSpace);
                    let fixed = a.kind == BodyKind::Fixed && b.kind == BodyKind::Fixed;
                    let near = a.shape.aabb(&a.pose).overlaps(&b.shape.aabb(&b.pose));
                    if !lies && !fixed && near && a.shape.overlaps(&a.pose, &b.shape, &b.pose) {
                        overlaps.push((j, i));
                    }
                }
            }
            assert!(overlaps.is_empty(), "{}: bodies {overlaps:?}", scene.name);
            // Of the meshes that are made here all triangles at sharp edges are found.
            let crowded = |shape: &Shape| matches!(shape, Shape::Mesh(m) if m.collider().crowded_cells() > 0);
            assert!(!bodies.iter().any(|body| crowded(&body.shape)), "{}", scene.name);
        }
    }

    #[test]
    fn sizes_count_what_they_say() {
        // Each hook is a body, beside the ground and the board.
        assert_eq!(mugs(41).bodies.len(), 2 + 21 + 41);
        assert_eq!(bowl(60).bodies.len(), 2 + 60);
        assert_eq!(chairs(50).bodies.len(), 1 + 50);
        assert_eq!(letters(42).bodies.len(), 1 + 42);
        assert_eq!(gears(8).bodies.len(), 1 + 2 * 8);
        assert_eq!(hills(60).bodies.len(), 1 + 60);
    }

    #[test]
    fn more_things_have_a_larger_bowl() {
        let size = |count| bowl(count).meshes["bowl"].scale;
        assert!(size(60) < 1.01 && size(200) > 1.4 && size(1000) > 2.5);
    }
}
