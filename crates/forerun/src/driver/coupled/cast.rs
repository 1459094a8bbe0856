//! Cast: what the bodies of a plain world are called and made of, so that they can come from a timeline and go back to one.

use std::sync::Arc;

use forerun_timeline::parts::{BodyParts, NameParts};
use forerun_timeline::{Snapshot, StillBody, TimelineParts, TimelineSettings};

use super::recount_rest;
use crate::dynamics::World;
use crate::{Body, BodyDef, BodyId, BodyState, Environment, Frame, Mass, Pose};

/// Who is in a world.
#[derive(Debug)]
pub(in crate::driver) struct Cast {
    /// By place in the world. Rising.
    names: Vec<BodyId>,
    /// By place in the world: how the body was made.
    defs: Vec<Option<Arc<BodyDef>>>,
    next_name: u32,
    /// Length of a frame of the timeline that this came from, or goes to. Seconds.
    frame_seconds: f32,
    /// The last snapshot since somebody came, went, or became another.
    still: Option<Snapshot>,
}

impl Cast {
    /// The bodies 0, 1, 2, ... of a world.
    pub(in crate::driver) fn of(world: &World) -> Cast {
        let count = world.bodies().len() as u32;
        Cast {
            names: (0..count).map(BodyId).collect(),
            defs: vec![None; count as usize],
            next_name: count,
            frame_seconds: world.environment.settings.frame_seconds,
            still: None,
        }
    }

    /// The bodies that a snapshot shows at a time (seconds), in a world.
    pub(super) fn of_snapshot(snapshot: &Snapshot, time_s: f64) -> (World, Cast) {
        let frame_seconds = snapshot.frame_seconds();
        let frame = Frame((time_s / f64::from(frame_seconds)).max(0.0) as u64);
        let mut world = World::new(snapshot.environment_at(frame));
        let mut cast = Cast {
            names: Vec::new(),
            defs: Vec::new(),
            next_name: snapshot.names() as u32,
            frame_seconds,
            still: None,
        };
        for StillBody { body, def, made, state } in snapshot.still_at(time_s) {
            world.put(Body::clone(&made), state);
            cast.names.push(body);
            cast.defs.push(def);
        }
        (world, cast)
    }

    pub(super) fn names(&self) -> &[BodyId] {
        &self.names
    }

    pub(super) fn frame_seconds(&self) -> f32 {
        self.frame_seconds
    }

    /// Where a body is in the world.
    pub(in crate::driver) fn place(&self, body: BodyId) -> Option<usize> {
        self.names.binary_search(&body).ok()
    }

    pub(in crate::driver) fn coming_body(&self) -> BodyId {
        BodyId(self.next_name)
    }

    /// A body was added to the world.
    pub(in crate::driver) fn add(&mut self, def: &BodyDef) {
        self.names.push(BodyId(self.next_name));
        self.defs.push(Some(Arc::new(def.clone())));
        self.next_name += 1;
        self.still = None;
    }

    /// A body was taken out of the world.
    pub(in crate::driver) fn remove(&mut self, place: usize) {
        self.names.remove(place);
        self.defs.remove(place);
        self.still = None;
    }

    /// A body, or gravity, is another.
    pub(in crate::driver) fn forget_still(&mut self) {
        self.still = None;
    }

    /// The world's environment, with frames of the length that they had at first.
    fn environment(&self, world: &World) -> Environment {
        let mut environment = world.environment;
        environment.settings.frame_seconds = self.frame_seconds;
        environment
    }

    /// The world's states, as they are where frames have the length that they had at first.
    fn states(&self, world: &World) -> Vec<BodyState> {
        let mut states = world.states().to_vec();
        let full = self.environment(world).settings.rest_frames();
        recount_rest(&mut states, world.environment.settings.rest_frames(), full);
        states.iter().map(|state| state.canonical()).collect()
    }

    /// The world as a snapshot of one frame.
    pub(super) fn snapshot(&mut self, world: &World, frame: Frame) -> Snapshot {
        let states = self.states(world);
        let snapshot = match &self.still {
            Some(still) => {
                let states: Vec<(BodyId, BodyState)> = self.names.iter().copied().zip(states).collect();
                still.moved(frame, &states)
            }
            None => {
                let bodies = self.names.iter().zip(&self.defs).zip(world.bodies().iter().zip(states));
                let bodies: Vec<StillBody> = bodies
                    .map(|((body, def), (made, state))| StillBody {
                        body: *body,
                        def: def.clone(),
                        made: Arc::new(made.clone()),
                        state,
                    })
                    .collect();
                Snapshot::still(frame, &bodies, self.environment(world))
            }
        };
        self.still = Some(snapshot.clone());
        snapshot
    }

    /// The world as the parts of a timeline without a past.
    pub(super) fn parts(&self, world: &World, frame: Frame, settings: TimelineSettings) -> TimelineParts {
        let mut names = vec![NameParts::default(); self.next_name as usize];
        let bodies = world.bodies().iter().zip(self.states(world));
        for ((name, def), (body, state)) in self.names.iter().zip(&self.defs).zip(bodies) {
            let def = def.clone().unwrap_or_else(|| Arc::new(def_of(body, &state)));
            let Body { kind, inverse_mass, material, gravity_scale, force, torque, spring, .. } = *body;
            let body =
                BodyParts { kind, inverse_mass, material, gravity_scale, force, torque, spring, state };
            if let Some(place) = names.get_mut(name.0 as usize) {
                *place = NameParts { def: Some(def), body: Some(body) };
            }
        }
        TimelineParts {
            settings,
            display: frame,
            oldest: frame,
            environment: self.environment(world),
            names,
            commands: Vec::new(),
            next_sequence: 0,
            undo: Vec::new(),
            redo: Vec::new(),
            frames: Vec::new(),
        }
    }
}

/// How a body can be made of which only is known what it is.
fn def_of(body: &Body, state: &BodyState) -> BodyDef {
    let Pose { position, rotation } = body.frame.inverse();
    let mass = if body.inverse_mass > 0.0 {
        Mass::Given {
            mass: 1.0 / body.inverse_mass,
            centre: position,
            inertia: body.inverse_inertia.recip(),
            principal_rotation: rotation,
        }
    } else {
        Mass::Density(1000.0)
    };
    BodyDef {
        pose: body.own_pose(state),
        velocity: state.velocity,
        angular_velocity: state.angular_velocity,
        kind: body.kind,
        material: body.material,
        mass,
        gravity_scale: body.gravity_scale,
        force: body.force,
        torque: body.torque,
        ..BodyDef::new(body.shape.clone())
    }
}
