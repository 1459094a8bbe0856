//! Positions: new poses from the displacements, angular momentum carried over.

use forerun_geometry::{Quat, Vec3};

use super::bodies::{Bodies, Column, eight_from};
use super::flight::fly;
use super::poses::{Q8, from_axes, is_large, to_axes};
use super::rotation::turned;
use super::spring::pull;
use crate::lanes::{LANES, LaneMask, Lanes, Twist8, V8, dispatched};
use crate::{BodyState, Environment, Member};

dispatched! {
    /// The states that the bodies have moved to, whether they were at rest or not, into `next`.
    pub(crate) fn integrate_positions(
        members: &[Member],
        bodies: &Bodies,
        environment: &Environment,
        next: &mut Vec<BodyState>,
    ) => position_lanes
}

#[inline(always)]
fn position_lanes<F: Lanes>(
    members: &[Member],
    bodies: &Bodies,
    environment: &Environment,
    next: &mut Vec<BodyState>,
) {
    next.clear();
    for (k, eight) in members.chunks(LANES).enumerate() {
        let moved = Moved::<F>::of(eight, bodies, k * LANES, environment).lanes();
        for (lane, member) in eight.iter().enumerate() {
            next.push(if bodies.centres[k * LANES + lane].0[7] > 0.0 {
                moved.state(lane, member)
            } else {
                fly(member.body, &member.state, environment, environment.settings.frame_seconds)
            });
        }
    }
}

/// Where and how eight dynamic bodies are.
struct Moved<F> {
    position: V8<F>,
    rotation: Q8<F>,
    velocity: V8<F>,
    spin: V8<F>,
}

impl<F: Lanes> Moved<F> {
    #[inline(always)]
    fn of(eight: &[Member], bodies: &Bodies, start: usize, environment: &Environment) -> Self {
        let rows = eight_from(start);
        let [_, _, _, s, ix, iy, iz, _] = F::gather(&bodies.centres, &rows);
        let [ax, ay, az, bx, by, bz, ..] = F::gather(&bodies.axes, &rows);
        let (a, b) = (V8 { x: ax, y: ay, z: az }, V8 { x: bx, y: by, z: bz });
        let (axes, i) = ([a, b, a.cross(b)], V8 { x: ix, y: iy, z: iz });
        let u = Twist8::of(F::gather(&bodies.velocities, &rows));
        let d = Twist8::of(F::gather(&bodies.displacements, &rows));
        let end = from_axes(&axes, u.angular.times(i));
        let rotation = from_axes(&axes, d.angular.times(i));

        let zero: Column = [0.0; LANES];
        let (mut q, mut w, mut spin, mut start_spin) = ([zero; 3], [1.0; LANES], [zero; 3], [zero; 3]);
        let mut position = [zero; 3];
        for (lane, member) in eight.iter().enumerate() {
            let r = member.state.rotation;
            (q[0][lane], q[1][lane], q[2][lane], w[lane]) = (r.x, r.y, r.z, r.w);
            for axis in 0..3 {
                position[axis][lane] = member.state.position[axis];
                spin[axis][lane] = member.state.angular_velocity[axis];
                start_spin[axis][lane] = bodies.spins[start + lane][axis];
            }
        }
        let V8 { x, y, z } = V8::<F>::from_arrays(position);
        let here = bodies.pulled.partition_point(|&i| (i as usize) < start);
        for &i in bodies.pulled[here..].iter().take_while(|&&i| (i as usize) < start + LANES) {
            let (lane, seconds) = (i as usize - start, environment.settings.frame_seconds);
            let (_, pulled) = pull(eight[lane].body, &eight[lane].state, seconds);
            for axis in 0..3 {
                spin[axis][lane] = pulled[axis];
            }
        }
        let mut turned_to = Q8 { v: V8::from_arrays(q), w: F::from_array(w) }.turned(rotation);
        turn_far(&mut turned_to, rotation, eight);

        // The momentum of the start, springs included, plus what contacts and torques added, in the new orientation. A body that turns about every axis
        // alike has no more to carry than its spin.
        let alike = ix.le(iy) & iy.le(ix) & iy.le(iz) & iz.le(iy);
        let carried = V8::from_arrays(spin) + (end - V8::from_arrays(start_spin));
        let i2 = i.times(i);
        let inside = to_axes(&axes, carried);
        let inside = V8 { x: inside.x / i2.x, y: inside.y / i2.y, z: inside.z / i2.z };
        let new_axes = turned_to.axes();
        let spin = from_axes(&new_axes, to_axes(&new_axes, from_axes(&axes, inside)).times(i2));
        Moved {
            position: V8 { x, y, z } + d.linear * s,
            rotation: turned_to,
            velocity: u.linear * s,
            spin: alike.select_v(end, spin),
        }
    }

    #[inline(always)]
    fn lanes(&self) -> MovedLanes {
        let columns = |v: V8<F>| [v.x.to_array(), v.y.to_array(), v.z.to_array()];
        MovedLanes {
            position: columns(self.position),
            rotation: columns(self.rotation.v),
            w: self.rotation.w.to_array(),
            velocity: columns(self.velocity),
            spin: columns(self.spin),
        }
    }
}

/// Does turns that are too large for lanes one by one.
#[inline(always)]
fn turn_far<F: Lanes>(turned_to: &mut Q8<F>, rotation: V8<F>, eight: &[Member]) {
    let large = is_large(rotation);
    if large == 0 {
        return;
    }
    let by = [rotation.x.to_array(), rotation.y.to_array(), rotation.z.to_array()];
    let v = turned_to.v;
    let [mut x, mut y, mut z, mut w] =
        [v.x.to_array(), v.y.to_array(), v.z.to_array(), turned_to.w.to_array()];
    for (lane, member) in eight.iter().enumerate() {
        if large >> lane & 1 == 1 {
            let q = turned(member.state.rotation, Vec3::new(by[0][lane], by[1][lane], by[2][lane]));
            (x[lane], y[lane], z[lane], w[lane]) = (q.x, q.y, q.z, q.w);
        }
    }
    *turned_to = Q8 { v: V8::from_arrays([x, y, z]), w: F::from_array(w) };
}

/// As [`Moved`], to be taken apart.
struct MovedLanes {
    position: [Column; 3],
    rotation: [Column; 3],
    w: Column,
    velocity: [Column; 3],
    spin: [Column; 3],
}

impl MovedLanes {
    #[inline(always)]
    fn state(&self, lane: usize, member: &Member) -> BodyState {
        let vector = |of: &[Column; 3]| Vec3::new(of[0][lane], of[1][lane], of[2][lane]);
        let q = vector(&self.rotation);
        BodyState {
            position: vector(&self.position),
            rotation: Quat::from_xyzw(q.x, q.y, q.z, self.w[lane]),
            velocity: vector(&self.velocity),
            angular_velocity: vector(&self.spin),
            rest: member.state.rest,
        }
        .canonical()
    }
}
