//! Nut: how far a nut has turned on its bolt, and how far it has come down: on a thread that holds, the one goes with the other.

use std::f32::consts::{PI, TAU};

use forerun::{Pose, Scene, Vec3};
use serde::{Deserialize, Serialize};

use crate::engine::Motion;
use crate::stage::Stage;

/// What became of the nut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct NutCount {
    /// Whole and parts of turns about the bolt's axis, to whichever side.
    pub(crate) turns: f32,
    /// Way along the axis, towards that of its ends which is lower. Metres.
    pub(crate) down_m: f32,
}

/// Follows the body called `nut` in the frame of the one called `bolt`, whose axis is y.
pub(crate) struct Nut {
    nut: usize,
    bolt: usize,
    start: Pose,
    now: Pose,
    angle: f32,
    /// 1, or -1 while the bolt stands on its head.
    up: f32,
}

impl Nut {
    /// None when the scene has not both.
    pub(crate) fn of(scene: &Scene, stage: &Stage) -> Option<Self> {
        let named = |name: &str| scene.bodies.iter().position(|body| body.name.as_deref() == Some(name));
        let (nut, bolt) = (named("nut")?, named("bolt")?);
        let start = stage.actors[bolt].def.pose.inverse() * stage.actors[nut].def.pose;
        let up = up_along(&stage.actors[bolt].def.pose);
        Some(Nut { nut, bolt, start, now: start, angle: 0.0, up })
    }

    /// Every frame: between two it must turn by less than half a turn.
    pub(crate) fn look_at(&mut self, motions: &[Motion]) {
        let new = motions[self.bolt].pose.inverse() * motions[self.nut].pose;
        if !new.position.is_finite() || !new.rotation.is_finite() {
            return;
        }
        let turn = new.rotation * self.now.rotation.conjugate();
        // The part of the turn that is about y.
        let angle = 2.0 * libm::atan2f(turn.y, turn.w);
        self.angle += if angle > PI {
            angle - TAU
        } else if angle < -PI {
            angle + TAU
        } else {
            angle
        };
        self.now = new;
        self.up = up_along(&motions[self.bolt].pose);
    }

    pub(crate) fn finish(&self) -> NutCount {
        let way: Vec3 = self.now.position - self.start.position;
        NutCount { turns: (self.angle / TAU).abs(), down_m: -self.up * way.y }
    }
}

/// Whether the axis of a bolt points upwards (1) or downwards (-1).
fn up_along(bolt: &Pose) -> f32 {
    1.0_f32.copysign((bolt.rotation * Vec3::Y).y)
}

#[cfg(test)]
mod tests {
    use forerun::Quat;

    use super::*;

    /// What is counted on a bolt that lies so, of a nut that goes 24 mm towards the bolt's foot, whole turns and all.
    fn counted(rotation: Quat) -> NutCount {
        let mut scene = Scene::open("tori:2").unwrap();
        scene.bodies[1].name = Some("bolt".to_owned());
        scene.bodies[2].name = Some("nut".to_owned());
        let stage = Stage::of(&scene).unwrap();
        let mut nut = Nut::of(&scene, &stage).unwrap();
        let bolt = Pose::new(Vec3::new(1.0, 2.0, 3.0), rotation);
        // A turn and a half in steps of 0.4 rad, 1 mm down each; the quaternion changes its sign on the way.
        for k in 1..=24_u8 {
            let own = Pose::new(
                nut.start.position - Vec3::Y * (0.001 * f32::from(k)),
                Quat::from_rotation_y(-0.4 * f32::from(k)) * nut.start.rotation,
            );
            let of = |pose: Pose| Motion { pose, velocity: Vec3::ZERO, angular_velocity: Vec3::ZERO };
            nut.look_at(&[of(Pose::IDENTITY), of(bolt), of(bolt * own)]);
        }
        nut.finish()
    }

    #[test]
    fn turns_add_up_however_the_bolt_lies() {
        let leaning = Quat::from_rotation_x(1.0) * Quat::from_rotation_z(0.5);
        for (rotation, down_m) in [(leaning, 0.024), (leaning * Quat::from_rotation_x(PI), -0.024)] {
            let count = counted(rotation);
            assert!((count.turns - 9.6 / TAU).abs() < 1e-3, "{count:?}");
            assert!((count.down_m - down_m).abs() < 1e-5, "{count:?}");
        }
    }

    #[test]
    fn a_scene_without_a_bolt_has_no_count() {
        let scene = Scene::open("tori:2").unwrap();
        assert!(Nut::of(&scene, &Stage::of(&scene).unwrap()).is_none());
    }
}
