//! The same bits for any thread count, any company, and whether resting islands are skipped or not.

mod common;

use common::{cuboid, ground, pyramid, rain, run, world_of};
use forerun_dynamics::{BodyState, StepSettings, Unobserved, World};
use forerun_geometry::{Shape, Vec3};

fn bits(world: &World) -> Vec<[u32; 14]> {
    world.states().iter().map(BodyState::bits).collect()
}

#[test]
fn thread_counts_agree() {
    let mut reference = None;
    for threads in [1, 2, 4] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        let mut world = world_of(&rain(200, 3));
        pool.install(|| run(&mut world, 120));
        let hash = bits(&world);
        assert!(*reference.get_or_insert_with(|| hash.clone()) == hash, "{threads} threads differ from 1");
    }
}

#[test]
fn threads_that_share_one_island_agree() {
    // So many contacts that even four threads share the sweeps of one island, some of them while it is hit.
    let mut defs = pyramid(100);
    let mut ball = cuboid(Vec3::splat(0.5), Vec3::new(0.3, 20.0, 2.0));
    ball.velocity = Vec3::new(0.0, 0.0, -30.0);
    defs.push(ball);
    let mut reference = None;
    for threads in [1, 2, 4] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        let mut world = world_of(&defs);
        pool.install(|| run(&mut world, 8));
        let hash = bits(&world);
        assert!(*reference.get_or_insert_with(|| hash.clone()) == hash, "{threads} threads differ from 1");
    }
}

#[test]
fn an_island_does_not_notice_the_others() {
    // Two heaps far apart, together and alone.
    let (left, right) = (rain(60, 1), rain(60, 2));
    let moved: Vec<_> = (right.iter().cloned())
        .map(|mut def| {
            // The ground is everywhere; its frame must not change.
            if def.shape != Shape::HalfSpace {
                def.pose.position.x += 64.0;
            }
            def
        })
        .collect();
    let mut both = world_of(&left.iter().chain(&moved[1..]).cloned().collect::<Vec<_>>());
    let (mut one, mut other) = (world_of(&left), world_of(&moved));
    for world in [&mut both, &mut one, &mut other] {
        run(world, 200);
    }
    let (both, one, other) = (bits(&both), bits(&one), bits(&other));
    assert!(both[..one.len()] == one[..], "the left heap differs");
    assert!(both[one.len()..] == other[1..], "the right heap differs");
}

#[test]
fn skipping_resting_islands_changes_nothing() {
    // A shot at a pyramid that has come to rest. Without the skip, every rest counter is one lower at the end of rest.
    let shot = |skip: bool| {
        let mut defs = pyramid(8);
        let mut ball = cuboid(Vec3::splat(0.3), Vec3::new(3.0, 6.0, 60.0));
        ball.velocity = Vec3::new(0.0, 6.0, -40.0);
        ball.gravity_scale = 0.5;
        defs.push(ball);
        let mut world = world_of(&defs);
        let full = StepSettings::default().rest_frames();
        for _ in 0..400 {
            if !skip {
                for state in world.states_mut() {
                    state.rest = state.rest.min(full);
                }
            }
            world.step(&mut Unobserved);
        }
        world
            .states()
            .iter()
            .map(|s| (s.position, s.rotation, s.velocity, s.angular_velocity))
            .collect::<Vec<_>>()
    };
    assert!(shot(true) == shot(false));
}

#[test]
fn a_support_that_goes_wakes_what_it_carried() {
    let mut world = world_of(&[
        ground(),
        cuboid(common::UNIT, Vec3::new(0.0, 0.5, 0.0)),
        cuboid(common::UNIT, Vec3::new(0.0, 1.5, 0.0)),
    ]);
    run(&mut world, 200);
    let full = world.environment.settings.rest_frames();
    assert!(world.states()[2].rest > full, "the stack has not come to rest");
    // Moved away by hand, and awake as every moved body is.
    world.states_mut()[1].position.x = 10.0;
    for state in world.states_mut() {
        state.rest = state.rest.min(full);
    }
    run(&mut world, 120);
    assert!(
        (world.states()[2].position.y - 0.5).abs() < 0.01,
        "it hangs at {}",
        world.states()[2].position.y
    );
}

#[test]
fn a_kinematic_body_pushes_what_rests_and_drops_what_it_carried() {
    // A block at rest on the ground in the way, and one at rest on a kinematic slab that then slides out from under it.
    let slab = |position: Vec3| {
        let mut def = cuboid(Vec3::new(0.5, 0.25, 0.5), position);
        def.kind = forerun_dynamics::BodyKind::Kinematic;
        def
    };
    let mut world = world_of(&[
        ground(),
        slab(Vec3::new(-2.0, 0.25, 0.0)),
        cuboid(Vec3::splat(0.25), Vec3::new(0.0, 0.25, 0.0)),
        slab(Vec3::new(0.0, 1.0, 5.0)),
        cuboid(Vec3::splat(0.25), Vec3::new(0.0, 1.5, 5.0)),
    ]);
    run(&mut world, 300);
    let full = world.environment.settings.rest_frames();
    assert!(
        world.states()[2].rest > full && world.states()[4].rest > full,
        "the blocks have not come to rest"
    );
    world.states_mut()[1].velocity.x = 1.0;
    world.states_mut()[3].velocity.x = 8.0;
    run(&mut world, 240);
    let (pushed, dropped) = (world.states()[2].position, world.states()[4].position);
    assert!(pushed.x > 2.0, "the kinematic body passed through: {pushed}");
    assert!((dropped.y - 0.25).abs() < 0.01, "the block hangs at {dropped}");
}

#[test]
fn a_body_that_blows_up_does_not_reach_the_others_through_the_ground() {
    let calm = |with_bomb: bool| {
        let mut floor = cuboid(Vec3::new(50.0, 1.0, 50.0), Vec3::new(0.0, -1.0, 0.0));
        floor.kind = forerun_dynamics::BodyKind::Fixed;
        let mut slider = cuboid(common::UNIT, Vec3::new(0.0, 0.5, 0.0));
        slider.velocity.x = 3.0;
        let mut defs = vec![floor, slider];
        if with_bomb {
            let mut bomb = cuboid(Vec3::splat(0.25), Vec3::new(10.0, 0.25, 5.0));
            bomb.mass = forerun_dynamics::Mass::Total(0.1);
            bomb.torque.y = 3e38;
            defs.push(bomb);
        }
        let mut world = world_of(&defs);
        let mut stopped = 0;
        for _ in 0..60 {
            stopped += world.step(&mut Unobserved).quarantined;
        }
        assert_eq!(stopped > 0, with_bomb, "the bomb is to blow up");
        assert!(world.states().iter().all(BodyState::is_finite));
        bits(&world)[1]
    };
    assert!(calm(false) == calm(true), "the sliding box noticed the other one");
}
