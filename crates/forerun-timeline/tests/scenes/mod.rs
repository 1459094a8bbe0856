//! Small scenes for the oracle: piles, walls, lines of dominoes, things that fall.

use std::sync::Arc;

use forerun_dynamics::{BodyDef, BodyKind};
use forerun_geometry::shape::{Capsule, Compound, Cuboid, Cylinder, Hull, Mesh, Shape, Sphere};
use forerun_geometry::{Pose, Vec3};

/// All scenes and their names.
pub(crate) fn all() -> Vec<(&'static str, Vec<BodyDef>)> {
    vec![
        ("piles", piles()),
        ("walls", walls()),
        ("dominoes", dominoes()),
        ("rain", rain()),
        ("pusher", pusher()),
        ("lumps", lumps()),
        ("field", field()),
    ]
}

fn cuboid(x: f32, y: f32, z: f32) -> Shape {
    Shape::Cuboid(Cuboid { half_extents: Vec3::new(x, y, z) })
}

fn ground() -> BodyDef {
    BodyDef::fixed(cuboid(40.0, 1.0, 40.0)).at(Vec3::new(0.0, -1.0, 0.0))
}

/// Six piles of four boxes, close but apart.
pub(crate) fn piles() -> Vec<BodyDef> {
    let mut bodies = vec![ground()];
    for pile in 0..6 {
        for level in 0..4 {
            let at = Vec3::new(1.3 * pile as f32 + 0.02 * level as f32, 0.5 + 1.0 * level as f32, 0.0);
            bodies.push(BodyDef::new(cuboid(0.5, 0.5, 0.5)).at(at));
        }
    }
    bodies
}

/// Two small walls, and a ball that flies into one of them.
pub(crate) fn walls() -> Vec<BodyDef> {
    let mut bodies = vec![ground()];
    for wall in 0..2 {
        for row in 0..3 {
            for column in 0..4 {
                let x = column as f32 + if row % 2 == 1 { 0.5 } else { 0.0 };
                let at = Vec3::new(x, 0.25 + 0.5 * row as f32, 3.0 * wall as f32);
                bodies.push(BodyDef::new(cuboid(0.48, 0.25, 0.25)).at(at));
            }
        }
    }
    let mut ball = BodyDef::new(cuboid(0.3, 0.3, 0.3)).at(Vec3::new(1.5, 1.0, -4.0));
    ball.velocity = Vec3::new(0.0, 1.0, 12.0);
    bodies.push(ball);
    bodies
}

/// A line of twelve dominoes, the first of them tipped, and a far one that nothing reaches.
pub(crate) fn dominoes() -> Vec<BodyDef> {
    let mut bodies = vec![ground()];
    for i in 0..12 {
        let mut domino = BodyDef::new(cuboid(0.1, 0.5, 0.25)).at(Vec3::new(0.5 * i as f32, 0.5, 0.0));
        if i == 0 {
            domino.angular_velocity = Vec3::new(0.0, 0.0, -3.0);
        }
        bodies.push(domino);
    }
    bodies.push(BodyDef::new(cuboid(0.1, 0.5, 0.25)).at(Vec3::new(-20.0, 0.5, 0.0)));
    bodies
}

/// Things of all simple shapes that fall in a heap on a half-space, some of them fast enough to pass through others in a frame.
pub(crate) fn rain() -> Vec<BodyDef> {
    let mut bodies = vec![BodyDef::fixed(Shape::HalfSpace)];
    for i in 0..24 {
        let (x, y, z) = ((i % 3) as f32 * 0.7, 1.0 + 0.8 * (i / 3) as f32, (i % 2) as f32 * 0.6);
        let shape = match i % 5 {
            2 => Shape::Capsule(Capsule { half_height: 0.2, radius: 0.15 }),
            3 => Shape::Cylinder(Cylinder { half_height: 0.2, radius: 0.25 }),
            4 => Shape::Sphere(Sphere { radius: 0.3 }),
            _ => cuboid(0.3, 0.2, 0.25),
        };
        let mut body = BodyDef::new(shape).at(Vec3::new(x, y, z));
        let fall = if i % 8 == 7 { -60.0 } else { -1.0 };
        body.velocity = Vec3::new(0.3 * (i % 4) as f32 - 0.4, fall, 0.2);
        body.angular_velocity = Vec3::new(0.0, 1.0, 0.5 * (i % 3) as f32);
        body.material.restitution = 0.25 * (i % 3) as f32;
        bodies.push(body);
    }
    bodies
}

/// A kinematic wall that pushes boxes in its way, and a pile beside it.
pub(crate) fn pusher() -> Vec<BodyDef> {
    let mut bodies = vec![ground()];
    let mut wall = BodyDef::new(cuboid(0.2, 0.5, 2.0)).at(Vec3::new(-2.0, 0.6, 0.0));
    wall.kind = BodyKind::Kinematic;
    wall.velocity = Vec3::new(1.5, 0.0, 0.0);
    bodies.push(wall);
    for i in 0..8 {
        let at = Vec3::new(0.8 * (i % 4) as f32, 0.3, 0.9 * (i / 4) as f32);
        bodies.push(BodyDef::new(cuboid(0.3, 0.3, 0.3)).at(at));
    }
    for level in 0..3 {
        let at = Vec3::new(0.0, 0.3 + 0.6 * level as f32, -4.0);
        bodies.push(BodyDef::new(cuboid(0.3, 0.3, 0.3)).at(at));
    }
    bodies
}

/// Triangle meshes (octahedra), hulls and compounds that fall on each other.
pub(crate) fn lumps() -> Vec<BodyDef> {
    let r = 0.45;
    let corners = [Vec3::X * r, -Vec3::X * r, Vec3::Y * r, -Vec3::Y * r, Vec3::Z * r, -Vec3::Z * r].to_vec();
    let triangles = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let mesh = Arc::new(Mesh::new(corners.clone(), triangles.to_vec()).expect("an octahedron is closed"));
    let hull = Arc::new(Hull::new(&corners).expect("an octahedron is convex"));
    let bars = vec![
        (Pose::from_position(Vec3::new(0.0, 0.3, 0.0)), cuboid(0.5, 0.1, 0.1)),
        (Pose::from_position(Vec3::new(0.0, -0.1, 0.0)), cuboid(0.1, 0.3, 0.1)),
    ];
    let compound = Arc::new(Compound::new(bars).expect("two boxes"));
    let mut bodies = vec![BodyDef::fixed(Shape::HalfSpace)];
    for i in 0..9 {
        let shape = match i % 3 {
            0 => Shape::Mesh(Arc::clone(&mesh)),
            1 => Shape::Hull(Arc::clone(&hull)),
            _ => Shape::Compound(Arc::clone(&compound)),
        };
        let at = Vec3::new(0.3 * (i % 2) as f32, 0.7 + 0.95 * i as f32 / 1.5, 0.2 * (i % 4) as f32);
        bodies.push(BodyDef::new(shape).at(at));
    }
    bodies
}

/// Sixty-four boxes spread over a field without gravity, every third of them under way through the others.
pub(crate) fn field() -> Vec<BodyDef> {
    (0..64)
        .map(|i| {
            let (column, row) = ((i % 8) as f32, (i / 8) as f32);
            let mut body = BodyDef::new(cuboid(0.4, 0.4, 0.4)).at(Vec3::new(2.0 * column, 0.0, 2.0 * row));
            body.gravity_scale = 0.0;
            if i % 3 == 0 {
                body.velocity = Vec3::new(4.0 - column, 0.0, row - 3.5);
            }
            body
        })
        .collect()
}
