//! Facets: how deep the meshes of rings lie in each other and in the ground, from their triangles alone, in double precision.
//!
//! The overlap of two meshes is that of the deepest point of either surface in the other. Points are looked for by halving the triangles that may hold a
//! deeper one than is known: no point of a triangle is deeper than its middle by more than its reach. None of the engine's contact code is used.

use forerun::dynamics::{Body, BodyState, World};
use forerun::geometry::shape::{Mesh, Shape};

use super::lab::{cross, dot, doubled, length, rotated};
use super::linkage::Torus;

/// Nobody looks for deeper points that are deeper by less. Metres.
const TOLERANCE: f64 = 1e-4;
/// Two triangles are equally near. Metres.
const TIE: f64 = 1e-9;

type Vector = [f64; 3];

/// A triangle of a mesh.
#[derive(Clone, Copy, Debug)]
struct Facet {
    corners: [Vector; 3],
    /// Unit, outwards.
    normal: Vector,
    middle: Vector,
    /// From the middle to the farthest corner. Metres.
    reach: f64,
}

/// The mesh of the rings of a world: every dynamic body is the same one, which lies within a torus about its y axis; the ground is y = 0.
#[derive(Clone, Debug)]
pub(crate) struct Facets {
    torus: Torus,
    facets: Vec<Facet>,
    /// Indices and bodies of the rings.
    rings: Vec<(usize, Body)>,
}

/// Where a ring is.
#[derive(Clone, Copy, Debug)]
struct Place {
    centre: Vector,
    rotation: [f64; 4],
}

impl Facets {
    pub(crate) fn new(world: &World, torus: Torus) -> Facets {
        let rings = world.bodies().iter().enumerate().filter(|(_, body)| body.is_dynamic());
        let rings: Vec<(usize, Body)> = rings.map(|(i, body)| (i, body.clone())).collect();
        let mesh = rings.iter().find_map(|(_, body)| match &body.shape {
            Shape::Mesh(mesh) => Some(mesh),
            _ => None,
        });
        let facets = mesh.map(|mesh| facets(mesh)).unwrap_or_default();
        Facets { torus, facets, rings }
    }

    /// The deepest overlap of any two rings, or of one and the ground. Metres, 0 where none overlap.
    pub(crate) fn deepest(&self, states: &[BodyState]) -> f64 {
        let place = |(i, body): &(usize, Body)| {
            let pose = body.own_pose(&states[*i]);
            Place { centre: doubled(pose.position), rotation: pose.rotation.to_array().map(f64::from) }
        };
        let places: Vec<Place> = self.rings.iter().map(place).collect();
        let corners = || self.facets.iter().flat_map(|facet| facet.corners);
        let mut deepest = 0.0f64;
        let reach = 2.0 * (self.torus.radius + self.torus.tube_radius);
        for (i, a) in places.iter().enumerate() {
            deepest = corners().fold(deepest, |deepest, corner| deepest.max(-a.out(corner)[1]));
            for (j, b) in places.iter().enumerate() {
                let apart = [0, 1, 2].map(|k| a.centre[k] - b.centre[k]);
                if i != j && dot(apart, apart) < reach * reach {
                    deepest = self.deepest_in(a, b, deepest);
                }
            }
        }
        deepest
    }

    /// The deepest point of the surface of one ring in another, or `least` if none is deeper. Metres
    fn deepest_in(&self, ring: &Place, other: &Place, least: f64) -> f64 {
        let there = |facet: &Facet| facet.corners.map(|corner| other.inward(ring.out(corner)));
        let mut left: Vec<[Vector; 3]> = self.facets.iter().map(there).collect();
        let mut least = least;
        while let Some(corners) = left.pop() {
            let (middle, reach) = ball(&corners);
            let hope = least + TOLERANCE - reach;
            // The mesh lies within the torus: nobody is deeper in it.
            if self.torus.depth(middle) <= hope {
                continue;
            }
            let depth = self.depth(middle);
            least = least.max(depth);
            if depth > hope {
                left.extend(quarters(&corners));
            }
        }
        least
    }

    /// How deep a point lies in the mesh; below 0 outside. Metres
    fn depth(&self, point: Vector) -> f64 {
        let (mut nearest, mut height) = (f64::INFINITY, 0.0f64);
        for facet in &self.facets {
            if length(minus(point, facet.middle)) - facet.reach > nearest {
                continue;
            }
            let from = minus(point, facet.nearest(point));
            let (distance, above) = (length(from), dot(from, facet.normal));
            // Of the triangles at a common edge the one that is seen most steeply knows which side it is.
            if distance < nearest - TIE || (distance < nearest + TIE && above.abs() > height.abs()) {
                height = above;
            }
            nearest = nearest.min(distance);
        }
        if height < 0.0 { nearest } else { -nearest }
    }
}

impl Torus {
    /// How deep a point lies in the torus, about the y axis; below 0 outside. Metres
    fn depth(&self, [x, y, z]: Vector) -> f64 {
        self.tube_radius - (x.hypot(z) - self.radius).hypot(y)
    }
}

impl Place {
    /// From the frame of the ring to the world.
    fn out(&self, point: Vector) -> Vector {
        let turned = rotated(self.rotation, point);
        [0, 1, 2].map(|k| self.centre[k] + turned[k])
    }

    /// From the world to the frame of the ring.
    fn inward(&self, point: Vector) -> Vector {
        let [x, y, z, w] = self.rotation;
        rotated([-x, -y, -z, w], minus(point, self.centre))
    }
}

impl Facet {
    fn new(corners: [Vector; 3]) -> Facet {
        let [a, b, c] = corners;
        let across = cross(minus(b, a), minus(c, a));
        let (middle, reach) = ball(&corners);
        Facet { corners, normal: across.map(|x| x / length(across)), middle, reach }
    }

    /// Its point nearest to another: the foot of that if it lies within, else one on an edge.
    fn nearest(&self, point: Vector) -> Vector {
        let height = dot(minus(point, self.corners[0]), self.normal);
        let foot = [0, 1, 2].map(|k| point[k] - height * self.normal[k]);
        let edges = [0, 1, 2].map(|k| [self.corners[k], self.corners[(k + 1) % 3]]);
        let within = |[a, b]: &[Vector; 2]| dot(cross(minus(*b, *a), minus(foot, *a)), self.normal) >= 0.0;
        if edges.iter().all(within) {
            return foot;
        }
        let on_edge = |[a, b]: [Vector; 2]| {
            let along = minus(b, a);
            let part = (dot(minus(point, a), along) / dot(along, along)).clamp(0.0, 1.0);
            [0, 1, 2].map(|k| a[k] + part * along[k])
        };
        let distance = |p: &Vector| length(minus(point, *p));
        edges.map(on_edge).into_iter().min_by(|p, q| distance(p).total_cmp(&distance(q))).unwrap_or(foot)
    }
}

fn facets(mesh: &Mesh) -> Vec<Facet> {
    (0..mesh.triangles.len()).map(|i| Facet::new(mesh.corners(i).map(doubled))).collect()
}

/// A ball around a triangle: its middle and radius.
fn ball(corners: &[Vector; 3]) -> (Vector, f64) {
    let middle = [0, 1, 2].map(|k| (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0);
    (middle, corners.iter().map(|corner| length(minus(*corner, middle))).fold(0.0, f64::max))
}

/// The four triangles between the corners of one and the middles of its edges.
fn quarters(&[a, b, c]: &[Vector; 3]) -> [[Vector; 3]; 4] {
    let half = |p: Vector, q: Vector| [0, 1, 2].map(|k| 0.5 * (p[k] + q[k]));
    let (ab, bc, ca) = (half(a, b), half(b, c), half(c, a));
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

fn minus(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|k| a[k] - b[k])
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;
    use std::sync::Arc;

    use forerun::dynamics::{BodyDef, Environment};
    use forerun::geometry::shape::mesh_make;
    use forerun::geometry::{Quat, Vec3};

    use super::super::lab::world;
    use super::*;

    const TORUS: Torus = Torus { radius: 0.5, tube_radius: 0.2 };

    /// Of two rings of 48 times 16 facets, far above the ground but for the first one's height.
    fn deepest(height: f32, place: Vec3, rotation: Quat) -> f64 {
        let ring = Shape::Mesh(Arc::new(mesh_make::torus(0.5, 0.2, 48, 16).unwrap()));
        let below = BodyDef::new(ring.clone()).at(Vec3::Y * height);
        let mut above = BodyDef::new(ring).at(Vec3::Y * height + place);
        above.pose.rotation = rotation;
        let world = world(Environment::default(), &[below, above]);
        Facets::new(&world, TORUS).deepest(world.states())
    }

    fn near(value: f64, expected: f64) {
        assert!((value - expected).abs() < 3e-4, "{value}, expected {expected}");
    }

    /// From so far below an edge round the tube to the facets beside it.
    fn beside(below: f64) -> f64 {
        below * (PI / 16.0).cos()
    }

    #[test]
    fn corners_and_facets_are_told_apart() {
        // Outermost are corners, which meet.
        near(deepest(9.0, Vec3::X * 1.36, Quat::IDENTITY), beside(0.04));
        near(deepest(9.0, Vec3::X * 1.41, Quat::IDENTITY), 0.0);
        // Turned about its own axis by half a segment one has an edge there, farther in.
        let half_turn = Quat::from_rotation_y((PI / 48.0) as f32);
        near(deepest(9.0, Vec3::X * 1.36, half_turn), beside(0.04 - 0.7 * (1.0 - (PI / 48.0).cos())));
        // On top of each other, corner to corner.
        near(deepest(9.0, Vec3::Y * 0.37, Quat::IDENTITY), beside(0.03));
    }

    #[test]
    fn the_ground_counts() {
        near(deepest(0.17, Vec3::Y * 9.0, Quat::IDENTITY), 0.03);
    }

    #[test]
    fn a_ring_through_the_hole_of_another_touches_neither() {
        let upright = Quat::from_rotation_x((PI / 2.0) as f32);
        near(deepest(9.0, Vec3::X * 0.5, upright), 0.0);
        assert!(deepest(9.0, Vec3::X * 0.62, upright) > 0.01);
    }
}
