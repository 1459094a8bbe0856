//! Velocities: springs and the gyroscopic term, once a frame; gravity, forces and torques follow in every substep.

use forerun_geometry::Vec3;

use super::bodies::{Bodies, Column, eight_from, flags};
use super::flight::spin_halfway;
use super::poses::{Q8, from_axes, is_large, to_axes};
use super::spring::pull;
use crate::halfway::Halfway;
use crate::lanes::{LANES, LaneMask, Lanes, Row, V8, cells, dispatched};
use crate::{BodyKind, Environment, Member};

dispatched! {
    /// Fills in the rows of all bodies, and the mass-scaled velocities that the contacts start from.
    pub(crate) fn integrate_velocities(
        bodies: &mut Bodies,
        members: &[Member],
        environment: &Environment,
    ) => velocity_lanes
}

#[inline(always)]
fn velocity_lanes<F: Lanes>(bodies: &mut Bodies, members: &[Member], environment: &Environment) {
    bodies.begin(members.len());
    for start in (0..bodies.centres.len()).step_by(LANES) {
        let eight = &members[start.min(members.len())..(start + LANES).min(members.len())];
        let own = Own::<F>::gather(bodies, eight, start, environment);
        let spin = own.spin_halfway(eight, environment);
        own.write(bodies, start, spin, environment);
        let [x, y, z] = [spin.x.to_array(), spin.y.to_array(), spin.z.to_array()];
        for lane in 0..eight.len() {
            bodies.spins[start + lane] = Vec3::new(x[lane], y[lane], z[lane]);
        }
    }
}

/// What eight bodies are and how they are. Bodies that there are not are fixed ones in the origin.
struct Own<F> {
    position: V8<F>,
    rotation: Q8<F>,
    axes: [V8<F>; 3],
    /// After springs.
    velocity: V8<F>,
    spin: V8<F>,
    inverse_mass: F,
    inverse_inertia: V8<F>,
    acceleration: V8<F>,
    torque: V8<F>,
    /// 1 or 0.
    dynamic: F,
    kinematic: F,
    /// Bit `i`: whether lane `i` is dynamic, turns, and not about every axis alike.
    gyroscopic: u32,
}

impl<F: Lanes> Own<F> {
    /// Also writes the surfaces, and notes who is pulled.
    #[inline(always)]
    fn gather(bodies: &mut Bodies, eight: &[Member], start: usize, environment: &Environment) -> Self {
        let zero: Column = [0.0; LANES];
        let (mut position, mut rotation, mut w) = ([zero; 3], [zero; 3], [1.0; LANES]);
        let (mut velocity, mut spin, mut inertia) = ([zero; 3], [zero; 3], [zero; 3]);
        let (mut mass, mut acceleration, mut torque) = (zero, [zero; 3], [zero; 3]);
        let (mut dynamic, mut kinematic, mut gyroscopic) = (0u32, 0u32, 0u32);
        for (lane, member) in eight.iter().enumerate() {
            let (body, state) = (member.body, &member.state);
            let (mut v, mut s) = (state.velocity, state.angular_velocity);
            if body.kind == BodyKind::Dynamic {
                dynamic |= 1 << lane;
                if body.spring.is_some() {
                    (v, s) = pull(body, state, environment.settings.frame_seconds);
                    bodies.pulled.push((start + lane) as u32);
                }
                let i = body.inverse_inertia;
                let alike = i.x.to_bits() == i.y.to_bits() && i.y.to_bits() == i.z.to_bits();
                gyroscopic |= u32::from(!alike && s != Vec3::ZERO) << lane;
            }
            kinematic |= u32::from(body.kind == BodyKind::Kinematic) << lane;
            let shift = match body.kind {
                BodyKind::Fixed => Vec3::ZERO,
                _ => Halfway::of(body, state, environment).shift,
            };
            let middle = state.position + shift;
            let a = environment.gravity * body.gravity_scale + body.force * body.inverse_mass;
            for axis in 0..3 {
                position[axis][lane] = middle[axis];
                velocity[axis][lane] = v[axis];
                spin[axis][lane] = s[axis];
                inertia[axis][lane] = body.inverse_inertia[axis];
                acceleration[axis][lane] = a[axis];
                torque[axis][lane] = body.torque[axis];
            }
            let q = state.rotation;
            (rotation[0][lane], rotation[1][lane], rotation[2][lane], w[lane]) = (q.x, q.y, q.z, q.w);
            mass[lane] = body.inverse_mass;
            let m = &body.material;
            let (half, inverse) = (body.half_thickness, body.inverse_mass);
            bodies.surfaces[start + lane] =
                Row([m.static_friction, m.friction, m.restitution, half, inverse, shift.x, shift.y, shift.z]);
        }
        for surface in &mut bodies.surfaces[start + eight.len()..start + LANES] {
            *surface = Row::default();
        }
        let rotation = Q8 { v: V8::from_arrays(rotation), w: F::from_array(w) };
        Own {
            position: V8::from_arrays(position),
            rotation,
            axes: rotation.axes(),
            velocity: V8::from_arrays(velocity),
            spin: V8::from_arrays(spin),
            inverse_mass: F::from_array(mass),
            inverse_inertia: V8::from_arrays(inertia),
            acceleration: V8::from_arrays(acceleration),
            torque: V8::from_arrays(torque),
            dynamic: flags(dynamic),
            kinematic: flags(kinematic),
            gyroscopic,
        }
    }

    /// The angular velocities that the bodies have half a frame on, see [`spin_halfway`]: what their contacts should see. None for fixed bodies.
    #[inline(always)]
    fn spin_halfway(&self, eight: &[Member], environment: &Environment) -> V8<F> {
        let moving = self.dynamic + self.kinematic;
        let spin = self.spin * moving;
        if self.gyroscopic == 0 {
            return spin;
        }
        let seconds = environment.settings.frame_seconds;
        let gyroscopic = flags::<F>(self.gyroscopic).gt(F::zero());
        let inertia = V8 {
            x: gyroscopic.select(self.inverse_inertia.x, F::one()),
            y: gyroscopic.select(self.inverse_inertia.y, F::one()),
            z: gyroscopic.select(self.inverse_inertia.z, F::one()),
        };
        let inside = to_axes(&self.axes, spin);
        let inside = V8 { x: inside.x / inertia.x, y: inside.y / inertia.y, z: inside.z / inertia.z };
        let momentum = from_axes(&self.axes, inside);
        let rotation = spin * F::splat(0.5 * seconds);
        let middle = self.rotation.turned(rotation).axes();
        let halfway = from_axes(&middle, to_axes(&middle, momentum).times(inertia));
        let mut spin = gyroscopic.select_v(halfway, spin);
        let large = is_large(rotation) & self.gyroscopic;
        if large != 0 {
            let [mut x, mut y, mut z] = [spin.x.to_array(), spin.y.to_array(), spin.z.to_array()];
            let before = [self.spin.x.to_array(), self.spin.y.to_array(), self.spin.z.to_array()];
            for (lane, member) in eight.iter().enumerate() {
                if large >> lane & 1 == 1 {
                    let before = Vec3::new(before[0][lane], before[1][lane], before[2][lane]);
                    let s = spin_halfway(member.body, &member.state, before, seconds);
                    (x[lane], y[lane], z[lane]) = (s.x, s.y, s.z);
                }
            }
            spin = V8::from_arrays([x, y, z]);
        }
        spin
    }

    #[inline(always)]
    fn write(&self, bodies: &mut Bodies, start: usize, spin: V8<F>, environment: &Environment) {
        let settings = &environment.settings;
        let h = F::splat(settings.frame_seconds / settings.substeps as f32);
        let rows = eight_from(start);
        let (zero, dynamic) = (F::zero(), self.dynamic);
        // The square root for dynamic bodies, 1 for kinematic, 0 for fixed ones; and its inverse.
        let kinematic = self.kinematic;
        let root = |x: F| x.sqrt() * dynamic + kinematic;
        let inverse = |root: F| {
            let yields = root.gt(zero);
            yields.select(F::one() / yields.select(root, F::one()), zero)
        };
        let i = self.inverse_inertia;
        let (s, i) = (root(self.inverse_mass), V8 { x: root(i.x), y: root(i.y), z: root(i.z) });
        let (per_s, per_i) = (inverse(s), V8 { x: inverse(i.x), y: inverse(i.y), z: inverse(i.z) });
        let (p, [a, b, _]) = (self.position, self.axes);
        F::scatter(cells(&mut bodies.centres), &rows, [p.x, p.y, p.z, s, i.x, i.y, i.z, dynamic]);
        F::scatter(cells(&mut bodies.axes), &rows, [a.x, a.y, a.z, b.x, b.y, b.z, zero, zero]);
        let v = self.velocity * per_s;
        let w = to_axes(&self.axes, spin).times(per_i);
        F::scatter(cells(&mut bodies.velocities), &rows, [v.x, v.y, v.z, w.x, w.y, w.z, zero, zero]);
        // sqrt(I) Rᵀ I⁻¹ τ = I^(-1/2) Rᵀ τ
        let v = self.acceleration * (per_s * dynamic * h);
        let w = to_axes(&self.axes, self.torque).times(i) * (dynamic * h);
        F::scatter(cells(&mut bodies.kicks), &rows, [v.x, v.y, v.z, w.x, w.y, w.z, zero, zero]);
    }
}
