//! Rotation: turning orientations, and what a spinning body does by itself.
//!
//! Only + - * / and square roots: the same bits on every platform.

use forerun_geometry::{Mat3, Quat, Vec3};
use glam::{DQuat, DVec3};

/// Largest turn (radians) for which the series below is used as it stands.
const SERIES_MAX: f32 = 1.0;
/// Largest turn of one elementary step of free rotation. Radians.
const FREE_TURN_MAX: f32 = 0.1;
/// Most elementary steps of free rotation in a frame.
const FREE_STEPS_MAX: u32 = 32;

/// The quaternion turned by a rotation vector in the world.
#[must_use]
pub(crate) fn turned(q: Quat, rotation: Vec3) -> Quat {
    (turn(rotation) * q).normalize()
}

/// The unit quaternion of a rotation vector (radians).
fn turn(rotation: Vec3) -> Quat {
    let square = rotation.length_squared();
    if square > SERIES_MAX * SERIES_MAX && square.is_finite() {
        let half = turn(rotation * 0.5);
        // A length that is off by a rounding would be squared with every doubling.
        return (half * half).normalize();
    }
    // tan(a/2) / a to the sixth order: relative error below 1e-4 up to one radian.
    let tangent = 0.5 * (1.0 + square * (1.0 / 12.0 + square * (1.0 / 120.0 + square * (17.0 / 20160.0))));
    let v = rotation * tangent;
    Quat::from_xyzw(v.x, v.y, v.z, 1.0).normalize()
}

/// Whether the body turns about every axis alike: then it has no gyroscopic torque.
#[must_use]
pub(crate) fn is_isotropic(inverse_inertia: Vec3) -> bool {
    let i = inverse_inertia;
    i.x.to_bits() == i.y.to_bits() && i.y.to_bits() == i.z.to_bits()
}

/// I⁻¹ in the world, applied: `R I⁻¹ Rᵀ v`.
#[must_use]
pub(crate) fn times_inverse_inertia(axes: &Mat3, inverse_inertia: Vec3, v: Vec3) -> Vec3 {
    *axes * ((axes.transpose() * v) * inverse_inertia)
}

/// Angular momentum: `R I Rᵀ ω`.
#[must_use]
pub(crate) fn angular_momentum(axes: &Mat3, inverse_inertia: Vec3, angular_velocity: Vec3) -> Vec3 {
    *axes * ((axes.transpose() * angular_velocity) / inverse_inertia)
}

/// Free rotation for `seconds`: orientation and angular velocity afterwards.
///
/// A symmetric splitting of the kinetic energy into its three axes (McLachlan 1993; Touma and Wisdom 1994): every part is an exact rotation, so
/// that the length of the angular momentum is kept to rounding and the energy oscillates without drift.
#[must_use]
pub(crate) fn spun(q: Quat, angular_velocity: Vec3, inverse_inertia: Vec3, seconds: f32) -> (Quat, Vec3) {
    if is_isotropic(inverse_inertia) {
        return (turned(q, angular_velocity * seconds), angular_velocity);
    }
    if angular_velocity == Vec3::ZERO {
        return (q, angular_velocity);
    }
    let whole_turn = angular_velocity.length() * seconds;
    let steps = ((whole_turn / FREE_TURN_MAX) as u32).min(FREE_STEPS_MAX - 1) + 1;
    let h = f64::from(seconds) / f64::from(steps);
    // In double precision: the same small turn rounds the same way every time, and in single precision the momentum would drift by it.
    let inverse_inertia = inverse_inertia.as_dvec3();
    let mut q = q.as_dquat();
    // Body frame: the momentum turns against the body.
    let mut l = (q.conjugate() * angular_velocity.as_dvec3()) / inverse_inertia;
    for _ in 0..steps {
        for (axis, part) in [(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)] {
            let mut rotation = DVec3::ZERO;
            rotation[axis] = l[axis] * inverse_inertia[axis] * (h * part);
            let r = small_turn(rotation);
            l = r.conjugate() * l;
            q *= r;
        }
    }
    let q = q.normalize();
    (q.as_quat(), (q * (l * inverse_inertia)).as_vec3())
}

/// As [`turn`], for turns of at most about [`FREE_TURN_MAX`] radians, in double precision.
fn small_turn(rotation: DVec3) -> DQuat {
    let square = rotation.length_squared();
    let tangent = 0.5 * (1.0 + square * (1.0 / 12.0 + square * (1.0 / 120.0 + square * (17.0 / 20160.0))));
    let v = rotation * tangent;
    DQuat::from_xyzw(v.x, v.y, v.z, 1.0).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spin_beyond_all_measure_leaves_a_rotation() {
        for rotation in [Vec3::new(-2.5e9, -7.5e9, 3.1e10) / 60.0, Vec3::X * 1e18, Vec3::splat(300.0)] {
            let q = turned(Quat::IDENTITY, rotation);
            assert!((q.length() - 1.0).abs() < 1e-6, "{rotation}: {q}");
        }
    }

    #[test]
    fn a_turn_of_many_radians_is_the_one_that_is_asked_for() {
        for angle in [0.3_f32, 2.0, 10.0, 100.0] {
            let q = turned(Quat::IDENTITY, Vec3::Y * angle);
            let expected = Quat::from_xyzw(0.0, libm::sinf(0.5 * angle), 0.0, libm::cosf(0.5 * angle));
            assert!(q.dot(expected).abs() > 1.0 - 1e-5, "{angle}: {q}, expected {expected}");
        }
    }
}
