//! What stands must stay standing, what slides must stop where the formula says.

mod common;

use common::{
    Random, UNIT, cuboid, ground, pyramid, run, tilted_gravity, turned, with_density, with_material, world_of,
};
use forerun_dynamics::{Environment, Material, World};
use forerun_geometry::Vec3;

/// How far any dynamic body sank, and moved sideways.
fn settled(world: &World, start: &[Vec3]) -> (f32, f32) {
    let mut worst = (0.0f32, 0.0f32);
    for (state, from) in world.states().iter().zip(start) {
        let moved = *from - state.position;
        worst = (worst.0.max(moved.y), worst.1.max(Vec3::new(moved.x, 0.0, moved.z).length()));
    }
    worst
}

fn check(name: &str, defs: &[forerun_dynamics::BodyDef], frames: usize, limits: (f32, f32)) {
    let mut world = world_of(defs);
    let start: Vec<Vec3> = world.states().iter().map(|s| s.position).collect();
    run(&mut world, frames);
    let (sank, drifted) = settled(&world, &start);
    assert!(sank < limits.0, "{name}: sank by {sank} m, allowed {}", limits.0);
    assert!(drifted < limits.1, "{name}: drifted by {drifted} m, allowed {}", limits.1);
    let full = world.environment.settings.rest_frames();
    let awake =
        world.bodies().iter().zip(world.states()).filter(|(b, s)| b.is_dynamic() && s.rest <= full).count();
    assert_eq!(awake, 0, "{name}: {awake} bodies are not at a fixpoint after {frames} frames");
}

#[test]
fn stacks_and_pyramids_stand_and_come_to_rest() {
    let stack = |gap: f32| {
        let boxes = (0..20).map(|i| cuboid(UNIT, Vec3::new(0.0, 0.5 + (1.0 + gap) * i as f32, 0.0)));
        [ground()].into_iter().chain(boxes).collect::<Vec<_>>()
    };
    check("stack of 20, touching", &stack(0.0), 200, (1e-3, 1e-3));
    // 1.9 m of gaps close; the rest is overlap.
    check("stack of 20, dropped", &stack(0.1), 600, (1.9 + 0.025, 0.01));
    check("pyramid of 20 rows", &pyramid(20), 200, (1e-3, 1e-3));
}

#[test]
fn a_crooked_tower_stays_where_it_lands() {
    let mut r = Random(5);
    let mut defs = vec![ground()];
    for i in 0..20 {
        let at = Vec3::new(r.between(-0.03, 0.03), 0.51 + 1.01 * i as f32, r.between(-0.03, 0.03));
        defs.push(turned(cuboid(UNIT, at), r.between(-0.3, 0.3)));
    }
    check("crooked tower of 20", &defs, 1200, (0.26, 0.01));
}

#[test]
fn light_boxes_carry_a_heavy_one() {
    let mut defs = pyramid(10);
    let top = defs.len() - 1;
    defs[top] = with_density(defs[top].clone(), 300_000.0);
    defs[top].pose.position.y += 0.5;
    check("capstone of 300 times the mass", &defs, 600, (0.52, 0.05));
}

#[test]
fn a_block_slides_and_stops_where_coulomb_says_whatever_its_restitution() {
    for restitution in [0.0, 0.5, 1.0] {
        let mut def = with_material(cuboid(UNIT, Vec3::new(0.0, 0.5, 0.0)), 0.3, restitution);
        def.velocity.x = 5.0;
        let mut world = world_of(&[with_material(ground(), 0.3, restitution), def]);
        run(&mut world, 150);
        let (x, expected) = (world.states()[1].position.x, 25.0 / (2.0 * 0.3 * 9.81));
        assert!((x / expected - 1.0).abs() < 0.01, "restitution {restitution}: {x} m, expected {expected} m");
        assert!(
            (world.states()[1].position.y - 0.5).abs() < 1e-3,
            "restitution {restitution}: it hopped or sank"
        );
    }
}

#[test]
fn friction_holds_up_to_its_angle() {
    // tan 26.565 degrees = 0.5
    for (friction, expected) in [(0.49, 0.5 * 9.81 * 25.0 * (0.447_21 - 0.49 * 0.894_43)), (0.51, 0.0)] {
        let def = with_material(cuboid(UNIT, Vec3::new(0.0, 0.5, 0.0)), friction, 0.0);
        let mut world = World::new(Environment { gravity: tilted_gravity(26.565), ..Environment::default() });
        world.environment.settings.rest_seconds = 0.0;
        for def in [with_material(ground(), friction, 0.0), def] {
            world.add(&def).expect("the definition is possible");
        }
        run(&mut world, 300);
        let x = world.states()[1].position.x;
        assert!(
            (x - expected).abs() < 0.02 * expected + 1e-3,
            "friction {friction}: {x} m, expected {expected} m"
        );
    }
}

#[test]
fn static_friction_holds_what_kinetic_friction_would_not() {
    // tan 26.565 degrees = 0.5, between the two coefficients.
    let run_from = |speed: f32| {
        let material = Material { friction: 0.4, static_friction: 0.6, restitution: 0.0 };
        let mut block = cuboid(UNIT, Vec3::new(0.0, 0.5, 0.0));
        block.material = material;
        block.velocity.x = speed;
        let mut floor = ground();
        floor.material = material;
        let mut world = World::new(Environment { gravity: tilted_gravity(26.565), ..Environment::default() });
        for def in [floor, block] {
            world.add(&def).expect("the definition is possible");
        }
        run(&mut world, 120);
        world.states()[1].position.x
    };
    let held = run_from(0.0);
    assert!(held.abs() < 1e-3, "it slipped by {held} m");
    // From 1 m/s: x = t + (g sin - 0.4 g cos) t² / 2 at t = 2 s.
    let (slid, expected) = (run_from(1.0), 2.0 + 0.5 * 9.81 * (0.447_21 - 0.4 * 0.894_43) * 4.0);
    assert!((slid / expected - 1.0).abs() < 0.02, "it slid {slid} m, expected {expected} m");
}

#[test]
fn classic_shock_propagation_holds_an_exact_pyramid() {
    let mut world = world_of(&pyramid(10));
    world.environment.settings.shock_propagation = forerun_dynamics::ShockPropagation::Classic;
    let start: Vec<Vec3> = world.states().iter().map(|s| s.position).collect();
    run(&mut world, 200);
    let (sank, drifted) = settled(&world, &start);
    assert!(sank < 1e-3 && drifted < 1e-3, "sank by {sank} m, drifted by {drifted} m");
}
