//! Inspections against Newton: what contacts pushed and rubbed with is what changed the momentum of each body. And against what is known of the scene.

mod common;

use common::{UNIT, cuboid, ground, pyramid, rain, run, world_of};
use forerun_dynamics::bounds::swept_bound;
use forerun_dynamics::{
    BodyDef, BodyId, BodyKind, InspectedBody, InspectedIsland, Inspection, Mass, Material, Member, Touches,
    Unobserved, World, inspect,
};
use forerun_geometry::{Shape, Vec3};

const DT: f32 = 1.0 / 60.0;
const G: f32 = 9.81;

fn inspected(world: &World) -> Inspection {
    let members: Vec<Member> = world
        .bodies()
        .iter()
        .zip(world.states())
        .enumerate()
        .map(|(i, (body, state))| Member { id: BodyId(i as u32), body, state: *state })
        .collect();
    inspect::inspect(&members, &world.environment)
}

fn pushed(inspection: &Inspection, first: u32, second: u32) -> f32 {
    let between =
        inspection.contacts.iter().filter(|c| (c.first, c.second) == (BodyId(first), BodyId(second)));
    between.map(|contact| contact.impulse()).sum()
}

fn stack(height: usize, x: f32) -> Vec<BodyDef> {
    (0..height).map(|i| cuboid(UNIT, Vec3::new(x, 0.5 + i as f32, 0.0))).collect()
}

/// The most that the momentum of a dynamic body is not what contacts and gravity explain, against its mass. m/s.
fn unexplained(before: &World, after: &World, inspection: &Inspection) -> f32 {
    let mut worst = 0.0_f32;
    for (i, body) in before.bodies().iter().enumerate().filter(|(_, body)| body.is_dynamic()) {
        let mass = 1.0 / body.inverse_mass;
        let mut change = Vec3::Y * (-G * DT * mass);
        for contact in &inspection.contacts {
            let pushes = contact.points().iter().map(|point| point.normal * point.impulse);
            let on_second = pushes.sum::<Vec3>() + contact.friction;
            match BodyId(i as u32) {
                id if id == contact.second => change += on_second,
                id if id == contact.first => change -= on_second,
                _ => {}
            }
        }
        let velocities = after.states()[i].velocity - before.states()[i].velocity;
        worst = worst.max((velocities - change / mass).length());
    }
    worst
}

#[test]
fn a_stack_carries_its_weight_awake_and_at_rest() {
    let mut world = world_of(&[vec![ground()], stack(5, 0.0)].concat());
    let weight = 1000.0 * G * DT;
    for (frames, rests) in [(1, false), (20, false), (300, true)] {
        run(&mut world, frames);
        let inspection = inspected(&world);
        for lower in 0..5 {
            let carried = (5 - lower) as f32 * weight;
            let impulse = pushed(&inspection, lower, lower + 1);
            assert!((impulse / carried - 1.0).abs() < 0.02, "after {frames}: {impulse} of {carried} N s");
        }
        let levels: Vec<Option<u32>> = inspection.bodies.iter().map(|body| body.level).collect();
        assert_eq!(levels, [Some(0), Some(1), Some(2), Some(3), Some(4), Some(5)]);
        let island = InspectedIsland { island: BodyId(1), bodies: 5, contacts: 5, slices: 1, resting: rests };
        assert_eq!(inspection.islands, [island]);
        for (body, made) in inspection.bodies.iter().zip(world.bodies()) {
            let expected = InspectedBody {
                body: body.body,
                bound: swept_bound(made, &world.states()[body.body.0 as usize], &world.environment),
                level: body.level,
                island: made.is_dynamic().then_some(BodyId(1)),
                slices: 1,
                resting: rests && made.is_dynamic(),
            };
            assert_eq!(*body, expected);
        }
    }
}

#[test]
fn every_momentum_is_what_contacts_and_gravity_say() {
    // Heaps that slide and roll; and a ball that spins, bounces and is so fast that its frame is cut.
    let mut spinning = BodyDef::new(Shape::sphere(0.2).unwrap()).at(Vec3::Y * 2.0);
    spinning.material = Material::new(0.5, 0.7);
    (spinning.velocity, spinning.angular_velocity) = (Vec3::new(3.0, -60.0, 0.0), Vec3::Z * 40.0);
    let floor = BodyDef::fixed(Shape::cuboid(Vec3::new(50.0, 0.05, 50.0)).unwrap()).at(Vec3::Y * -0.05);
    let mut slices_max = 0;
    for (name, defs, frames) in [("rain", rain(30, 7), 90), ("ball", vec![floor, spinning], 40)] {
        let mut world = world_of(&defs);
        let (mut rubbed, mut bounced) = (0.0_f32, false);
        for frame in 0..frames {
            let before = world.clone();
            let inspection = inspected(&world);
            world.step(&mut Unobserved);
            let error = unexplained(&before, &world, &inspection);
            let fastest = before.states().iter().map(|s| s.velocity.length()).fold(1.0, f32::max);
            // Coming to rest sets the last of the velocity to nothing.
            assert!(error < 2e-3 * fastest, "{name}, frame {frame}: {error} of {fastest} m/s");
            rubbed = inspection.contacts.iter().map(|c| c.friction.length()).fold(rubbed, f32::max);
            slices_max = inspection.islands.iter().map(|island| island.slices).fold(slices_max, u32::max);
            bounced |= world
                .states()
                .iter()
                .zip(before.states())
                .any(|(now, then)| now.velocity.y > then.velocity.y + 9.0);
        }
        assert!(rubbed > 0.1, "{name}: something rubs");
        assert!(name != "ball" || bounced, "the ball bounces");
    }
    assert!(slices_max > 1, "a frame is cut");
}

#[test]
fn islands_that_are_done_again_in_smaller_parts_are_told_of_once() {
    let mut ball = BodyDef::new(Shape::sphere(0.5).unwrap()).at(Vec3::new(-1.2, 1.6, 0.0));
    (ball.mass, ball.velocity) = (Mass::Density(50_000.0), Vec3::X * 30.0);
    let mut world = world_of(&[pyramid(5), vec![ball]].concat());
    let (mut touches, mut slices_max) = (Touches::default(), 0);
    for frame in 0..30 {
        let inspection = inspected(&world);
        world.step_touching(&mut Unobserved, &mut touches);
        let names: Vec<_> = inspection.contacts.iter().map(|c| (c.first, c.second, c.slice)).collect();
        assert!(names.windows(2).all(|pair| pair[0] < pair[1]), "frame {frame}: {names:?}");
        let most = inspection.islands.iter().map(|island| island.slices).fold(1, u32::max);
        assert!(inspection.contacts.iter().all(|contact| contact.slice < most));
        slices_max = slices_max.max(most);
        for touch in &touches.list {
            let impulse = pushed(&inspection, touch.first.0, touch.second.0);
            assert!((impulse - touch.impulse).abs() <= 1e-4 * touch.impulse, "{touch:?}: {impulse} N s");
        }
    }
    assert!(slices_max > 1, "a frame is cut");
}

#[test]
fn friction_is_what_coulomb_says_and_works_against_the_slide() {
    let mut crate_ = cuboid(UNIT, Vec3::Y * 0.5);
    crate_.velocity = Vec3::X * 5.0;
    crate_.material = Material::new(0.4, 0.0);
    let mut floor = ground();
    floor.material = Material::new(0.4, 0.0);
    let mut world = world_of(&[floor, crate_]);
    run(&mut world, 10);
    let inspection = inspected(&world);
    let [contact] = &inspection.contacts[..] else { panic!("{:?}", inspection.contacts) };
    let limit = 0.4 * contact.impulse();
    assert!((contact.impulse() / (1000.0 * G * DT) - 1.0).abs() < 0.02);
    assert!((contact.friction + Vec3::X * limit).length() < 0.01 * limit, "{}", contact.friction);
    assert!(
        contact.points().iter().all(|p| p.position.y.abs() < 0.01 && (p.normal - Vec3::Y).length() < 1e-3)
    );
}

#[test]
fn inspections_and_touches_tell_of_the_same_impulses() {
    let mut world = world_of(&pyramid(6));
    let mut touches = Touches::default();
    for _ in 0..40 {
        let inspection = inspected(&world);
        world.step_touching(&mut Unobserved, &mut touches);
        assert!(!touches.list.is_empty());
        for touch in &touches.list {
            let impulse = pushed(&inspection, touch.first.0, touch.second.0);
            assert!((impulse - touch.impulse).abs() <= 1e-5 * touch.impulse, "{touch:?}: {impulse} N s");
        }
    }
}

#[test]
fn islands_are_named_after_their_lowest_body_and_who_touches_nothing_has_one() {
    let mut defs = vec![ground(), cuboid(UNIT, Vec3::new(50.0, 9.0, 0.0))];
    for pile in 0..3 {
        defs.extend(stack(2 + pile, 10.0 * pile as f32));
    }
    defs.push(BodyDef { kind: BodyKind::Kinematic, ..cuboid(UNIT, Vec3::new(-50.0, 5.0, 0.0)) });
    let inspection = inspected(&world_of(&defs));
    let islands: Vec<(u32, u32, u32)> =
        inspection.islands.iter().map(|i| (i.island.0, i.bodies, i.contacts)).collect();
    assert_eq!(islands, [(1, 1, 0), (2, 2, 2), (4, 3, 3), (7, 4, 4)]);
    let of = |body: usize| (inspection.bodies[body].level, inspection.bodies[body].island);
    assert_eq!(of(1), (None, Some(BodyId(1))));
    assert_eq!(of(10), (Some(4), Some(BodyId(7))));
    assert_eq!(of(11), (Some(0), None));
    assert_eq!(of(0), (Some(0), None));
}

#[test]
fn an_environment_that_is_not_possible_has_nothing_inside() {
    let mut world = world_of(&pyramid(2));
    world.environment.settings.substeps = 0;
    assert_eq!(inspected(&world), Inspection::default());
}
