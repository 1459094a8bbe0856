//! What the contact tests share: shapes made by hand, random poses, and support functions written anew.

use std::sync::Arc;

use forerun_geometry::contact::contact_manifolds;
use forerun_geometry::shape::{
    Capsule, Cuboid, Cylinder, Hull, HullEdge, HullFace, Sphere, hull_inner_radius,
};
use forerun_geometry::{Manifold, Motion, Placed, Pose, Quat, Shape, Vec3};

pub(crate) fn sphere(radius: f32) -> Shape {
    Shape::Sphere(Sphere { radius })
}

pub(crate) fn capsule(half_height: f32, radius: f32) -> Shape {
    Shape::Capsule(Capsule { half_height, radius })
}

pub(crate) fn cylinder(half_height: f32, radius: f32) -> Shape {
    Shape::Cylinder(Cylinder { half_height, radius })
}

pub(crate) fn cuboid(x: f32, y: f32, z: f32) -> Shape {
    Shape::Cuboid(Cuboid { half_extents: Vec3::new(x, y, z) })
}

/// The hull of a few points in convex position, by trying all planes through three of them.
pub(crate) fn hull(points: &[Vec3]) -> Shape {
    let centre = points.iter().fold(Vec3::ZERO, |sum, point| sum + *point) / points.len() as f32;
    let mut made = Hull {
        vertices: points.to_vec(),
        faces: Vec::new(),
        corners: Vec::new(),
        edges: Vec::new(),
        centre,
        inner_radius: 0.0,
    };
    let count = points.len();
    for i in 0..count {
        for j in i + 1..count {
            for k in j + 1..count {
                add_face_through(&mut made, [i, j, k]);
            }
        }
    }
    add_edges(&mut made);
    made.inner_radius = hull_inner_radius(&made.faces, made.centre);
    Shape::Hull(Arc::new(made))
}

fn add_face_through(hull: &mut Hull, [i, j, k]: [usize; 3]) {
    let (p, q, r) = (hull.vertices[i], hull.vertices[j], hull.vertices[k]);
    let mut normal = (q - p).cross(r - p).normalize();
    if normal.dot(hull.centre - p) > 0.0 {
        normal = -normal;
    }
    let height = |vertex: &Vec3| normal.dot(*vertex - p);
    let known = hull.faces.iter().any(|face| face.normal.dot(normal) > 0.99999);
    if known || hull.vertices.iter().any(|vertex| height(vertex) > 1.0e-4) {
        return;
    }
    let mut corners: Vec<u32> =
        (0..hull.vertices.len() as u32).filter(|&v| height(&hull.vertices[v as usize]) > -1.0e-4).collect();
    let middle =
        corners.iter().fold(Vec3::ZERO, |sum, &v| sum + hull.vertices[v as usize]) / corners.len() as f32;
    let u = (p - middle).normalize();
    let v = normal.cross(u);
    let angle = |corner: &u32| {
        let arm = hull.vertices[*corner as usize] - middle;
        libm::atan2f(arm.dot(v), arm.dot(u))
    };
    corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    let first = hull.corners.len() as u32;
    hull.faces.push(HullFace { normal, offset: normal.dot(p), first, count: corners.len() as u32 });
    hull.corners.extend(corners);
}

fn add_edges(hull: &mut Hull) {
    let mut sides: Vec<([u32; 2], u32)> = Vec::new();
    for (index, face) in hull.faces.iter().enumerate() {
        let corners = &hull.corners[face.first as usize..(face.first + face.count) as usize];
        for k in 0..corners.len() {
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            sides.push(([a.min(b), a.max(b)], index as u32));
        }
    }
    sides.sort_unstable();
    for pair in sides.chunks(2) {
        assert_eq!(pair[0].0, pair[1].0, "every edge lies between two faces");
        hull.edges.push(HullEdge { vertices: pair[0].0, faces: [pair[0].1, pair[1].1] });
    }
}

/// A cube as a hull.
pub(crate) fn cube_hull(half: f32) -> Shape {
    let mut points = Vec::new();
    for x in [-half, half] {
        for y in [-half, half] {
            for z in [-half, half] {
                points.push(Vec3::new(x, y, z));
            }
        }
    }
    hull(&points)
}

/// A regular octahedron with the given corner distance.
pub(crate) fn octahedron(radius: f32) -> Shape {
    hull(&[Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z].map(|axis| axis * radius))
}

pub(crate) fn tetrahedron(radius: f32) -> Shape {
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    hull(&corners.map(|corner| Vec3::from_array(corner) * (radius / libm::sqrtf(3.0))))
}

pub(crate) fn manifolds(first: (&Shape, Pose), second: (&Shape, Pose), margin: f32) -> Vec<Manifold> {
    let mut out = Vec::new();
    let place = |(shape, pose)| Placed { shape, pose, motion: Motion::default() };
    contact_manifolds(&place(first), &place(second), margin, &mut out);
    out
}

pub(crate) fn at(x: f32, y: f32, z: f32) -> Pose {
    Pose::from_position(Vec3::new(x, y, z))
}

pub(crate) fn turned(position: Vec3, axis: Vec3, angle: f32) -> Pose {
    let (sine, cosine) = libm::sincosf(0.5 * angle);
    let v = axis.normalize() * sine;
    Pose::new(position, Quat::from_xyzw(v.x, v.y, v.z, cosine))
}

/// A linear congruential generator (Knuth's MMIX constants).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Uniform from `low` to `high`.
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 40) as f32 / (1 << 24) as f32)
    }

    pub(crate) fn vector(&mut self, reach: f32) -> Vec3 {
        Vec3::new(self.between(-reach, reach), self.between(-reach, reach), self.between(-reach, reach))
    }

    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.vector(1.0);
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    pub(crate) fn rotation(&mut self) -> Quat {
        let axis = self.direction();
        turned(Vec3::ZERO, axis, self.between(0.0, std::f32::consts::TAU)).rotation
    }
}

/// The outermost point of a shape in a direction, written independently of the engine.
pub(crate) fn outermost(shape: &Shape, pose: &Pose, direction: Vec3) -> f32 {
    let d = pose.inverse_transform_vector(direction);
    let local = match shape {
        Shape::Sphere(s) => s.radius * d.length(),
        Shape::Capsule(c) => c.half_height * d.y.abs() + c.radius * d.length(),
        Shape::Cylinder(c) => c.half_height * d.y.abs() + c.radius * libm::sqrtf(d.x * d.x + d.z * d.z),
        Shape::Cuboid(c) => c.half_extents.dot(d.abs()),
        Shape::Hull(h) => h.vertices.iter().map(|v| v.dot(d)).fold(f32::NEG_INFINITY, f32::max),
        other => panic!("{other:?} has no support function here"),
    };
    local + pose.position.dot(direction)
}

/// Separation along a direction, from the first to the second.
pub(crate) fn separation_along(a: (&Shape, Pose), b: (&Shape, Pose), direction: Vec3) -> f32 {
    -outermost(b.0, &b.1, -direction) - outermost(a.0, &a.1, direction)
}

/// The largest separation over many directions, refined around the best few: the true signed distance, from below.
pub(crate) fn brute_separation(a: (&Shape, Pose), b: (&Shape, Pose)) -> (f32, Vec3) {
    let rounds = 2000;
    let mut best: Vec<(f32, Vec3)> = Vec::new();
    for k in 0..rounds {
        // Fibonacci sphere.
        let y = 1.0 - 2.0 * (k as f32 + 0.5) / rounds as f32;
        let r = libm::sqrtf(1.0 - y * y);
        let (s, c) = libm::sincosf(k as f32 * 2.399_963);
        let direction = Vec3::new(r * c, y, r * s);
        best.push((separation_along(a, b, direction), direction));
    }
    best.sort_by(|x, y| y.0.total_cmp(&x.0));
    best.truncate(8);
    let mut random = Random(7);
    for (value, direction) in &mut best {
        let mut step = 0.1;
        while step > 1.0e-5 {
            let mut better = false;
            for _ in 0..12 {
                let candidate = (*direction + random.direction() * step).normalize();
                let separation = separation_along(a, b, candidate);
                if separation > *value {
                    (*value, *direction, better) = (separation, candidate, true);
                }
            }
            if !better {
                step *= 0.5;
            }
        }
    }
    best.into_iter().fold((f32::NEG_INFINITY, Vec3::Y), |m, x| if x.0 > m.0 { x } else { m })
}

/// How far a point is from the surface of a shape: 0 on it. Exact inside and near faces and sides. A capsule counts as a
/// ball that is drawn along its segment; the ball must touch the point with the given normal.
pub(crate) fn off_surface(shape: &Shape, pose: &Pose, point: Vec3, normal: Vec3) -> f32 {
    let p = pose.inverse_transform_point(point);
    match shape {
        Shape::HalfSpace => p.y,
        Shape::Sphere(s) => p.length() - s.radius,
        Shape::Capsule(c) => {
            let centre = p - pose.inverse_transform_vector(normal) * c.radius;
            (centre - Vec3::new(0.0, centre.y.clamp(-c.half_height, c.half_height), 0.0)).length()
        }
        Shape::Cuboid(c) => (p.abs() - c.half_extents).max_element(),
        Shape::Cylinder(c) => (libm::sqrtf(p.x * p.x + p.z * p.z) - c.radius).max(p.y.abs() - c.half_height),
        Shape::Hull(h) => {
            h.faces.iter().map(|face| face.normal.dot(p) - face.offset).fold(f32::NEG_INFINITY, f32::max)
        }
        other => panic!("{other:?} has no surface here"),
    }
}
