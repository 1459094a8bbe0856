//! Staging: from a scene to a timeline or a world, and from a scene's commands to changes.

use std::fmt;

use forerun_dynamics::{BodyError, EnvironmentError, World};
use forerun_scene::{Scene, SceneCommand, SceneError};
use forerun_timeline::{
    Change, Command, CommandError, CommandKey, Frame, Timeline, TimelineError, TimelineSettings,
};

use crate::BodyId;

/// Why a scene cannot be brought to the engine.
#[derive(Clone, Debug, PartialEq)]
pub enum StagingError {
    /// The scene itself is at fault: file, place and remedy.
    Scene(SceneError),
    /// Gravity or a setting of the scene is not possible.
    Environment {
        /// Name of the scene.
        scene: String,
        /// What is wrong with it.
        error: EnvironmentError,
    },
    /// A body of the scene is not possible.
    Body {
        /// Name of the scene.
        scene: String,
        /// Number of the body.
        index: usize,
        /// What is wrong with it.
        error: BodyError,
    },
    /// A command of the scene is not possible.
    Command {
        /// Name of the scene.
        scene: String,
        /// What is wrong with it.
        error: CommandError,
    },
}

impl fmt::Display for StagingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StagingError::Scene(error) => write!(f, "{error}"),
            StagingError::Environment { scene, error } => {
                write!(f, "{scene}: {error}; change the scene or leave the field out")
            }
            StagingError::Body { scene, index, error } => {
                write!(f, "{scene}: bodies[{index}].{error}; change the body in the scene")
            }
            StagingError::Command { scene, error } => write!(f, "{scene}: commands: {error}"),
        }
    }
}

impl std::error::Error for StagingError {}

impl From<SceneError> for StagingError {
    fn from(error: SceneError) -> Self {
        StagingError::Scene(error)
    }
}

/// A timeline of the scene's bodies at frame 0, its commands in it as if they had always been known.
///
/// # Errors
/// When the scene, a body or a command is not possible.
pub fn timeline_of(scene: &Scene, settings: TimelineSettings) -> Result<Timeline, StagingError> {
    let mut timeline = bare_timeline_of(scene, settings)?;
    for (sequence, command) in changes_of(scene)?.into_iter().enumerate() {
        if matches!(command.change, Change::Add { .. }) {
            timeline.reserve_body();
        }
        let key = CommandKey { frame: command.frame, source: 0, sequence: sequence as u64 };
        timeline
            .submit(Command { key, change: command.change })
            .map_err(|error| StagingError::Command { scene: scene.name.clone(), error })?;
    }
    Ok(timeline)
}

/// A timeline of the scene's bodies at frame 0 alone.
pub(crate) fn bare_timeline_of(scene: &Scene, settings: TimelineSettings) -> Result<Timeline, StagingError> {
    let scene_name = || scene.name.clone();
    Timeline::new(&scene.bodies()?, scene.environment(), settings).map_err(|error| match error {
        TimelineError::Environment(error) => StagingError::Environment { scene: scene_name(), error },
        TimelineError::Body { index, error } => StagingError::Body { scene: scene_name(), index, error },
    })
}

/// A world of the scene's bodies at frame 0, without its commands.
///
/// # Errors
/// When the scene or a body is not possible.
pub fn world_of(scene: &Scene) -> Result<World, StagingError> {
    let mut world = World::new(scene.environment());
    for (index, def) in scene.bodies()?.iter().enumerate() {
        let added = world.add(def);
        added.map_err(|error| StagingError::Body { scene: scene.name.clone(), index, error })?;
    }
    Ok(world)
}

/// A change and the frame from which on it holds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TimedChange {
    pub(crate) frame: Frame,
    pub(crate) change: Change,
}

/// The scene's commands in the order of their frames. Bodies keep their numbers as names.
pub(crate) fn changes_of(scene: &Scene) -> Result<Vec<TimedChange>, StagingError> {
    let commands = scene.commands()?;
    // A timeline's first frame is given: commands act after it.
    let frame = |frame: u64| Frame(frame.max(1));
    Ok(commands
        .into_iter()
        .map(|c| TimedChange { frame: frame(c.frame), change: change_of(c.command) })
        .collect())
}

fn change_of(command: SceneCommand) -> Change {
    match command {
        SceneCommand::Add { body, def } => Change::Add { body: BodyId(body), def },
        SceneCommand::Remove { body } => Change::Remove { body: BodyId(body) },
        SceneCommand::Move { body, pose } => Change::Move { body: BodyId(body), pose },
        SceneCommand::Push { body, impulse, point } => {
            Change::Push { body: BodyId(body), impulse, at_point: point }
        }
        SceneCommand::SetVelocity { body, velocity, angular_velocity } => {
            Change::SetVelocity { body: BodyId(body), velocity, angular_velocity }
        }
        SceneCommand::SetForce { body, force, torque } => {
            Change::SetForce { body: BodyId(body), force, torque }
        }
        SceneCommand::SetMaterial { body, material } => Change::SetMaterial { body: BodyId(body), material },
        SceneCommand::SetGravityScale { body, scale } => {
            Change::SetGravityScale { body: BodyId(body), scale }
        }
        SceneCommand::SetMass { body, mass } => Change::SetMass { body: BodyId(body), mass },
        SceneCommand::SetKind { body, kind } => Change::SetKind { body: BodyId(body), kind },
        SceneCommand::Hold { body, spring } => Change::Hold { body: BodyId(body), spring },
        SceneCommand::Release { body } => Change::Release { body: BodyId(body) },
        SceneCommand::SetGravity { gravity } => Change::SetGravity { gravity },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use forerun_scene::Format;

    #[test]
    fn a_factor_on_gravity_in_a_scene_reaches_the_timeline() {
        let text = "name = 'up'\n[[bodies]]\nshape = { sphere = { radius = 1 } }\n\
                    [[commands]]\nframe = 1\nset_gravity_scale = { body = 0, scale = -1 }\n";
        let scene = Scene::parse(text, Format::Toml, "up").expect("a possible scene");
        let mut timeline = timeline_of(&scene, TimelineSettings::default()).expect("a possible scene");
        while timeline.advance() != forerun_timeline::Progress::Idle {}
        let velocity = |frame| timeline.state(BodyId(0), Frame(frame)).expect("it is there").velocity.y;
        assert!(velocity(1) < 0.0 && velocity(60) > 9.0, "{} and {} m/s", velocity(1), velocity(60));
    }
}
