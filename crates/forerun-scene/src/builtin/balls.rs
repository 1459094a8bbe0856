//! Cubes of balls without friction: they collapse, or bounce for ever (SimBenchmark, *666* and *elastic 666*).

use forerun_geometry::Vec3;

use super::noise::Noise;
use super::parts::{ground, sphere};
use crate::Scene;

const RADIUS: f32 = 0.1;
const PITCH: f32 = 0.21;

/// `side`³ balls of 10 kg, the lowest centres at `lowest` (metres), each moved by up to 1 mm along every axis.
fn cube_of_balls(mut scene: Scene, side: u32, (lowest, restitution): (f32, f32)) -> Scene {
    let ball = sphere(RADIUS).of_mass(10.0).surface(0.0, restitution);
    scene.put(ground().surface(0.0, restitution));
    let mut noise = Noise::new(42);
    for i in 0..side * side * side {
        let cell = Vec3::new((i % side) as f32, (i / (side * side)) as f32, (i / side % side) as f32);
        let mut shift = || noise.between(0.0, 0.001);
        let shift = Vec3::new(shift(), shift(), shift());
        scene.put(ball.clone().at(cell * PITCH + shift + Vec3::Y * lowest));
    }
    scene.timed(10.0, 0.01, 9.81)
}

/// Restitution 0, from just above the ground.
pub(super) fn cube_collapses(side: u32) -> Scene {
    let scene = Scene::new("ball_cube", "A cube of balls without friction falls apart: none may overlap.");
    cube_of_balls(scene, side, (0.101, 0.0))
}

/// Restitution 1, from 1 m above the ground.
pub(super) fn cube_bounces(side: u32) -> Scene {
    let scene = Scene::new("elastic_ball_cube", "A cube of elastic balls falls apart: their energy stays.");
    cube_of_balls(scene, side, (1.101, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_start_apart() {
        let scene = cube_collapses(6);
        assert_eq!(scene.bodies.len(), 1 + 216);
        let places: Vec<Vec3> = scene.bodies[1..].iter().map(|b| Vec3::from_array(b.position)).collect();
        for (i, a) in places.iter().enumerate() {
            assert!(a.y > RADIUS);
            assert!(places[..i].iter().all(|b| a.distance(*b) > 2.0 * RADIUS));
        }
    }
}
