//! forerun: a bare world, as `forerun bench --awake` steps it.

use std::num::NonZeroU16;

use forerun::dynamics::{Unobserved, World};
use forerun::{BodyDef, Threads};

use crate::engine::{Engine, Motion};
use crate::stage::Stage;

pub(crate) struct Forerun {
    world: World,
    threads: Threads,
}

impl Forerun {
    pub(crate) fn new(stage: &Stage, threads: u16) -> Result<Self, String> {
        let mut world = World::new(stage.environment);
        for actor in &stage.actors {
            let def: &BodyDef = &actor.def;
            world.add(def).map_err(|error| error.to_string())?;
        }
        let threads = Threads::exactly(NonZeroU16::new(threads).unwrap_or(NonZeroU16::MIN));
        Ok(Forerun { world, threads: threads.map_err(|error| error.to_string())? })
    }
}

impl Engine for Forerun {
    fn step(&mut self) -> Result<(), String> {
        let report = self.threads.install(|| self.world.step(&mut Unobserved));
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
