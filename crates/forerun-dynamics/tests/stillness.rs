//! What is at rest costs nothing, and nobody sees it from the states.

mod common;

use common::{UNIT, cuboid, ground, pyramid, run, world_of};
use forerun_dynamics::{BodyKind, Observer, Stage, Touches, World};
use forerun_geometry::{Shape, Vec3};

/// Counts the stages that are done.
#[derive(Default)]
struct Stages(u32);

impl Observer for Stages {
    fn after(&mut self, _stage: Stage) {
        self.0 += 1;
    }
}

/// As if all bodies of an exactly placed world had been quiet for long.
fn put_to_rest(world: &mut World) {
    let full = world.environment.settings.rest_frames();
    world.states_mut().iter_mut().for_each(|state| state.rest = full + 1);
}

#[test]
fn a_hundred_thousand_boxes_at_rest_need_no_stage() {
    let mut defs = vec![ground()];
    for i in 0..100_000 {
        defs.push(cuboid(UNIT, Vec3::new(2.0 * (i % 300) as f32, 0.5, 2.0 * (i / 300) as f32)));
    }
    let mut world = world_of(&defs);
    put_to_rest(&mut world);
    let (mut first, mut later) = (Stages::default(), Stages::default());
    let before = world.states().to_vec();
    world.step(&mut first);
    let mut touches = Touches::default();
    for _ in 0..1000 {
        world.step(&mut later);
    }
    assert_eq!((first.0, later.0), (1, 0));
    world.step_touching(&mut later, &mut touches);
    world.step_touching(&mut later, &mut touches);
    assert_eq!(later.0, 1, "who is told for the first time who rests is told in full");
    assert!(touches.resting[1..].iter().all(|resting| *resting));
    assert!(world.states()[1..].iter().zip(&before[1..]).all(|(a, b)| a.same_bits(b)));
    // What is changed from outside is seen.
    world.states_mut()[5].position.y += 1.0;
    world.step(&mut later);
    assert!(world.states()[5].velocity.y < 0.0);
}

#[test]
fn a_world_that_forgets_gives_the_same_bits() {
    let mut defs = pyramid(4);
    for x in [20.0, 21.2, 40.0] {
        defs.push(cuboid(UNIT, Vec3::new(x, 0.5, 0.0)));
    }
    let mut ball = cuboid(UNIT, Vec3::new(40.0, 30.0, 0.0));
    ball.shape = Shape::sphere(0.5).expect("a radius");
    defs.push(ball.clone());
    // It comes from afar, and sweeps one of the boxes along into the other.
    let mut sweeper = cuboid(UNIT, Vec3::new(12.0, 0.7, 0.0));
    (sweeper.kind, sweeper.velocity) = (BodyKind::Kinematic, Vec3::new(2.0, 0.0, 0.0));
    defs.push(sweeper);
    let (mut knows, mut forgets) = (world_of(&defs), world_of(&defs));
    for world in [&mut knows, &mut forgets] {
        world.environment.settings.rest_seconds = 0.25;
    }
    let mut fewer = false;
    for frame in 0..300 {
        let a = knows.step(&mut Stages::default());
        let b = {
            let _ = forgets.states_mut();
            forgets.step(&mut Stages::default())
        };
        assert_eq!(knows.state_hash(), forgets.state_hash(), "frame {frame}");
        assert_eq!(a.islands, b.islands, "frame {frame}");
        fewer |= a.contacts < b.contacts;
    }
    assert!(fewer, "something was at rest, while something moved");
    assert!(knows.states()[11].position.x > 20.1, "the box was swept along");
    run(&mut knows, 1);
}
