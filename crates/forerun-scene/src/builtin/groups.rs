//! Scenes to try the timeline on: groups that stay apart, that meet, that merge; heaps; and bodies too fast for a frame.

use forerun_geometry::Vec3;

use super::dissertation::{DOMINO_STEP, domino, tipped};
use super::noise::Noise;
use super::parts::{box_part, cube, cuboid, ground, mesh, sphere, turn, walls as pit};
use super::piles::{centred, cube_side, square_side};
use crate::mesh::TorusEntry;
use crate::{BodyEntry, MeshEntry, Scene, ShapeEntry};

/// Straight lines of dominoes, too far apart to meet; the first of each is tipped.
pub(super) fn domino_lines(count: u32) -> Scene {
    const LINE: u32 = 25;
    let mut scene = Scene::new(
        "domino_lines",
        "Lines of 25 dominoes, 2 m apart; the first of each is tipped over, and no line touches another.",
    );
    scene.put(ground());
    for line in 0..count {
        for i in 0..LINE {
            let foot = Vec3::new(DOMINO_STEP * centred(i, LINE), 0.0, 2.0 * centred(line, count));
            let body = domino(foot, Vec3::X);
            scene.put(if i == 0 { tipped(body, Vec3::X) } else { body });
        }
    }
    scene
}

/// Bins in a square, each with a pile: only walls of 4 cm are between one pile and the next, so that the bounds of bodies on both
/// sides overlap and the bodies never touch.
pub(super) fn walls(count: u32) -> Scene {
    const BIN: f32 = 2.2;
    const HALF_THICKNESS: f32 = 0.02;
    const HALF_HEIGHT: f32 = 1.25;
    let mut scene = Scene::new(
        "walls",
        "Piles of 36 boxes in bins with thin walls: their bounds overlap through the walls, but they never touch.",
    );
    scene.put(ground());
    let side = square_side(count);
    let rows = count.div_ceil(side);
    let (half_x, half_z) = (0.5 * BIN * side as f32, 0.5 * BIN * rows as f32);
    let up = Vec3::Y * HALF_HEIGHT;
    for i in 0..=side {
        let wall = cuboid(HALF_THICKNESS, HALF_HEIGHT, half_z).fixed();
        scene.put(wall.at(up + Vec3::X * (BIN * centred(i, side + 1))));
    }
    for i in 0..=rows {
        let wall = cuboid(half_x, HALF_HEIGHT, HALF_THICKNESS).fixed();
        scene.put(wall.at(up + Vec3::Z * (BIN * centred(i, rows + 1))));
    }
    let mut noise = Noise::new(17);
    for pile in 0..count {
        let foot = Vec3::new(centred(pile % side, side), 0.0, centred(pile / side, rows)) * BIN;
        for i in 0..36 {
            let cell = Vec3::new(centred(i % 3, 3), (i / 9) as f32, centred(i / 3 % 3, 3));
            let place = foot + cell * Vec3::new(0.7, 0.6, 0.7) + Vec3::Y * 0.5;
            scene.put(cuboid(0.25, 0.2, 0.3).at(place).turned(noise.rotation()));
        }
    }
    scene
}

/// A cue ball hits a triangle of balls on a table: each was an island of its own, and the break makes them one.
pub(super) fn billiard_break(rows: u32) -> Scene {
    const RADIUS: f32 = 0.028_575;
    const HALF_LENGTH: f32 = 1.27;
    const HALF_WIDTH: f32 = 0.635;
    const CUSHION: f32 = 0.1;
    let mut scene = Scene::new(
        "break",
        "A cue ball at 8 m/s breaks a triangle of billiard balls, each an island of its own until then.",
    );
    scene.seconds = 10.0;
    // Friction at a contact is the geometric mean: 0.2 on the cloth, 0.06 between balls.
    let (cloth, ball) = (0.2 * 0.2 / 0.06, 0.06);
    let grow = (rows as f32 * 0.12).max(1.0);
    let (half_length, half_width) = (HALF_LENGTH * grow, HALF_WIDTH * grow);
    let bed = cuboid(half_length + 2.0 * CUSHION, 0.1, half_width + 2.0 * CUSHION);
    scene.put(bed.named("table").fixed().surface(cloth, 0.0).at(Vec3::Y * -0.1));
    for side in [-1.0, 1.0] {
        let long = cuboid(half_length + 2.0 * CUSHION, 0.05, CUSHION).fixed().surface(cloth, 0.75);
        scene.put(long.at(Vec3::new(0.0, 0.05, side * (half_width + CUSHION))));
        let short = cuboid(CUSHION, 0.05, half_width).fixed().surface(cloth, 0.75);
        scene.put(short.at(Vec3::new(side * (half_length + CUSHION), 0.05, 0.0)));
    }
    let ball = sphere(RADIUS).of_mass(0.17).surface(ball, 0.95);
    let up = Vec3::Y * RADIUS;
    let cue = ball.clone().named("cue").at(up - Vec3::X * (0.5 * half_length));
    // A little off the axis: a break that is exactly symmetric never happens.
    scene.put(cue.moving(Vec3::new(8.0, 0.0, 0.05)));
    let pitch = 2.02 * RADIUS;
    for row in 0..rows {
        for i in 0..=row {
            let place = Vec3::new(0.866_025_4 * row as f32, 0.0, centred(i, row + 1)) * pitch;
            scene.put(ball.clone().at(up + place + Vec3::X * (0.5 * half_length - 0.4)));
        }
    }
    scene
}

/// Group A, a tray with three boxes, slides into group B, a stack of boxes, after 5 s; group Z, a ball that bounces on and on and a
/// line of falling dominoes, is 15 m away.
pub(super) fn meeting(_: u32) -> Scene {
    const SPEED: f32 = 2.0;
    const HALF_TRAY: f32 = 0.6;
    let mut scene = Scene::new(
        "meeting",
        "A tray with boxes (A) slides into a stack of boxes (B) after 5 s; a bouncing ball and dominoes (Z) stay far away.",
    );
    scene.seconds = 10.0;
    scene.put(ground().surface(0.5, 0.0));
    let rim = [0.05, 0.15, 0.3];
    let edge = HALF_TRAY - 0.05;
    let parts = vec![
        box_part([HALF_TRAY, 0.05, 0.3], [0.0; 3]),
        box_part(rim, [edge, 0.2, 0.0]),
        box_part(rim, [-edge, 0.2, 0.0]),
    ];
    let sliding = Vec3::X * SPEED;
    // Its front is 10 m from the stack.
    let tray = BodyEntry::new(ShapeEntry::Compound(parts)).named("A tray").surface(0.0, 0.0);
    let foot = Vec3::X * -(10.0 + HALF_TRAY);
    scene.put(tray.at(foot + Vec3::Y * 0.05).moving(sliding));
    for i in 0..3 {
        let block = cube(0.15).named(format!("A{i}")).surface(0.5, 0.0);
        scene.put(block.at(foot + Vec3::new(0.33 * centred(i, 3), 0.25, 0.0)).moving(sliding));
    }
    for level in 0..3 {
        let block = cuboid(0.25, 0.15, 0.3).named(format!("B{level}")).surface(0.5, 0.0);
        scene.put(block.at(Vec3::new(0.25, 0.15 + 0.3 * level as f32, 0.0)));
    }
    let away = Vec3::Z * 15.0;
    scene.put(sphere(0.25).named("Z ball").surface(0.5, 1.0).at(away + Vec3::Y * 2.0));
    for i in 0..8 {
        let foot = away + Vec3::new(DOMINO_STEP * (5.0 + i as f32), 0.0, 0.0);
        let body = domino(foot, Vec3::X).named(format!("Z{i}"));
        scene.put(if i == 0 { tipped(body, Vec3::X) } else { body });
    }
    scene
}

/// A chain of interlocked rings hangs from a fixed one; its end is thrown at a heap of boxes.
pub(super) fn swing(links: u32) -> Scene {
    const RADIUS: f32 = 0.3;
    const TUBE_RADIUS: f32 = 0.08;
    let mut scene = Scene::new(
        "swing",
        "A chain of interlocked rings of 384 triangles each hangs from a fixed one and swings into a heap of boxes.",
    );
    let torus = TorusEntry { radius: RADIUS, tube_radius: TUBE_RADIUS, segments: 24, sides: 8 };
    scene.meshes.insert("link".to_owned(), MeshEntry::from(torus));
    scene.put(ground());
    // From one link to the next where the tubes touch, less a little play.
    let pitch = 2.0 * (RADIUS - TUBE_RADIUS) - 0.01;
    let top = 0.8 + pitch * links as f32;
    for i in 0..=links {
        // The axis of a ring is y: laid over about z or about x, in turn.
        let axis = if i % 2 == 0 { Vec3::Z } else { Vec3::X };
        let link = mesh("link").turned(turn(axis, std::f32::consts::FRAC_PI_2)).surface(0.3, 0.0);
        let down = pitch * i as f32;
        let place = Vec3::Y * (top - down);
        scene.put(if i == 0 {
            link.named("hook").fixed().at(place)
        } else {
            // Like a pendulum: each link as fast as it is far from the hook.
            link.at(place).moving(Vec3::X * (1.2 * down))
        });
    }
    for i in 0..36 {
        let cell =
            Vec3::new(1.5 + 0.45 * (i % 3) as f32, 0.2 + 0.41 * (i / 9) as f32, 0.45 * centred(i / 3 % 3, 3));
        scene.put(cube(0.2).at(cell));
    }
    scene
}

/// Boxes of many sizes fall a little way into a pit and lie there as one heap.
pub(super) fn pile(count: u32) -> Scene {
    let mut scene = Scene::new(
        "pile",
        "Boxes of many sizes fall into a pit from just above each other: one heap that comes to rest.",
    );
    scene.seconds = 20.0;
    // As wide as it is high, about: 10 x 10 a layer for 1000 boxes.
    let side = cube_side(count);
    scene.put(ground());
    pit(&mut scene, 0.5 * side as f32, 1.5 * side as f32);
    let mut noise = Noise::new(23);
    for i in 0..count {
        let (layer, cell) = (i / (side * side), i % (side * side));
        let lattice =
            Vec3::new(centred(cell % side, side), 0.5 + 0.9 * layer as f32, centred(cell / side, side));
        let mut half = || noise.between(0.2, 0.4);
        let body = cuboid(half(), half(), half());
        scene.put(body.at(lattice).turned(noise.rotation()));
    }
    scene
}

/// Elastic balls without gravity in a closed box: a frame of 1/60 s takes them 0.83 m, the walls are 0.1 m thick.
pub(super) fn hail(count: u32) -> Scene {
    const HALF: f32 = 5.0;
    const HALF_THICKNESS: f32 = 0.05;
    const RADIUS: f32 = 0.1;
    const SPEED: f32 = 50.0;
    let mut scene = Scene::new(
        "hail",
        "Elastic balls at 50 m/s in a closed box with walls of 0.1 m: none may get out, and their energy stays.",
    )
    .timed(10.0, 1.0 / 60.0, 0.0);
    let outer = HALF + 2.0 * HALF_THICKNESS;
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let half = Vec3::splat(outer) + axis * (HALF_THICKNESS - outer);
        for side in [-1.0, 1.0] {
            let wall = cuboid(half.x, half.y, half.z).fixed().surface(0.0, 1.0);
            scene.put(wall.at(axis * (side * (HALF + HALF_THICKNESS))));
        }
    }
    // Cells of a cubic lattice, one ball in each, so that none overlap.
    let side = cube_side(count);
    let pitch = (2.0 * HALF - 2.0 * RADIUS) / side as f32;
    let play = (0.5 * pitch - RADIUS).max(0.0);
    let mut noise = Noise::new(29);
    for i in 0..count {
        let cell = Vec3::new(
            centred(i % side, side),
            centred(i / side % side, side),
            centred(i / (side * side), side),
        );
        let shift = Vec3::new(noise.about_zero(play), noise.about_zero(play), noise.about_zero(play));
        let ball = sphere(RADIUS).surface(0.0, 1.0).at(cell * pitch + shift);
        scene.put(ball.moving(noise.rotation() * Vec3::X * SPEED));
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(body: &BodyEntry) -> Vec3 {
        Vec3::from_array(body.position)
    }

    #[test]
    fn sizes_count_what_they_say() {
        assert_eq!(domino_lines(40).bodies.len(), 1 + 1000);
        // 5 x 4 bins have 6 and 5 walls.
        assert_eq!(walls(20).bodies.len(), 1 + 6 + 5 + 20 * 36);
        assert_eq!(billiard_break(4).bodies.len(), 5 + 1 + 10);
        assert_eq!(swing(8).bodies.len(), 1 + 1 + 8 + 36);
        assert_eq!(pile(1000).bodies.len(), 1 + 4 + 1000);
        assert_eq!(hail(500).bodies.len(), 6 + 500);
    }

    #[test]
    fn balls_of_the_hail_are_inside_and_apart_at_50_m_per_s() {
        let scene = hail(500);
        let balls = &scene.bodies[6..];
        for (i, ball) in balls.iter().enumerate() {
            assert!(place(ball).abs().max_element() < 4.9);
            assert!((Vec3::from_array(ball.velocity).length() - 50.0).abs() < 1e-4);
            assert!(balls[..i].iter().all(|other| place(ball).distance(place(other)) > 0.2));
        }
    }

    #[test]
    fn billiard_balls_are_on_the_table_and_apart() {
        for rows in [1, 4, 5, 50] {
            let scene = billiard_break(rows);
            let half_extents = Vec3::from_array(scene.bodies[0].position) + Vec3::Y * 0.1;
            assert!(half_extents.length() < 1e-6);
            let cushions: Vec<f32> =
                scene.bodies[1..5].iter().map(|b| place(b).abs().max_element()).collect();
            let inside = cushions.iter().copied().fold(0.0, f32::max) - 0.1;
            for (i, ball) in scene.bodies[5..].iter().enumerate() {
                assert!(place(ball).x.abs() < inside - 0.028, "{rows} rows, ball {i}: {}", place(ball));
                let others = &scene.bodies[5..5 + i];
                assert!(others.iter().all(|other| place(ball).distance(place(other)) > 0.0573));
            }
        }
    }

    #[test]
    fn neighbouring_links_are_interlocked() {
        let scene = swing(8);
        for pair in scene.bodies[1..=9].windows(2) {
            let distance = place(&pair[0]).distance(place(&pair[1]));
            // The tube of one goes through the hole of the other, without touching it.
            assert!(distance < 0.44 && distance > 0.3, "{distance}");
        }
    }
}
