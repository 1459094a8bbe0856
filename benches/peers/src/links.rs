//! Links: which rings go through which, and which hang round a pole: what must not change, however hard they hit.

use std::collections::BTreeMap;
use std::f32::consts::TAU;

use forerun::scene::mesh::MeshSource;
use forerun::scene::{BodyEntry, MeshEntry, ShapeEntry};
use forerun::{BodyKind, Pose, Quat, Scene, Shape, Vec3};
use serde::{Deserialize, Serialize};

use crate::engine::Motion;
use crate::stage::Stage;

/// Corners of a ring's middle line.
const CORNERS: u8 = 48;
/// Moments between two frames at which a ring is looked for on its way through a pole.
const MOMENTS: u8 = 32;

/// What became of links and threaded poles.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct LinkCount {
    /// Rings.
    pub(crate) rings: usize,
    /// Pairs of rings through each other at the start, and how many of these still are at the end.
    pub(crate) linked: [usize; 2],
    /// How often two rings went through each other's tube.
    pub(crate) links_changed: usize,
    /// Poles.
    pub(crate) poles: usize,
    /// How often a ring went through a pole below its top.
    pub(crate) poles_passed: usize,
    /// Rings round a pole at the end.
    pub(crate) threaded: usize,
    /// Rings that rest on top of a pole at the end.
    pub(crate) on_top: usize,
}

/// The middle line of a ring in its own frame: a circle about y, its halves moved apart along x.
#[derive(Clone, Copy, Debug)]
struct Ring {
    body: usize,
    radius: f32,
    half_length: f32,
    tube_radius: f32,
}

/// A fixed cylinder along the world's y.
#[derive(Clone, Copy, Debug)]
struct Pole {
    foot: Vec3,
    top: f32,
}

/// Follows the rings of a scene.
pub(crate) struct Links {
    rings: Vec<Ring>,
    poles: Vec<Pole>,
    poses: Vec<Pose>,
    speeds: Vec<f32>,
    /// Linking numbers that are not 0, by places in `rings`.
    linked: BTreeMap<[usize; 2], i32>,
    linked_at_start: Vec<[usize; 2]>,
    links_changed: usize,
    poles_passed: usize,
}

impl Links {
    pub(crate) fn of(scene: &Scene, stage: &Stage) -> Self {
        let ring = |(body, entry): (usize, &BodyEntry)| {
            let ShapeEntry::Mesh(name) = &entry.shape else { return None };
            Ring::of(body, scene.meshes.get(name)?)
        };
        let rings: Vec<Ring> = scene.bodies.iter().enumerate().filter_map(ring).collect();
        let pole = |actor: &crate::stage::Actor| {
            let (Shape::Cylinder(cylinder), BodyKind::Fixed) = (&actor.def.shape, actor.def.kind) else {
                return None;
            };
            let middle = actor.def.pose.position;
            let upright = (actor.def.pose.rotation * Vec3::Y).y > 0.999;
            upright.then_some(Pole { foot: middle, top: middle.y + cylinder.half_height })
        };
        let poles: Vec<Pole> = stage.actors.iter().filter_map(pole).collect();
        let poses: Vec<Pose> = rings.iter().map(|ring| stage.actors[ring.body].def.pose).collect();
        let speeds = vec![0.0; poses.len()];
        let mut links = Links {
            rings,
            poles,
            poses,
            speeds,
            linked: BTreeMap::new(),
            linked_at_start: Vec::new(),
            links_changed: 0,
            poles_passed: 0,
        };
        links.linked = links.linking_numbers();
        links.linked_at_start = links.linked.keys().copied().collect();
        links
    }

    /// Every frame, so that nothing goes there and back unseen.
    pub(crate) fn look_at(&mut self, motions: &[Motion]) {
        let new: Vec<Pose> = self.rings.iter().map(|ring| motions[ring.body].pose).collect();
        if new.iter().any(|pose| !pose.position.is_finite() || !pose.rotation.is_finite()) {
            return;
        }
        self.poles_passed += self.passed(&new);
        self.poses = new;
        self.speeds = self.rings.iter().map(|ring| motions[ring.body].velocity.length()).collect();
        let linked = self.linking_numbers();
        let all: std::collections::BTreeSet<_> = linked.keys().chain(self.linked.keys()).collect();
        self.links_changed +=
            all.into_iter().filter(|pair| linked.get(*pair) != self.linked.get(*pair)).count();
        self.linked = linked;
    }

    /// None when the scene has nothing that can be linked.
    pub(crate) fn finish(&self) -> Option<LinkCount> {
        let threaded = |(ring, pose): (&Ring, &Pose)| {
            let round = |pole: &&Pole| ring.height_on(pose, pole).is_some_and(|height| height < pole.top);
            self.poles.iter().find(round).is_some()
        };
        let rests_on_top = |((ring, pose), speed): ((&Ring, &Pose), &f32)| {
            let over = |pole: &&Pole| {
                let aside = (pose.position - pole.foot) * Vec3::new(1.0, 0.0, 1.0);
                aside.length() < ring.reach()
                    && (0.0..2.0 * ring.reach()).contains(&(pose.position.y - pole.top))
            };
            *speed < 0.3 && self.poles.iter().any(|pole| over(&pole))
        };
        let still = self.linked_at_start.iter().filter(|pair| self.linked.contains_key(*pair)).count();
        let placed = || self.rings.iter().zip(&self.poses);
        (self.rings.len() > 1).then(|| LinkCount {
            rings: self.rings.len(),
            linked: [self.linked_at_start.len(), still],
            links_changed: self.links_changed,
            poles: self.poles.len(),
            poles_passed: self.poles_passed,
            threaded: placed().filter(|placed| threaded(*placed)).count(),
            on_top: placed().zip(&self.speeds).filter(|placed| rests_on_top(*placed)).count(),
        })
    }

    fn linking_numbers(&self) -> BTreeMap<[usize; 2], i32> {
        let mut found = BTreeMap::new();
        for (i, (a, a_pose)) in self.rings.iter().zip(&self.poses).enumerate() {
            for (j, (b, b_pose)) in self.rings.iter().zip(&self.poses).enumerate().skip(i + 1) {
                if a_pose.position.distance(b_pose.position) < a.reach() + b.reach() {
                    let number = a.linking_number(a_pose, b, b_pose);
                    if number != 0 {
                        found.insert([i, j], number);
                    }
                }
            }
        }
        found
    }

    /// How often rings go through poles on their way to the new poses.
    fn passed(&self, new: &[Pose]) -> usize {
        let mut count = 0;
        for ((ring, old), new) in self.rings.iter().zip(&self.poses).zip(new) {
            for pole in &self.poles {
                let near = |pose: &Pose| {
                    let aside = (pose.position - pole.foot) * Vec3::new(1.0, 0.0, 1.0);
                    aside.length() < ring.reach() && pose.position.y - ring.reach() < pole.top
                };
                if near(old) || near(new) {
                    count += ring.passes(old, new, pole);
                }
            }
        }
        count
    }
}

impl Ring {
    fn of(body: usize, entry: &MeshEntry) -> Option<Ring> {
        let (radius, half_length, tube_radius) = match &entry.source {
            MeshSource::Torus(torus) => (torus.radius, 0.0, torus.tube_radius),
            MeshSource::Link(link) => (link.radius, 0.5 * link.straight, link.tube_radius),
            _ => return None,
        };
        let scale = entry.scale;
        Some(Ring {
            body,
            radius: radius * scale,
            half_length: half_length * scale,
            tube_radius: tube_radius * scale,
        })
    }

    /// From the middle to the farthest point of the middle line. Metres.
    fn reach(&self) -> f32 {
        self.half_length + self.radius
    }

    /// Whether a point of the ring's plane, in its own frame, is within the middle line.
    fn encloses(&self, p: Vec3) -> bool {
        p.distance(Vec3::X * p.x.clamp(-self.half_length, self.half_length)) < self.radius
    }

    fn corner(&self, k: u8) -> Vec3 {
        let way = Quat::from_rotation_y(TAU * (f32::from(k) + 0.5) / f32::from(CORNERS)) * Vec3::X;
        way * self.radius + Vec3::X * self.half_length.copysign(way.x)
    }

    /// How often the middle line of this ring goes through the disc of another, one way less the other.
    fn linking_number(&self, pose: &Pose, other: &Ring, other_pose: &Pose) -> i32 {
        let to_other = other_pose.inverse() * *pose;
        let corner = |k: u8| to_other.transform_point(self.corner(k % CORNERS));
        (0..CORNERS).filter_map(|k| other.crossing(corner(k), corner(k + 1))).map(|(_, side)| side).sum()
    }

    /// Where on the way from `a` to `b` (0 to 1, in the ring's own frame) its disc is crossed, and to which side.
    fn crossing(&self, a: Vec3, b: Vec3) -> Option<(f32, i32)> {
        if (a.y < 0.0) == (b.y < 0.0) {
            return None;
        }
        let part = a.y / (a.y - b.y);
        self.encloses(a.lerp(b, part) * Vec3::new(1.0, 0.0, 1.0))
            .then_some((part, if b.y < 0.0 { -1 } else { 1 }))
    }

    /// Height at which the line through a pole, which goes on above it, crosses the ring's disc. Metres.
    fn height_on(&self, pose: &Pose, pole: &Pole) -> Option<f32> {
        let far = 2.0 * self.reach() + pose.position.y.abs() + pole.top.abs();
        let own = |y: f32| pose.inverse_transform_point(Vec3::new(pole.foot.x, y, pole.foot.z));
        let (part, _) = self.crossing(own(-far), own(far))?;
        Some(-far + 2.0 * far * part)
    }

    /// How often the ring comes off a pole, or round it, other than over its top, on its way between two poses.
    fn passes(&self, old: &Pose, new: &Pose, pole: &Pole) -> usize {
        let at = |k: u8| {
            let part = f32::from(k) / f32::from(MOMENTS);
            let position = old.position.lerp(new.position, part);
            self.height_on(&Pose::new(position, old.rotation.slerp(new.rotation, part)), pole)
        };
        let through = |k: &u8| match (at(*k), at(*k + 1)) {
            (Some(height), None) | (None, Some(height)) => height < pole.top - self.tube_radius,
            _ => false,
        };
        (0..MOMENTS).filter(through).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn links(scene: &str) -> (Links, Vec<Motion>) {
        let scene = Scene::open(scene).unwrap();
        let stage = Stage::of(&scene).unwrap();
        let still = |actor: &crate::stage::Actor| Motion {
            pose: actor.def.pose,
            velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
        };
        let motions = stage.actors.iter().map(still).collect();
        (Links::of(&scene, &stage), motions)
    }

    #[test]
    fn a_ring_pulled_through_another_is_seen_and_one_moved_around_it_is_not() {
        let (mut links, mut motions) = links("tori:2");
        let upright = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
        motions[1].pose = Pose::from_position(Vec3::Y * 5.0);
        for x in [3.0, 1.2, 0.8, 0.5, 0.3] {
            motions[2].pose = Pose::new(Vec3::new(x, 5.0, 0.0), upright);
            links.look_at(&motions);
        }
        let linked = links.finish().unwrap();
        assert_eq!((linked.links_changed, linked.linked, links.linked.len()), (1, [0, 0], 1));
        motions[2].pose.position.y = 9.0;
        links.look_at(&motions);
        assert_eq!(links.finish().unwrap().links_changed, 2);
    }

    #[test]
    fn a_ring_may_come_over_the_top_of_a_pole_and_not_through_its_side() {
        let (mut links, mut motions) = links("rings:2");
        // The middle pole of 25, 20 m high; rings have radii 1.5 and 0.4 m.
        let ring = 26;
        let lie = |x: f32, y: f32| Pose::from_position(Vec3::new(x, y, 0.0));
        let mut show = |x: f32, y: f32| {
            motions[ring].pose = lie(x, y);
            links.look_at(&motions);
            let count = links.finish().unwrap();
            (count.poles_passed, count.threaded)
        };
        show(3.0, 30.0);
        assert_eq!(show(0.5, 21.0), (0, 0));
        assert_eq!(show(0.5, 19.0), (0, 1));
        assert_eq!(show(0.9, 5.0), (0, 1));
        assert_eq!(show(2.0, 5.0), (1, 0));
        assert_eq!(show(0.0, 4.0), (2, 1));
        motions[ring].pose = lie(0.4, 20.4);
        links.look_at(&motions);
        assert_eq!(links.finish().unwrap().on_top, 1);
    }

    #[test]
    fn a_chain_starts_linked() {
        let (links, _) = links("chain");
        let count = links.finish().unwrap();
        assert_eq!(count.linked, [count.rings - 1; 2]);
    }
}
