//! Worlds to test with.
#![allow(dead_code, reason = "each test file uses its own part")]

use forerun_dynamics::{BodyDef, BodyKind, Environment, Mass, Material, Unobserved, World};
use forerun_geometry::{Pose, Quat, Shape, Vec3};

pub(crate) const UNIT: Vec3 = Vec3::splat(0.5);

/// A small generator with a fixed seed (Knuth's MMIX constants).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 40) as f32 / (1u64 << 24) as f32)
    }

    pub(crate) fn rotation(&mut self) -> Quat {
        let mut part = || self.between(-1.0, 1.0);
        Quat::from_xyzw(part(), part(), part(), part() + 1.5).normalize()
    }
}

pub(crate) fn cuboid(half_extents: Vec3, position: Vec3) -> BodyDef {
    BodyDef::new(Shape::cuboid(half_extents).expect("sizes are above 0")).at(position)
}

pub(crate) fn turned(mut def: BodyDef, yaw: f32) -> BodyDef {
    def.pose.rotation = Quat::from_xyzw(0.0, libm::sinf(0.5 * yaw), 0.0, libm::cosf(0.5 * yaw));
    def
}

pub(crate) fn ground() -> BodyDef {
    BodyDef { kind: BodyKind::Fixed, ..BodyDef::new(Shape::HalfSpace) }
}

pub(crate) fn world_of(defs: &[BodyDef]) -> World {
    let mut world = World::new(Environment::default());
    for def in defs {
        world.add(def).expect("the definition is possible");
    }
    world
}

pub(crate) fn run(world: &mut World, frames: usize) {
    for _ in 0..frames {
        world.step(&mut Unobserved);
    }
}

/// A wall of unit boxes, exactly touching, on the ground.
pub(crate) fn pyramid(base: usize) -> Vec<BodyDef> {
    let mut defs = vec![ground()];
    for row in 0..base {
        for i in 0..base - row {
            defs.push(cuboid(UNIT, Vec3::new(i as f32 + 0.5 * row as f32, 0.5 + row as f32, 0.0)));
        }
    }
    defs
}

/// Boxes, spheres and capsules at random over a walled pit.
pub(crate) fn rain(count: usize, seed: u64) -> Vec<BodyDef> {
    let mut r = Random(seed);
    let mut defs = vec![ground()];
    for (x, z) in [(3.0, 0.0), (-3.0, 0.0), (0.0, 3.0), (0.0, -3.0)] {
        let half = if z == 0.0 { Vec3::new(0.5, 4.0, 3.0) } else { Vec3::new(3.0, 4.0, 0.5) };
        defs.push(BodyDef { kind: BodyKind::Fixed, ..cuboid(half, Vec3::new(x, 4.0, z)) });
    }
    for i in 0..count {
        let at = Vec3::new((i % 4) as f32 - 1.5, 1.0 + (i / 16) as f32, (i / 4 % 4) as f32 - 1.5);
        let shape = match i % 3 {
            0 => Shape::sphere(r.between(0.2, 0.4)),
            1 => Shape::cuboid(Vec3::new(r.between(0.2, 0.4), r.between(0.2, 0.3), r.between(0.2, 0.4))),
            _ => Shape::capsule(r.between(0.1, 0.3), r.between(0.15, 0.25)),
        };
        let mut def = BodyDef::new(shape.expect("sizes are above 0")).at(at);
        def.pose.rotation = r.rotation();
        defs.push(def);
    }
    defs
}

/// Rings in a heap, as meshes of 384 triangles, with a ball, a capsule, a cylinder and a box of other shapes of primitives among them.
pub(crate) fn heap_of_rings(count: usize) -> Vec<BodyDef> {
    let mesh = forerun_geometry::shape::mesh_make::torus(0.5, 0.2, 24, 8).expect("sizes are above 0");
    let ring = Shape::from(mesh);
    let mut r = Random(7);
    let mut defs = vec![ground()];
    for i in 0..count {
        let at = Vec3::new(0.9 * (i % 2) as f32, 0.6 + 0.7 * (i / 2) as f32, r.between(-0.2, 0.2));
        let shape = match i % 8 {
            3 => Shape::sphere(0.3),
            5 => Shape::capsule(0.3, 0.2),
            6 => Shape::cylinder(0.3, 0.3),
            7 => Shape::cuboid(Vec3::new(0.4, 0.1, 0.3)),
            _ => Ok(ring.clone()),
        };
        let mut def = BodyDef::new(shape.expect("sizes are above 0")).at(at);
        def.pose.rotation = r.rotation();
        defs.push(def);
    }
    defs
}

pub(crate) fn tilted_gravity(degrees: f32) -> Vec3 {
    let a = degrees.to_radians();
    Vec3::new(libm::sinf(a), -libm::cosf(a), 0.0) * 9.81
}

pub(crate) fn with_material(mut def: BodyDef, friction: f32, restitution: f32) -> BodyDef {
    def.material = Material::new(friction, restitution);
    def
}

pub(crate) fn with_density(mut def: BodyDef, density: f32) -> BodyDef {
    def.mass = Mass::Density(density);
    def
}

pub(crate) fn pose_of(world: &World, body: usize) -> Pose {
    world.bodies()[body].own_pose(&world.states()[body])
}
