//! Energy meter: mechanical energy and mean speed of the dynamic bodies.

use forerun::dynamics::World;
use forerun::{Body, BodyState, Vec3};

/// Kinetic plus potential energy, heights against gravity measured from the origin. Joules, summed in f64.
pub(crate) fn mechanical_j(world: &World) -> f64 {
    let gravity = world.environment.gravity;
    let of_body = |(body, state): (&Body, &BodyState)| {
        if !body.is_dynamic() {
            return 0.0;
        }
        let mass = 1.0 / f64::from(body.inverse_mass);
        let spin = state.rotation.conjugate() * state.angular_velocity;
        let moments = body.inverse_inertia.to_array().map(|inverse| 1.0 / f64::from(inverse));
        let turning: f64 =
            (spin.to_array().iter().zip(moments)).map(|(w, i)| i * f64::from(*w).powi(2)).sum();
        let moving = mass * dot(state.velocity, state.velocity);
        0.5 * (moving + turning) - mass * f64::from(body.gravity_scale) * dot(gravity, state.position)
    };
    world.bodies().iter().zip(world.states()).map(of_body).sum()
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a.to_array().iter().zip(b.to_array()).map(|(x, y)| f64::from(*x) * f64::from(y)).sum()
}

/// Mean speed of the centres of mass of the dynamic bodies. m/s.
pub(crate) fn mean_speed(world: &World) -> f64 {
    let speeds: Vec<f64> = (world.bodies().iter().zip(world.states()))
        .filter(|(body, _)| body.is_dynamic())
        .map(|(_, state)| f64::from(state.velocity.length()))
        .collect();
    if speeds.is_empty() { 0.0 } else { speeds.iter().sum::<f64>() / speeds.len() as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use forerun::{BodyDef, Cuboid, Environment, Shape};

    #[test]
    fn a_spinning_box_in_the_air_has_the_energy_of_the_formula() {
        let mut world = World::new(Environment::default());
        let mut def =
            BodyDef::new(Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) })).at(Vec3::Y * 2.0);
        def.velocity = Vec3::new(3.0, 0.0, 0.0);
        def.angular_velocity = Vec3::new(0.0, 0.0, 6.0);
        world.add(&def).expect("a plain box");
        // m = 1000 kg, I = m/6: m v²/2 + I w²/2 + m g h
        let expected = 500.0 * 9.0 + 500.0 / 6.0 * 36.0 + 1000.0 * 9.81 * 2.0;
        assert!((mechanical_j(&world) / expected - 1.0).abs() < 1e-5, "{}", mechanical_j(&world));
        assert!((mean_speed(&world) - 3.0).abs() < 1e-6);
    }
}
