//! Touches against Newton: what bodies were pushed with is what changed their momentum. And the same bits for everybody.

mod common;

use common::{UNIT, cuboid, ground, pyramid, rain, world_of};
use forerun_dynamics::{BodyDef, BodyId, Material, Touch, Touches, Unobserved, World};
use forerun_geometry::{Shape, Vec3};

const DT: f32 = 1.0 / 60.0;
const G: f32 = 9.81;

fn ball(radius: f32, position: Vec3, restitution: f32) -> BodyDef {
    let mut def = BodyDef::new(Shape::sphere(radius).unwrap()).at(position);
    def.material = Material::new(0.0, restitution);
    def
}

fn mass(world: &World, body: usize) -> f32 {
    1.0 / world.bodies()[body].inverse_mass
}

fn between(touches: &Touches, first: u32, second: u32) -> Option<&Touch> {
    touches.list.iter().find(|t| (t.first, t.second) == (BodyId(first), BodyId(second)))
}

/// By how much the momentum of a body is not what its touches and gravity explain. N s.
fn unexplained(before: &World, after: &World, touches: &Touches, body: usize) -> f32 {
    let id = BodyId(body as u32);
    let mut change = Vec3::Y * (-G * DT * mass(before, body));
    for touch in &touches.list {
        if touch.second == id {
            change += touch.normal * touch.impulse;
        } else if touch.first == id {
            change -= touch.normal * touch.impulse;
        }
    }
    let velocities = after.states()[body].velocity - before.states()[body].velocity;
    (velocities * mass(before, body) - change).length()
}

#[test]
fn what_rests_carries_the_weight_above_it() {
    let stack: Vec<BodyDef> = (0..3).map(|i| cuboid(UNIT, Vec3::Y * (0.5 + i as f32))).collect();
    let mut world = world_of(&[vec![ground()], stack].concat());
    let mut touches = Touches::default();
    let weight = 1000.0 * G * DT;
    for frame in 0..200 {
        world.step_touching(&mut Unobserved, &mut touches);
        assert_eq!(touches.list.len(), 3, "frame {frame}");
        for (lower, carried) in [(0, 3.0), (1, 2.0), (2, 1.0)] {
            let touch = between(&touches, lower, lower + 1).unwrap();
            assert!((touch.impulse / (carried * weight) - 1.0).abs() < 0.01, "{frame}: {touch:?}");
            assert!((touch.normal - Vec3::Y).length() < 1e-3);
            assert!((0.0..0.05).contains(&touch.speed), "{touch:?}");
            assert!((touch.point - Vec3::Y * lower as f32).length() < 0.02, "{touch:?}");
        }
    }
    // The end of it is at rest, and not solved any more.
    assert!(touches.resting[1] && touches.resting[2] && touches.resting[3]);
}

#[test]
fn a_ball_that_bounces_is_pushed_as_its_velocity_says() {
    // The fast one needs slices.
    for (speed, restitution) in [(0.0, 0.7), (0.0, 0.0), (-150.0, 0.5), (-150.0, 0.0)] {
        let mut def = ball(0.2, Vec3::Y * 2.0, restitution);
        def.velocity.y = speed;
        let floor = BodyDef::fixed(Shape::cuboid(Vec3::new(9.0, 0.05, 9.0)).unwrap()).at(Vec3::Y * -0.05);
        let mut world = world_of(&[floor, def]);
        let (mut touches, mut hits, mut slices) = (Touches::default(), 0, 0);
        for frame in 0..90 {
            let before = world.clone();
            slices = slices.max(world.step_touching(&mut Unobserved, &mut touches).slices_max);
            let error = unexplained(&before, &world, &touches, 1);
            let scale = mass(&world, 1) * (1.0 + before.states()[1].velocity.length());
            // Coming to rest sets the last of the velocity to nothing.
            let frozen =
                world.states()[1].velocity == Vec3::ZERO && before.states()[1].velocity != Vec3::ZERO;
            assert!(error < 1e-4 * scale || frozen, "frame {frame}, {speed} m/s: {error} of {scale} N s");
            hits += u32::from(touches.list.iter().any(|t| t.impulse > 0.5 * mass(&world, 1)));
        }
        assert!(hits > 0 && (slices > 1) == (speed < -100.0), "{hits} hits, {slices} slices");
    }
}

#[test]
fn two_balls_push_each_other_alike() {
    let mut left = ball(0.5, Vec3::new(-1.0, 5.0, 0.1), 1.0);
    let right = ball(0.3, Vec3::new(0.5, 5.0, 0.0), 1.0);
    left.velocity.x = 6.0;
    let mut world = world_of(&[left, right]);
    let (mut touches, mut met) = (Touches::default(), 0);
    for _ in 0..20 {
        let before = world.clone();
        world.step_touching(&mut Unobserved, &mut touches);
        for body in 0..2 {
            let error = unexplained(&before, &world, &touches, body);
            assert!(error < 1e-4 * mass(&world, body) * 8.0, "{error}");
        }
        if let Some(touch) = between(&touches, 0, 1) {
            met += 1;
            // Elastic, along the line of centres: 2 m M / (m + M) times the closing speed.
            let (m, n) = (mass(&world, 0), mass(&world, 1));
            let closing = before.states()[0].velocity - before.states()[1].velocity;
            let expected = 2.0 * m * n / (m + n) * closing.dot(touch.normal);
            assert!((touch.impulse / expected - 1.0).abs() < 1e-3, "{touch:?}, {expected}");
            assert!(touch.normal.x > 0.9);
            assert!((touch.speed - closing.dot(touch.normal)).abs() < 1e-4, "{touch:?}");
        }
    }
    assert_eq!(met, 1);
}

#[test]
fn smooth_balls_in_a_heap_are_pushed_as_their_velocities_say() {
    let mut defs = vec![ground()];
    let mut random = common::Random(4);
    for _ in 0..60 {
        let mut at = || random.between(-1.0, 1.0);
        let place = Vec3::new(at(), 2.5 + 2.0 * at(), at());
        defs.push(ball(0.25, place, 0.3));
    }
    let mut world = world_of(&defs);
    let (mut touches, mut explained) = (Touches::default(), 0);
    for _ in 0..120 {
        let before = world.clone();
        let report = world.step_touching(&mut Unobserved, &mut touches);
        // In slices the mean normal of a pair says less than each slice's own.
        if report.slices_max > 1 {
            continue;
        }
        for body in 1..defs.len() {
            let error = unexplained(&before, &world, &touches, body);
            assert!(error < 0.02 * mass(&world, body), "body {body}: {error} N s");
            explained += 1;
        }
    }
    assert!(explained > 2000, "{explained}");
}

/// What each frame tells, and the world afterwards.
fn recorded(defs: &[BodyDef], frames: usize) -> (Vec<Vec<Touch>>, World) {
    let mut world = world_of(defs);
    let mut touches = Touches::default();
    let all = (0..frames).map(|_| {
        world.step_touching(&mut Unobserved, &mut touches);
        touches.list.clone()
    });
    (all.collect(), world)
}

fn assert_same(a: &[Touch], b: &[Touch], what: &str) {
    assert_eq!(a.len(), b.len(), "{what}");
    for (a, b) in a.iter().zip(b) {
        assert!(a.same_bits(b), "{what}: {a:?} {b:?}");
    }
}

#[test]
fn thread_counts_agree_and_the_world_does_not_notice() {
    let defs = rain(200, 3);
    let mut plain = world_of(&defs);
    for _ in 0..120 {
        plain.step(&mut Unobserved);
    }
    let mut reference: Option<Vec<Vec<Touch>>> = None;
    for threads in [1, 2, 4] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        let (all, world) = pool.install(|| recorded(&defs, 120));
        assert_eq!(world.state_hash(), plain.state_hash());
        let reference = reference.get_or_insert_with(|| all.clone());
        for (frame, (a, b)) in all.iter().zip(&*reference).enumerate() {
            assert_same(a, b, &format!("frame {frame}, {threads} threads"));
        }
    }
    assert!(reference.unwrap()[119].len() > 200);
}

#[test]
fn an_island_tells_the_same_in_company() {
    let (left, right) = (rain(60, 1), rain(60, 2));
    let moved = right[1..].iter().cloned().map(|mut def| {
        def.pose.position.x += 64.0;
        def
    });
    let both: Vec<BodyDef> = left.iter().cloned().chain(moved).collect();
    let ((alone, _), (together, _)) = (recorded(&left, 150), recorded(&both, 150));
    let last = BodyId(left.len() as u32);
    for (frame, (alone, together)) in alone.iter().zip(together).enumerate() {
        let left: Vec<Touch> = together.into_iter().filter(|t| t.second < last).collect();
        assert_same(&left, alone, &format!("frame {frame}"));
    }
}

#[test]
fn what_is_not_solved_would_tell_the_same() {
    // A pyramid that has come to rest, and the same with the mark of the fixpoint taken off.
    let mut world = world_of(&pyramid(5));
    let mut touches = Touches::default();
    for _ in 0..300 {
        world.step_touching(&mut Unobserved, &mut touches);
    }
    assert!(touches.resting.iter().filter(|resting| **resting).count() == 15, "{:?}", touches.resting);
    let mut again = world.clone();
    for state in again.states_mut() {
        state.rest = state.rest.min(1_000_000).saturating_sub(1);
    }
    let mut solved = Touches::default();
    again.step_touching(&mut Unobserved, &mut solved);
    assert!(solved.resting.iter().all(|resting| !resting));
    assert_same(&touches.list, &solved.list, "solved once more");
    assert!(!touches.list.is_empty());
}
