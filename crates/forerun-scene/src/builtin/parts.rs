//! What the built-in scenes are put together from.

use std::f32::consts::PI;

use forerun_geometry::{Quat, Vec3};

use crate::shape::{BoxEntry, CylinderEntry, SphereEntry};
use crate::{BodyEntry, KindEntry, PartEntry, RotationEntry, Scene, ShapeEntry};

impl BodyEntry {
    pub(super) fn at(mut self, position: Vec3) -> BodyEntry {
        self.position = plain(position);
        self
    }

    pub(super) fn turned(mut self, rotation: Quat) -> BodyEntry {
        self.rotation = Some(RotationEntry::Quaternion(rotation.to_array().map(|x| x + 0.0)));
        self
    }

    pub(super) fn named(mut self, name: impl Into<String>) -> BodyEntry {
        self.name = Some(name.into());
        self
    }

    pub(super) fn moving(mut self, velocity: Vec3) -> BodyEntry {
        self.velocity = plain(velocity);
        self
    }

    pub(super) fn spinning(mut self, angular_velocity: Vec3) -> BodyEntry {
        self.angular_velocity = plain(angular_velocity);
        self
    }

    pub(super) fn fixed(mut self) -> BodyEntry {
        self.kind = KindEntry::Fixed;
        self
    }

    pub(super) fn kinematic(mut self) -> BodyEntry {
        self.kind = KindEntry::Kinematic;
        self
    }

    pub(super) fn surface(mut self, friction: f32, restitution: f32) -> BodyEntry {
        self.friction = Some(friction);
        self.restitution = Some(restitution);
        self
    }

    pub(super) fn of_mass(mut self, mass: f32) -> BodyEntry {
        self.mass = Some(mass);
        self
    }

    pub(super) fn of_density(mut self, density: f32) -> BodyEntry {
        self.density = Some(density);
        self
    }
}

impl Scene {
    pub(super) fn put(&mut self, body: BodyEntry) {
        self.bodies.push(body);
    }

    /// Sets how long the scene is, its frame and its gravity (downwards, m/s²).
    pub(super) fn timed(mut self, seconds: f32, frame_seconds: f32, gravity: f32) -> Scene {
        self.seconds = seconds;
        self.frame_seconds = frame_seconds;
        // 0 - g: no gravity is +0, not -0.
        self.gravity = [0.0, 0.0 - gravity, 0.0];
        self
    }
}

/// With +0 for -0, which would only puzzle whoever reads the file.
fn plain(v: Vec3) -> [f32; 3] {
    v.to_array().map(|x| x + 0.0)
}

/// The ground: everything at or below y = 0.
pub(super) fn ground() -> BodyEntry {
    BodyEntry::new(ShapeEntry::HalfSpace).named("ground").fixed()
}

/// A box by half extents.
pub(super) fn cuboid(x: f32, y: f32, z: f32) -> BodyEntry {
    BodyEntry::new(ShapeEntry::Box(BoxEntry { half_extents: [x, y, z] }))
}

/// A cube by half its edge.
pub(super) fn cube(half: f32) -> BodyEntry {
    cuboid(half, half, half)
}

pub(super) fn sphere(radius: f32) -> BodyEntry {
    BodyEntry::new(ShapeEntry::Sphere(SphereEntry { radius }))
}

pub(super) fn cylinder(radius: f32, half_height: f32) -> BodyEntry {
    BodyEntry::new(ShapeEntry::Cylinder(CylinderEntry { half_height, radius }))
}

pub(super) fn mesh(name: &str) -> BodyEntry {
    BodyEntry::new(ShapeEntry::Mesh(name.to_owned()))
}

/// A box as a part of a compound, by half extents.
pub(super) fn box_part(half_extents: [f32; 3], position: [f32; 3]) -> PartEntry {
    PartEntry { shape: ShapeEntry::Box(BoxEntry { half_extents }), position, rotation: None }
}

/// Four fixed walls around a square of the ground.
pub(super) fn walls(scene: &mut Scene, half_width: f32, height: f32) {
    let (thickness, half) = (0.5, 0.5 * height);
    let middle = half_width + thickness;
    for side in [-1.0, 1.0] {
        let wall = cuboid(thickness, half, half_width + 2.0 * thickness).fixed();
        scene.put(wall.at(Vec3::new(side * middle, half, 0.0)));
        let wall = cuboid(half_width, half, thickness).fixed();
        scene.put(wall.at(Vec3::new(0.0, half, side * middle)));
    }
}

/// A turn by an angle (radians) about a unit axis.
pub(super) fn turn(axis: Vec3, angle: f32) -> Quat {
    let (sin, cos) = libm::sincosf(0.5 * angle);
    Quat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos)
}

pub(super) fn radians(degrees: f32) -> f32 {
    degrees * (PI / 180.0)
}

/// A plane through the origin that falls towards +x.
pub(super) struct Incline {
    pub(super) rotation: Quat,
    pub(super) down: Vec3,
    pub(super) normal: Vec3,
}

impl Incline {
    pub(super) fn new(angle: f32) -> Incline {
        let (sin, cos) = libm::sincosf(angle);
        Incline {
            rotation: turn(Vec3::Z, -angle),
            down: Vec3::new(cos, -sin, 0.0),
            normal: Vec3::new(sin, cos, 0.0),
        }
    }
}
