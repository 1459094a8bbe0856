//! What only just stands must stand: an arch, a card house.
#![allow(clippy::excessive_precision, reason = "the digits are those of the source")]

mod common;

use common::{cuboid, ground, pyramid, with_density, with_material, world_of};
use forerun_dynamics::{BodyDef, Mass, Unobserved, World};
use forerun_geometry::{Quat, Shape, Vec3};

/// Corners of the joints of an arch of 17 stones, inside and outside, from a springer to the keystone (sample `Arch` of Box2D, to be scaled by 0.25).
const JOINTS: [[f32; 4]; 9] = [
    [16.0, 0.0, 24.0, 0.0],
    [14.938_037, 5.133_601, 22.336_195, 6.022_998],
    [13.798_717, 10.249_281, 20.549_369, 12.009_644],
    [12.562_53, 15.341_07, 18.608_546, 17.947_032],
    [11.200_41, 20.398_565, 16.467_693, 23.813_679],
    [9.665_212, 25.403_699, 14.053_25, 29.570_794],
    [7.871_799, 30.317_934, 11.235_51, 35.137_758],
    [5.635_2, 35.038_207, 7.752_568, 40.304_507],
    [2.405_938, 39.095_541, 3.016_932, 44.288_916],
];

const STONE: f32 = 200.0;

/// A stone 1 m deep between two joints.
fn stone(joints: [[f32; 4]; 2], friction: f32) -> BodyDef {
    let mut points = Vec::new();
    for [x, y, outer_x, outer_y] in joints {
        for z in [-0.5, 0.5] {
            points.push(Vec3::new(0.25 * x, 0.25 * y, z));
            points.push(Vec3::new(0.25 * outer_x, 0.25 * outer_y, z));
        }
    }
    let centre = points.iter().sum::<Vec3>() / points.len() as f32;
    points.iter_mut().for_each(|p| *p -= centre);
    let def = BodyDef::new(Shape::hull(&points).expect("the corners fill space")).at(centre);
    with_material(with_density(def, STONE), friction, 0.0)
}

/// The arch with boxes of 4 m by 1 m piled on its keystone. A linear program over all forces within the cones of friction (limit analysis) says that
/// with friction 0.6 it carries 2.56 of them; with two, 0.527 would do.
fn arch(boxes: usize, friction: f32) -> Vec<BodyDef> {
    let mirrored = |[x, y, outer_x, outer_y]: [f32; 4]| [-x, y, -outer_x, outer_y];
    let mut defs = vec![with_material(ground(), friction, 0.0)];
    for pair in JOINTS.windows(2) {
        defs.push(stone([pair[0], pair[1]], friction));
        defs.push(stone([mirrored(pair[0]), mirrored(pair[1])], friction));
    }
    defs.push(stone([JOINTS[8], mirrored(JOINTS[8])], friction));
    for i in 0..boxes {
        let y = 0.25 * JOINTS[8][3] + 0.5 + i as f32;
        let load = cuboid(Vec3::new(2.0, 0.5, 0.5), Vec3::new(0.0, y, 0.0));
        defs.push(with_material(with_density(load, STONE), friction, 0.0));
    }
    defs
}

/// The farthest that any body has moved. Metres
fn farthest(world: &World, start: &World) -> f32 {
    let pairs = world.states().iter().zip(start.states());
    pairs.map(|(here, there)| here.position.distance(there.position)).fold(0.0, f32::max)
}

fn awake(world: &World) -> usize {
    let full = world.environment.settings.rest_frames();
    world.bodies().iter().zip(world.states()).filter(|(b, s)| b.is_dynamic() && s.rest <= full).count()
}

#[test]
fn an_arch_carries_what_limit_analysis_says() {
    for boxes in 0..=2 {
        let mut world = world_of(&arch(boxes, 0.6));
        let start = world.clone();
        for _ in 0..300 {
            world.step(&mut Unobserved);
        }
        let moved = farthest(&world, &start);
        assert!(moved < 0.01, "with {boxes} boxes a stone moves by {moved} m");
        assert_eq!(awake(&world), 0, "with {boxes} boxes it does not come to rest");
    }
}

#[test]
fn an_arch_stands_without_the_rule_of_rest() {
    let mut world = world_of(&arch(1, 0.6));
    world.environment.settings.rest_seconds = 0.0;
    let start = world.clone();
    for _ in 0..300 {
        world.step(&mut Unobserved);
    }
    let moved = farthest(&world, &start);
    assert!(moved < 0.03, "a stone moves by {moved} m");
}

#[test]
fn an_arch_falls_when_its_stones_are_too_smooth() {
    let mut world = world_of(&arch(2, 0.3));
    let start = world.clone();
    for _ in 0..300 {
        world.step(&mut Unobserved);
    }
    assert!(farthest(&world, &start) > 1.0, "two boxes ask for friction 0.527");
}

/// Five storeys of cards 2 mm thick and 0.4 m high, a few millimetres apart (sample `CardHouse` of Box2D).
fn card_house() -> Vec<BodyDef> {
    let card = |x: f32, y: f32, degrees: f32| {
        let mut def = cuboid(Vec3::new(0.001, 0.2, 0.1), Vec3::new(x, y, 0.0));
        let half = 0.5 * degrees.to_radians();
        def.pose.rotation = Quat::from_xyzw(0.0, 0.0, libm::sinf(half), libm::cosf(half));
        def.mass = Mass::Total(0.01);
        with_material(def, 0.7, 0.0)
    };
    let mut defs = vec![with_material(ground(), 0.7, 0.0)];
    for storey in 0..5 {
        let y = 0.18 + 0.37 * storey as f32;
        for pair in 0..5 - storey {
            let x = 0.175 * storey as f32 + 0.35 * pair as f32;
            if pair < 4 - storey {
                defs.push(card(x + 0.25, y + 0.185, 90.0));
            }
            defs.push(card(x, y, -25.0));
            defs.push(card(x + 0.175, y, 25.0));
        }
    }
    defs
}

#[test]
fn a_card_house_settles_and_stands() {
    let mut world = world_of(&card_house());
    world.environment.settings.frame_seconds = 1.0 / 240.0;
    let start = world.clone();
    for _ in 0..1200 {
        world.step(&mut Unobserved);
    }
    // The gaps of five storeys close: 0.02 m at the top.
    let moved = farthest(&world, &start);
    assert!(moved < 0.03, "a card moves by {moved} m");
    assert_eq!(awake(&world), 0, "it does not come to rest");
}

#[test]
fn islands_of_other_classes_beside_it_change_no_bit() {
    let arch = arch(1, 0.6);
    let mut beside = pyramid(4);
    let mut heap = common::rain(40, 3);
    let mut jolted = common::rain(20, 4);
    for (k, defs) in [&mut beside, &mut heap, &mut jolted].into_iter().enumerate() {
        defs.remove(0);
        for def in defs {
            def.pose.position.z += 40.0 * (k + 1) as f32;
        }
    }
    let mut alone = world_of(&arch);
    let mut together = world_of(&[arch, beside, heap, jolted].concat());
    for frame in 0..60 {
        alone.step(&mut Unobserved);
        together.step(&mut Unobserved);
        for (i, state) in alone.states().iter().enumerate() {
            assert!(state.same_bits(&together.states()[i]), "body {i}, frame {frame}");
        }
    }
}
