//! Springs, slow drivers, slow bounces and thin plates: what each needs of the step.

mod common;

use common::{cuboid, ground, run, with_material, world_of};
use forerun_dynamics::{BodyDef, BodyKind, Environment, Spring, World};
use forerun_geometry::{Shape, Vec3};

#[test]
fn slow_elastic_balls_bounce_where_gravity_does_not_act() {
    for speed in [0.02, 0.08, 0.5] {
        let ball = |x: f32, v: f32| {
            let mut def = with_material(BodyDef::new(Shape::sphere(0.5).expect("above 0")), 0.0, 1.0);
            def.pose.position = Vec3::new(x, 5.0, 0.0);
            def.velocity.x = v;
            def.gravity_scale = 0.0;
            def
        };
        let mut world = world_of(&[ball(-0.55, speed), ball(0.55, -speed)]);
        run(&mut world, 600);
        let after = world.states()[1].velocity.x;
        assert!((after / speed - 1.0).abs() < 0.01, "at {speed} m/s the ball leaves at {after} m/s");
    }
}

#[test]
fn a_slow_platform_carries_what_stands_on_it() {
    let mut platform = with_material(cuboid(Vec3::new(0.5, 0.1, 0.5), Vec3::new(0.0, 1.0, 0.0)), 1.0, 0.0);
    platform.kind = BodyKind::Kinematic;
    platform.velocity.x = 0.04;
    let block = with_material(cuboid(Vec3::splat(0.2), Vec3::new(0.0, 1.3, 0.0)), 1.0, 0.0);
    let mut world = world_of(&[ground(), platform, block]);
    run(&mut world, 600);
    let (platform, block) = (world.states()[1].position, world.states()[2].position);
    assert!((block.x - platform.x).abs() < 0.01, "the platform is at {platform}, the block at {block}");
}

#[test]
fn a_held_body_does_not_jump_through_a_wall() {
    let mut wall = cuboid(Vec3::new(0.02, 2.0, 2.0), Vec3::new(0.4, 2.0, 0.0));
    wall.kind = BodyKind::Fixed;
    let mut world = world_of(&[ground(), wall, cuboid(Vec3::splat(0.2), Vec3::new(0.0, 1.0, 0.0))]);
    let target = Vec3::new(8.0, 1.0, 0.0);
    world.bodies_mut()[2].spring =
        Some(Spring { anchor: Vec3::ZERO, target, frequency_hz: 5.0, damping_ratio: 1.0 });
    run(&mut world, 60);
    let x = world.states()[2].position.x;
    assert!(x < 0.25, "it went through, to {x} m");
}

#[test]
fn a_spring_turns_a_plank_that_lies_on_the_floor() {
    // Frictionless, held at one end and pulled across: the spring's moment is the only one about the vertical.
    let plank = with_material(cuboid(Vec3::new(1.0, 0.1, 0.1), Vec3::new(0.0, 0.1, 0.0)), 0.0, 0.0);
    let mut world = world_of(&[with_material(ground(), 0.0, 0.0), plank]);
    world.environment.settings.rest_seconds = 0.0;
    world.bodies_mut()[1].spring = Some(Spring {
        anchor: Vec3::new(1.0, 0.0, 0.0),
        target: Vec3::new(1.0, 0.1, 0.02),
        frequency_hz: 1.0,
        damping_ratio: 1.0,
    });
    run(&mut world, 6);
    // A force at the end of a rod: the moment m a arm over the inertia m l² / 3.
    let s = &world.states()[1];
    let (spin, speed) = (-s.angular_velocity.y, s.velocity.z);
    let expected = speed / ((4.0 + 0.04) / 12.0);
    assert!(
        speed > 0.0 && (spin / expected - 1.0).abs() < 0.05,
        "it turns at {spin} rad/s, expected {expected}"
    );
}

#[test]
fn thin_plates_that_lie_still_are_not_cut_into_slices() {
    let mut defs = vec![ground()];
    for i in 0..3 {
        defs.push(cuboid(Vec3::new(0.3, 0.004, 0.3), Vec3::new(0.0, 0.004 + 0.008 * i as f32, 0.0)));
    }
    defs.push(cuboid(Vec3::splat(0.2), Vec3::new(0.0, 0.224, 0.0)));
    let mut world = World::new(Environment::default());
    world.environment.settings.frame_seconds = 0.03;
    for def in &defs {
        world.add(def).expect("the definition is possible");
    }
    run(&mut world, 200);
    let full = world.environment.settings.rest_frames();
    assert!(world.states()[1..].iter().all(|s| s.rest > full), "they do not come to rest");
    let y = world.states()[4].position.y;
    assert!((y - 0.224).abs() < 5e-3, "the block is at {y} m");
}
