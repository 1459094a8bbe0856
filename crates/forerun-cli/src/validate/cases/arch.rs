//! Arch: seventeen voussoirs hold each other and carry four boxes.
//!
//! Box3D's sample *Arch* (and Box2D's), a quarter of its size: gravity 10 m/s², friction 0.6. The voussoirs as hulls, and again as meshes.

use forerun::dynamics::{BodyDef, BodyState, World};
use forerun::geometry::Shape;

use crate::validate::Figure;
use crate::validate::gauge::Gauge;
use crate::validate::lab::{built_in, doubled, length, rotated, watch, world};

/// Bodies: the ground, eight voussoirs on each side from the ground up, the keystone, four boxes.
const VOUSSOIRS: std::ops::Range<usize> = 1..18;
const KEYSTONE: usize = 17;
const TOP_BOX: usize = 21;
const HEIGHT: f64 = 11.1;
const SAG_PART_MAX: f64 = 0.02;
const SLIP_MAX: f64 = 0.05;
const SECONDS: f64 = 30.0;
/// Corners that are nearer than this at first are one.
const SAME: f64 = 1e-4;

pub(crate) fn run() -> Vec<Figure> {
    let mut figures = Vec::new();
    let (hulls, environment) = built_in("arch");
    let meshes = hulls.iter().map(as_mesh).collect::<Vec<_>>();
    stand("hulls", &hulls, world(environment, &hulls), &mut figures);
    stand("meshes", &hulls, world(environment, &meshes), &mut figures);
    figures
}

/// The body with its hull as a mesh of the same triangles.
fn as_mesh(def: &BodyDef) -> BodyDef {
    let Shape::Hull(hull) = &def.shape else { return def.clone() };
    let corners: Vec<_> = hull.triangles().flatten().collect();
    let triangles = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = Shape::mesh(corners, triangles).expect("the faces of a hull close a mesh");
    BodyDef { shape: mesh, ..def.clone() }
}

/// Two voussoirs, and a corner of each that is at the same place at first.
struct Joint {
    bodies: [usize; 2],
    /// Each in the own frame of its body.
    corners: [[f64; 3]; 2],
}

/// A point of a body, now.
fn at(world: &World, states: &[BodyState], body: usize, point: [f64; 3]) -> [f64; 3] {
    let pose = world.bodies()[body].own_pose(&states[body]);
    let turned = rotated(pose.rotation.to_array().map(f64::from), point);
    let position = doubled(pose.position);
    [0, 1, 2].map(|k| position[k] + turned[k])
}

fn joints(defs: &[BodyDef]) -> Vec<Joint> {
    let corners: Vec<(usize, [f64; 3], [f64; 3])> = VOUSSOIRS
        .flat_map(|body| {
            let def = &defs[body];
            let Shape::Hull(hull) = &def.shape else { return Vec::new() };
            let own =
                |v: &forerun::geometry::Vec3| (body, doubled(*v), doubled(def.pose.transform_point(*v)));
            hull.vertices.iter().map(own).collect()
        })
        .collect();
    let mut joints = Vec::new();
    for (i, (a, own_a, in_world_a)) in corners.iter().enumerate() {
        for (b, own_b, in_world_b) in &corners[..i] {
            let apart = length([0, 1, 2].map(|k| in_world_a[k] - in_world_b[k]));
            if a != b && apart < SAME {
                joints.push(Joint { bodies: [*a, *b], corners: [*own_a, *own_b] });
            }
        }
    }
    joints
}

fn stand(kind: &str, hulls: &[BodyDef], mut world: World, figures: &mut Vec<Figure>) {
    let (joints, first) = (joints(hulls), world.states().to_vec());
    let height = |states: &[BodyState], body: usize| f64::from(states[body].position.y);
    let mut stands_until = 0.0;
    watch(&mut world, SECONDS, |time, states| {
        if height(&first, KEYSTONE) - height(states, KEYSTONE) <= SAG_PART_MAX * HEIGHT {
            stands_until = time;
        }
    });
    let last = world.states();
    let parted = |joint: &Joint| {
        let [a, b] = [0, 1].map(|i| at(&world, last, joint.bodies[i], joint.corners[i]));
        length([0, 1, 2].map(|k| a[k] - b[k]))
    };
    let slip = joints.iter().map(parted).fold(0.0, f64::max);
    let sag = height(&first, KEYSTONE) - height(last, KEYSTONE);
    let load = height(&first, TOP_BOX) - height(last, TOP_BOX);
    let name = |what: &str| format!("{kind}: {what}");
    figures.extend([
        Figure::at_most(name("sag of the keystone, part of the height"), sag / HEIGHT, SAG_PART_MAX),
        Figure::at_most(name("most slip between two neighbours, m"), slip, SLIP_MAX),
        Figure::at_most(name("sag of the topmost box, m"), load, 0.5),
        Figure::reported(name("keystone in its place until, s"), stands_until),
    ]);
    // Meshes are not gauged: their hulls are, at the same poses.
    if kind == "hulls" {
        figures
            .push(Figure::reported(name("deepest overlap at the end, m"), Gauge::new(&world).deepest(last)));
    }
}
