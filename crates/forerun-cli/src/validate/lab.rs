//! Lab: what the cases share: built-in scenes, worlds, slopes, energy and momentum.
//!
//! Figures are computed in double precision from the stored states.

use forerun::Scene;
use forerun::dynamics::{Body, BodyDef, BodyState, Environment, StepSettings, Unobserved, World};
use forerun::geometry::{Pose, Quat, Shape, Vec3};
use forerun::timeline::check::Random;

/// Standard gravity of the older papers. m/s²
pub(crate) const GRAVITY_98: Vec3 = Vec3::new(0.0, -9.8, 0.0);

/// The default step at `rate` frames a second.
pub(crate) fn environment(gravity: Vec3, rate: u32) -> Environment {
    let settings = StepSettings { frame_seconds: 1.0 / rate as f32, ..StepSettings::default() };
    Environment { gravity, settings }
}

/// Bodies and environment of a built-in scene, without its commands.
///
/// # Panics
/// When there is no such scene: the cases are fixed, so that this is a mistake in a case.
pub(crate) fn built_in(name: &str) -> (Vec<BodyDef>, Environment) {
    let scene = Scene::open(name).expect("a built-in scene");
    let bodies = scene.bodies().expect("the bodies of a built-in scene are possible");
    (bodies, scene.environment())
}

/// A world with these bodies, in this order.
///
/// # Panics
/// When a definition is refused: the cases are fixed, so that this is a mistake in a case.
pub(crate) fn world(environment: Environment, defs: &[BodyDef]) -> World {
    let mut world = World::new(environment);
    for def in defs {
        let added = world.add(def);
        assert!(added.is_ok(), "a case defines an impossible body: {added:?}");
    }
    world
}

/// Steps the world for some seconds; after each frame the visitor sees the time since the start of the call (s) and the states.
pub(crate) fn watch(world: &mut World, seconds: f64, mut visit: impl FnMut(f64, &[BodyState])) {
    let dt = f64::from(world.environment.settings.frame_seconds);
    let frames = (seconds / dt).round() as u32;
    for frame in 1..=frames {
        world.step(&mut Unobserved);
        visit(f64::from(frame) * dt, world.states());
    }
}

/// Some rotation; not all are equally likely.
pub(crate) fn any_rotation(random: &mut Random) -> Quat {
    let rotation = Quat::from_xyzw(random.signed(), random.signed(), random.signed(), random.signed());
    // Close to nothing there is none.
    if rotation.length() > 0.1 { rotation.normalize() } else { Quat::IDENTITY }
}

/// A plane through the origin that falls towards +x.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slope {
    /// Radians.
    angle: f64,
}

impl Slope {
    pub(crate) fn degrees(degrees: f64) -> Slope {
        Slope { angle: degrees.to_radians() }
    }

    /// From the frame of the plane (x downhill, y out of it) to the world.
    pub(crate) fn rotation(self) -> Quat {
        let (sin, cos) = (-0.5 * self.angle).sin_cos();
        Quat::from_xyzw(0.0, 0.0, sin as f32, cos as f32)
    }

    pub(crate) fn sin(self) -> f64 {
        self.angle.sin()
    }

    pub(crate) fn cos(self) -> f64 {
        self.angle.cos()
    }

    /// A point or vector of the world in the frame of the plane, in double precision.
    pub(crate) fn local(self, v: Vec3) -> [f64; 3] {
        let (x, y) = (f64::from(v.x), f64::from(v.y));
        [x * self.cos() - y * self.sin(), x * self.sin() + y * self.cos(), f64::from(v.z)]
    }

    /// A pose given in the frame of the plane.
    pub(crate) fn pose(self, position: Vec3, rotation: Quat) -> Pose {
        Pose::new(Vec3::ZERO, self.rotation()) * Pose::new(position, rotation)
    }

    /// The plane as ground.
    pub(crate) fn ground(self) -> BodyDef {
        let mut def = BodyDef::fixed(Shape::half_space());
        def.pose.rotation = self.rotation();
        def
    }
}

/// Kinetic energy. J
pub(crate) fn kinetic_energy(body: &Body, state: &BodyState) -> f64 {
    let v = doubled(state.velocity);
    let w = doubled(state.rotation.conjugate() * state.angular_velocity);
    let mut energy = 0.5 * dot(v, v) / f64::from(body.inverse_mass);
    for (w, inverse) in w.iter().zip(body.inverse_inertia.to_array()) {
        energy += 0.5 * w * w / f64::from(inverse);
    }
    energy
}

/// Momentum. kg m/s
pub(crate) fn momentum(body: &Body, state: &BodyState) -> [f64; 3] {
    doubled(state.velocity).map(|v| v / f64::from(body.inverse_mass))
}

/// Angular momentum about the centre of mass, along the axes of the world. kg m²/s
pub(crate) fn spin_momentum(body: &Body, state: &BodyState) -> [f64; 3] {
    let q = state.rotation;
    let q = [q.x, q.y, q.z, q.w].map(f64::from);
    let conjugate = [-q[0], -q[1], -q[2], q[3]];
    let mut l = rotated(conjugate, doubled(state.angular_velocity));
    for (l, inverse) in l.iter_mut().zip(body.inverse_inertia.to_array()) {
        *l /= f64::from(inverse);
    }
    rotated(q, l)
}

/// Angular momentum about the origin. kg m²/s
pub(crate) fn angular_momentum(body: &Body, state: &BodyState) -> [f64; 3] {
    let orbit = cross(doubled(state.position), momentum(body, state));
    let spin = spin_momentum(body, state);
    [0, 1, 2].map(|k| orbit[k] + spin[k])
}

pub(crate) fn doubled(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// Angle between two vectors. Degrees.
pub(crate) fn angle_between(a: [f64; 3], b: [f64; 3]) -> f64 {
    length(cross(a, b)).atan2(dot(a, b)).to_degrees()
}

/// A vector turned by a unit quaternion (x, y, z, w).
pub(crate) fn rotated(q: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    let axis = [q[0], q[1], q[2]];
    let t = cross(axis, v).map(|x| 2.0 * x);
    let u = cross(axis, t);
    [0, 1, 2].map(|k| v[k] + q[3] * t[k] + u[k])
}

/// Kinetic and potential energy of the dynamic bodies, heights from y = 0 against a gravity (m/s²) along -y. J
pub(crate) fn mechanical_energy(bodies: &[Body], states: &[BodyState], gravity: f64) -> f64 {
    let pairs = bodies.iter().zip(states).filter(|(body, _)| body.is_dynamic());
    pairs
        .map(|(body, state)| {
            let weight = gravity / f64::from(body.inverse_mass);
            kinetic_energy(body, state) + weight * f64::from(state.position.y)
        })
        .sum()
}

/// Distance between two places of a body. Metres
pub(crate) fn moved(first: &BodyState, now: &BodyState) -> f64 {
    let (a, b) = (doubled(first.position), doubled(now.position));
    length([0, 1, 2].map(|k| b[k] - a[k]))
}

/// Angle between two rotations of a body. Degrees, 0 to 180
pub(crate) fn turned(first: &BodyState, now: &BodyState) -> f64 {
    let relative = (first.rotation.conjugate() * now.rotation).to_array().map(f64::from);
    let sine = length([relative[0], relative[1], relative[2]]);
    2.0 * sine.atan2(relative[3].abs()).to_degrees()
}

/// The speed of the fastest centre of mass. m/s
pub(crate) fn fastest(states: &[BodyState]) -> f64 {
    states.iter().map(|state| length(doubled(state.velocity))).fold(0.0, f64::max)
}

/// The largest of a number over all bodies, each at first and now.
pub(crate) fn worst(
    first: &[BodyState],
    now: &[BodyState],
    of: impl Fn(&BodyState, &BodyState) -> f64,
) -> f64 {
    first.iter().zip(now).map(|(first, now)| of(first, now)).fold(0.0, f64::max)
}
