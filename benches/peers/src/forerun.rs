//! forerun: a bare world, as `forerun bench --awake` steps it.

use forerun::dynamics::{Unobserved, World};

use crate::engine::{Engine, Motion};
use crate::stage::Stage;

pub(crate) struct Forerun {
    world: World,
}

impl Forerun {
    pub(crate) fn new(stage: &Stage) -> Result<Self, String> {
        let mut world = World::new(stage.environment);
        for actor in &stage.actors {
            world.add(&actor.def).map_err(|error| error.to_string())?;
        }
        Ok(Forerun { world })
    }
}

impl Engine for Forerun {
    fn step(&mut self) -> Result<(), String> {
        let report = self.world.step(&mut Unobserved);
        if report.quarantined > 0 { Err("a state was not finite".to_owned()) } else { Ok(()) }
    }

    fn motions(&self) -> Vec<Motion> {
        let motion = |(body, state): (&forerun::Body, &forerun::BodyState)| Motion {
            pose: body.own_pose(state),
            velocity: state.velocity,
            angular_velocity: state.angular_velocity,
        };
        self.world.bodies().iter().zip(self.world.states()).map(motion).collect()
    }
}
