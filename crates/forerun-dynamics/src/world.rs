//! World: bodies and one state each, for those who want no timeline.

use crate::detection::Detection;
use crate::scratch::{StepScratch, emptied};
use crate::step::{Group, Known, Member, StepReport, advance_islands};
use crate::stillness::Stillness;
use crate::{Body, BodyDef, BodyError, BodyId, BodyState, Environment, Observer, Stage, Touch, Touches};

/// Bodies at one frame.
#[derive(Clone, Debug, Default)]
pub struct World {
    bodies: Vec<Body>,
    states: Vec<BodyState>,
    detection: Detection,
    scratch: StepScratch,
    stillness: Stillness,
    /// Gravity and settings. While [`Environment::check`] refuses them, [`World::step`] moves nothing.
    pub environment: Environment,
}

impl World {
    /// An empty world.
    #[must_use]
    pub fn new(environment: Environment) -> Self {
        World { environment, ..World::default() }
    }

    /// Adds a body.
    ///
    /// # Errors
    /// When the definition is not possible; see [`Body::new`].
    pub fn add(&mut self, def: &BodyDef) -> Result<BodyId, BodyError> {
        let (body, state) = Body::new(def)?;
        self.bodies.push(body);
        self.states.push(state);
        self.stillness.forget();
        Ok(BodyId(self.bodies.len() as u32 - 1))
    }

    /// Puts in a body that was made before, in some state.
    pub fn put(&mut self, body: Body, state: BodyState) -> BodyId {
        self.bodies.push(body);
        self.states.push(state);
        self.stillness.forget();
        BodyId(self.bodies.len() as u32 - 1)
    }

    /// Takes a body out; those after it have ids that are one less from then on. `None` when there is no such body.
    pub fn remove(&mut self, body: BodyId) -> Option<(Body, BodyState)> {
        let place = body.0 as usize;
        if place >= self.bodies.len() {
            return None;
        }
        self.stillness.forget();
        Some((self.bodies.remove(place), self.states.remove(place)))
    }

    /// All bodies, in the order of their ids.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// All bodies, to be changed.
    pub fn bodies_mut(&mut self) -> &mut [Body] {
        self.stillness.forget();
        &mut self.bodies
    }

    /// The state of each body, in the order of their ids.
    #[must_use]
    pub fn states(&self) -> &[BodyState] {
        &self.states
    }

    /// The states, to be changed. A state that is not finite stops the body at the next step.
    pub fn states_mut(&mut self) -> &mut [BodyState] {
        self.stillness.forget();
        &mut self.states
    }

    /// Goes on by one frame; stands still, with an empty report, in an environment that is not possible. While all bodies rest, and nothing is changed
    /// from outside, there is nothing to do.
    pub fn step(&mut self, observer: &mut dyn Observer) -> StepReport {
        self.advance(observer, None)
    }

    /// As [`World::step`], with the same bits, and tells who touched whom during the frame. `touches` is what the step before told (at
    /// first: the default), as bodies at rest are not looked at again.
    pub fn step_touching(&mut self, observer: &mut dyn Observer, touches: &mut Touches) -> StepReport {
        if touches.resting.len() == self.states.len() && self.stillness.everybody(&self.environment) {
            return StepReport::of_nothing();
        }
        let before = std::mem::take(touches);
        let report = self.advance(observer, Some(touches));
        let rests = |id: BodyId| touches.resting.get(id.0 as usize).is_some_and(|resting| *resting);
        let stayed: Vec<Touch> =
            before.list.into_iter().filter(|touch| rests(touch.first) || rests(touch.second)).collect();
        touches.list.extend(stayed);
        touches.list.sort_by_key(|touch| (touch.first, touch.second));
        report
    }

    fn advance(&mut self, observer: &mut dyn Observer, touches: Option<&mut Touches>) -> StepReport {
        if self.environment.check().is_err() {
            return StepReport::default();
        }
        if touches.is_none() && self.stillness.everybody(&self.environment) {
            return StepReport::of_nothing();
        }
        let World { bodies, states, detection, scratch, stillness, environment } = self;
        let mut members: Vec<Member> = std::mem::take(&mut scratch.members);
        members.extend((bodies.iter().zip(&*states).enumerate()).map(|(i, (body, state))| Member {
            id: BodyId(i as u32),
            body,
            state: *state,
        }));
        detection.find_pairs(&members, environment);
        stillness.set_apart(&members, environment, &mut detection.pairs);
        detection.find_contacts(&members, environment);
        observer.after(Stage::Collisions);
        let group = Group { members: &members, pairs: &detection.pairs, contacts: &detection.contacts };
        let known = Known { still: &stillness.still, touches, close_up: None };
        let report = advance_islands(&group, environment, observer, known, scratch);
        scratch.members = emptied(members);
        stillness.note((states, &scratch.next), &scratch.plan.resting, environment);
        std::mem::swap(states, &mut scratch.next);
        report
    }

    /// A 64-bit hash of all states, the same on every platform (FNV-1a over their bits).
    #[must_use]
    pub fn state_hash(&self) -> u64 {
        let bytes = self.states.iter().flat_map(BodyState::bits).flat_map(u32::to_le_bytes);
        bytes
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    }
}

#[cfg(test)]
mod tests {
    use forerun_geometry::Vec3;
    use forerun_geometry::shape::{Cuboid, Shape};

    use super::*;
    use crate::Unobserved;

    /// Two boxes on the ground, in an environment that `change` has touched, after ten frames.
    fn ten_frames(change: impl Fn(&mut Environment)) -> World {
        let mut world = World::default();
        let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
        let ground = Shape::Cuboid(Cuboid { half_extents: Vec3::new(9.0, 0.5, 9.0) });
        world.add(&BodyDef::fixed(ground).at(Vec3::new(0.0, -0.5, 0.0))).unwrap();
        world.add(&BodyDef::new(cube.clone()).at(Vec3::new(0.0, 0.5, 0.0))).unwrap();
        world.add(&BodyDef::new(cube).at(Vec3::new(0.1, 2.5, 0.0))).unwrap();
        change(&mut world.environment);
        for _ in 0..10 {
            world.step(&mut Unobserved);
        }
        world
    }

    #[test]
    fn an_environment_that_is_not_possible_moves_nothing() {
        let start = ten_frames(|e| e.settings.frame_seconds = 0.0).state_hash();
        assert_ne!(ten_frames(|_| ()).state_hash(), start);
        assert_eq!(ten_frames(|e| e.settings.substeps = 0).state_hash(), start);
        assert_eq!(ten_frames(|e| e.settings.slices_max = 0).state_hash(), start);
        assert_eq!(ten_frames(|e| e.gravity.x = f32::NAN).state_hash(), start);
    }

    #[test]
    fn the_ends_of_the_ranges_make_no_nan() {
        let changes: [fn(&mut Environment); 10] = [
            |e| e.gravity = Vec3::ZERO,
            |e| e.gravity = Vec3::splat(f32::MAX),
            |e| e.gravity = Vec3::splat(f32::MIN_POSITIVE),
            |e| e.settings.frame_seconds = 0.000_01,
            |e| e.settings.frame_seconds = 1.0,
            |e| (e.settings.substeps, e.settings.first_sweeps, e.settings.first_sweeps_hard) = (1, 1, 1),
            |e| (e.settings.overlap_recovery, e.settings.shock_yield) = (0.0, 0.0),
            |e| (e.settings.contact_margin_m, e.settings.overlap_allowed_m) = (0.0, 0.0),
            |e| e.settings.rest_seconds = f32::MAX,
            |e| e.settings.recovery_speed_max = f32::MAX,
        ];
        for change in changes {
            let world = ten_frames(change);
            assert_eq!(world.environment.check(), Ok(()));
            assert!(world.states().iter().all(BodyState::is_finite), "{:?}", world.environment);
        }
    }
}
