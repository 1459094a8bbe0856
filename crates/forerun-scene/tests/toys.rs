//! The scenes of made meshes do what they are for.

use forerun_dynamics::{Unobserved, World};
use forerun_scene::Scene;

const GRAVITY: f32 = 9.81;

fn start(scene: &str) -> World {
    let scene = Scene::open(scene).unwrap();
    let mut world = World::new(scene.environment());
    for body in scene.bodies().unwrap() {
        world.add(&body).unwrap();
    }
    world
}

fn step(world: &mut World, frames: u32) {
    for _ in 0..frames {
        world.step(&mut Unobserved);
    }
}

#[test]
fn nothing_explodes_or_falls_through() {
    for scene in ["mugs:4", "bowl:8", "chairs:9", "letters:9", "gears:3", "hills:9"] {
        let mut world = start(scene);
        let highest = world.states().iter().fold(0.0_f32, |y, state| y.max(state.position.y));
        // As fast as one that fell from the highest place, and a little for spins.
        let fastest = (2.0 * GRAVITY * (highest + 1.0)).sqrt();
        for frame in 0..150 {
            step(&mut world, 1);
            for (i, state) in world.states().iter().enumerate() {
                assert!(
                    state.position.is_finite() && state.rotation.is_finite(),
                    "{scene}, frame {frame}, body {i}"
                );
                assert!(state.position.y > -0.2, "{scene}, frame {frame}, body {i}: {}", state.position);
                assert!(
                    state.velocity.length() < fastest,
                    "{scene}, frame {frame}, body {i}: {}",
                    state.velocity
                );
            }
        }
    }
}

#[test]
fn a_mug_hangs_on_its_hook() {
    let mut world = start("mugs:1");
    let mug = world.states().len() - 1;
    let before = world.states()[mug].position;
    step(&mut world, 600);
    let after = world.states()[mug].position;
    assert!((after - before).length() < 0.2, "{before} {after}");
}

#[test]
fn a_bowl_stands_and_holds_what_falls_into_it() {
    let mut world = start("bowl:24");
    step(&mut world, 600);
    let bowl = world.states()[1];
    assert!((bowl.rotation * glam::Vec3::Y).y > 0.999, "it stands");
    for (i, state) in world.states().iter().enumerate().skip(2) {
        let off = state.position - bowl.position;
        assert!(
            off.x.hypot(off.z) < 4.0 && (0.3..3.0).contains(&state.position.y),
            "{i}: {}",
            state.position
        );
    }
}

#[test]
fn gears_turn_each_other_by_their_teeth() {
    let mut world = start("gears:4");
    // Every second body after the ground is a gear on the peg before it.
    let gears = [2, 4, 6, 8];
    step(&mut world, 240);
    let mut turned = [0.0; 4];
    for _ in 0..720 {
        step(&mut world, 1);
        for (turned, gear) in turned.iter_mut().zip(gears) {
            *turned += world.states()[gear].angular_velocity.y / 720.0;
        }
    }
    for (mean, exact) in turned.into_iter().zip([1.0, -12.0 / 20.0, 12.0 / 15.0, -1.0]) {
        assert!((mean - exact).abs() < 0.03, "{turned:?}");
    }
}
