//! Box3D, through its C interface, at its defaults: 4 substeps, friction by the geometric mean, restitution by the larger.
//!
//! It has no half-space: the ground is a wide box. Cylinders are prisms of 32 sides, and hulls have at most 128 edges.
#![allow(unsafe_code, reason = "box3d-sys is a bare C interface")]

use std::ptr::{self, NonNull};

use box3d_sys::*;
use forerun::geometry::Mat3;
use forerun::geometry::shape::{Hull, Mesh};
use forerun::{BodyKind, Pose, Quat, Shape, Vec3};

use crate::engine::{Engine, GROUND_DEPTH_M, Motion};
use crate::stage::{Actor, Stage};

/// As in its samples.
const SUBSTEPS: i32 = 4;
/// Most sides that its cylinders can have.
const CYLINDER_SIDES: i32 = 32;
/// Most vertices, edges and faces of its hulls.
const HULL_FEATURES: usize = 128;
/// So many vertices have 126 edges when all faces are triangles.
const HULL_VERTICES: i32 = 44;

pub(crate) struct Box3d {
    world: b3WorldId,
    meshes: Vec<NonNull<b3MeshData>>,
    bodies: Vec<b3BodyId>,
    frame_seconds: f32,
}

impl Box3d {
    pub(crate) fn new(stage: &Stage, threads: u16) -> Result<Self, String> {
        // SAFETY: the definition is complete as `b3DefaultWorldDef` gives it, and copied.
        let world = unsafe {
            let mut def = b3DefaultWorldDef();
            def.gravity = vector(stage.environment.gravity);
            def.enableSleep = false;
            def.workerCount = u32::from(threads);
            b3CreateWorld(&raw const def)
        };
        let frame_seconds = stage.environment.settings.frame_seconds;
        let mut box3d = Box3d { world, meshes: Vec::new(), bodies: Vec::new(), frame_seconds };
        let ground_reach_m = stage.ground_reach_m();
        for actor in &stage.actors {
            box3d.add(actor, ground_reach_m)?;
        }
        Ok(box3d)
    }

    fn add(&mut self, actor: &Actor, ground_reach_m: f32) -> Result<(), String> {
        let def = &actor.def;
        // SAFETY: the world is live until `drop`; the definition is complete and copied.
        let body = unsafe {
            let mut body_def = b3DefaultBodyDef();
            body_def.type_ = match def.kind {
                BodyKind::Dynamic => b3BodyType_b3_dynamicBody,
                BodyKind::Fixed => b3BodyType_b3_staticBody,
                BodyKind::Kinematic => b3BodyType_b3_kinematicBody,
            };
            body_def.position = vector(def.pose.position);
            body_def.rotation = rotation(def.pose.rotation);
            body_def.gravityScale = def.gravity_scale;
            b3CreateBody(self.world, &raw const body_def)
        };
        self.bodies.push(body);
        // SAFETY: reads nothing.
        let mut shape_def = unsafe { b3DefaultShapeDef() };
        shape_def.baseMaterial.friction = def.material.friction;
        shape_def.baseMaterial.restitution = def.material.restitution;
        let builder = Builder { body, shape_def, ground_reach_m };
        builder.add(&def.shape, &Pose::IDENTITY, &mut self.meshes)?;
        // SAFETY: the body is live: bodies are never removed. Velocities come after the mass, so that it is the centre of mass that moves so.
        unsafe {
            if actor.body.is_dynamic() {
                b3Body_SetMassData(body, mass(actor));
            }
            b3Body_SetLinearVelocity(body, vector(def.velocity));
            b3Body_SetAngularVelocity(body, vector(def.angular_velocity));
        }
        Ok(())
    }
}

impl Drop for Box3d {
    fn drop(&mut self) {
        // SAFETY: the world goes before the meshes that its shapes point to; each is freed once.
        unsafe {
            b3DestroyWorld(self.world);
            for mesh in &self.meshes {
                b3DestroyMesh(mesh.as_ptr());
            }
        }
    }
}

impl Engine for Box3d {
    fn step(&mut self) -> Result<(), String> {
        // SAFETY: the world is live, and borrowed exclusively.
        unsafe { b3World_Step(self.world, self.frame_seconds, SUBSTEPS) };
        Ok(())
    }

    fn motions(&self) -> Vec<Motion> {
        let vec3 = |v: b3Vec3| Vec3::new(v.x, v.y, v.z);
        let motion = |body: &b3BodyId| {
            // SAFETY: bodies are never removed; no step runs while `self` is borrowed.
            let (at, velocity, angular_velocity) = unsafe {
                (
                    b3Body_GetTransform(*body),
                    b3Body_GetLinearVelocity(*body),
                    b3Body_GetAngularVelocity(*body),
                )
            };
            Motion {
                pose: Pose::new(vec3(at.p), Quat::from_xyzw(at.q.v.x, at.q.v.y, at.q.v.z, at.q.s)),
                velocity: vec3(velocity),
                angular_velocity: vec3(angular_velocity),
            }
        };
        self.bodies.iter().map(motion).collect()
    }
}

/// Mass, centre and inertia about it, along the axes of the body's own frame.
fn mass(actor: &Actor) -> b3MassData {
    let principal = actor.body.frame.inverse();
    let (axes, moments) = (principal.axes(), actor.body.inverse_inertia.recip());
    let scaled = Mat3::from_cols(axes.x_axis * moments.x, axes.y_axis * moments.y, axes.z_axis * moments.z);
    let inertia = scaled * axes.transpose();
    b3MassData {
        mass: 1.0 / actor.body.inverse_mass,
        center: vector(principal.position),
        inertia: b3Matrix3 {
            cx: vector(inertia.x_axis),
            cy: vector(inertia.y_axis),
            cz: vector(inertia.z_axis),
        },
    }
}

/// Adds shapes to one live body.
struct Builder {
    body: b3BodyId,
    shape_def: b3ShapeDef,
    /// Half the width of the box that stands for a half-space. Metres.
    ground_reach_m: f32,
}

impl Builder {
    /// A shape at a pose in the body's own frame.
    fn add(&self, shape: &Shape, at: &Pose, meshes: &mut Vec<NonNull<b3MeshData>>) -> Result<(), String> {
        match shape {
            Shape::Sphere(s) => {
                let sphere = b3Sphere { center: vector(at.position), radius: s.radius };
                // SAFETY: the body is live; definition and sphere are copied.
                unsafe { b3CreateSphereShape(self.body, &raw const self.shape_def, &raw const sphere) };
            }
            Shape::Cuboid(s) => self.add_box(s.half_extents, at),
            Shape::Capsule(s) => {
                let end = |y: f32| vector(at.transform_point(Vec3::Y * y));
                let capsule =
                    b3Capsule { center1: end(-s.half_height), center2: end(s.half_height), radius: s.radius };
                // SAFETY: the body is live; definition and capsule are copied.
                unsafe { b3CreateCapsuleShape(self.body, &raw const self.shape_def, &raw const capsule) };
            }
            Shape::Cylinder(s) => {
                // SAFETY: reads its arguments only.
                let hull = unsafe {
                    b3CreateCylinder(2.0 * s.half_height, s.radius, -s.half_height, CYLINDER_SIDES)
                };
                self.add_hull(hull, at)?;
            }
            Shape::Hull(hull) => self.add_hull(convex(hull), at)?,
            Shape::HalfSpace => {
                let reach = self.ground_reach_m;
                let below = Pose::from_position(Vec3::Y * (-0.5 * GROUND_DEPTH_M));
                self.add_box(Vec3::new(reach, 0.5 * GROUND_DEPTH_M, reach), &(*at * below));
            }
            Shape::Compound(compound) => {
                for (part_at, part) in &compound.parts {
                    self.add(part, &(*at * *part_at), meshes)?;
                }
            }
            Shape::Mesh(mesh) => meshes.push(self.add_mesh(mesh)?),
        }
        Ok(())
    }

    fn add_box(&self, half: Vec3, at: &Pose) {
        // SAFETY: the body is live; definition and hull are copied.
        unsafe {
            let hull = b3MakeTransformedBoxHull(half.x, half.y, half.z, transform(at));
            b3CreateHullShape(self.body, &raw const self.shape_def, &raw const hull.base);
        }
    }

    /// Takes the hull over.
    fn add_hull(&self, hull: *mut b3HullData, at: &Pose) -> Result<(), String> {
        if hull.is_null() {
            return Err("a hull that it cannot make".to_owned());
        }
        // SAFETY: the body and the hull are live; the shape has copies; the hull is freed once, here.
        unsafe {
            let whole = vector(Vec3::ONE);
            b3CreateTransformedHullShape(self.body, &raw const self.shape_def, hull, transform(at), whole);
            b3DestroyHull(hull);
        }
        Ok(())
    }

    /// The shape points to the mesh that is returned.
    fn add_mesh(&self, mesh: &Mesh) -> Result<NonNull<b3MeshData>, String> {
        let mut vertices: Vec<b3Vec3> = mesh.vertices.iter().map(|v| vector(*v)).collect();
        let mut indices: Vec<i32> = mesh.triangles.iter().flatten().map(|i| *i as i32).collect();
        let def = b3MeshDef {
            vertices: vertices.as_mut_ptr(),
            indices: indices.as_mut_ptr(),
            vertexCount: vertices.len() as i32,
            triangleCount: mesh.triangles.len() as i32,
            ..b3MeshDef::default()
        };
        // SAFETY: what the definition points to is live and read before the call returns; no list of bad triangles is asked for.
        let made = NonNull::new(unsafe { b3CreateMesh(&raw const def, ptr::null_mut(), 0) });
        let made = made.ok_or("a mesh that it cannot make")?;
        // SAFETY: the body is live; the mesh stays until `Box3d` is dropped.
        unsafe {
            b3CreateMeshShape(self.body, &raw const self.shape_def, made.as_ptr(), vector(Vec3::ONE));
        }
        Ok(made)
    }
}

/// Null when it cannot be made. A hull with too many vertices, edges or faces loses some.
fn convex(hull: &Hull) -> *mut b3HullData {
    let fits = hull.vertices.len().max(hull.edges.len()).max(hull.faces.len()) <= HULL_FEATURES;
    let points: Vec<b3Vec3> = hull.vertices.iter().map(|v| vector(*v)).collect();
    let most = if fits { HULL_FEATURES as i32 } else { HULL_VERTICES };
    // SAFETY: the points are live and read before the call returns.
    unsafe { b3CreateHull(points.as_ptr(), points.len() as i32, most) }
}

fn vector(v: Vec3) -> b3Vec3 {
    b3Vec3 { x: v.x, y: v.y, z: v.z }
}

fn rotation(q: Quat) -> b3Quat {
    b3Quat { v: b3Vec3 { x: q.x, y: q.y, z: q.z }, s: q.w }
}

fn transform(pose: &Pose) -> b3Transform {
    b3Transform { p: vector(pose.position), q: rotation(pose.rotation) }
}
