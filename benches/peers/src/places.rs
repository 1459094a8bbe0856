//! Places: what still hangs where it hung, and what lies in the bowl.

use forerun::{Pose, Scene, Shape, Vec3};
use serde::{Deserialize, Serialize};

use crate::engine::Motion;
use crate::stage::{Actor, Stage};

/// What became of bodies that have a place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct PlaceCount {
    /// Moving meshes that start within the bounds of a fixed compound (a hook), and how many of these still are.
    pub(crate) hanging: [usize; 2],
    /// Bodies other than the one called `bowl`, and how many of these are in it; none where there is no such body.
    pub(crate) in_bowl: Option<[usize; 2]>,
}

/// Looks at the end of a run.
pub(crate) fn at_end(scene: &Scene, stage: &Stage, end: &[Motion]) -> PlaceCount {
    let start: Vec<Pose> = stage.actors.iter().map(|actor| actor.def.pose).collect();
    let end: Vec<Pose> = end.iter().map(|motion| motion.pose).collect();
    let bodies: Vec<&Actor> = stage.actors.iter().collect();
    let hooks: Vec<usize> = (0..bodies.len())
        .filter(|i| bodies[*i].is_fixed() && matches!(bodies[*i].def.shape, Shape::Compound(_)))
        .collect();
    let is_at = |body: usize, hook: usize, poses: &[Pose]| {
        let bounds = |i: usize| bodies[i].def.shape.aabb(&poses[i]);
        poses[body].position.is_finite() && bounds(body).overlaps(&bounds(hook))
    };
    let mut hanging = [0, 0];
    for body in (0..bodies.len()).filter(|i| matches!(bodies[*i].def.shape, Shape::Mesh(_))) {
        if let Some(hook) = hooks.iter().find(|hook| is_at(body, **hook, &start)) {
            hanging[0] += 1;
            hanging[1] += usize::from(is_at(body, *hook, &end));
        }
    }
    let bowl = scene.bodies.iter().position(|body| body.name.as_deref() == Some("bowl"));
    let in_bowl = bowl.map(|bowl| {
        let bounds = bodies[bowl].def.shape.aabb(&Pose::IDENTITY);
        let others = || (0..bodies.len()).filter(|i| *i != bowl && !bodies[*i].is_fixed());
        let is_in = |i: &usize| {
            let own = end[bowl].inverse_transform_point(end[*i].position);
            let out = (own * Vec3::new(1.0, 0.0, 1.0)).length();
            // What lies on top of a heap in it is in it too.
            out < bounds.half_extents().x && (bounds.min.y..2.0 * bounds.max.y).contains(&own.y)
        };
        [others().count(), others().filter(is_in).count()]
    });
    PlaceCount { hanging, in_bowl }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_start(scene: &str) -> (Scene, Stage, Vec<Motion>) {
        let scene = Scene::open(scene).unwrap();
        let stage = Stage::of(&scene).unwrap();
        let still =
            |a: &Actor| Motion { pose: a.def.pose, velocity: Vec3::ZERO, angular_velocity: Vec3::ZERO };
        let motions = stage.actors.iter().map(still).collect();
        (scene, stage, motions)
    }

    #[test]
    fn a_mug_that_has_fallen_off_its_hook_is_missed() {
        let (scene, stage, mut motions) = at_start("mugs:8");
        assert_eq!(at_end(&scene, &stage, &motions).hanging, [4, 4]);
        // Ground, board, and then each hook with its mug.
        motions[5].pose.position.z += 3.0;
        assert_eq!(at_end(&scene, &stage, &motions), PlaceCount { hanging: [4, 3], in_bowl: None });
    }

    #[test]
    fn what_lies_beside_the_bowl_is_not_in_it() {
        let (scene, stage, mut motions) = at_start("bowl:3");
        for motion in motions.iter_mut().skip(2) {
            motion.pose.position = Vec3::new(0.5, 1.0, 0.5);
        }
        assert_eq!(at_end(&scene, &stage, &motions).in_bowl, Some([3, 3]));
        motions[4].pose.position = Vec3::new(5.0, 0.3, 0.0);
        assert_eq!(at_end(&scene, &stage, &motions).in_bowl, Some([3, 2]));
    }
}
