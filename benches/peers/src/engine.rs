//! Engine: what is asked of each, and which there are.

use std::path::Path;

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
    /// Goes on by one frame, on the threads of the pool that it is called in or on its own.
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
    /// Rapier, meshes cut finely; only for scenes where meshes move
    RapierFine,
    /// Rapier, meshes as bare triangles; only for scenes where meshes move
    RapierTriangles,
    /// Box3D, meshes cut into convex parts
    Box3d,
    /// Box3D, meshes cut finely; only for scenes where meshes move
    Box3dFine,
    /// Jolt, meshes cut into convex parts
    Jolt,
}

impl Kind {
    /// What is run when nobody says which.
    pub(crate) const USUAL: [Kind; 5] =
        [Kind::Forerun, Kind::Rapier, Kind::RapierTriangles, Kind::Box3d, Kind::Jolt];
    /// All there are.
    pub(crate) const ALL: [Kind; 7] = [
        Kind::Forerun,
        Kind::Rapier,
        Kind::RapierFine,
        Kind::RapierTriangles,
        Kind::Box3d,
        Kind::Box3dFine,
        Kind::Jolt,
    ];

    /// Whether it differs from another of the list only where meshes move.
    pub(crate) fn is_for_meshes(self) -> bool {
        matches!(self, Kind::RapierFine | Kind::RapierTriangles | Kind::Box3dFine)
    }

    /// How it has meshes cut; none where it takes them as they are.
    #[cfg(feature = "engines")]
    pub(crate) fn fineness(self) -> Option<Fineness> {
        match self {
            Kind::Forerun | Kind::RapierTriangles => None,
            Kind::Rapier | Kind::Box3d | Kind::Jolt => Some(Fineness::Default),
            Kind::RapierFine | Kind::Box3dFine => Some(Fineness::Fine),
        }
    }

    /// Name with version, as it stands in the lock file.
    pub(crate) fn label(self) -> String {
        match self {
            Kind::Forerun => "forerun".to_owned(),
            Kind::Rapier => format!("Rapier {}", locked_version("rapier3d")),
            Kind::RapierFine => format!("Rapier {}, fine", locked_version("rapier3d")),
            Kind::RapierTriangles => format!("Rapier {}, triangles", locked_version("rapier3d")),
            Kind::Box3d => format!("Box3D (box3d-sys {})", locked_version("box3d-sys")),
            Kind::Box3dFine => format!("Box3D (box3d-sys {}), fine", locked_version("box3d-sys")),
            Kind::Jolt => format!("Jolt {}", locked_version("joltc-sys")),
        }
    }
}

/// How finely meshes are cut.
#[cfg(feature = "engines")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fineness {
    /// As parry's VHACD does it by default, and so Rapier's `convex_decomposition`.
    Default,
    /// Twice as fine in space, and a tenth of the hollowness left in a part.
    Fine,
}

/// The version of a package that this program was built with. `1.2.3+Lib-4.5.6` is a wrapper's own version and that of what it wraps.
fn locked_version(package: &str) -> &'static str {
    let lock = include_str!("../Cargo.lock");
    let after = lock.split_once(&format!("name = \"{package}\"\nversion = \"")).map(|(_, after)| after);
    let version = after.and_then(|after| after.split('"').next()).unwrap_or("?");
    version.split_once('+').map_or(version, |(_, wrapped)| wrapped.trim_start_matches("Jolt-"))
}

/// What cutting the moving meshes of a stage took and brought.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Cutting {
    /// The most hulls of a mesh, 0 when none was cut.
    pub(crate) hulls: usize,
    /// CPU time. Milliseconds.
    pub(crate) cpu_ms: f64,
}

/// Makes the stage what the engine takes: meshes that it does not take are cut into hulls; these are kept in a folder, if one is
/// given. Fails with what the engine cannot do.
#[cfg(feature = "engines")]
pub(crate) fn prepare(kind: Kind, stage: &mut Stage, folder: Option<&Path>) -> Result<Cutting, String> {
    if kind == Kind::Forerun {
        return Ok(Cutting::default());
    }
    let pushed = |actor: &crate::stage::Actor| actor.def.force.length() + actor.def.torque.length() > 0.0;
    if stage.actors.iter().any(pushed) {
        return Err("constant forces and torques are not passed on".to_owned());
    }
    crate::parts::cut_meshes(kind, stage, folder)
}

/// Builds the world of an engine. Fails with what the engine cannot do.
#[cfg(feature = "engines")]
pub(crate) fn build(kind: Kind, stage: &Stage, threads: u16) -> Result<Box<dyn Engine>, String> {
    Ok(match kind {
        Kind::Forerun => Box::new(crate::forerun::Forerun::new(stage)?),
        Kind::Rapier | Kind::RapierFine | Kind::RapierTriangles => {
            Box::new(crate::rapier::Rapier::new(stage, threads)?)
        }
        Kind::Box3d | Kind::Box3dFine => Box::new(crate::box3d::Box3d::new(stage, threads)?),
        Kind::Jolt => Box::new(crate::jolt::Jolt::new(stage, threads)?),
    })
}

/// Our own engine takes every stage as it is; the others are not in this program.
#[cfg(not(feature = "engines"))]
pub(crate) fn prepare(kind: Kind, _: &mut Stage, _: Option<&Path>) -> Result<Cutting, String> {
    if kind == Kind::Forerun { Ok(Cutting::default()) } else { Err(WITHOUT_ENGINES.to_owned()) }
}

/// Builds the world of our own engine.
#[cfg(not(feature = "engines"))]
pub(crate) fn build(kind: Kind, stage: &Stage, _: u16) -> Result<Box<dyn Engine>, String> {
    match kind {
        Kind::Forerun => Ok(Box::new(crate::forerun::Forerun::new(stage)?)),
        _ => Err(WITHOUT_ENGINES.to_owned()),
    }
}

#[cfg(not(feature = "engines"))]
pub(crate) const WITHOUT_ENGINES: &str = "this program was built without the feature \"engines\"";

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

    /// Every shape, turned, its centre of mass elsewhere than the origin of its frame (the wedge and the compound), in the air above a ground.
    #[cfg(feature = "engines")]
    const SHAPES: &str = r#"
        name = "shapes"
        bodies = [
            { kind = "fixed", shape = "half_space", position = [0, -3, 0] },
            { shape = { sphere = { radius = 0.3 } }, position = [0, 2, 0] },
            { shape = { box = { half_extents = [0.3, 0.2, 0.1] } }, position = [2, 2, 0] },
            { shape = { capsule = { half_height = 0.3, radius = 0.2 } }, position = [4, 2, 0] },
            { shape = { cylinder = { half_height = 0.3, radius = 0.2 } }, position = [6, 2, 0] },
            { shape = { hull = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]] } }, position = [8, 2, 0] },
            { shape = { compound = [
                { shape = { box = { half_extents = [0.5, 0.1, 0.1] } }, position = [1, 0, 0] },
                { shape = { sphere = { radius = 0.2 } } },
            ] }, position = [10, 2, 0] },
        ]
    "#;

    /// A quarter of a second in which nothing touches: rotation about the centre of mass, of which the pose, and not the centre, is compared.
    #[cfg(feature = "engines")]
    #[test]
    fn bodies_of_every_shape_fly_alike_in_every_engine() {
        let mut scene = forerun::Scene::parse(SHAPES, forerun::scene::Format::Toml, "shapes").unwrap();
        for body in scene.bodies.iter_mut().skip(1) {
            body.velocity = [0.5, 2.0, 0.0];
            body.angular_velocity = [0.0, 0.0, 0.5];
        }
        let fly = |kind| {
            let mut stage = Stage::of(&scene).unwrap();
            prepare(kind, &mut stage, None).unwrap();
            let mut world = build(kind, &stage, 1).unwrap();
            (0..15).for_each(|_| world.step().unwrap());
            world.motions()
        };
        let ours = fly(Kind::Forerun);
        for kind in [Kind::Rapier, Kind::Box3d, Kind::Jolt] {
            for (i, (our, peer)) in ours.iter().zip(fly(kind)).enumerate() {
                // Engines integrate gravity differently within a step: g dt t / 2 is 20 mm.
                let apart = our.pose.position.distance(peer.pose.position);
                assert!(apart < 0.03, "{kind:?}, body {i}: {apart} m");
                let turned = our.pose.rotation.angle_between(peer.pose.rotation);
                assert!(turned < 0.02, "{kind:?}, body {i}: {turned} rad");
                let faster = (our.velocity - peer.velocity).length();
                assert!(faster < 0.01, "{kind:?}, body {i}: {faster} m/s");
            }
        }
    }
}
