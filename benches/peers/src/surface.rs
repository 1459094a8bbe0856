//! Surface: points of a shape's surface, and how deep a point lies inside a shape: what overlap is measured with.

use std::collections::BTreeSet;
use std::f32::consts::TAU;

use forerun::geometry::shape::{Hull, Mesh};
use forerun::{Pose, Quat, Shape, Vec3};

use crate::true_mesh::{TrueMesh, ends};

/// Points along the edges of a mesh, beside its vertices; up to one an edge more.
const EDGE_POINTS: f32 = 3000.0;
/// Points round what is round.
const ROUND: u32 = 32;

/// A shape that can be asked for depths.
pub(crate) enum Solid {
    /// A closed mesh.
    Mesh(TrueMesh),
    /// A shape that is no mesh and holds none.
    Plain(Shape),
    /// Parts, each at a pose in the frame of the whole.
    Parts(Vec<(Pose, Solid)>),
    /// An open mesh: a surface without an inside.
    Nothing,
}

impl Solid {
    pub(crate) fn of(shape: &Shape) -> Self {
        match shape {
            Shape::Mesh(mesh) if mesh.has_inside() => Solid::Mesh(TrueMesh::new(mesh.clone())),
            Shape::Mesh(_) => Solid::Nothing,
            Shape::Compound(compound) => {
                Solid::Parts(compound.parts.iter().map(|(at, part)| (*at, Solid::of(part))).collect())
            }
            plain => Solid::Plain(plain.clone()),
        }
    }

    /// How deep a point of the shape's frame lies inside, if that is more than `least`, which is 0 or more. Metres.
    pub(crate) fn depth_above(&self, point: Vec3, least: f32) -> Option<f32> {
        match self {
            Solid::Mesh(mesh) => mesh.depth_above(point, least),
            Solid::Plain(shape) => Some(plain_depth(shape, point)).filter(|depth| *depth > least),
            Solid::Parts(parts) => {
                let depths = parts
                    .iter()
                    .filter_map(|(at, part)| part.depth_above(at.inverse_transform_point(point), least));
                depths.reduce(f32::max)
            }
            Solid::Nothing => None,
        }
    }
}

/// How deep a point lies inside, exact there; 0 or less outside. Metres.
fn plain_depth(shape: &Shape, p: Vec3) -> f32 {
    match shape {
        Shape::Sphere(s) => s.radius - p.length(),
        Shape::Cuboid(s) => (s.half_extents - p.abs()).min_element(),
        Shape::Capsule(s) => s.radius - p.distance(Vec3::Y * p.y.clamp(-s.half_height, s.half_height)),
        Shape::Cylinder(s) => (s.radius - p.x.hypot(p.z)).min(s.half_height - p.y.abs()),
        Shape::Hull(hull) => {
            hull.faces.iter().map(|face| face.offset - face.normal.dot(p)).fold(f32::INFINITY, f32::min)
        }
        Shape::HalfSpace => -p.y,
        Shape::Compound(_) | Shape::Mesh(_) => 0.0,
    }
}

/// Points of the surface, in the shape's frame: of meshes and hulls the vertices and points along edges, of plain shapes enough of all sides. None of a
/// half-space. Metres.
pub(crate) fn points(shape: &Shape) -> Vec<Vec3> {
    match shape {
        Shape::Sphere(s) => ball(s.radius, 0.0),
        Shape::Cuboid(s) => cuboid(s.half_extents),
        Shape::Capsule(s) => {
            let sides = levels(s.half_height, s.radius).flat_map(|y| circle(s.radius, y));
            sides.chain(ball(s.radius, s.half_height)).collect()
        }
        Shape::Cylinder(s) => {
            let spacing = TAU / ROUND as f32 * s.radius;
            let ends = [-1.0, 1.0].into_iter().flat_map(|side| {
                (0..8_u8).flat_map(move |k| circle(s.radius * f32::from(k) / 8.0, side * s.half_height))
            });
            levels(s.half_height, spacing).flat_map(|y| circle(s.radius, y)).chain(ends).collect()
        }
        Shape::Hull(hull) => of_hull(hull),
        Shape::HalfSpace => Vec::new(),
        Shape::Compound(compound) => {
            let of_part = |(at, part): &(Pose, Shape)| -> Vec<Vec3> {
                points(part).into_iter().map(|p| at.transform_point(p)).collect()
            };
            compound.parts.iter().flat_map(of_part).collect()
        }
        Shape::Mesh(mesh) => of_mesh(mesh),
    }
}

fn of_mesh(mesh: &Mesh) -> Vec<Vec3> {
    let edges: BTreeSet<[u32; 2]> =
        mesh.triangles.iter().flat_map(|t| [0, 1, 2].map(|edge| ends(t, edge))).collect();
    let edges = || edges.iter().map(|edge| edge.map(|v| mesh.vertices[v as usize]));
    let length: f32 = edges().map(|[a, b]| a.distance(b)).sum();
    let spacing = length / EDGE_POINTS;
    let along = edges().flat_map(|[a, b]| {
        let parts = (a.distance(b) / spacing).ceil().max(1.0) as u32;
        (1..parts).map(move |k| a.lerp(b, k as f32 / parts as f32))
    });
    mesh.vertices.iter().copied().chain(along).collect()
}

fn of_hull(hull: &Hull) -> Vec<Vec3> {
    let along = hull.edges.iter().flat_map(|edge| {
        let [a, b] = edge.vertices.map(|v| hull.vertices[v as usize]);
        (1..8_u8).map(move |k| a.lerp(b, f32::from(k) / 8.0))
    });
    let middles = hull.triangles().map(|[a, b, c]| (a + b + c) / 3.0);
    hull.vertices.iter().copied().chain(along).chain(middles).collect()
}

/// Nine points along each side of each face.
fn cuboid(half: Vec3) -> Vec<Vec3> {
    let steps = || (-4..=4_i8).map(|k| f32::from(k) / 4.0);
    let faces = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|normal| {
        let (u, v) = (Vec3::new(normal.z, normal.x, normal.y), Vec3::new(normal.y, normal.z, normal.x));
        steps().flat_map(move |a| steps().flat_map(move |b| [1.0, -1.0].map(|s| normal * s + u * a + v * b)))
    });
    faces.map(|corner| corner * half).collect()
}

/// Points on a sphere whose halves are moved apart by `half_height` along y, evenly (a spiral by the golden angle).
fn ball(radius: f32, half_height: f32) -> Vec<Vec3> {
    const COUNT: u16 = 400;
    let point = |k: u16| {
        let y = 1.0 - 2.0 * (f32::from(k) + 0.5) / f32::from(COUNT);
        let out = Vec3::X * (1.0 - y * y).sqrt();
        let turned = Quat::from_rotation_y(TAU * (f32::from(k) * 0.618_034).fract()) * out;
        (turned + Vec3::Y * y) * radius + Vec3::Y * half_height.copysign(y)
    };
    (0..COUNT).map(point).collect()
}

fn circle(radius: f32, y: f32) -> impl Iterator<Item = Vec3> {
    let around = |k: u32| Quat::from_rotation_y(TAU * k as f32 / ROUND as f32);
    (0..ROUND).map(move |k| around(k) * (Vec3::X * radius) + Vec3::Y * y)
}

/// Heights from one end to the other, no further apart than `spacing`.
fn levels(half_height: f32, spacing: f32) -> impl Iterator<Item = f32> {
    let parts = (2.0 * half_height / spacing).ceil().clamp(1.0, 1000.0) as u16;
    (0..=parts).map(move |k| half_height * (2.0 * f32::from(k) / f32::from(parts) - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes() -> Vec<Shape> {
        let corners: Vec<Vec3> = (0..8_u8)
            .map(|k| Vec3::new(f32::from(k & 1), f32::from(k >> 1 & 1), f32::from(k >> 2)))
            .collect();
        vec![
            Shape::sphere(0.4).unwrap(),
            Shape::cuboid(Vec3::new(0.3, 0.2, 0.5)).unwrap(),
            Shape::capsule(0.3, 0.2).unwrap(),
            Shape::cylinder(0.5, 0.2).unwrap(),
            Shape::hull(&corners).unwrap(),
        ]
    }

    #[test]
    fn points_lie_on_the_surface_and_on_every_side_of_it() {
        for shape in shapes() {
            let (solid, all) = (Solid::of(&shape), points(&shape));
            // Cylinders have points inside their end faces, which lie on the surface too.
            assert!(all.iter().all(|p| plain_depth(&shape, *p).abs() < 1e-5), "{shape:?}");
            let box_of_all = forerun::Aabb::around(all.iter().copied());
            let bounds = shape.aabb(&Pose::IDENTITY);
            assert!((box_of_all.min - bounds.min).abs().max_element() < 0.02, "{shape:?}");
            assert!((box_of_all.max - bounds.max).abs().max_element() < 0.02, "{shape:?}");
            assert!(solid.depth_above(bounds.centre(), 0.0).is_some_and(|depth| depth > 0.15));
            assert!(solid.depth_above(bounds.max + 0.01, 0.0).is_none());
        }
    }

    #[test]
    fn edges_of_a_mesh_have_points_too() {
        let stage = crate::stage::Stage::of(&forerun::Scene::open("tori:1").unwrap()).unwrap();
        let shape = &stage.actors[1].def.shape;
        let (Shape::Mesh(mesh), all) = (shape, points(shape)) else { panic!("not a mesh") };
        assert!(all.len() > mesh.vertices.len() + 1000 && all.len() < 7000, "{}", all.len());
        let solid = Solid::of(shape);
        assert!(all.iter().all(|p| solid.depth_above(*p, 1e-4).is_none()));
    }
}
