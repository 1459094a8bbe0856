//! Spring: a hand that holds a point of a body, as a soft constraint that is stable at any stiffness.

use forerun_geometry::{Mat3, Vec3};

use super::rotation::times_inverse_inertia;
use crate::{Body, BodyState};

/// Velocity and angular velocity after the body's spring, if any, has pulled for `seconds`.
///
/// Implicit Euler for a damped spring on the held point: `(K + γ) λ = -(u + β x / h)` with `γ = 1 / (h (c + h k))` and
/// `β = h k / (c + h k)`.
#[must_use]
pub(crate) fn pull(body: &Body, state: &BodyState, seconds: f32) -> (Vec3, Vec3) {
    let Some(spring) = body.spring.filter(|_| body.is_dynamic()) else {
        return (state.velocity, state.angular_velocity);
    };
    let axes = state.pose().axes();
    let arm = axes * body.frame.transform_point(spring.anchor);
    let stretch = state.position + arm - spring.target;
    let mass = 1.0 / body.inverse_mass;
    let omega = 2.0 * std::f32::consts::PI * spring.frequency_hz;
    let (stiffness, damping) = (mass * omega * omega, 2.0 * mass * spring.damping_ratio * omega);
    let yielding = seconds * (damping + seconds * stiffness);
    if yielding <= 0.0 {
        return (state.velocity, state.angular_velocity);
    }
    let soft = 1.0 / yielding;
    let bias = stretch * (seconds * stiffness / (damping + seconds * stiffness) / seconds);
    // K = 1/m + r*ᵀ I⁻¹ r*, column by column.
    let column = |axis: Vec3| {
        let turned = times_inverse_inertia(&axes, body.inverse_inertia, arm.cross(axis));
        axis * (body.inverse_mass + soft) + turned.cross(arm)
    };
    let k = Mat3::from_cols(column(Vec3::X), column(Vec3::Y), column(Vec3::Z));
    let impulse = k.inverse() * -(state.velocity_at(state.position + arm) + bias);
    let spin = times_inverse_inertia(&axes, body.inverse_inertia, arm.cross(impulse));
    (state.velocity + impulse * body.inverse_mass, state.angular_velocity + spin)
}
