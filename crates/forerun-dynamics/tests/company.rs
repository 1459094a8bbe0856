//! An island does not notice what shares a block with it, down to the smallest numbers.

mod common;

use common::{Random, UNIT, cuboid, world_of};
use forerun_dynamics::{BodyDef, Material, Unobserved};
use forerun_geometry::{Shape, Vec3};

/// Two boxes that lie against each other without weight, and move by next to nothing.
fn boxes(random: &mut Random) -> Vec<BodyDef> {
    let mut defs = vec![cuboid(UNIT, Vec3::ZERO), cuboid(UNIT, Vec3::new(0.999, 0.1, 0.2))];
    for def in &mut defs {
        def.gravity_scale = 0.0;
        let mut tiny = || random.between(-1.0, 1.0) * libm::powf(10.0, random.between(-36.0, -14.0));
        def.velocity = Vec3::new(tiny(), tiny(), tiny());
        def.angular_velocity = Vec3::new(tiny(), tiny(), tiny());
    }
    defs
}

/// Two balls that bounce off each other, far away.
fn balls() -> Vec<BodyDef> {
    let ball = |x: f32, speed: f32| {
        let mut def = BodyDef::new(Shape::sphere(0.5).expect("a radius")).at(Vec3::new(x, 0.0, 50.0));
        (def.gravity_scale, def.velocity.x, def.material) = (0.0, speed, Material::new(0.5, 1.0));
        def
    };
    vec![ball(0.0, 2.0), ball(1.05, -2.0)]
}

#[test]
fn a_bounce_beside_it_does_not_rub_a_contact_that_nothing_presses() {
    for seed in 0..300 {
        let boxes = boxes(&mut Random(seed));
        let mut alone = world_of(&boxes);
        let mut together = world_of(&[boxes, balls()].concat());
        for frame in 0..5 {
            alone.step(&mut Unobserved);
            together.step(&mut Unobserved);
            for i in 0..2 {
                let (a, b) = (alone.states()[i], together.states()[i]);
                assert!(a.same_bits(&b), "body {i}, seed {seed}, frame {frame}: {a:?} {b:?}");
            }
        }
        assert!(together.states()[2].velocity.x < -1.0, "the balls have bounced");
    }
}
