//! World: bodies and one state each, for those who want no timeline.

use crate::broad_phase::{Bound, overlapping_pairs};
use crate::narrow_phase::find_contacts;
use crate::step::{Group, Member, StepReport, advance};
use crate::{Body, BodyDef, BodyError, BodyId, BodyState, Environment, Observer, Stage, bounds};

/// Bodies at one frame.
#[derive(Clone, Debug, Default)]
pub struct World {
    bodies: Vec<Body>,
    states: Vec<BodyState>,
    /// Gravity and settings.
    pub environment: Environment,
}

impl World {
    /// An empty world.
    #[must_use]
    pub fn new(environment: Environment) -> Self {
        World { bodies: Vec::new(), states: Vec::new(), environment }
    }

    /// Adds a body.
    ///
    /// # Errors
    /// When the definition is not possible; see [`Body::new`].
    pub fn add(&mut self, def: &BodyDef) -> Result<BodyId, BodyError> {
        let (body, state) = Body::new(def)?;
        self.bodies.push(body);
        self.states.push(state);
        Ok(BodyId(self.bodies.len() as u32 - 1))
    }

    /// All bodies, in the order of their ids.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// All bodies, to be changed.
    pub fn bodies_mut(&mut self) -> &mut [Body] {
        &mut self.bodies
    }

    /// The state of each body, in the order of their ids.
    #[must_use]
    pub fn states(&self) -> &[BodyState] {
        &self.states
    }

    /// The states, to be changed. A state that is not finite stops the body at the next step.
    pub fn states_mut(&mut self) -> &mut [BodyState] {
        &mut self.states
    }

    /// Goes on by one frame.
    pub fn step(&mut self, observer: &mut dyn Observer) -> StepReport {
        let members: Vec<Member> = (self.bodies.iter().zip(&self.states).enumerate())
            .map(|(i, (body, state))| Member { id: BodyId(i as u32), body, state: *state })
            .collect();
        let bounds: Vec<Bound> = members
            .iter()
            .map(|m| Bound {
                aabb: bounds::swept_bound(m.body, &m.state, &self.environment),
                dynamic: m.body.is_dynamic(),
            })
            .collect();
        let pairs = overlapping_pairs(&bounds);
        let contacts = find_contacts(&members, &pairs, &self.environment);
        observer.after(Stage::Collisions);
        let group = Group { members: &members, pairs: &pairs, contacts: &contacts };
        let (next, report) = advance(&group, &self.environment, observer);
        self.states = next;
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
