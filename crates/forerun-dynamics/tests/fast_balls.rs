//! The length of a slice follows from the states: fast balls stay in a thin box, keep their energy, and slices end where motion does.

mod common;

use common::{Random, cuboid, with_material, world_of};
use forerun_dynamics::{BodyDef, BodyKind, BodyState, Unobserved, World};
use forerun_geometry::{Shape, Vec3};

/// Half the inner width of the box. Metres.
const HALF: f32 = 5.0;
/// Half the thickness of its walls. Metres.
const WALL: f32 = 0.05;
const RADIUS: f32 = 0.1;

/// Bodies at random places in a closed box, flying in random directions. `(speed, friction, restitution)`.
fn in_a_box(count: usize, shape: &Shape, (speed, friction, restitution): (f32, f32, f32)) -> World {
    let mut defs = Vec::new();
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let half = Vec3::splat(HALF + 2.0 * WALL) - axis * (HALF + WALL);
        for side in [-1.0, 1.0] {
            let wall = BodyDef { kind: BodyKind::Fixed, ..cuboid(half, axis * (side * (HALF + WALL))) };
            defs.push(with_material(wall, friction, restitution));
        }
    }
    let mut random = Random(6);
    let reach = HALF - 2.0 * RADIUS;
    for _ in 0..count {
        let mut place = || random.between(-reach, reach);
        let at = Vec3::new(place(), place(), place());
        let mut body = BodyDef::new(shape.clone()).at(at);
        body.velocity = random.rotation() * Vec3::new(speed, 0.0, 0.0);
        defs.push(with_material(body, friction, restitution));
    }
    world_of(&defs)
}

fn bodies(world: &World) -> impl Iterator<Item = &BodyState> {
    world.bodies().iter().zip(world.states()).filter(|(b, _)| b.is_dynamic()).map(|(_, s)| s)
}

/// Bodies whose centre is not in the box any more.
fn escaped(world: &World) -> usize {
    bodies(world).filter(|s| s.position.abs().max_element() > HALF).count()
}

/// Kinetic and potential energy over the mass of a body.
fn energy(world: &World) -> f64 {
    let g = f64::from(-world.environment.gravity.y);
    let of = |s: &BodyState| {
        0.5 * f64::from(s.velocity.length_squared()) + g * f64::from(s.position.y + HALF - RADIUS)
    };
    bodies(world).map(of).sum()
}

/// Steps once and returns the most slices of an island.
fn slices(world: &mut World) -> u32 {
    world.step(&mut Unobserved).slices_max
}

#[test]
fn fast_balls_stay_in_a_thin_box_with_their_energy() {
    let mut world = in_a_box(500, &Shape::sphere(RADIUS).expect("above 0"), (50.0, 0.0, 1.0));
    let start = energy(&world);
    let sliced = (0..120).filter(|_| slices(&mut world) > 1).count();
    assert!(sliced > 60, "the scene is to need slices, and did in {sliced} frames");
    assert_eq!(escaped(&world), 0, "bodies are outside");
    let part = energy(&world) / start;
    assert!((part - 1.0).abs() < 2e-3, "energy is now {part} of the first");
}

#[test]
fn what_a_fast_ball_throws_at_a_wall_stays_inside() {
    // The hit happens within the frame, and the wall is nowhere near the path that the thrown ball was on.
    let mut wall = cuboid(Vec3::new(WALL, 2.0, 2.0), Vec3::new(0.3, 0.0, 0.0));
    wall.kind = BodyKind::Fixed;
    let ball = |x: f32, speed: f32| {
        let mut def = BodyDef::new(Shape::sphere(RADIUS).expect("above 0")).at(Vec3::new(x, 0.0, 0.0));
        def.velocity.x = speed;
        def.gravity_scale = 0.0;
        with_material(def, 0.0, 1.0)
    };
    for speed in [20.0, 50.0, 90.0] {
        let mut world = world_of(&[wall.clone(), ball(0.0, 0.0), ball(-0.5, speed)]);
        for _ in 0..20 {
            slices(&mut world);
            assert!(bodies(&world).all(|s| s.position.x < 0.3), "at {speed} m/s a ball is behind the wall");
        }
    }
}

#[test]
fn slices_end_with_the_motion() {
    let shape = Shape::cuboid(Vec3::splat(RADIUS)).expect("above 0");
    let mut world = in_a_box(200, &shape, (50.0, 0.5, 0.3));
    let mut counts = Vec::new();
    let mut moved_last = 0;
    for frame in 0..900 {
        counts.push(slices(&mut world));
        if bodies(&world).any(|s| s.velocity.length() > 0.5) {
            moved_last = frame;
        }
    }
    assert!(counts[0] > 1, "the scene is to start with slices");
    assert!(moved_last < 700, "something moved at frame {moved_last}");
    assert!(counts[moved_last + 60..].iter().all(|&count| count == 1), "slices go on after the motion");
    assert_eq!(escaped(&world), 0, "bodies are outside");
}

/// Gravity of 10^7 m/s² on everybody in a large scene must not make everybody a neighbour of everybody.
#[test]
fn a_speed_beyond_all_measure_makes_nobody_a_far_neighbour() {
    let mut environment = forerun_dynamics::Environment::default();
    environment.gravity.y = -1e7;
    let ball = Shape::Sphere(forerun_geometry::shape::Sphere { radius: 0.1 });
    let (body, state) = forerun_dynamics::Body::new(&BodyDef::new(ball)).unwrap();
    let bound = forerun_dynamics::bounds::swept_bound(&body, &state, &environment);
    let size = bound.max - bound.min;
    assert!(size.y > 19.0 && size.y < 21.0 && size.x < 1.0, "{size}");
}
