//! Substep: what happens to the bodies between the passes over their contacts.

use super::bodies::Bodies;
use crate::lanes::{LaneMask, Lanes, Row, dispatched};

dispatched! {
    /// Gravity, forces and torques, and once more what the contacts did in the last substep.
    pub(crate) fn fall(bodies: &mut Bodies) => fall_lanes
}

dispatched! {
    /// Moves the bodies by their velocities for one substep. A body that no impulse reached flies its parabola; one that was pushed moves as the
    /// contacts were solved, with its new velocity.
    pub(crate) fn displace(bodies: &mut Bodies, substep_seconds: f32) => displace_lanes
}

dispatched! {
    /// Notes what the contacts did.
    pub(crate) fn note_pushes(bodies: &mut Bodies) => note_lanes
}

#[inline(always)]
fn load<F: Lanes>(row: &Row) -> F {
    F::from_array(row.0)
}

#[inline(always)]
fn fall_lanes<F: Lanes>(bodies: &mut Bodies) {
    let rows = bodies.velocities.iter_mut().zip(&mut bodies.free);
    for ((velocity, free), (kick, push)) in rows.zip(bodies.kicks.iter().zip(&bodies.pushes)) {
        let falling = load::<F>(velocity) + load(kick);
        free.0 = falling.to_array();
        velocity.0 = (falling + load(push)).to_array();
    }
}

#[inline(always)]
fn displace_lanes<F: Lanes>(bodies: &mut Bodies, substep_seconds: f32) {
    let h = F::splat(substep_seconds);
    let rows = bodies.displacements.iter_mut().zip(&bodies.velocities);
    for ((displacement, velocity), (free, kick)) in rows.zip(bodies.free.iter().zip(&bodies.kicks)) {
        let (v, free) = (load::<F>(velocity), load::<F>(free));
        let flies = (v.le(free) & free.le(v)).bits() == 0xff;
        let half = F::splat(if flies { 0.5 } else { 0.0 });
        let moved = load::<F>(displacement) + h * (v - half * load(kick));
        displacement.0 = moved.to_array();
    }
}

#[inline(always)]
fn note_lanes<F: Lanes>(bodies: &mut Bodies) {
    for (push, (velocity, free)) in bodies.pushes.iter_mut().zip(bodies.velocities.iter().zip(&bodies.free)) {
        push.0 = (load::<F>(velocity) - load(free)).to_array();
    }
}
