//! Random change: what a check does to the bodies of a timeline.
//!
//! Promise: every kind of change and every number in it varies. Most sizes suit the body; one change in fifty is beyond all measure, and
//! the next one finds what that left behind.

use forerun_dynamics::{Body, BodyDef, BodyId, BodyKind, BodyState, Material, Spring};
use forerun_geometry::{Pose, Quat, Vec3};

use crate::{Change, Frame, Timeline};

/// One change in so many is beyond all measure.
const EXTREME_EVERY: u64 = 50;

/// How far beyond: from what may happen to what an f32 barely holds.
const EXTREMES: [f32; 6] = [1e3, 1e6, 1e10, 1e18, 1e27, 1e36];

/// A small generator of random numbers (splitmix64, Steele et al. 2014). For tests: nothing in the physics is random.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A generator; all its numbers follow from the seed.
    #[must_use]
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from 0 to below `end`; 0 when that is 0.
    pub fn below(&mut self, end: u64) -> u64 {
        self.bits() % end.max(1)
    }

    /// A number from -1 to 1.
    pub fn signed(&mut self) -> f32 {
        // 24 bits fit an f32 exactly.
        (self.bits() >> 40) as f32 / 8_388_608.0 - 1.0
    }

    /// A vector in the cube from -1 to 1.
    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// A random change of a body as it is stored at a frame (or the last one, if that is earlier). Reserves names for bodies to be added.
pub fn random_change(timeline: &mut Timeline, frame: Frame, random: &mut Random) -> Change {
    let stored = frame.min(timeline.horizon());
    let bodies = timeline.bodies_at(stored);
    let pick = bodies.get(random.below(bodies.len() as u64) as usize).copied();
    let looked_up = pick.and_then(|id| {
        let state = *timeline.state(id, stored)?;
        Some(Subject { id, state, body: timeline.body_at(id, stored)?.as_ref().clone() })
    });
    let extreme = random.below(EXTREME_EVERY) == 0;
    let factor = if extreme { EXTREMES[random.below(EXTREMES.len() as u64) as usize] } else { 1.0 };
    // Nobody is there: gravity is all that can change.
    let Some(subject) = looked_up else {
        return Change::SetGravity { gravity: random.vector() * (10.0 * factor) };
    };
    match random.below(100) {
        0..68 => subject.moved(timeline, factor, random),
        68..98 => subject.altered(factor, random),
        _ => Change::SetGravity { gravity: Vec3::new(0.0, -9.81, 0.0) + random.vector() * factor },
    }
}

/// Whom the change is about.
struct Subject {
    id: BodyId,
    state: BodyState,
    body: Body,
}

impl Subject {
    /// A length that suits the body. Metres.
    fn size(&self) -> f32 {
        if self.body.radius.is_finite() { self.body.radius.min(2.0) } else { 1.0 }
    }

    /// kg.
    fn mass(&self) -> f32 {
        if self.body.inverse_mass > 0.0 { 1.0 / self.body.inverse_mass } else { 1.0 }
    }

    /// What changes where the body is, how it moves, or whether it is there.
    fn moved(&self, timeline: &mut Timeline, factor: f32, random: &mut Random) -> Change {
        let Subject { id: body, state, body: what } = self;
        let (body, size, pose) = (*body, self.size(), what.own_pose(state));
        match random.below(65) {
            0..20 => Change::Push {
                body,
                impulse: random.vector() * (3.0 * self.mass() * factor),
                at_point: (random.below(2) == 0).then(|| state.position + random.vector() * size),
            },
            20..32 => match timeline.definitions.def(body).filter(|_| what.is_dynamic()).cloned() {
                Some(def) => {
                    let above =
                        Pose { position: pose.position + random.vector() * (3.0 * size * factor), ..pose };
                    let def = BodyDef { pose: above, velocity: random.vector(), ..BodyDef::clone(&def) };
                    Change::Add { body: timeline.reserve_body(), def: Box::new(def) }
                }
                None => Change::Release { body },
            },
            32..42 => Change::Remove { body },
            42..52 => {
                let moved = pose.position + random.vector() * (2.0 * size * factor);
                let (v, w) = (random.vector(), random.signed());
                let turned = Quat::from_xyzw(v.x, v.y, v.z, w + 2.0).normalize();
                Change::Move { body, pose: Pose { position: moved, rotation: turned } }
            }
            // An edit that changes nothing, at most the body's rest.
            52..57 => Change::Push { body, impulse: Vec3::ZERO, at_point: None },
            _ => Change::SetVelocity {
                body,
                velocity: random.vector() * (3.0 * factor),
                angular_velocity: random.vector() * (3.0 * factor),
            },
        }
    }

    /// What changes the body itself: spring, surface, forces, kind.
    fn altered(&self, factor: f32, random: &mut Random) -> Change {
        let (body, size) = (self.id, self.size());
        match random.below(37) {
            0..8 => Change::Hold { body, spring: self.spring(factor, random) },
            8..12 => Change::Release { body },
            12..18 => {
                let friction = (0.5 + 0.5 * random.signed()) * factor;
                let extra = if random.below(2) == 0 { 0.0 } else { 1.0 + random.signed() };
                let restitution = if random.below(2) == 0 { 0.0 } else { 0.5 + 0.5 * random.signed() };
                let static_friction = friction + extra * friction;
                Change::SetMaterial { body, material: Material { friction, static_friction, restitution } }
            }
            18..23 => Change::SetForce {
                body,
                force: random.vector() * (4.0 * self.mass() * factor),
                torque: random.vector()
                    * (if random.below(2) == 0 { 0.0 } else { self.mass() * size * factor }),
            },
            23..28 => Change::SetGravityScale { body, scale: random.signed() * factor },
            // Up to eight times heavier or lighter.
            28..32 => {
                let times = (1.0 + 7.0 * random.signed().abs()) * factor.abs().max(0.01);
                let mass = if random.below(2) == 0 { self.mass() * times } else { self.mass() / times };
                Change::SetMass { body, mass: mass.clamp(1e-6, 1e9) }
            }
            _ => {
                let kinds = [BodyKind::Dynamic, BodyKind::Fixed, BodyKind::Kinematic];
                Change::SetKind { body, kind: kinds[random.below(3) as usize] }
            }
        }
    }

    /// Soft or stiff, loose or overdamped, to a near place or, one time in four, a far one.
    fn spring(&self, factor: f32, random: &mut Random) -> Spring {
        const FREQUENCIES_HZ: [f32; 5] = [0.1, 1.5, 5.0, 30.0, 1000.0];
        const DAMPING_RATIOS: [f32; 4] = [0.0, 0.7, 1.0, 10.0];
        let far = if random.below(4) == 0 { 50.0 } else { 1.0 };
        let (anchor, target) = (random.vector() * (0.5 * self.size()), random.vector() * (2.0 * self.size()));
        Spring {
            anchor,
            target: self.body.own_pose(&self.state).position + target * (far * factor),
            frequency_hz: FREQUENCIES_HZ[random.below(FREQUENCIES_HZ.len() as u64) as usize],
            damping_ratio: DAMPING_RATIOS[random.below(DAMPING_RATIOS.len() as u64) as usize],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TimelineSettings;
    use forerun_dynamics::Environment;
    use forerun_geometry::shape::{Cuboid, Shape};

    /// What a check never does, it never shows.
    #[test]
    fn every_number_varies_and_some_are_extreme() {
        let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
        let bodies = [BodyDef::new(cube.clone()), BodyDef::new(cube).at(Vec3::Y)];
        let mut timeline =
            Timeline::new(&bodies, Environment::default(), TimelineSettings::default()).unwrap();
        let mut random = Random::new(1);
        let changes: Vec<Change> =
            (0..20_000).map(|_| random_change(&mut timeline, Frame(0), &mut random)).collect();
        let any = |test: fn(&Change) -> bool| assert!(changes.iter().any(test));
        any(|c| matches!(c, Change::SetForce { torque, .. } if *torque != Vec3::ZERO));
        any(|c| matches!(c, Change::SetMaterial { material, .. } if material.restitution > 0.5));
        any(|c| matches!(c, Change::SetMaterial { material: m, .. } if m.static_friction > m.friction));
        any(|c| matches!(c, Change::Hold { spring, .. } if spring.frequency_hz > 100.0));
        any(|c| matches!(c, Change::Hold { spring, .. } if spring.damping_ratio == 0.0));
        any(|c| matches!(c, Change::Hold { spring, .. } if (20.0..1e3).contains(&spring.target.length())));
        any(|c| matches!(c, Change::Push { impulse, .. } if impulse.length() > 1e15));
        any(|c| matches!(c, Change::SetVelocity { velocity, .. } if velocity.length() > 1e15));
        any(|c| matches!(c, Change::Move { pose, .. } if pose.position.length() > 1e15));
        any(|c| matches!(c, Change::SetGravity { gravity } if gravity.length() > 1e9));
        // Nearly all of them, extreme or not, are accepted.
        let refused = changes.iter().filter(|change| change.check_numbers().is_err()).count();
        assert!(refused < 200, "{refused} of 20000");
    }
}
