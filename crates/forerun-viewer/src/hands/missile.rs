//! Missile: what is thrown or added, and how it has to be thrown to get where it is aimed.

use std::collections::BTreeMap;

use forerun::geometry::shape::mesh_make;
use forerun::{BodyDef, BodyKind, Mass, Shape, Vec3};

use crate::session::Play;
use crate::view::{Grip, Missile};

/// The tube of a torus, and the middle of it, as parts of its size.
const TORUS: [f32; 2] = [0.3, 0.7];

/// Sizes are made to steps of this, so that not every motion of a slider is another mesh. Metres.
const SIZE_STEP_M: f32 = 0.01;

/// What can be thrown. Meshes are kept: to make their fields takes some time.
#[derive(Debug, Default)]
pub(super) struct Missiles {
    /// By steps of size.
    tori: BTreeMap<u32, Shape>,
}

impl Missiles {
    /// What is to be thrown, at the origin and at rest.
    ///
    /// # Errors
    /// What is missing, and how to get it.
    pub(super) fn def(&mut self, play: &Play, grip: &Grip) -> Result<BodyDef, String> {
        let steps = (grip.size / SIZE_STEP_M).round().clamp(1.0, 1e4);
        let size = steps * SIZE_STEP_M;
        let shape = match grip.missile {
            Missile::Ball => Shape::sphere(size).map_err(|error| error.to_string())?,
            Missile::Box => Shape::cuboid(Vec3::splat(size)).map_err(|error| error.to_string())?,
            Missile::Torus => self.torus(steps as u32)?,
            Missile::Selected => return selected(play),
        };
        Ok(BodyDef { mass: Mass::Density(grip.density), ..BodyDef::new(shape) })
    }

    fn torus(&mut self, steps: u32) -> Result<Shape, String> {
        if let Some(made) = self.tori.get(&steps) {
            return Ok(made.clone());
        }
        let [tube, radius] = TORUS.map(|part| part * steps as f32 * SIZE_STEP_M);
        let made: Shape = mesh_make::torus(radius, tube, 24, 12).map_err(|error| error.to_string())?.into();
        self.tori.insert(steps, made.clone());
        Ok(made)
    }
}

/// One like the selected body.
fn selected(play: &Play) -> Result<BodyDef, String> {
    let active = play.selection.active().ok_or("nothing is selected: pick a body to throw others like it")?;
    let def = play.def_of(active).ok_or("the selected body is not there now")?;
    if !def.shape.has_volume() {
        return Err("the selected body bounds no volume, so it cannot be thrown: pick another".to_owned());
    }
    Ok(BodyDef {
        pose: forerun::Pose { position: Vec3::ZERO, ..def.pose },
        velocity: Vec3::ZERO,
        angular_velocity: Vec3::ZERO,
        kind: BodyKind::Dynamic,
        ..def
    })
}

/// From the origin of a body to the farthest point of it. Metres.
pub(super) fn radius_of(def: &BodyDef) -> f32 {
    def.shape.radius_about(Vec3::ZERO)
}

/// The velocity with which something gets from here by `way` (metres) under gravity: of the two ways the flatter one. None where the speed
/// (m/s) is too small for it.
///
/// From way = v t + g t²/2 and |v| = speed: |g|²/4 t⁴ - (way·g + speed²) t² + |way|² = 0, a quadratic in t².
pub(super) fn lead(way: Vec3, gravity: Vec3, speed: f32) -> Option<Vec3> {
    let quarter = 0.25 * gravity.length_squared();
    let middle = way.dot(gravity) + speed * speed;
    let root = middle * middle - 4.0 * quarter * way.length_squared();
    if root < 0.0 || middle <= 0.0 || way == Vec3::ZERO {
        return None;
    }
    // The smaller root, in the form that does not cancel and knows no gravity.
    let time = (2.0 * way.length_squared() / (middle + root.sqrt())).sqrt();
    Some(way / time - gravity * (0.5 * time))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_led_gets_where_it_is_aimed_at_the_speed_that_it_is_given() {
        let gravity = Vec3::Y * -9.81;
        for way in [Vec3::new(8.0, -3.0, 2.0), Vec3::new(0.0, 5.0, 1.0), Vec3::new(-15.0, 0.0, 0.0)] {
            for gravity in [gravity, Vec3::ZERO, Vec3::new(3.0, 1.0, 0.0)] {
                let velocity = lead(way, gravity, 15.0).expect("near enough");
                assert!((velocity.length() - 15.0).abs() < 1e-3, "{velocity}");
                // The nearest that it comes in two seconds.
                let at = |t: f32| velocity * t + gravity * (0.5 * t * t);
                let nearest =
                    (0..20_000).map(|i| at(i as f32 * 1e-4).distance(way)).fold(f32::INFINITY, f32::min);
                assert!(nearest < 2e-3, "{nearest} m beside {way}");
            }
        }
        assert_eq!(lead(Vec3::X * 100.0, gravity, 15.0), None, "too far");
        let down = lead(Vec3::Y * -4.0, gravity, 15.0).expect("below");
        assert!((down - Vec3::Y * -15.0).length() < 1e-4, "{down}");
    }
}
