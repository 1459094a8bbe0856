//! Who comes to rest, who does not, and what wakes.

mod common;

use common::{UNIT, cuboid, ground, pyramid, rain, run, tilted_gravity, with_material, world_of};
use forerun_dynamics::{BodyDef, BodyKind, Environment, World};
use forerun_geometry::{Quat, Shape, Vec3};

/// Dynamic bodies that are not at a fixpoint.
fn awake(world: &World) -> usize {
    let full = world.environment.settings.rest_frames();
    world.bodies().iter().zip(world.states()).filter(|(b, s)| b.is_dynamic() && s.rest <= full).count()
}

#[test]
fn heaps_come_to_rest() {
    for seed in 1..4 {
        // What is round may still roll over the floor; boxes may not.
        let mut defs = rain(150, seed);
        defs.retain(|d| matches!(d.shape, Shape::Cuboid(_) | Shape::HalfSpace));
        let mut world = world_of(&defs);
        run(&mut world, 600);
        assert_eq!(awake(&world), 0, "heap {seed}: boxes are awake after 10 s");
        let before = world.state_hash();
        run(&mut world, 10);
        assert_eq!(world.state_hash(), before, "heap {seed} moves");
    }
}

#[test]
fn of_a_heap_with_balls_hardly_any_are_awake() {
    for seed in 1..4 {
        let mut world = world_of(&rain(150, seed));
        run(&mut world, 900);
        let full = world.environment.settings.rest_frames();
        let moving = |i: usize| world.bodies()[i].is_dynamic() && world.states()[i].rest < full;
        let moving: Vec<usize> = (0..world.states().len()).filter(|&i| moving(i)).collect();
        assert!(moving.len() <= 3, "heap {seed}: bodies {moving:?} are awake after 15 s");
    }
}

#[test]
fn fallen_dominoes_come_to_rest() {
    let mut defs = vec![ground()];
    for i in 0..30 {
        defs.push(cuboid(Vec3::new(0.05, 0.25, 0.125), Vec3::new(0.2 * i as f32, 0.25, 0.0)));
    }
    defs[1].velocity.x = 1.0;
    defs[1].angular_velocity.z = -4.0;
    let mut world = world_of(&defs);
    run(&mut world, 600);
    assert!(world.states()[30].position.y < 0.2, "the last one stands: {}", world.states()[30].position.y);
    assert_eq!(awake(&world), 0, "dominoes are awake after 10 s");
}

#[test]
fn a_block_that_barely_slides_goes_on() {
    // tan 26.565 degrees = 0.5: what friction leaves is less than 1 % of gravity.
    let block = with_material(cuboid(UNIT, Vec3::new(0.0, 0.5, 0.0)), 0.49, 0.0);
    let mut world = World::new(Environment { gravity: tilted_gravity(26.565), ..Environment::default() });
    for def in [with_material(ground(), 0.49, 0.0), block] {
        world.add(&def).expect("the definition is possible");
    }
    run(&mut world, 300);
    let (x, expected) = (world.states()[1].position.x, 0.5 * 9.81 * 25.0 * (0.447_21 - 0.49 * 0.894_43));
    assert!((x / expected - 1.0).abs() < 0.02, "it slid {x} m, expected {expected} m");
}

#[test]
fn what_slides_or_rolls_slowly_goes_on() {
    let mut block = with_material(cuboid(UNIT, Vec3::new(0.0, 0.5, 0.0)), 0.0, 0.0);
    block.velocity.x = 0.01;
    let mut ball = BodyDef::new(Shape::sphere(0.25).expect("above 0")).at(Vec3::new(0.0, 0.25, 5.0));
    ball.velocity.x = 0.025;
    ball.angular_velocity.z = -0.1;
    let mut world = world_of(&[ground(), block, ball]);
    run(&mut world, 1200);
    for (i, expected) in [(1, 0.2), (2, 0.5)] {
        let x = world.states()[i].position.x;
        assert!((x - expected).abs() < 0.005, "body {i} is at {x} m after 20 s, expected {expected} m");
    }
}

#[test]
fn what_rests_goes_with_a_slow_carrier() {
    let ice = with_material(ground(), 0.0, 0.0);
    let slab = with_material(cuboid(Vec3::new(1.0, 0.1, 0.5), Vec3::new(0.0, 0.1, 0.0)), 1.0, 0.0);
    let rider = with_material(cuboid(Vec3::splat(0.2), Vec3::new(0.0, 0.4, 0.0)), 1.0, 0.0);
    let mut world = world_of(&[ice, slab, rider]);
    run(&mut world, 120);
    assert_eq!(awake(&world), 0, "slab and rider have not come to rest");
    // A push by hand, and what was pushed is awake.
    world.states_mut()[1].velocity.x = 0.03;
    world.states_mut()[1].rest = 0;
    run(&mut world, 600);
    let (slab, rider) = (world.states()[1].position.x, world.states()[2].position.x);
    assert!(slab > 0.2, "the slab has stopped at {slab} m");
    assert!((slab - rider).abs() < 0.01, "the slab is at {slab} m, its rider at {rider} m");
}

#[test]
fn nothing_hangs_in_the_air() {
    // One at the top of its throw, one that claims to be at rest.
    let mut thrown = cuboid(UNIT, Vec3::new(0.0, 5.0, 0.0));
    thrown.velocity.y = 9.81;
    let mut world = world_of(&[ground(), thrown, cuboid(UNIT, Vec3::new(5.0, 5.0, 0.0))]);
    world.states_mut()[2].rest = world.environment.settings.rest_frames() + 1;
    run(&mut world, 240);
    for i in [1, 2] {
        let y = world.states()[i].position.y;
        assert!((y - 0.5).abs() < 0.01, "body {i} hangs at {y} m");
    }
}

#[test]
fn a_plate_just_past_its_balance_falls() {
    // Balance is at atan(0.05 / 0.5); this leans 0.17 degrees more, on its lower edge.
    let lean: f32 = libm::atanf(0.1) + 0.003;
    let (s, c) = (libm::sinf(lean), libm::cosf(lean));
    let height = 0.5 * c + 0.05 * s;
    let mut plate = cuboid(Vec3::new(0.05, 0.5, 0.3), Vec3::new(0.0, height, 0.0));
    plate.pose.rotation = Quat::from_xyzw(0.0, 0.0, libm::sinf(0.5 * lean), libm::cosf(0.5 * lean));
    let mut world = world_of(&[ground(), plate]);
    run(&mut world, 600);
    let y = world.states()[1].position.y;
    assert!(y < 0.06, "it leans at {y} m");
}

#[test]
fn a_ball_that_spins_in_its_place_comes_to_stand() {
    let mut ball = BodyDef::new(Shape::sphere(0.2).expect("above 0")).at(Vec3::new(0.0, 0.2, 0.0));
    ball.angular_velocity.y = 1.0;
    let mut world = world_of(&[ground(), ball]);
    run(&mut world, 30);
    let spin = world.states()[1].angular_velocity.y;
    // A patch of 2 mm: mu g 0.002 / (0.4 r²) = 0.613 rad/s².
    assert!((spin - (1.0 - 0.5 * 0.613)).abs() < 0.02, "it spins at {spin} rad/s after half a second");
    run(&mut world, 240);
    assert_eq!(awake(&world), 0, "it spins still");
}

#[test]
fn an_impact_wakes_the_whole_island() {
    let mut defs = pyramid(6);
    let top = defs.len() - 1;
    let mut ball = cuboid(Vec3::splat(0.3), Vec3::new(0.0, 0.5, 40.0));
    ball.velocity.z = -15.0;
    ball.gravity_scale = 0.0;
    defs.push(ball);
    let mut world = world_of(&defs);
    let full = world.environment.settings.rest_frames();
    let mut resting = 0;
    while world.states()[top + 1].velocity.z < -14.9 && resting < 1000 {
        run(&mut world, 1);
        resting += 1;
        if resting == 100 {
            assert_eq!(awake(&world), 1, "all but the ball are at rest");
        }
    }
    assert!(world.states()[1..=top].iter().all(|s| s.rest <= full), "part of the pyramid was skipped");
}

#[test]
fn a_pulled_out_support_wakes_what_it_carried() {
    // A lintel on two posts, boxes on the lintel; one post is torn away sideways.
    let post = |x: f32| cuboid(Vec3::new(0.1, 0.5, 0.2), Vec3::new(x, 0.5, 0.0));
    let mut puller = cuboid(Vec3::new(0.1, 0.3, 0.3), Vec3::new(0.8, 0.4, 0.0));
    puller.kind = BodyKind::Kinematic;
    let mut world = world_of(&[
        ground(),
        post(-0.9),
        post(1.1),
        cuboid(Vec3::new(1.3, 0.1, 0.3), Vec3::new(0.1, 1.1, 0.0)),
        cuboid(Vec3::splat(0.2), Vec3::new(0.8, 1.4, 0.0)),
        puller,
    ]);
    run(&mut world, 200);
    assert_eq!(awake(&world), 0, "the portal has not come to rest");
    world.states_mut()[5].velocity.x = 3.0;
    run(&mut world, 300);
    let (lintel, load) = (world.states()[3].position.y, world.states()[4].position.y);
    assert!(lintel < 0.9 && load < 1.0, "lintel at {lintel} m, load at {load} m");
}
