//! The eight-lane kernel against the scalar reference of the geometry crate.

use forerun_geometry::contact::{contact_manifolds, cuboid_cuboid};
use forerun_geometry::shape::Cuboid;
use forerun_geometry::{Placed, Pose, Quat, Shape, Vec3};

use super::cuboids::{Boxes, cuboid_contacts};
use super::{FAST, Outlook, find_contacts};
use crate::bounds::{Prospect, pair_margin};
use crate::{Body, BodyDef, BodyId, Environment, Member};

struct Random(u64);

impl Random {
    fn between(&mut self, low: f32, high: f32) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 40) as f32 / (1u64 << 24) as f32)
    }

    fn vector(&mut self, reach: f32) -> Vec3 {
        Vec3::new(self.between(-reach, reach), self.between(-reach, reach), self.between(-reach, reach))
    }

    /// Half of the poses are nearly aligned, as in stacks.
    fn pose(&mut self, reach: f32) -> Pose {
        let spread = if self.between(0.0, 1.0) < 0.5 { 0.02 } else { 1.0 };
        let v = self.vector(spread);
        Pose::new(self.vector(reach), Quat::from_xyzw(v.x, v.y, v.z, 1.0).normalize())
    }
}

#[test]
fn eight_lanes_find_the_manifolds_of_the_reference() {
    let mut r = Random(11);
    let (mut bodies, mut pairs) = (Vec::new(), Vec::new());
    for _ in 0..6002 {
        let half_extents = Vec3::splat(0.7) + r.vector(0.5);
        let pose = r.pose(0.9);
        let shape = Shape::Cuboid(Cuboid { half_extents });
        let def =
            BodyDef { pose, velocity: r.vector(0.8), angular_velocity: r.vector(0.2), ..BodyDef::new(shape) };
        bodies.push(Body::new(&def).unwrap());
    }
    let members: Vec<Member> = (bodies.iter().enumerate())
        .map(|(i, (body, state))| Member { id: BodyId(i as u32), body, state: *state })
        .collect();
    let environment = Environment::default();
    let prospects: Vec<Prospect> =
        members.iter().map(|m| Prospect::new(m.body, &m.state, &environment)).collect();
    let outlook = Outlook { members: &members, prospects: &prospects, environment: &environment };
    let mut boxes = Boxes::default();
    boxes.fill(&outlook);
    for i in 0..3001 {
        pairs.push((i, i + 3001));
    }
    let (mut found, mut fast) = (Vec::new(), Vec::new());
    cuboid_contacts(&boxes, &pairs, &mut found, &mut fast);
    let mut found = found.into_iter().peekable();
    let mut fast = fast.into_iter().peekable();
    let (mut differing, mut quick) = (0, 0);
    for pair in pairs {
        let place = |i: u32| match &members[i as usize].body.shape {
            Shape::Cuboid(cuboid) => (cuboid, &prospects[i as usize]),
            _ => unreachable!(),
        };
        let ((a, pa), (b, pb)) = (place(pair.0), place(pair.1));
        let margin = pair_margin(pa, pb, &environment);
        let is_fast = margin > FAST * environment.settings.contact_margin_m;
        assert_eq!(fast.next_if_eq(&pair).is_some(), is_fast, "margin {margin}");
        let ours = found.next_if(|c| (c.first, c.second) == pair).map(|c| c.manifold);
        if is_fast {
            assert!(ours.is_none());
            quick += 1;
            continue;
        }
        let reference = cuboid_cuboid(a, &pa.pose, b, &pb.pose, margin);
        let same = match (&reference, &ours) {
            (None, None) => true,
            (Some(x), Some(y)) => {
                x.normal.dot(y.normal) > 0.999
                    && (x.deepest() - y.deepest()).abs() < 1e-4
                    && x.count == y.count
            }
            _ => false,
        };
        differing += usize::from(!same);
    }
    assert!(found.next().is_none() && fast.next().is_none(), "a manifold for no pair");
    assert!((300..1500).contains(&quick), "{quick} pairs are fast");
    // Ties between axes or corners fall either way by rounding, in one pair of a hundred at most: half of the boxes are nearly aligned.
    assert!(differing <= 30, "{differing} manifolds differ");
}

/// Boxes in, on and over a ground that is level or not, before and after it in the order of bodies.
#[test]
fn eight_boxes_on_the_ground_touch_as_one_does() {
    let mut r = Random(5);
    let mut defs = Vec::new();
    for i in 0..600 {
        let half_extents = Vec3::splat(0.7) + r.vector(0.5);
        let mut pose = r.pose(0.9);
        let ground = i % 100 == 50;
        if ground {
            pose = Pose::new(r.vector(0.3), Quat::from_xyzw(r.between(-0.3, 0.3), 0.2, 0.1, 1.0).normalize());
        }
        let def = if ground {
            BodyDef::fixed(Shape::HalfSpace)
        } else {
            BodyDef::new(Shape::Cuboid(Cuboid { half_extents }))
        };
        defs.push(BodyDef { pose, velocity: r.vector(3.0), angular_velocity: r.vector(1.0), ..def });
    }
    let bodies: Vec<_> = defs.iter().map(|def| Body::new(def).unwrap()).collect();
    let members: Vec<Member> = (bodies.iter().enumerate())
        .map(|(i, (body, state))| Member { id: BodyId(i as u32), body, state: *state })
        .collect();
    let pairs: Vec<(u32, u32)> = (0..6u32)
        .flat_map(|g| (0..600).filter(|i| i % 100 != 50).map(move |i| (100 * g + 50, i)))
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect::<std::collections::BTreeSet<_>>()
        .into_iter()
        .collect();
    let environment = Environment::default();
    let mut found = find_contacts(&members, &pairs, &environment).into_iter().peekable();
    let mut points = [0; 5];
    for pair in pairs {
        let placed = |i: u32| {
            let member = &members[i as usize];
            let prospect = Prospect::new(member.body, &member.state, &environment);
            (Placed { shape: &member.body.shape, pose: prospect.pose, motion: prospect.motion }, prospect)
        };
        let ((a, pa), (b, pb)) = (placed(pair.0), placed(pair.1));
        let mut reference = Vec::new();
        contact_manifolds(&a, &b, pair_margin(&pa, &pb, &environment), &mut reference);
        let ours = found.next_if(|c| (c.first, c.second) == pair).map(|c| c.manifold);
        assert_eq!(ours.is_some(), !reference.is_empty(), "{pair:?}");
        let (Some(ours), Some(reference)) = (ours, reference.first()) else { continue };
        points[ours.count as usize] += 1;
        assert_eq!(ours.count, reference.count, "{pair:?}");
        for (x, y) in ours.points().iter().zip(reference.points()) {
            assert!((x.position - y.position).length() < 1e-5, "{pair:?}: {x:?} {y:?}");
            // Found where the bodies are halfway, and told of where they are at the start.
            let start = |i: u32| members[i as usize].state.position;
            let way = pb.halfway.way(start(pair.1), y.position) - pa.halfway.way(start(pair.0), y.position);
            let separation = y.separation - y.normal.dot(way);
            assert!((x.normal - y.normal).length() < 1e-6 && (x.separation - separation).abs() < 1e-5);
        }
    }
    assert!(found.next().is_none());
    assert!(points[1..].iter().all(|&count| count > 20), "{points:?}");
}
