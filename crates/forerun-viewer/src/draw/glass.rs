//! Glass: fixed bodies that hide what moves are seen through: the near walls of a box that something rains into.

use forerun::{Body, BodyId, BodyKind, Pose, Ray, Shape, Vec3};

use crate::session::Play;

/// So many moving bodies are looked for, and so many fixed ones may be in the way.
const LOOKED_FOR: usize = 16;
const WALLS_MAX: usize = 64;
/// Who hides more than this part of them is seen through.
const HIDDEN: f32 = 0.12;

/// The fixed bodies that hide moving ones from an eye. Sorted.
pub(super) fn hiding(play: &Play, eye: Vec3, found: &mut Vec<BodyId>) {
    found.clear();
    let bodies = || play.samples.iter().filter_map(|(id, sample)| Some((*id, play.body(*id)?, &sample.pose)));
    let is_wall = |body: &Body| body.kind == BodyKind::Fixed && !matches!(body.shape, Shape::HalfSpace);
    if !bodies().any(|(_, body, _)| is_wall(body)) {
        return;
    }
    let step = play.samples.len().div_ceil(LOOKED_FOR).max(1);
    let moving: Vec<(Vec3, f32)> = bodies()
        .filter(|(_, body, _)| body.is_dynamic())
        .step_by(step)
        .map(|(_, body, pose)| (pose.transform_point(body.frame.position), body.radius))
        .collect();
    let walls = bodies().filter(|(_, body, _)| is_wall(body)).take(WALLS_MAX);
    found.extend(walls.filter(|(_, body, pose)| hides(&body.shape, pose, eye, &moving)).map(|(id, ..)| id));
}

/// Whether a shape is between an eye and many balls.
fn hides(shape: &Shape, pose: &Pose, eye: Vec3, balls: &[(Vec3, f32)]) -> bool {
    let hidden = balls.iter().filter(|(centre, radius)| {
        let distance = (*centre - eye).length() - radius;
        Ray::towards(eye, *centre)
            .is_some_and(|ray| distance > 0.0 && shape.cast_ray(pose, &ray, distance).is_some())
    });
    hidden.count() as f32 > HIDDEN * balls.len() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wall_hides_what_is_behind_it_and_nothing_else() {
        let wall = Shape::cuboid(Vec3::new(1.0, 1.0, 0.1)).unwrap();
        let row = |z: f32| (0..8).map(|i| (Vec3::new(0.2 * i as f32 - 0.7, 0.0, z), 0.1)).collect::<Vec<_>>();
        let eye = Vec3::Z * 9.0;
        assert!(hides(&wall, &Pose::IDENTITY, eye, &row(-1.0)));
        assert!(!hides(&wall, &Pose::IDENTITY, eye, &row(1.0)), "they are before it");
        assert!(!hides(&wall, &Pose::from_position(Vec3::X * 1.2), eye, &row(-1.0)[..5]));
        assert!(!hides(&wall, &Pose::IDENTITY, Vec3::new(0.0, 9.0, -1.0), &row(-1.0)));
        assert!(!hides(&wall, &Pose::IDENTITY, eye, &[]));
    }
}
