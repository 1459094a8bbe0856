//! Meters: what a bench reads off a world: overlap, energy, speed. The step reads none of them.
//!
//! Promise: overlap is measured from poses alone. Velocities, gravity and the margin of the contact search are left out, so what the solver
//! expects or allows plays no part, and poses that another engine computed are measured by the same rule.

use forerun_geometry::Vec3;

use crate::detection::Detection;
use crate::step::Member;
use crate::{Body, BodyId, BodyState, Environment, StepSettings, World};

/// The deepest overlap of two bodies of the world. Metres, 0 when nothing overlaps.
#[must_use]
pub fn deepest_overlap_m(world: &World) -> f32 {
    let still = Environment {
        gravity: Vec3::ZERO,
        settings: StepSettings { contact_margin_m: 0.0, ..world.environment.settings },
    };
    let states = world.states().iter().map(|state| BodyState {
        velocity: Vec3::ZERO,
        angular_velocity: Vec3::ZERO,
        ..*state
    });
    let members: Vec<Member> = (world.bodies().iter().zip(states).enumerate())
        .map(|(i, (body, state))| Member { id: BodyId(i as u32), body, state })
        .collect();
    let mut detection = Detection::default();
    detection.run(&members, &still);
    let contacts = &detection.contacts;
    contacts
        .iter()
        .flat_map(|contact| &contact.manifold.points[..contact.manifold.count as usize])
        .map(|point| -point.separation)
        .fold(0.0, f32::max)
}

/// Kinetic plus potential energy of the dynamic bodies, heights against gravity measured from the origin. Joules, summed in f64.
#[must_use]
pub fn mechanical_energy_j(world: &World) -> f64 {
    let gravity = world.environment.gravity;
    let of_body = |(body, state): (&Body, &BodyState)| {
        if !body.is_dynamic() {
            return 0.0;
        }
        let mass = 1.0 / f64::from(body.inverse_mass);
        let spin = state.rotation.conjugate() * state.angular_velocity;
        let moments = body.inverse_inertia.to_array().map(|inverse| 1.0 / f64::from(inverse));
        let turning: f64 =
            (spin.to_array().iter().zip(moments)).map(|(w, i)| i * f64::from(*w) * f64::from(*w)).sum();
        let moving = mass * dot(state.velocity, state.velocity);
        0.5 * (moving + turning) - mass * f64::from(body.gravity_scale) * dot(gravity, state.position)
    };
    world.bodies().iter().zip(world.states()).map(of_body).sum()
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a.to_array().iter().zip(b.to_array()).map(|(x, y)| f64::from(*x) * f64::from(y)).sum()
}

/// Mean speed of the centres of mass of the dynamic bodies. m/s, 0 when there are none.
#[must_use]
pub fn mean_speed(world: &World) -> f64 {
    let speeds: Vec<f64> = (world.bodies().iter().zip(world.states()))
        .filter(|(body, _)| body.is_dynamic())
        .map(|(_, state)| f64::from(state.velocity.length()))
        .collect();
    if speeds.is_empty() { 0.0 } else { speeds.iter().sum::<f64>() / speeds.len() as f64 }
}

#[cfg(test)]
mod tests {
    use forerun_geometry::shape::{Cuboid, Shape};

    use super::*;
    use crate::BodyDef;

    fn cube() -> BodyDef {
        BodyDef::new(Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) }))
    }

    #[test]
    fn a_spinning_box_in_the_air_has_the_energy_of_the_formula() {
        let mut world = World::new(Environment::default());
        let mut def = cube().at(Vec3::Y * 2.0);
        def.velocity = Vec3::new(3.0, 0.0, 0.0);
        def.angular_velocity = Vec3::new(0.0, 0.0, 6.0);
        world.add(&def).expect("a plain box");
        // m = 1000 kg, I = m/6: m v²/2 + I w²/2 + m g h
        let expected = 500.0 * 9.0 + 500.0 / 6.0 * 36.0 + 1000.0 * 9.81 * 2.0;
        let energy = mechanical_energy_j(&world);
        assert!((energy / expected - 1.0).abs() < 1e-5, "{energy}");
        assert!((mean_speed(&world) - 3.0).abs() < 1e-6);
    }

    #[test]
    fn overlap_comes_from_poses_and_not_from_what_is_about_to_happen() {
        let mut world = World::new(Environment::default());
        world.add(&cube()).expect("a plain box");
        let mut second = cube().at(Vec3::new(0.1, 0.97, 0.0));
        second.velocity = Vec3::Y * -20.0;
        world.add(&second).expect("a plain box");
        assert!((deepest_overlap_m(&world) - 0.03).abs() < 1e-5, "{}", deepest_overlap_m(&world));
        // Close to each other and fast, but apart.
        world.states_mut()[1].position.y = 1.01;
        assert!(deepest_overlap_m(&world) <= 0.0);
    }
}
