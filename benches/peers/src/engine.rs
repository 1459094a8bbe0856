//! Engine: what is asked of each, and which there are.

use forerun::{Pose, Vec3};
use serde::{Deserialize, Serialize};

use crate::stage::Stage;

/// How deep the box is that stands for a half-space in engines that have none. Metres.
#[cfg(feature = "engines")]
pub(crate) const GROUND_DEPTH_M: f32 = 10.0;

/// Where a body is and how it moves: all that the quality of an engine is measured from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion {
    /// Where the body's own frame is.
    pub(crate) pose: Pose,
    /// Velocity of the centre of mass. m/s.
    pub(crate) velocity: Vec3,
    /// rad/s, in the world.
    pub(crate) angular_velocity: Vec3,
}

/// A world of some engine.
pub(crate) trait Engine {
    /// Goes on by one frame.
    fn step(&mut self) -> Result<(), String>;

    /// The motions of all bodies, in the order of the scene.
    fn motions(&self) -> Vec<Motion>;
}

/// An engine, and what it makes of triangle meshes that move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Kind {
    /// This project, meshes as they are
    Forerun,
    /// Rapier, meshes cut into convex parts
    Rapier,
    /// Rapier, meshes as bare triangles; only for scenes where meshes move
    RapierTriangles,
    /// Box3D, meshes cut into convex parts
    Box3d,
    /// Jolt, meshes cut into convex parts
    Jolt,
}

impl Kind {
    pub(crate) const ALL: [Kind; 5] =
        [Kind::Forerun, Kind::Rapier, Kind::RapierTriangles, Kind::Box3d, Kind::Jolt];

    /// Name with version, as it stands in the lock file.
    pub(crate) fn label(self) -> String {
        let named = |name: &str, package: &str| format!("{name} {}", locked_version(package));
        match self {
            Kind::Forerun => "forerun".to_owned(),
            Kind::Rapier => named("Rapier", "rapier3d"),
            Kind::RapierTriangles => named("Rapier, triangles", "rapier3d"),
            Kind::Box3d => named("Box3D", "box3d-sys"),
            Kind::Jolt => named("Jolt", "joltc-sys"),
        }
    }
}

/// The version of a package that this program was built with. `1.2.3+Lib-4.5.6` is a wrapper's own version and that of what it wraps.
fn locked_version(package: &str) -> &'static str {
    let lock = include_str!("../Cargo.lock");
    let after = lock.split_once(&format!("name = \"{package}\"\nversion = \"")).map(|(_, after)| after);
    let version = after.and_then(|after| after.split('"').next()).unwrap_or("?");
    version.split_once('+').map_or(version, |(_, wrapped)| wrapped.trim_start_matches("Jolt-"))
}

/// Builds the world of an engine. Fails with what the engine cannot do.
#[cfg(feature = "engines")]
pub(crate) fn build(kind: Kind, mut stage: Stage, threads: u16) -> Result<Box<dyn Engine>, String> {
    if kind == Kind::Forerun {
        return Ok(Box::new(crate::forerun::Forerun::new(&stage, threads)?));
    }
    let pushed = |actor: &crate::stage::Actor| actor.def.force.length() + actor.def.torque.length() > 0.0;
    if stage.actors.iter().any(pushed) {
        return Err("constant forces and torques are not passed on".to_owned());
    }
    if kind != Kind::RapierTriangles && stage.has_moving_meshes() {
        crate::parts::cut_moving_meshes(&mut stage)?;
    }
    Ok(match kind {
        Kind::Forerun | Kind::Rapier | Kind::RapierTriangles => {
            Box::new(crate::rapier::Rapier::new(&stage, threads)?)
        }
        Kind::Box3d => Box::new(crate::box3d::Box3d::new(&stage, threads)?),
        Kind::Jolt => Box::new(crate::jolt::Jolt::new(&stage, threads)?),
    })
}

/// Builds the world of our own engine; the others are not in this program.
#[cfg(not(feature = "engines"))]
pub(crate) fn build(kind: Kind, stage: Stage, threads: u16) -> Result<Box<dyn Engine>, String> {
    match kind {
        Kind::Forerun => Ok(Box::new(crate::forerun::Forerun::new(&stage, threads)?)),
        _ => Err("this program was built without the feature \"engines\"".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_engine_has_a_version() {
        for kind in Kind::ALL {
            assert!(!kind.label().contains('?'), "{}", kind.label());
        }
        assert!(Kind::Jolt.label().starts_with("Jolt 5"), "{}", Kind::Jolt.label());
    }
}
