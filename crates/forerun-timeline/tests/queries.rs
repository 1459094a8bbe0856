//! Queries against the same questions put to every body in turn, and against formulas.

use forerun_dynamics::{BodyDef, BodyId, Environment};
use forerun_geometry::shape::mesh_make;
use forerun_geometry::{Aabb, Pose, Quat, Ray, Shape, Vec3};
use forerun_timeline::check::Random;
use forerun_timeline::{BodyHit, Change, Frame, Progress, Snapshot, Timeline, TimelineSettings};

fn shapes() -> Vec<Shape> {
    let mut random = Random::new(3);
    let cloud: Vec<Vec3> = (0..12).map(|_| random.vector() * 0.5).collect();
    let simple = vec![
        Shape::sphere(0.4).unwrap(),
        Shape::cuboid(Vec3::new(0.6, 0.1, 0.3)).unwrap(),
        Shape::capsule(0.4, 0.2).unwrap(),
        Shape::cylinder(0.1, 0.5).unwrap(),
        Shape::hull(&cloud).unwrap(),
        mesh_make::torus(0.5, 0.2, 16, 8).unwrap().into(),
    ];
    // Off centre, so that the body's own frame is not at its centre of mass.
    let part = |x: f32, shape: &Shape| (Pose::from_position(Vec3::new(x, 0.2, 0.0)), shape.clone());
    let compound = Shape::compound(vec![part(0.7, &simple[0]), part(-0.3, &simple[1])]).unwrap();
    let mut all = simple;
    all.push(compound);
    all
}

fn turned(random: &mut Random) -> Quat {
    let v = random.vector();
    Quat::from_xyzw(v.x, v.y, v.z, random.signed() + 1.5).normalize()
}

/// A crowd of all shapes, some fast, over a ground; edited, and not all of it computed again.
fn crowd() -> Timeline {
    let mut random = Random::new(8);
    let mut bodies = vec![BodyDef::fixed(Shape::HalfSpace)];
    for i in 0..70 {
        let shape = &shapes()[i % 7];
        let pose = Pose::new(random.vector() * 4.0 + Vec3::Y * 5.0, turned(&mut random));
        let mut def = BodyDef::new(shape.clone());
        def.pose = pose;
        def.velocity = random.vector() * if i % 5 == 0 { 200.0 } else { 5.0 };
        def.angular_velocity = random.vector() * 10.0;
        bodies.push(def);
    }
    let settings = TimelineSettings { lookahead: 50, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(&bodies, Environment::default(), settings).unwrap();
    while timeline.advance() != Progress::Idle {}
    // Up to the frame of a command all are shown where the step leads them.
    for body in (1..70).step_by(4) {
        let pose = Pose::from_position(random.vector() * 300.0);
        timeline.change(Frame(10), Change::Move { body: BodyId(body), pose }).unwrap();
    }
    while timeline.advance() != Progress::Idle {}
    let push = |body| Change::Push { body: BodyId(body), impulse: Vec3::splat(500.0), at_point: None };
    for body in [3, 17, 40] {
        timeline.change(Frame(20), push(body)).unwrap();
    }
    timeline.change(Frame(30), Change::Remove { body: BodyId(9) }).unwrap();
    for _ in 0..14 {
        let _ = timeline.advance();
    }
    timeline
}

/// At frames, between them, where bodies are late, and past the horizon.
fn times(random: &mut Random) -> Vec<f64> {
    let mut times = vec![0.0, 9.5 / 60.0, 9.9 / 60.0, 10.0 / 60.0, 0.7, 5.0];
    times.extend((0..12).map(|_| f64::from(random.signed() + 1.0) * 0.45));
    times
}

fn each(snapshot: &Snapshot, seconds: f64) -> Vec<(BodyId, Shape, Pose)> {
    let mut samples = Vec::new();
    snapshot.sample_all(seconds, &mut samples);
    let shape = |id| snapshot.body_at(id, snapshot.oldest()).unwrap().shape.clone();
    samples.into_iter().map(|(id, sample)| (id, shape(id), sample.pose)).collect()
}

#[test]
fn rays_meet_what_each_body_says() {
    let timeline = crowd();
    assert!(timeline.valid_to() < timeline.horizon());
    let snapshot = timeline.snapshot();
    let mut random = Random::new(9);
    let (mut met, mut missed) = (0, 0);
    for seconds in times(&mut random) {
        let each = each(&snapshot, seconds);
        for _ in 0..200 {
            let origin = random.vector() * 8.0 + Vec3::Y * 5.0;
            let ray = Ray { origin, direction: random.vector().normalize() };
            let max = if random.below(3) == 0 { f32::INFINITY } else { 6.0 };
            let meet = |(id, shape, pose): &(BodyId, Shape, Pose)| {
                let hit = shape.cast_ray(pose, &ray, max)?;
                Some(BodyHit { body: *id, distance: hit.distance, point: hit.point, normal: hit.normal })
            };
            let mut all: Vec<BodyHit> = each.iter().filter_map(meet).collect();
            all.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.body.cmp(&b.body)));
            // A direction of another length that is exact to scale.
            let long = Ray { direction: ray.direction * 4.0, ..ray };
            same_hits(&snapshot.cast_ray_through(seconds, &long, max), &all);
            same_hits(snapshot.cast_ray(seconds, &ray, max).as_slice(), &all[..all.len().min(1)]);
            let odd: Vec<BodyHit> = all.iter().filter(|hit| hit.body.0 % 2 == 1).copied().collect();
            let found = snapshot.cast_ray_among(seconds, &ray, max, |body| body.0 % 2 == 1);
            same_hits(found.as_slice(), &odd[..odd.len().min(1)]);
            met += all.len();
            missed += usize::from(all.is_empty());
        }
    }
    assert!(met > 1000 && missed > 1000, "{met} met, {missed} missed");
}

/// The direction is made a unit vector once more: its last bit may differ.
fn same_hits(found: &[BodyHit], expected: &[BodyHit]) {
    assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
    for (a, b) in found.iter().zip(expected) {
        assert_eq!(a.body, b.body);
        assert!((a.distance - b.distance).abs() < 1e-4 * (1.0 + b.distance), "{a:?} {b:?}");
        assert!(a.point.distance(b.point) < 1e-3 * (1.0 + b.distance), "{a:?} {b:?}");
    }
}

#[test]
fn overlaps_and_boxes_find_who_each_body_says() {
    let snapshot = crowd().snapshot();
    let mut random = Random::new(10);
    let mut found = 0;
    for seconds in times(&mut random) {
        let each = each(&snapshot, seconds);
        for shape in (0..8).flat_map(|_| shapes()) {
            let pose = Pose::new(random.vector() * 4.0 + Vec3::Y * 4.0, turned(&mut random));
            let ids = |test: &dyn Fn(&Shape, &Pose) -> bool| -> Vec<BodyId> {
                each.iter().filter(|(_, shape, pose)| test(shape, pose)).map(|(id, ..)| *id).collect()
            };
            let overlapping = snapshot.overlapping(seconds, &shape, &pose);
            assert_eq!(overlapping, ids(&|other, at| other.overlaps(at, &shape, &pose)));
            let aabb = shape.aabb(&pose);
            let inside = snapshot.in_box(seconds, &aabb);
            let bounded = ids(&|other, at| other.aabb(at).overlaps(&aabb));
            assert!(inside.iter().all(|id| bounded.contains(id)), "{inside:?} {bounded:?}");
            assert!(overlapping.iter().all(|id| inside.contains(id)), "{overlapping:?} {inside:?}");
            found += overlapping.len();
        }
    }
    assert!(found > 100, "{found}");
}

#[test]
fn a_falling_ball_is_where_galileo_says() {
    let ball = BodyDef::new(Shape::sphere(0.5).unwrap()).at(Vec3::new(0.0, 50.0, 0.0));
    let mut timeline = Timeline::new(&[ball], Environment::default(), TimelineSettings::default()).unwrap();
    while timeline.advance() != Progress::Idle {}
    let snapshot = timeline.snapshot();
    let up = Ray { origin: Vec3::new(0.3, 0.0, 0.0), direction: Vec3::Y };
    for seconds in [0.0, 0.25, 0.333, 1.0, 1.234] {
        let height = 50.0 - 0.5 * 9.81 * seconds * seconds;
        let hit = snapshot.cast_ray(seconds, &up, 60.0).unwrap();
        assert!((f64::from(hit.distance) - (height - 0.4)).abs() < 1e-4, "{seconds}: {hit:?}");
        assert!((hit.normal - Vec3::new(0.6, -0.8, 0.0)).length() < 1e-4);
        let pose = snapshot.pose(BodyId(0), seconds).unwrap();
        assert!((f64::from(pose.position.y) - height).abs() < 1e-4);
        assert_eq!(snapshot.cast_ray(seconds, &up, hit.distance - 1e-3), None);
        let touching = Shape::sphere(0.25).unwrap();
        let beside = |gap: f32| Pose::from_position(pose.position + Vec3::X * (0.75 + gap));
        assert_eq!(snapshot.overlapping(seconds, &touching, &beside(-1e-3)), [BodyId(0)]);
        assert_eq!(snapshot.overlapping(seconds, &touching, &beside(1e-3)), []);
    }
}

#[test]
fn a_point_of_a_spinning_body_moves_about_its_centre_of_mass() {
    // The own frame is one metre from the centre of mass.
    let part = (Pose::from_position(Vec3::X), Shape::sphere(0.5).unwrap());
    let def = BodyDef::new(Shape::compound(vec![part]).unwrap());
    let mut def = def.at(Vec3::new(4.0, 0.0, 0.0));
    (def.velocity, def.angular_velocity, def.gravity_scale) =
        (Vec3::new(0.0, 6.0, 0.0), Vec3::new(0.0, 0.0, 2.0), 0.0);
    let mut timeline = Timeline::new(&[def], Environment::default(), TimelineSettings::default()).unwrap();
    while timeline.advance() != Progress::Idle {}
    let snapshot = timeline.snapshot();
    for seconds in [0.0, 0.41, 1.0] {
        let centre = Vec3::new(5.0, 6.0 * seconds as f32, 0.0);
        let arm = Vec3::new(0.3, 0.2, 0.1);
        let expected = Vec3::new(-2.0 * arm.y, 6.0 + 2.0 * arm.x, 0.0);
        let found = snapshot.velocity_at(BodyId(0), centre + arm, seconds).unwrap();
        assert!((found - expected).length() < 1e-4, "{seconds}: {found}");
        let (sine, cosine) = libm::sincosf(2.0 * seconds as f32);
        let own = centre - Vec3::new(cosine, sine, 0.0);
        let pose = snapshot.pose(BodyId(0), seconds).unwrap();
        assert!((pose.position - own).length() < 1e-3, "{seconds}: {pose:?} {own}");
    }
}

#[test]
fn what_is_no_number_finds_nothing() {
    let snapshot = crowd().snapshot();
    let ray = Ray { origin: Vec3::Y * 30.0, direction: -Vec3::Y };
    assert!(snapshot.cast_ray(0.0, &ray, 100.0).is_some());
    let bad = f32::NAN;
    for (seconds, origin, direction, max) in [
        (f64::NAN, ray.origin, ray.direction, 100.0),
        (f64::INFINITY, ray.origin, ray.direction, 100.0),
        (0.0, Vec3::splat(bad), ray.direction, 100.0),
        (0.0, ray.origin, Vec3::new(0.0, bad, 0.0), 100.0),
        (0.0, ray.origin, Vec3::ZERO, 100.0),
        (0.0, ray.origin, ray.direction, bad),
        (0.0, ray.origin, ray.direction, -1.0),
    ] {
        let ray = Ray { origin, direction };
        assert_eq!(snapshot.cast_ray(seconds, &ray, max), None);
        assert_eq!(snapshot.cast_ray_through(seconds, &ray, max), []);
    }
    assert_eq!(snapshot.pose(BodyId(1), f64::NAN), None);
    assert_eq!(snapshot.pose(BodyId(1000), 0.0), None);
    assert_eq!(snapshot.velocity_at(BodyId(1), Vec3::splat(bad), 0.0), None);
    let nowhere = Pose::from_position(Vec3::splat(bad));
    assert_eq!(snapshot.overlapping(0.0, &Shape::HalfSpace, &nowhere), []);
    let all = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
    assert_eq!(snapshot.in_box(0.0, &all).len(), 71);
    assert_eq!(snapshot.in_box(0.0, &Aabb { min: all.max, max: all.min }), []);
    assert_eq!(snapshot.in_box(0.0, &Aabb { min: Vec3::splat(bad), ..all }), []);
}

/// How long the questions take with many bodies: `cargo test --release -p forerun-timeline --test queries -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
#[allow(
    clippy::disallowed_types,
    clippy::print_stdout,
    reason = "a measurement has a clock and is read by people"
)]
fn ten_thousand_bodies() {
    let cube = Shape::cuboid(Vec3::splat(0.5)).unwrap();
    let def = |i: u32| {
        let place = Vec3::new((i % 100) as f32, 40.0, (i / 100) as f32) * 1.5;
        let mut def = BodyDef::new(cube.clone()).at(place);
        def.angular_velocity = Vec3::splat(1.0);
        def
    };
    let bodies: Vec<BodyDef> = (0..10_000).map(def).collect();
    let settings = TimelineSettings { lookahead: 10, ..TimelineSettings::default() };
    let mut timeline = Timeline::new(&bodies, Environment::default(), settings).unwrap();
    while timeline.advance() != Progress::Idle {}
    let snapshot = timeline.snapshot();
    let origin = Vec3::new(-5.0, 59.9, 20.0);
    let ray = Ray { origin, direction: Vec3::new(1.0, 0.0, 0.3).normalize() };
    let ball = Shape::sphere(3.0).unwrap();
    let pose = Pose::from_position(Vec3::new(50.0, 60.0, 50.0));
    let time = |name: &str, ask: &dyn Fn(f64) -> usize| {
        for seconds in [0.1, 0.108] {
            let start = std::time::Instant::now();
            let found: usize = (0..100).map(|_| ask(seconds)).sum();
            println!("{name} at {seconds} s: {:?} for {} found", start.elapsed() / 100, found / 100);
        }
    };
    time("cast_ray", &|t| usize::from(snapshot.cast_ray(t, &ray, 1000.0).is_some()));
    time("cast_ray_through", &|t| snapshot.cast_ray_through(t, &ray, 1000.0).len());
    time("overlapping", &|t| snapshot.overlapping(t, &ball, &pose).len());
    time("in_box", &|t| snapshot.in_box(t, &ball.aabb(&pose)).len());
}
