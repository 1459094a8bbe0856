//! Jolt, through its C interface: 10 velocity and 2 position iterations, friction by the geometric mean, restitution by the larger.
//!
//! What differs from the C interface's own defaults: damping is 0 (it would brake everything by 5 % a second) and sleep is off; convex
//! shapes are rounded as in Jolt itself (0.05 m, at most half the smallest half extent), without which every contact takes its slow path.
//! The interface cannot set gravity, so bodies scale it; it knows no half-space (the ground is a wide box), no mesh, and takes mass from density.
#![allow(unsafe_code, reason = "joltc-sys is a bare C interface")]

use std::ffi::{CStr, c_uint, c_void};
use std::ptr;

use forerun::{BodyKind, Mass, Pose, Quat, Shape, Vec3};
use joltc_sys::*;

use crate::engine::{Engine, GROUND_DEPTH_M, Motion};
use crate::stage::{Actor, Stage, is_shared};

// Jolt is C++, and joltc-sys does not say so to the linker.
#[cfg_attr(target_os = "linux", link(name = "stdc++"))]
#[cfg_attr(target_vendor = "apple", link(name = "c++"))]
unsafe extern "C" {}

/// Jolt's `cDefaultConvexRadius`. Metres.
const CONVEX_RADIUS: f32 = 0.05;
/// Gravity of a new Jolt system. m/s².
const OWN_GRAVITY: f32 = 9.81;
/// Room for what one step stores; pages that are not used are never resident. Bytes.
const SCRATCH_BYTES: c_uint = 1 << 30;

const STILL: JPC_ObjectLayer = 0;
const MOVING: JPC_ObjectLayer = 1;

pub(crate) struct Jolt {
    system: *mut JPC_PhysicsSystem,
    interface: *mut JPC_BodyInterface,
    scratch: *mut JPC_TempAllocatorImpl,
    jobs: *mut JPC_JobSystemThreadPool,
    layers: Layers,
    bodies: Vec<Placed>,
    frame_seconds: f32,
}

/// A body, and where our frame of it is in Jolt's.
struct Placed {
    id: JPC_BodyID,
    own: Pose,
}

/// The three tables of who meets whom, which the system points to.
struct Layers {
    broad: *mut JPC_BroadPhaseLayerInterface,
    object_and_broad: *mut JPC_ObjectVsBroadPhaseLayerFilter,
    pairs: *mut JPC_ObjectLayerPairFilter,
}

impl Jolt {
    pub(crate) fn new(stage: &Stage, threads: u16) -> Result<Self, String> {
        let gravity = stage.environment.gravity;
        if gravity.x.abs() + gravity.z.abs() > 0.0 {
            return Err("its C interface has gravity along y only".to_owned());
        }
        let mut jolt = Jolt::empty(stage, threads);
        let ground_reach_m = stage.ground_reach_m();
        let mut last = None;
        for actor in &stage.actors {
            let maker = Maker { density: density(actor)?, ground_reach_m };
            let shape = match last.take() {
                Some((before, made)) if maker.makes_the_same(&before, actor)? => made,
                _ => Owned(maker.make(&actor.def.shape)?),
            };
            jolt.add(actor, gravity.y / -OWN_GRAVITY, &shape);
            last = Some((actor, shape));
        }
        // SAFETY: `system` is live until `drop`; no update runs.
        unsafe { JPC_PhysicsSystem_OptimizeBroadPhase(jolt.system) };
        Ok(jolt)
    }

    fn empty(stage: &Stage, threads: u16) -> Self {
        let count = stage.actors.len() as c_uint;
        // SAFETY: the three registrations come before anything else and once in this process, which builds one engine. All pointers are
        // kept in `Jolt`, and freed in `drop` only; the callbacks read nothing but their arguments.
        unsafe {
            JPC_RegisterDefaultAllocator();
            JPC_FactoryInit();
            JPC_RegisterTypes();
            let layers = Layers {
                broad: JPC_BroadPhaseLayerInterface_new(ptr::null(), BROAD_LAYERS),
                object_and_broad: JPC_ObjectVsBroadPhaseLayerFilter_new(ptr::null(), OBJECT_AND_BROAD),
                pairs: JPC_ObjectLayerPairFilter_new(ptr::null(), OBJECT_PAIRS),
            };
            let system = JPC_PhysicsSystem_new();
            // 0: as many locks as it sees fit. 16 pairs and 8 contacts a body are more than a pile of boxes has.
            let (bodies, pairs, contacts) = (count + 1, 16 * count + 1024, 8 * count + 1024);
            let Layers { broad, object_and_broad, pairs: layer_pairs } = layers;
            JPC_PhysicsSystem_Init(system, bodies, 0, pairs, contacts, broad, object_and_broad, layer_pairs);
            let (jobs, barriers) = (JPC_MAX_PHYSICS_JOBS as c_uint, JPC_MAX_PHYSICS_BARRIERS as c_uint);
            Jolt {
                system,
                interface: JPC_PhysicsSystem_GetBodyInterface(system),
                scratch: JPC_TempAllocatorImpl_new(SCRATCH_BYTES),
                // The thread that steps works too.
                jobs: JPC_JobSystemThreadPool_new3(jobs, barriers, i32::from(threads) - 1),
                layers,
                bodies: Vec::with_capacity(stage.actors.len()),
                frame_seconds: stage.environment.settings.frame_seconds,
            }
        }
    }

    fn add(&mut self, actor: &Actor, gravity_part: f32, shape: &Owned) {
        let (def, fixed) = (&actor.def, actor.is_fixed());
        // The box that stands for a half-space has its middle below.
        let is_ground = matches!(def.shape, Shape::HalfSpace);
        let own = Pose::from_position(Vec3::Y * if is_ground { 0.5 * GROUND_DEPTH_M } else { 0.0 });
        let pose = def.pose * own.inverse();
        let settings = JPC_BodyCreationSettings {
            Position: vector(pose.position),
            Rotation: rotation(pose.rotation),
            LinearVelocity: vector(def.velocity),
            AngularVelocity: vector(def.angular_velocity),
            ObjectLayer: if fixed { STILL } else { MOVING },
            MotionType: match def.kind {
                BodyKind::Dynamic => JPC_MOTION_TYPE_DYNAMIC,
                BodyKind::Fixed => JPC_MOTION_TYPE_STATIC,
                BodyKind::Kinematic => JPC_MOTION_TYPE_KINEMATIC,
            },
            AllowSleeping: false,
            Friction: def.material.friction,
            Restitution: def.material.restitution,
            LinearDamping: 0.0,
            AngularDamping: 0.0,
            GravityFactor: def.gravity_scale * gravity_part,
            Shape: shape.0,
            ..JPC_BodyCreationSettings::default()
        };
        let activation = if fixed { JPC_ACTIVATION_DONT_ACTIVATE } else { JPC_ACTIVATION_ACTIVATE };
        // SAFETY: `interface` belongs to the live `system`; `settings` is complete, its shape is live, and the body takes a share in it.
        let id = unsafe { JPC_BodyInterface_CreateAndAddBody(self.interface, &settings, activation) };
        self.bodies.push(Placed { id, own });
    }
}

/// Density that gives the body the mass of ours. kg/m³.
fn density(actor: &Actor) -> Result<f32, String> {
    if !actor.body.is_dynamic() {
        return Ok(1000.0);
    }
    if matches!(actor.def.mass, Mass::Given { .. }) {
        return Err("its C interface takes no mass but that of a density".to_owned());
    }
    Ok(1.0 / (actor.body.inverse_mass * actor.def.shape.mass_properties(1.0).mass))
}

/// A share in a shape.
struct Owned(*mut JPC_Shape);

impl Drop for Owned {
    fn drop(&mut self) {
        // SAFETY: the share was ours since the shape was made, and is given up once.
        unsafe { JPC_Shape_Release(self.0) };
    }
}

impl Drop for Jolt {
    fn drop(&mut self) {
        // SAFETY: each was made in `empty`, is freed once, and the system goes before what it points to.
        unsafe {
            JPC_PhysicsSystem_delete(self.system);
            JPC_BroadPhaseLayerInterface_delete(self.layers.broad);
            JPC_ObjectVsBroadPhaseLayerFilter_delete(self.layers.object_and_broad);
            JPC_ObjectLayerPairFilter_delete(self.layers.pairs);
            JPC_JobSystemThreadPool_delete(self.jobs);
            JPC_TempAllocatorImpl_delete(self.scratch);
        }
    }
}

impl Engine for Jolt {
    fn step(&mut self) -> Result<(), String> {
        // SAFETY: all three are live, and nobody else uses them: `self` is borrowed exclusively.
        let error =
            unsafe { JPC_PhysicsSystem_Update(self.system, self.frame_seconds, 1, self.scratch, self.jobs) };
        if error == 0 { Ok(()) } else { Err(format!("its tables are full (error {error})")) }
    }

    fn motions(&self) -> Vec<Motion> {
        let vec3 = |v: JPC_Vec3| Vec3::new(v.x, v.y, v.z);
        let motion = |Placed { id, own }: &Placed| {
            // SAFETY: the body was added and is never removed; no update runs while `self` is borrowed.
            let (at, q, velocity, angular_velocity) = unsafe {
                (
                    JPC_BodyInterface_GetPosition(self.interface, *id),
                    JPC_BodyInterface_GetRotation(self.interface, *id),
                    JPC_BodyInterface_GetLinearVelocity(self.interface, *id),
                    JPC_BodyInterface_GetAngularVelocity(self.interface, *id),
                )
            };
            Motion {
                pose: Pose::new(vec3(at), Quat::from_xyzw(q.x, q.y, q.z, q.w)) * *own,
                velocity: vec3(velocity),
                angular_velocity: vec3(angular_velocity),
            }
        };
        self.bodies.iter().map(motion).collect()
    }
}

/// Makes shapes of one density.
#[derive(Clone, Copy)]
struct Maker {
    /// kg/m³.
    density: f32,
    /// Half the width of the box that stands for a half-space. Metres.
    ground_reach_m: f32,
}

impl Maker {
    /// Whether a body's shape is the one that it made for the body before.
    fn makes_the_same(self, before: &&Actor, actor: &Actor) -> Result<bool, String> {
        let shared = is_shared(&before.def.shape, &actor.def.shape);
        Ok(shared && density(before)?.to_bits() == self.density.to_bits())
    }

    /// A shape with one share in it.
    fn make(self, shape: &Shape) -> Result<*mut JPC_Shape, String> {
        // SAFETY (of all calls below): the settings are complete and live; what they point to is read before the call returns; on success
        // the first pointer, and else the second, is set (see `created`).
        match shape {
            Shape::Sphere(s) => {
                let settings =
                    JPC_SphereShapeSettings { Radius: s.radius, Density: self.density, ..Default::default() };
                created(|shape, error| unsafe { JPC_SphereShapeSettings_Create(&settings, shape, error) })
            }
            Shape::Cuboid(s) => self.cuboid(s.half_extents),
            Shape::Capsule(s) => {
                let settings = JPC_CapsuleShapeSettings {
                    Radius: s.radius,
                    HalfHeightOfCylinder: s.half_height,
                    Density: self.density,
                    ..Default::default()
                };
                created(|shape, error| unsafe { JPC_CapsuleShapeSettings_Create(&settings, shape, error) })
            }
            Shape::Cylinder(s) => {
                let settings = JPC_CylinderShapeSettings {
                    Radius: s.radius,
                    HalfHeight: s.half_height,
                    ConvexRadius: CONVEX_RADIUS.min(0.5 * s.radius.min(s.half_height)),
                    Density: self.density,
                    ..Default::default()
                };
                created(|shape, error| unsafe { JPC_CylinderShapeSettings_Create(&settings, shape, error) })
            }
            Shape::Hull(hull) => {
                let points: Vec<JPC_Vec3> = hull.vertices.iter().map(|v| vector(*v)).collect();
                let settings = JPC_ConvexHullShapeSettings {
                    Points: points.as_ptr(),
                    PointsLen: points.len(),
                    MaxConvexRadius: CONVEX_RADIUS,
                    Density: self.density,
                    ..Default::default()
                };
                created(|shape, error| unsafe { JPC_ConvexHullShapeSettings_Create(&settings, shape, error) })
            }
            Shape::HalfSpace => {
                self.cuboid(Vec3::new(self.ground_reach_m, 0.5 * GROUND_DEPTH_M, self.ground_reach_m))
            }
            Shape::Compound(parts) => {
                let part = |(at, part): &(Pose, Shape)| Ok((*at, self.make(part)?));
                compound(&parts.parts.iter().map(part).collect::<Result<Vec<_>, String>>()?)
            }
            Shape::Mesh(_) => Err("its C interface has no triangle meshes".to_owned()),
        }
    }

    fn cuboid(self, half_extents: Vec3) -> Result<*mut JPC_Shape, String> {
        let settings = JPC_BoxShapeSettings {
            HalfExtent: vector(half_extents),
            ConvexRadius: CONVEX_RADIUS.min(0.5 * half_extents.min_element()),
            Density: self.density,
            ..Default::default()
        };
        // SAFETY: as in `make`.
        created(|shape, error| unsafe { JPC_BoxShapeSettings_Create(&settings, shape, error) })
    }
}

/// Shapes held together; each gives up its share to the whole.
fn compound(parts: &[(Pose, *mut JPC_Shape)]) -> Result<*mut JPC_Shape, String> {
    let sub_shapes: Vec<JPC_SubShapeSettings> = parts
        .iter()
        .map(|(at, shape)| JPC_SubShapeSettings {
            Shape: *shape,
            Position: vector(at.position),
            Rotation: rotation(at.rotation),
            ..Default::default()
        })
        .collect();
    let settings = JPC_StaticCompoundShapeSettings {
        SubShapes: sub_shapes.as_ptr(),
        SubShapesLen: sub_shapes.len(),
        ..Default::default()
    };
    // SAFETY: as in `make`; the parts are live, and the compound takes a share in each before ours is given up.
    unsafe {
        let whole = created(|shape, error| JPC_StaticCompoundShapeSettings_Create(&settings, shape, error));
        parts.iter().for_each(|(_, shape)| JPC_Shape_Release(*shape));
        whole
    }
}

/// The shape that a `..._Create` function makes, or its message.
fn created(
    create: impl FnOnce(*mut *mut JPC_Shape, *mut *mut JPC_String) -> bool,
) -> Result<*mut JPC_Shape, String> {
    let (mut shape, mut error) = (ptr::null_mut(), ptr::null_mut());
    if create(&raw mut shape, &raw mut error) {
        return Ok(shape);
    }
    if error.is_null() {
        return Err("a shape that it cannot make".to_owned());
    }
    // SAFETY: on failure the message is a live string of its own, copied and then freed here.
    unsafe {
        let message = CStr::from_ptr(JPC_String_c_str(error)).to_string_lossy().into_owned();
        JPC_String_delete(error);
        Err(message)
    }
}

fn vector(v: Vec3) -> JPC_Vec3 {
    // The fourth number has to repeat the third.
    JPC_Vec3 { x: v.x, y: v.y, z: v.z, _w: v.z }
}

fn rotation(q: Quat) -> JPC_Quat {
    JPC_Quat { x: q.x, y: q.y, z: q.z, w: q.w }
}

const BROAD_LAYERS: JPC_BroadPhaseLayerInterfaceFns = JPC_BroadPhaseLayerInterfaceFns {
    GetNumBroadPhaseLayers: Some(broad_layer_count),
    GetBroadPhaseLayer: Some(broad_layer),
};

const OBJECT_AND_BROAD: JPC_ObjectVsBroadPhaseLayerFilterFns =
    JPC_ObjectVsBroadPhaseLayerFilterFns { ShouldCollide: Some(meets_broad_layer) };

const OBJECT_PAIRS: JPC_ObjectLayerPairFilterFns = JPC_ObjectLayerPairFilterFns { ShouldCollide: Some(meet) };

unsafe extern "C" fn broad_layer_count(_: *const c_void) -> c_uint {
    2
}

/// Layers of the broad phase are those of the objects.
unsafe extern "C" fn broad_layer(_: *const c_void, layer: JPC_ObjectLayer) -> JPC_BroadPhaseLayer {
    layer as JPC_BroadPhaseLayer
}

unsafe extern "C" fn meets_broad_layer(
    _: *const c_void,
    layer: JPC_ObjectLayer,
    other: JPC_BroadPhaseLayer,
) -> bool {
    layer == MOVING || JPC_ObjectLayer::from(other) == MOVING
}

unsafe extern "C" fn meet(_: *const c_void, layer: JPC_ObjectLayer, other: JPC_ObjectLayer) -> bool {
    layer == MOVING || other == MOVING
}
