//! Rapier: friction by the geometric mean and restitution by the larger, as ours; all else at its defaults.

use forerun::geometry::shape::Hull;
use forerun::{BodyKind, Pose, Quat, Shape, Vec3};
use rapier3d::parry::mass_properties::MassProperties;
use rapier3d::prelude::{
    CoefficientCombineRule, ColliderBuilder, PhysicsWorld, RigidBody, RigidBodyBuilder, RigidBodyHandle,
    SharedShape, Vector,
};

use crate::engine::{Engine, Motion};
use crate::stage::{Actor, Stage, is_shared};

type RapierPose = rapier3d::math::Pose;
type RapierRotation = rapier3d::math::Rotation;

pub(crate) struct Rapier {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
}

impl Rapier {
    pub(crate) fn new(stage: &Stage, threads: u16) -> Result<Self, String> {
        // With its feature `parallel` it uses the threads of the pool that it is called in, and else none.
        if threads > 1 && cfg!(not(feature = "rapier-threads")) {
            return Err("built without the feature \"rapier-threads\"".to_owned());
        }
        let mut world = PhysicsWorld::new();
        world.gravity = vector(stage.environment.gravity);
        world.integration_parameters.dt = stage.environment.settings.frame_seconds;
        let mut bodies = Vec::with_capacity(stage.actors.len());
        // Of the body before: bodies of one shape share it, as ours do.
        let mut last: Option<(&Shape, SharedShape)> = None;
        for actor in &stage.actors {
            let material = actor.def.material;
            let shape = match &last {
                Some((same, made)) if is_shared(same, &actor.def.shape) => made.clone(),
                _ => shape(&actor.def.shape)?,
            };
            last = Some((&actor.def.shape, shape.clone()));
            // Its mass comes with the body.
            let collider = ColliderBuilder::new(shape)
                .density(0.0)
                .friction(material.friction)
                .friction_combine_rule(CoefficientCombineRule::GeometricMean)
                .restitution(material.restitution)
                .restitution_combine_rule(CoefficientCombineRule::Max);
            bodies.push(world.insert(body(actor), collider).0);
        }
        Ok(Rapier { world, bodies })
    }
}

fn body(actor: &Actor) -> RigidBody {
    let builder = match actor.def.kind {
        BodyKind::Dynamic => RigidBodyBuilder::dynamic(),
        BodyKind::Fixed => RigidBodyBuilder::fixed(),
        BodyKind::Kinematic => RigidBodyBuilder::kinematic_velocity_based(),
    };
    let mut builder = builder
        .pose(pose(&actor.def.pose))
        .linvel(vector(actor.def.velocity))
        .angvel(vector(actor.def.angular_velocity))
        .gravity_scale(actor.def.gravity_scale)
        .can_sleep(false);
    if actor.body.is_dynamic() {
        let principal = actor.body.frame.inverse();
        builder = builder.additional_mass_properties(MassProperties::with_principal_inertia_frame(
            vector(principal.position),
            1.0 / actor.body.inverse_mass,
            vector(actor.body.inverse_inertia.recip()),
            rotation(principal.rotation),
        ));
    }
    builder.build()
}

fn shape(shape: &Shape) -> Result<SharedShape, String> {
    Ok(match shape {
        Shape::Sphere(s) => SharedShape::ball(s.radius),
        Shape::Cuboid(s) => SharedShape::cuboid(s.half_extents.x, s.half_extents.y, s.half_extents.z),
        Shape::Capsule(s) => SharedShape::capsule_y(s.half_height, s.radius),
        Shape::Cylinder(s) => SharedShape::cylinder(s.half_height, s.radius),
        Shape::Hull(hull) => convex(hull)?,
        Shape::HalfSpace => SharedShape::halfspace(Vector::Y),
        Shape::Compound(compound) => {
            let part = |(at, part): &(Pose, Shape)| Ok((pose(at), self::shape(part)?));
            SharedShape::compound(compound.parts.iter().map(part).collect::<Result<_, String>>()?)
        }
        Shape::Mesh(mesh) => {
            let vertices = mesh.vertices.iter().map(|v| vector(*v)).collect();
            SharedShape::trimesh(vertices, mesh.triangles.clone()).map_err(|error| error.to_string())?
        }
    })
}

fn convex(hull: &Hull) -> Result<SharedShape, String> {
    let points: Vec<Vector> = hull.vertices.iter().map(|v| vector(*v)).collect();
    SharedShape::convex_hull(&points).ok_or_else(|| "a hull that it cannot make".to_owned())
}

fn vector(v: Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn rotation(q: Quat) -> RapierRotation {
    RapierRotation::from_xyzw(q.x, q.y, q.z, q.w)
}

fn pose(pose: &Pose) -> RapierPose {
    RapierPose::from_parts(vector(pose.position), rotation(pose.rotation))
}

impl Engine for Rapier {
    fn step(&mut self) -> Result<(), String> {
        self.world.step();
        Ok(())
    }

    fn motions(&self) -> Vec<Motion> {
        let vec3 = |v: Vector| Vec3::new(v.x, v.y, v.z);
        let motion = |handle: &RigidBodyHandle| {
            let body = &self.world.bodies[*handle];
            let (at, q) = (body.position().translation, body.position().rotation);
            Motion {
                pose: Pose::new(vec3(at), Quat::from_xyzw(q.x, q.y, q.z, q.w)),
                velocity: vec3(body.linvel()),
                angular_velocity: vec3(body.angvel()),
            }
        };
        self.bodies.iter().map(motion).collect()
    }
}
