//! Towers: structures that have to stand, with the sizes of Box3D's and PEEL's samples: cubes, planks, cards.

use forerun_geometry::Vec3;

use super::parts::{cube, cuboid, ground, radians, turn};
use super::piles::put_pyramid;
use crate::Scene;

/// Friction and gravity (m/s²) of Box3D's samples.
const FRICTION: f32 = 0.6;
const GRAVITY: f32 = 10.0;

fn on_ground(name: &str, description: &str, seconds: f32) -> Scene {
    let mut scene = Scene::new(name, description).timed(seconds, 1.0 / 60.0, GRAVITY);
    scene.put(ground().surface(FRICTION, 0.0));
    scene
}

fn put_column(scene: &mut Scene, count: u32, (lowest, pitch): (f32, f32)) {
    for i in 0..count {
        scene.put(cube(0.5).surface(FRICTION, 0.0).at(Vec3::Y * (lowest + pitch * i as f32)));
    }
}

/// Cubes of 1 m that touch exactly.
pub(super) fn tower(count: u32) -> Scene {
    let mut scene = on_ground("tower", "Cubes of 1 m on top of each other, exactly touching.", 120.0);
    put_column(&mut scene, count, (0.5, 1.0));
    scene
}

/// The same with gaps of 0.25 m, all falling (Box3D, *Box Stack*).
pub(super) fn falling_tower(count: u32) -> Scene {
    let mut scene = on_ground("falling_tower", "Cubes of 1 m above each other, 0.25 m apart, fall.", 30.0);
    put_column(&mut scene, count, (0.75, 1.25));
    scene
}

/// Two planks a layer, each layer across the one below; layers begin 1 cm apart and the lowest halfway in the ground
/// (after Box3D, *Jenga Stack*).
pub(super) fn jenga(layers: u32) -> Scene {
    let mut scene = on_ground("jenga", "Layers of two planks, each across the one below.", 30.0);
    for layer in 0..layers {
        let across = layer % 2 == 1;
        let height = (2.1 * layer as f32 + 0.5) * 0.1;
        for side in [-0.8, 0.8] {
            let plank = if across { cuboid(0.1, 0.1, 1.0) } else { cuboid(1.0, 0.1, 0.1) };
            let place = if across { Vec3::new(side, height, 0.0) } else { Vec3::new(0.0, height, side) };
            scene.put(plank.surface(FRICTION, 0.0).at(place));
        }
    }
    scene
}

/// A pyramid of 5 cm cubes (Box3D, *Tiny Pyramid*).
pub(super) fn tiny_pyramid(base: u32) -> Scene {
    let mut scene = on_ground("tiny_pyramid", "A pyramid of 5 cm cubes, exactly touching.", 30.0);
    put_pyramid(&mut scene, base, &cube(0.025).surface(FRICTION, 0.0), Vec3::ZERO);
    scene
}

/// A house of cards 2 mm thick: pairs that lean on each other, and cards across them (PEEL, *CardHouse*).
pub(super) fn card_house(levels: u32) -> Scene {
    const PITCH: f32 = 0.175;
    let mut scene = Scene::new("card_house", "Cards of 40 x 20 x 0.2 cm lean on each other and carry more.")
        .timed(10.0, 1.0 / 240.0, 9.81);
    scene.put(ground().surface(0.7, 0.0));
    // x is through the card, y along it.
    let card = cuboid(0.001, 0.2, 0.1).of_mass(0.01).surface(0.7, 0.0);
    let lean = |degrees: f32| turn(Vec3::Z, radians(degrees));
    for level in 0..levels {
        let y = 0.18 + 0.37 * level as f32;
        let pairs = levels - level;
        for pair in 0..pairs {
            let x = PITCH * (level + 2 * pair) as f32;
            if pair + 1 < pairs {
                scene.put(card.clone().at(Vec3::new(x + 0.25, y + 0.185, 0.0)).turned(lean(90.0)));
            }
            scene.put(card.clone().at(Vec3::new(x, y, 0.0)).turned(lean(-25.0)));
            scene.put(card.clone().at(Vec3::new(x + PITCH, y, 0.0)).turned(lean(25.0)));
        }
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_of_the_samples() {
        assert_eq!(tower(40).bodies.len(), 1 + 40);
        assert_eq!(falling_tower(40).bodies.len(), 1 + 40);
        assert_eq!(jenga(30).bodies.len(), 1 + 60);
        assert_eq!(tiny_pyramid(30).bodies.len(), 1 + 465);
        assert_eq!(card_house(5).bodies.len(), 1 + 40);
    }
}
