//! Overlap: the deepest of bodies of which one at least is a mesh, measured against the meshes of the scene, whatever an engine made of them.
//!
//! Points of one body's surface are looked up in the other, both ways. A thin part that is right within another counts with half of the thinner's
//! thickness: from there on every way leads out.

use std::rc::Rc;

use forerun::{Aabb, Pose, Shape, Vec3};

use crate::engine::Motion;
use crate::stage::{Stage, is_shared};
use crate::surface::{self, Solid};

/// The bodies of a scene as they really are.
pub(crate) struct TrueBodies {
    bodies: Vec<TrueBody>,
}

struct TrueBody {
    shape: Shape,
    form: Rc<Form>,
    is_fixed: bool,
}

/// What bodies of one shape share.
struct Form {
    solid: Solid,
    points: Vec<Vec3>,
    has_mesh: bool,
}

impl TrueBodies {
    /// Of a stage whose meshes are still whole.
    pub(crate) fn of(stage: &Stage) -> Self {
        let mut bodies: Vec<TrueBody> = Vec::with_capacity(stage.actors.len());
        for actor in &stage.actors {
            let shape = actor.def.shape.clone();
            let known = bodies.iter().find(|body| is_shared(&body.shape, &shape));
            let form = known.map_or_else(|| Rc::new(Form::of(&shape)), |body| body.form.clone());
            bodies.push(TrueBody { shape, form, is_fixed: actor.is_fixed() });
        }
        TrueBodies { bodies }
    }

    /// The deepest overlap of two bodies that are not both fixed, one of them a mesh. Metres, 0 when nothing overlaps; bodies whose motion is not finite are
    /// left out.
    pub(crate) fn deepest_m(&self, motions: &[Motion]) -> f32 {
        let mut placed: Vec<(Aabb, Pose, &TrueBody)> = (self.bodies.iter().zip(motions))
            .filter(|(_, motion)| motion.pose.position.is_finite() && motion.pose.rotation.is_finite())
            .map(|(body, motion)| (body.shape.aabb(&motion.pose), motion.pose, body))
            .collect();
        placed.sort_by(|a, b| a.0.min.x.total_cmp(&b.0.min.x));
        let mut deepest = 0.0_f32;
        for (i, (bounds, pose, body)) in placed.iter().enumerate() {
            let near = placed[i + 1..].iter().take_while(|(other, ..)| other.min.x <= bounds.max.x);
            for (_, other_pose, other) in near.filter(|(others, ..)| others.overlaps(bounds)) {
                let meets = body.form.has_mesh || other.form.has_mesh;
                if meets && !(body.is_fixed && other.is_fixed) {
                    deepest = body.form.deepest_in(&other.form, &(other_pose.inverse() * *pose), deepest);
                    deepest = other.form.deepest_in(&body.form, &(pose.inverse() * *other_pose), deepest);
                }
            }
        }
        deepest
    }
}

impl Form {
    fn of(shape: &Shape) -> Self {
        let has_mesh = match shape {
            Shape::Mesh(_) => true,
            Shape::Compound(whole) => whole.parts.iter().any(|(_, part)| matches!(part, Shape::Mesh(_))),
            _ => false,
        };
        Form { solid: Solid::of(shape), points: surface::points(shape), has_mesh }
    }

    /// The deepest point of this surface in another solid, in whose frame it is at `at`, or `least` if none is deeper. Metres.
    fn deepest_in(&self, other: &Form, at: &Pose, least: f32) -> f32 {
        let deeper =
            |least, point: &Vec3| other.solid.depth_above(at.transform_point(*point), least).unwrap_or(least);
        self.points.iter().fold(least, deeper)
    }
}

#[cfg(test)]
mod tests {
    use forerun::{Quat, Scene};

    use super::*;

    fn motions(poses: &[Pose]) -> Vec<Motion> {
        let still = |pose: &Pose| Motion { pose: *pose, velocity: Vec3::ZERO, angular_velocity: Vec3::ZERO };
        poses.iter().map(still).collect()
    }

    /// Two rings of radii 0.5 and 0.2 m: side by side, one through the other's hole, and crossed.
    #[test]
    fn rings_overlap_where_their_tubes_do() {
        let stage = Stage::of(&Scene::open("tori:2").unwrap()).unwrap();
        let bodies = TrueBodies::of(&stage);
        let upright = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
        let deepest = |place: Vec3, turn: Quat| {
            let poses =
                [Pose::IDENTITY, Pose::from_position(Vec3::Y * 5.0), Pose::new(Vec3::Y * 5.0 + place, turn)];
            bodies.deepest_m(&motions(&poses))
        };
        let side_by_side = deepest(Vec3::X * 1.35, Quat::IDENTITY);
        assert!((side_by_side - 0.05).abs() < 0.007, "{side_by_side}");
        assert!(deepest(Vec3::X * 1.41, Quat::IDENTITY) <= 0.0);
        // Its tube through the middle of the hole, which is 0.3 m wide to every side: 0.1 m is left.
        assert!(deepest(Vec3::X * 0.5, upright) <= 0.0);
        // 0.12 m further: 20 mm deep.
        let crossed = deepest(Vec3::X * 0.62, upright);
        assert!((crossed - 0.02).abs() < 0.007, "{crossed}");
        // In the ground, whose frame is that of the world.
        let poses = [Pose::IDENTITY, Pose::from_position(Vec3::Y * 0.17), Pose::from_position(Vec3::Y * 5.0)];
        let sunk = bodies.deepest_m(&motions(&poses));
        assert!((sunk - 0.03).abs() < 0.005, "{sunk}");
    }
}
