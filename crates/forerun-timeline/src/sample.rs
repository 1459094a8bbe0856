//! Sample: a body between two stored states (dissertation, algorithm 1: `BuscaEstado`).
//!
//! Promise: whatever is between two states follows from them, the body and gravity alone. Positions are interpolated linearly, or,
//! where nothing but gravity and constant forces acted, by the cubic with the stored velocities (Hermite); orientations along the
//! shorter arc (slerp, Shoemake 1985).

use forerun_dynamics::{Body, BodyState, Environment};
use forerun_geometry::Quat;

/// A velocity change that free flight explains to within this shows that no impulse acted. m/s.
const FREE_VELOCITY_M_PER_S: f32 = 1e-3;

/// Above this cosine of half the angle, slerp is as good as a straight line, whose formula does not divide by a small sine.
const STRAIGHT_COSINE: f32 = 0.9995;

/// The state between two of a body, `part` of a frame (0 to 1) after the first.
pub(crate) fn between(
    states: (&BodyState, &BodyState),
    part: f32,
    body: &Body,
    environment: &Environment,
) -> BodyState {
    let (a, b) = states;
    let dt = environment.settings.frame_seconds;
    let position = if flies_freely(states, body, environment) {
        // Cubic Hermite: ends and slopes as stored.
        let (s, s2) = (part, part * part);
        let s3 = s2 * s;
        let travelled = (b.position - a.position) * (3.0 * s2 - 2.0 * s3);
        a.position + travelled + (a.velocity * (s3 - 2.0 * s2 + s) + b.velocity * (s3 - s2)) * dt
    } else {
        a.position + (b.position - a.position) * part
    };
    BodyState {
        position,
        rotation: slerp(a.rotation, b.rotation, part),
        velocity: a.velocity + (b.velocity - a.velocity) * part,
        angular_velocity: a.angular_velocity + (b.angular_velocity - a.angular_velocity) * part,
        rest: a.rest,
    }
}

/// The state going on for some frames (0 or more) at the velocities that it has.
pub(crate) fn beyond(state: &BodyState, frames: f32, frame_seconds: f32) -> BodyState {
    let seconds = frames * frame_seconds;
    let mut next = *state;
    next.position += state.velocity * seconds;
    let speed = state.angular_velocity.length();
    if speed > 0.0 && speed.is_finite() {
        let (sine, cosine) = libm::sincosf(0.5 * speed * seconds);
        let axis = state.angular_velocity * (sine / speed);
        next.rotation = (Quat::from_xyzw(axis.x, axis.y, axis.z, cosine) * state.rotation).normalize();
    }
    next
}

/// Whether gravity and constant forces alone lead from one state to the other.
fn flies_freely((a, b): (&BodyState, &BodyState), body: &Body, environment: &Environment) -> bool {
    if !body.is_dynamic() || body.spring.is_some() {
        return false;
    }
    let dt = environment.settings.frame_seconds;
    let change = (environment.gravity * body.gravity_scale + body.force * body.inverse_mass) * dt;
    let tolerance = FREE_VELOCITY_M_PER_S + 1e-5 * a.velocity.length();
    // A body that is moved elsewhere keeps its velocity. Integrators differ by at most half a frame's change of velocity.
    let travelled = (a.velocity + b.velocity) * (0.5 * dt);
    let slack = (0.5 * change.length() + tolerance) * dt + 1e-6 * (a.position.length() + b.position.length());
    (b.velocity - a.velocity - change).length() <= tolerance
        && (b.position - a.position - travelled).length() <= slack
}

/// From `a` to `b` along the shorter arc at a constant rate.
fn slerp(a: Quat, b: Quat, part: f32) -> Quat {
    let dot = a.dot(b);
    // q and -q are the same rotation.
    let (b, cosine) = if dot < 0.0 { (-b, -dot) } else { (b, dot) };
    if cosine > STRAIGHT_COSINE {
        return (a * (1.0 - part) + b * part).normalize();
    }
    let angle = libm::acosf(cosine);
    let scale = 1.0 / libm::sinf(angle);
    (a * (libm::sinf((1.0 - part) * angle) * scale) + b * (libm::sinf(part * angle) * scale)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use forerun_dynamics::BodyDef;
    use forerun_geometry::Vec3;
    use forerun_geometry::shape::{Shape, Sphere};

    const DT: f32 = 1.0 / 60.0;

    fn ball() -> (Body, BodyState) {
        Body::new(&BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 }))).unwrap()
    }

    #[test]
    fn free_fall_is_followed_to_the_micrometre() {
        let (body, mut a) = ball();
        let environment = Environment::default();
        let g = environment.gravity;
        a.velocity = Vec3::new(3.0, 2.0, 0.0);
        let at = |t: f32| a.position + a.velocity * t + g * (0.5 * t * t);
        let b = BodyState { position: at(DT), velocity: a.velocity + g * DT, ..a };
        for part in [0.1, 0.25, 0.5, 0.77] {
            let found = between((&a, &b), part, &body, &environment).position;
            assert!((found - at(part * DT)).length() < 1e-6, "{part}: {found}");
        }
    }

    #[test]
    fn a_bounce_stays_between_its_states() {
        let (body, mut a) = ball();
        let environment = Environment::default();
        a.position.y = 0.52;
        a.velocity.y = -5.0;
        let b = BodyState { position: Vec3::new(0.0, 0.55, 0.0), velocity: Vec3::new(0.0, 5.0, 0.0), ..a };
        for part in [0.1, 0.5, 0.9] {
            let y = between((&a, &b), part, &body, &environment).position.y;
            assert!((y - (0.52 + 0.03 * part)).abs() < 1e-6, "{y}");
        }
    }

    #[test]
    fn slerp_turns_at_a_constant_rate_and_the_short_way() {
        for full in [0.01_f32, 0.3, 2.0] {
            let turned = |angle: f32| {
                let (sine, cosine) = libm::sincosf(0.5 * angle);
                Quat::from_xyzw(0.0, sine, 0.0, cosine)
            };
            for part in [0.2, 0.5, 0.7] {
                let expected = turned(full * part);
                for end in [turned(full), -turned(full)] {
                    let found = slerp(Quat::IDENTITY, end, part);
                    let error = 2.0 * (found - expected).length();
                    assert!(error < 1e-5, "angle {full}, part {part}: error {error} rad");
                }
            }
        }
    }

    #[test]
    fn beyond_the_last_state_a_body_goes_on() {
        let (_, mut a) = ball();
        a.velocity.x = 6.0;
        a.angular_velocity.z = 20.0;
        let b = beyond(&a, 2.0, DT);
        assert!((b.position.x - 0.2).abs() < 1e-6);
        let angle = 2.0 * libm::atan2f(b.rotation.z, b.rotation.w);
        assert!((angle - 20.0 * 2.0 * DT).abs() < 1e-5);
    }
}
