//! Stage: what every engine is given: the bodies of a scene with the masses that ours have, in one order.
#![cfg_attr(not(feature = "engines"), allow(dead_code, reason = "our own engine needs the definitions only"))]

use std::sync::Arc;

use forerun::dynamics::World;
use forerun::{Body, BodyDef, BodyKind, Environment, Scene, Shape, world_of};

/// Bodies, gravity and frame length of a scene. Commands are left out.
#[derive(Clone, Debug)]
pub(crate) struct Stage {
    pub(crate) environment: Environment,
    pub(crate) actors: Vec<Actor>,
}

/// A body: how it was defined, and what mass, centre and axes that gives it.
#[derive(Clone, Debug)]
pub(crate) struct Actor {
    /// The shape may be another than that of the scene: parts instead of a mesh.
    pub(crate) def: BodyDef,
    pub(crate) body: Body,
}

impl Stage {
    /// The bodies of a scene, none of which is to come to rest.
    pub(crate) fn of(scene: &Scene) -> Result<Stage, String> {
        let world = world_awake(scene)?;
        let defs = scene.bodies().map_err(|error| error.to_string())?;
        let bodies = world.bodies().iter().cloned();
        let actors = defs.into_iter().zip(bodies).map(|(def, body)| Actor { def, body }).collect();
        Ok(Stage { environment: world.environment, actors })
    }

    /// Half the width of the ground for engines whose ground has an end: wide enough for what the scene throws. Metres.
    pub(crate) fn ground_reach_m(&self) -> f32 {
        let places = self.actors.iter().map(|actor| actor.def.pose.position.abs().max_element());
        50.0 + 2.0 * places.fold(0.0, f32::max)
    }

    /// Whether a body that moves is a triangle mesh.
    pub(crate) fn has_moving_meshes(&self) -> bool {
        let is_mesh = |actor: &Actor| matches!(actor.def.shape, Shape::Mesh(_)) && !actor.is_fixed();
        self.actors.iter().any(is_mesh)
    }
}

impl Actor {
    pub(crate) fn is_fixed(&self) -> bool {
        self.def.kind == BodyKind::Fixed
    }
}

/// Whether two bodies have one shape in memory, so that the engine may share its own too.
pub(crate) fn is_shared(a: &Shape, b: &Shape) -> bool {
    match (a, b) {
        (Shape::Hull(a), Shape::Hull(b)) => Arc::ptr_eq(a, b),
        (Shape::Compound(a), Shape::Compound(b)) => Arc::ptr_eq(a, b),
        (Shape::Mesh(a), Shape::Mesh(b)) => Arc::ptr_eq(a, b),
        _ => false,
    }
}

/// The scene as a world of ours in which nothing comes to rest.
pub(crate) fn world_awake(scene: &Scene) -> Result<World, String> {
    let mut world = world_of(scene).map_err(|error| error.to_string())?;
    world.environment.settings.rest_seconds = 0.0;
    Ok(world)
}
