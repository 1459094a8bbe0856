//! Missile: what is thrown or added, and how it has to be thrown to get where it is aimed.

use forerun::geometry::shape::mesh_make;
use forerun::{BodyDef, BodyKind, Mass, Shape, Vec3};

use crate::host::{Making, make};
use crate::session::Play;
use crate::view::{Grip, Missile};

/// The tube of a torus, and the middle of it, as parts of its size.
const TORUS: [f32; 2] = [0.3, 0.7];

/// Sizes are made to steps of this, so that not every motion of a slider is another mesh. Metres.
const SIZE_STEP_M: f32 = 0.01;

/// So many tori are kept.
const TORI_MAX: usize = 8;

/// What can be thrown. Meshes are made elsewhere than on the display's thread, where that is possible, and kept: their fields take some time.
#[derive(Debug, Default)]
pub(super) struct Missiles {
    /// By steps of size. The one that was used last comes last.
    tori: Vec<(u32, Shape)>,
    /// One at a time.
    making: Option<(u32, Making<Result<Shape, String>>)>,
}

impl Missiles {
    /// What is to be thrown, at the origin and at rest; none while it is being made.
    ///
    /// # Errors
    /// What is missing, and how to get it.
    pub(super) fn def(&mut self, play: &Play, grip: &Grip) -> Result<Option<BodyDef>, String> {
        let steps = steps_of(grip);
        let size = steps as f32 * SIZE_STEP_M;
        let shape = match grip.missile {
            Missile::Ball => Shape::sphere(size).map_err(|error| error.to_string())?,
            Missile::Box => Shape::cuboid(Vec3::splat(size)).map_err(|error| error.to_string())?,
            Missile::Torus => match self.torus(steps)? {
                Some(torus) => torus,
                None => return Ok(None),
            },
            Missile::Selected => return selected(play).map(Some),
        };
        Ok(Some(BodyDef { mass: Mass::Density(grip.density), ..BodyDef::new(shape) }))
    }

    /// Begins to make what has to be made before it can be thrown.
    pub(super) fn prepare(&mut self, grip: &Grip) {
        if grip.missile == Missile::Torus {
            // What goes wrong is said when it is to be thrown.
            let _ = self.torus(steps_of(grip));
        }
    }

    fn torus(&mut self, steps: u32) -> Result<Option<Shape>, String> {
        if let Some(at) = self.tori.iter().position(|(of, _)| *of == steps) {
            self.tori[at..].rotate_left(1);
            return Ok(self.tori.last().map(|(_, torus)| torus.clone()));
        }
        let (of, making) = self.making.get_or_insert_with(|| (steps, make(move || torus(steps))));
        let Some(made) = making.poll() else { return Ok(None) };
        let of = *of;
        self.making = None;
        let made = made.and_then(|made| made);
        // One of another size, which nobody wants any more, is kept all the same.
        if let Ok(torus) = &made {
            self.tori.push((of, torus.clone()));
            let surplus = self.tori.len().saturating_sub(TORI_MAX);
            self.tori.drain(..surplus);
        }
        if of == steps { made.map(Some) } else { Ok(None) }
    }
}

fn steps_of(grip: &Grip) -> u32 {
    (grip.size / SIZE_STEP_M).round().clamp(1.0, 1e4) as u32
}

fn torus(steps: u32) -> Result<Shape, String> {
    let [tube, radius] = TORUS.map(|part| part * steps as f32 * SIZE_STEP_M);
    mesh_make::torus(radius, tube, 24, 12).map(Shape::from).map_err(|error| error.to_string())
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
    fn a_torus_is_made_elsewhere_and_only_the_last_are_kept() {
        let mut missiles = Missiles::default();
        assert!(missiles.torus(30).is_ok_and(|torus| torus.is_none()), "it is not made while one waits");
        let mut of_size = |steps: u32| {
            let wait = std::time::Duration::from_millis(2);
            let made = (0..5000).find_map(|_| {
                std::thread::sleep(wait);
                missiles.torus(steps).expect("there is such a torus")
            });
            let radius = made.expect("within ten seconds").radius_about(Vec3::ZERO);
            assert!((radius - 0.01 * steps as f32).abs() < 1e-3 * radius, "{radius} of {steps}");
            missiles.tori.len()
        };
        let kept: Vec<usize> = (30..42).map(&mut of_size).collect();
        assert_eq!(kept, [1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 8, 8]);
        assert_eq!(of_size(36), 8, "it was still there");
    }

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
