//! Tessellation: any shape as triangles with normals, for drawing only.

use forerun::geometry::shape::{Capsule, Cylinder};
use forerun::{Shape, Vec3};

/// Segments of a full turn.
const TURN: u32 = 40;
/// And where there are many bodies.
const COARSE_TURN: u32 = 18;
/// Cosine of the angle between two faces (35 degrees) up to which the edge between them is drawn round.
const ROUND: f32 = 0.82;
/// Vertices with more faces than this keep the normals of their faces: looking at all pairs would take long.
const FACES_MAX: usize = 48;

/// A triangle with a normal at each corner, counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    /// In the frame of the shape. Metres.
    pub corners: [Vec3; 3],
    /// Unit vectors, one a corner.
    pub normals: [Vec3; 3],
}

/// Triangles by the numbers of their corners.
#[derive(Default)]
struct Triangles {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// The surface of a shape in its own frame. None for half-spaces, which have no end.
#[must_use]
pub fn facets(shape: &Shape) -> Vec<Facet> {
    facets_of(shape, TURN)
}

/// The surface of a shape as it is drawn where there are many: what is round is less so.
#[must_use]
pub fn coarse_facets(shape: &Shape) -> Vec<Facet> {
    facets_of(shape, COARSE_TURN)
}

/// With so many segments of a full turn: an even number.
fn facets_of(shape: &Shape, turn: u32) -> Vec<Facet> {
    let triangles = match shape {
        Shape::HalfSpace => Triangles::default(),
        Shape::Sphere(sphere) => turned(&half_circle(sphere.radius, 0.0, turn), turn),
        Shape::Capsule(Capsule { half_height, radius }) => {
            turned(&half_circle(*radius, *half_height, turn), turn)
        }
        Shape::Cylinder(Cylinder { half_height, radius }) => {
            let line =
                [[0.0, *half_height], [*radius, *half_height], [*radius, -half_height], [0.0, -half_height]];
            turned(&line, turn)
        }
        Shape::Cuboid(cuboid) => block(cuboid.half_extents),
        Shape::Hull(hull) => {
            let corners: Vec<Vec3> = hull.triangles().flatten().collect();
            let triangles = (0..corners.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            // Every triangle has corners of its own: faces stay flat.
            Triangles { vertices: corners, triangles }
        }
        Shape::Mesh(mesh) => {
            return with_normals(&mesh.vertices, &mesh.triangles);
        }
        Shape::Compound(compound) => {
            let parts = compound.parts.iter();
            return parts
                .flat_map(|(pose, part)| {
                    facets_of(part, turn).into_iter().map(|facet| Facet {
                        corners: facet.corners.map(|corner| pose.transform_point(corner)),
                        normals: facet.normals.map(|normal| pose.rotation * normal),
                    })
                })
                .collect();
        }
    };
    with_normals(&triangles.vertices, &triangles.triangles)
}

/// Half a circle as (distance from the y axis, height), its halves moved apart.
fn half_circle(radius: f32, half_height: f32, turn: u32) -> Vec<[f32; 2]> {
    let parts = turn / 2;
    (0..=parts)
        .map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::PI / f64::from(parts)).sin_cos();
            let shift = if 2 * i <= parts { half_height } else { -half_height };
            [radius * sin as f32, radius * cos as f32 + shift]
        })
        .collect()
}

/// The surface that a line, from the upper to the lower end of the y axis, makes when it turns about it.
fn turned(line: &[[f32; 2]], turn: u32) -> Triangles {
    let mut made = Triangles::default();
    for [out, height] in line {
        for k in 0..turn {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / f64::from(turn)).sin_cos();
            made.vertices.push(Vec3::new(out * cos as f32, *height, out * sin as f32));
        }
    }
    for row in 0..line.len() as u32 - 1 {
        for k in 0..turn {
            let (a, b) = (row * turn + k, row * turn + (k + 1) % turn);
            made.triangles.extend([[a, b, b + turn], [a, b + turn, a + turn]]);
        }
    }
    made
}

fn block(half: Vec3) -> Triangles {
    let side = |k: u32, axis: u32| if k >> axis & 1 == 0 { -1.0 } else { 1.0 };
    let vertices = (0..8).map(|k| half * Vec3::new(side(k, 0), side(k, 1), side(k, 2))).collect();
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Triangles { vertices, triangles }
}

/// Normals that are round where the surface nearly is, and those of the faces elsewhere.
fn with_normals(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Facet> {
    let corners = |t: &[u32; 3]| t.map(|i| vertices[i as usize]);
    // As long as the triangle is large, so that slivers count little.
    let areas: Vec<Vec3> = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = corners(t);
            (b - a).cross(c - a)
        })
        .collect();
    let mut around: Vec<(u32, u32)> =
        triangles.iter().enumerate().flat_map(|(t, corners)| corners.map(|v| (v, t as u32))).collect();
    around.sort_unstable();
    let faces_of = |vertex: u32| {
        let start = around.partition_point(|(v, _)| *v < vertex);
        let end = around.partition_point(|(v, _)| *v <= vertex);
        &around[start..end]
    };
    let normal_at = |vertex: u32, t: usize| {
        let own = areas[t].normalize_or_zero();
        let faces = faces_of(vertex);
        if faces.len() > FACES_MAX {
            return own;
        }
        let near = faces.iter().map(|(_, t)| areas[*t as usize]);
        near.filter(|area| area.normalize_or_zero().dot(own) > ROUND).sum::<Vec3>().normalize_or(own)
    };
    let facet = |(t, triangle): (usize, &[u32; 3])| Facet {
        corners: corners(triangle),
        normals: triangle.map(|v| normal_at(v, t)),
    };
    triangles.iter().enumerate().filter(|(t, _)| areas[*t].length_squared() > 0.0).map(facet).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use forerun::Pose;
    use forerun::geometry::shape::mesh_make;

    /// By the divergence theorem; right only if all facets face outwards and leave no hole.
    fn volume(shape: &Shape) -> f32 {
        facets(shape)
            .iter()
            .map(|facet| {
                let [a, b, c] = facet.corners;
                let outward = (b - a).cross(c - a);
                assert!(
                    facet.normals.iter().all(|n| n.dot(outward) > 0.0 && (n.length() - 1.0).abs() < 1e-4)
                );
                a.dot(b.cross(c)) / 6.0
            })
            .sum()
    }

    #[test]
    fn every_shape_is_closed_and_faces_outwards() {
        let half = Vec3::new(0.5, 1.0, 1.5);
        let shapes = [
            Shape::sphere(1.2).unwrap(),
            Shape::cuboid(half).unwrap(),
            Shape::capsule(0.7, 0.4).unwrap(),
            Shape::cylinder(0.7, 0.4).unwrap(),
            Shape::hull(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]).unwrap(),
            mesh_make::torus(0.5, 0.2, 24, 12).unwrap().into(),
            Shape::compound(vec![(Pose::from_position(Vec3::X), Shape::cuboid(half).unwrap())]).unwrap(),
        ];
        for shape in shapes {
            let (drawn, true_volume) = (volume(&shape), shape.mass_properties(1.0).mass);
            assert!((0.98..1.001).contains(&(drawn / true_volume)), "{drawn} of {true_volume}: {shape:?}");
        }
        assert!(facets(&Shape::HalfSpace).is_empty());
    }
}
