//! Small scenes with a point: cradle and slope; and structures that have to stand: capstone, arch, plank, kapla.

use forerun_geometry::Vec3;

use super::parts::{Incline, cube, cuboid, ground, radians, sphere, turn};
use super::piles::put_pyramid;
use crate::shape::HullEntry;
use crate::{BodyEntry, Scene, ShapeEntry};

/// A row of balls between two walls; the shock runs to and fro.
pub(super) fn cradle(count: u32) -> Scene {
    const RADIUS: f32 = 0.25;
    let mut scene = Scene::new(
        "cradle",
        "Elastic balls in a row: one comes in, one leaves on the other side, and comes back from the wall.",
    );
    scene.put(ground().surface(0.0, 0.0));
    // Gaps of 2 % of the radius: each impact is one between two balls, and the textbook's answer holds.
    let pitch = 2.02 * RADIUS;
    let half_row = 0.5 * pitch * count as f32;
    for side in [-1.0, 1.0] {
        let wall = cuboid(0.25, 0.5, 0.5).fixed().surface(0.0, 1.0);
        scene.put(wall.at(Vec3::new(side * (half_row + 2.25), 0.5, 0.0)));
    }
    let ball = sphere(RADIUS).surface(0.0, 1.0);
    let incoming = Vec3::new(-half_row - 1.0, RADIUS, 0.0);
    scene.put(ball.clone().named("incoming").at(incoming).moving(Vec3::X * 3.0));
    for i in 0..count {
        let x = pitch * (i as f32 + 0.5) - half_row;
        scene.put(ball.clone().at(Vec3::new(x, RADIUS, 0.0)));
    }
    scene
}

/// Blocks of different friction on a ramp of 20 degrees.
pub(super) fn slope(_: u32) -> Scene {
    let mut scene = Scene::new(
        "slope",
        "Blocks on a ramp of 20 degrees: one stays, one slides and stops, one slides for ever, one tumbles.",
    );
    let ramp = Incline::new(radians(20.0));
    let deck = cuboid(10.0, 0.5, 3.0).named("ramp").fixed().surface(1.0, 0.0);
    scene.put(ground());
    let middle = Vec3::Y * 4.0;
    scene.put(deck.at(middle - ramp.normal * 0.5).turned(ramp.rotation));
    // Friction at the contact is the geometric mean with the ramp's 1: the square of what is wanted.
    let blocks = [("stays", 0.5, 0.0), ("stops", 0.5, 1.25), ("slides", 0.25, 0.0)];
    for (i, (name, friction, speed)) in blocks.into_iter().enumerate() {
        let z = 1.2 * (i as f32 - 1.5);
        let place = middle - ramp.down * 8.0 + ramp.normal * 0.25 + Vec3::Z * z;
        let block = cube(0.25).named(name).surface(friction * friction, 0.0);
        scene.put(block.at(place).turned(ramp.rotation).moving(ramp.down * speed));
    }
    let place = middle - ramp.down * 8.0 + ramp.normal * 0.6 + Vec3::Z * 1.8;
    scene.put(cuboid(0.15, 0.6, 0.15).named("tumbles").at(place).turned(ramp.rotation));
    scene
}

/// Three pyramids of 10 rows whose top cubes are dropped and weigh 1/3, 2/3 and all of `ratio` times the others.
pub(super) fn capstone(ratio: u32) -> Scene {
    let mut scene =
        Scene::new("capstone", "Heavy top cubes fall on pyramids of light cubes, which must carry them.")
            .timed(30.0, 1.0 / 60.0, 10.0);
    scene.put(ground().surface(0.6, 0.0));
    let brick = cube(1.0).surface(0.6, 0.0).of_density(1.0);
    for third in 1..=3 {
        let foot = Vec3::X * (30.0 * (third as f32 - 2.0));
        put_pyramid(&mut scene, 10, &brick, foot);
        // The cube put last is the top one.
        if let Some(top) = scene.bodies.last_mut() {
            top.density = Some((ratio as f32 * third as f32 / 3.0).max(1.0));
            top.position[1] += 2.0;
        }
    }
    scene
}

/// Inner and outer corners of one half of the arch, from the ground to the keystone (Box3D's sample of this name). Quarter metres.
const ARCH: [([f32; 2], [f32; 2]); 9] = [
    ([16.0, 0.0], [24.0, 0.0]),
    ([14.938_037, 5.133_601], [22.336_195, 6.022_998]),
    ([13.798_717, 10.249_281], [20.549_37, 12.009_644]),
    ([12.562_53, 15.341_07], [18.608_546, 17.947_032]),
    ([11.200_41, 20.398_565], [16.467_693, 23.813_679]),
    ([9.665_212, 25.403_7], [14.053_25, 29.570_794]),
    ([7.871_799, 30.317_934], [11.235_51, 35.137_758]),
    ([5.635_2, 35.038_207], [7.752_568, 40.304_51]),
    ([2.405_938, 39.095_54], [3.016_932, 44.288_916]),
];

/// Seventeen wedges that hold each other, and four boxes on top.
pub(super) fn arch(_: u32) -> Scene {
    let mut scene = Scene::new("arch", "Seventeen wedges stand by holding each other, and carry four boxes.")
        .timed(30.0, 1.0 / 60.0, 10.0);
    scene.put(ground().surface(0.6, 0.0));
    let mirrored = |[x, y]: [f32; 2]| [-x, y];
    for side in [1.0, -1.0] {
        for pair in ARCH.windows(2) {
            let ((inner, outer), (inner_next, outer_next)) = (pair[0], pair[1]);
            let face = [inner, outer, outer_next, inner_next].map(|[x, y]| [side * x, y]);
            scene.put(wedge(face));
        }
    }
    let (inner, outer) = ARCH[ARCH.len() - 1];
    scene.put(wedge([inner, outer, mirrored(outer), mirrored(inner)]).named("keystone"));
    for i in 0..4 {
        let place = Vec3::Y * (0.5 + 0.25 * outer[1] + i as f32);
        scene.put(cuboid(2.0, 0.5, 0.5).surface(0.6, 0.0).of_density(200.0).at(place));
    }
    scene
}

/// A block 1 m deep with a four-sided face, placed by its middle.
fn wedge(face: [[f32; 2]; 4]) -> BodyEntry {
    let corners = face.map(|[x, y]| Vec3::new(0.25 * x, 0.25 * y, 0.0));
    let middle = (corners[0] + corners[1] + corners[2] + corners[3]) * 0.25;
    let points = [-0.5, 0.5].iter().flat_map(|&z| corners.map(|c| (c - middle + Vec3::Z * z).to_array()));
    let hull = ShapeEntry::Hull(HullEntry { points: points.collect() });
    BodyEntry::new(hull).at(middle).surface(0.6, 0.0).of_density(200.0)
}

/// A plank over an edge, seven cubes falling on it, and a heavy box that makes it a catapult.
pub(super) fn plank(_: u32) -> Scene {
    let mut scene = Scene::new(
        "plank",
        "Seven cubes settle on a plank over an edge until a box of 100 kg hits its far end.",
    )
    .timed(20.0, 1.0 / 60.0, 9.8);
    // The paper's friction at the ground and the base is 0.3; with cubes of 0.5 the geometric mean needs 0.18.
    scene.put(ground().surface(0.18, 0.0));
    scene.put(cube(2.0).named("base").fixed().surface(0.18, 0.1).at(Vec3::Y * 2.0));
    let plank = cuboid(5.0, 0.25, 1.0).named("plank").of_mass(10.0).surface(0.5, 0.1);
    scene.put(plank.at(Vec3::new(2.0, 4.25, 0.0)));
    let cubes = [
        [-0.65, 4.0, 0.0],
        [0.65, 5.0, 0.0],
        [0.05, 7.0, 0.0],
        [0.0, 9.0, 0.05],
        [-0.05, 14.0, -0.05],
        [0.0, 17.0, 0.0],
        [0.0, 19.0, 0.0],
    ];
    for (i, place) in cubes.into_iter().enumerate() {
        let block = cube(0.5).of_mass(1.0).surface(0.5, 0.3).at(Vec3::from_array(place) + Vec3::Y * 2.0);
        let last = i + 1 == cubes.len();
        scene.put(if last { block.turned(turn(Vec3::Y, radians(45.0))) } else { block });
    }
    let falling = cube(1.0).named("falling").of_mass(100.0).surface(0.5, 0.05);
    scene.put(falling.at(Vec3::new(5.8, 75.7, 0.0)));
    scene
}

/// A tower of thin blocks (SimBenchmark's Kapla tower; its z axis is our y).
pub(super) fn kapla(floors: u32) -> Scene {
    let mut scene =
        Scene::new("kapla", "A tower of loose blocks, 17 a floor, which is stable and has to stand.")
            .timed(60.0, 0.01, 9.81);
    scene.put(ground().surface(0.8, 0.0));
    let block = |x: f32, y: f32, z: f32| cuboid(x, y, z).of_mass(10.0).surface(0.8, 0.0);
    for floor in 0..floors {
        let foot = Vec3::Y * (0.2 * floor as f32);
        for j in 0..8 {
            scene.put(block(0.025, 0.05, 0.125).at(foot + Vec3::new(0.2 * j as f32, 0.05, 0.0)));
        }
        for j in 0..4 {
            scene.put(block(0.1, 0.05, 0.025).at(foot + Vec3::new(0.4 * j as f32 + 0.1, 0.15, -0.1)));
        }
        for j in 0..3 {
            scene.put(block(0.1, 0.05, 0.025).at(foot + Vec3::new(0.4 * j as f32 + 0.3, 0.15, 0.1)));
        }
        for x in [0.1, 1.3] {
            scene.put(block(0.1, 0.05, 0.025).at(foot + Vec3::new(x, 0.15, 0.1)));
        }
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_of_the_arch_share_a_face() {
        let scene = arch(1);
        let world = |body: &BodyEntry| -> Vec<Vec3> {
            let ShapeEntry::Hull(HullEntry { points }) = &body.shape else { return Vec::new() };
            points.iter().map(|p| Vec3::from_array(*p) + Vec3::from_array(body.position)).collect()
        };
        let wedges: Vec<Vec<Vec3>> = scene.bodies[1..18].iter().map(world).collect();
        for pair in [(0, 1), (6, 7), (7, 16), (8, 9), (15, 16)] {
            let (a, b) = (&wedges[pair.0], &wedges[pair.1]);
            let shared = a.iter().filter(|p| b.iter().any(|q| p.distance(*q) < 1e-5)).count();
            assert_eq!(shared, 4, "{pair:?}");
        }
    }

    #[test]
    fn slope_blocks_lie_on_the_ramp() {
        let scene = slope(1);
        let ramp = Incline::new(radians(20.0));
        for block in &scene.bodies[2..5] {
            let height = (Vec3::from_array(block.position) - Vec3::Y * 4.0).dot(ramp.normal);
            assert!((height - 0.25).abs() < 1e-5, "{height}");
        }
    }

    #[test]
    fn kapla_has_seventeen_blocks_a_floor() {
        assert_eq!(kapla(6).bodies.len(), 1 + 102);
    }
}
