//! Gauge: how deep boxes, hulls and balls overlap each other and a level ground, from their poses alone, in double precision.
//!
//! None of the engine's contact code is used: the depth of two convex bodies is the least of the overlaps of their shadows along every face normal
//! and every product of two edges (the separating axes), found by brute force.

use forerun::dynamics::{Body, BodyState, World};
use forerun::geometry::Pose;
use forerun::geometry::shape::{Hull, Shape};

use super::lab::{cross, dot, doubled, length, rotated};

/// Two directions whose sine is less are parallel.
const PARALLEL: f64 = 1e-5;

/// What the gauge knows of one body's shape, in the body's own frame.
#[derive(Clone, Debug)]
enum Probe {
    /// Everything at or below y = 0.
    Ground,
    Ball(f64),
    /// One convex solid, or the parts of a compound.
    Solids(Vec<Solid>),
    /// Another shape: not looked at.
    Unknown,
}

#[derive(Clone, Debug, Default)]
struct Solid {
    corners: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    edges: Vec<[f64; 3]>,
    radius: f64,
}

/// Measures the overlaps in one world.
#[derive(Clone, Debug)]
pub(crate) struct Gauge {
    bodies: Vec<(Body, Probe)>,
}

impl Gauge {
    pub(crate) fn new(world: &World) -> Gauge {
        Gauge::with_shapes(world, world.bodies().iter().map(|body| &body.shape))
    }

    /// Measures the bodies of the world as if each had another shape: meshes by the solids that they are made of.
    pub(crate) fn with_shapes<'a>(world: &World, shapes: impl Iterator<Item = &'a Shape>) -> Gauge {
        Gauge { bodies: world.bodies().iter().cloned().zip(shapes.map(Probe::of)).collect() }
    }

    /// The deepest overlap of two bodies of which at least one is dynamic. Metres, 0 when nothing overlaps.
    pub(crate) fn deepest(&self, states: &[BodyState]) -> f64 {
        let placed: Vec<Placed> =
            self.bodies.iter().zip(states).map(|((body, probe), state)| probe.placed(body, state)).collect();
        let mut deepest = 0.0f64;
        for (i, a) in placed.iter().enumerate() {
            for b in &placed[..i] {
                let apart = [0, 1, 2].map(|k| a.centre[k] - b.centre[k]);
                let reach = a.radius + b.radius;
                if (a.dynamic || b.dynamic) && dot(apart, apart) < reach * reach {
                    deepest = deepest.max(a.depth(b));
                }
            }
        }
        deepest
    }
}

/// A shape where it is now.
struct Placed<'a> {
    probe: &'a Probe,
    dynamic: bool,
    centre: [f64; 3],
    radius: f64,
    /// Corners, normals and edges in the world.
    solids: Vec<Solid>,
}

impl Probe {
    fn of(shape: &Shape) -> Probe {
        match shape {
            Shape::HalfSpace => Probe::Ground,
            Shape::Sphere(sphere) => Probe::Ball(f64::from(sphere.radius)),
            Shape::Cuboid(cuboid) => Probe::Solids(vec![Solid::cuboid(doubled(cuboid.half_extents))]),
            Shape::Hull(hull) => Probe::Solids(vec![Solid::hull(hull)]),
            Shape::Compound(compound) => Probe::Solids(compound.parts.iter().flat_map(Solid::part).collect()),
            _ => Probe::Unknown,
        }
    }

    fn placed(&self, body: &Body, state: &BodyState) -> Placed<'_> {
        let pose = body.own_pose(state);
        let centre = doubled(pose.position);
        let q = pose.rotation.to_array().map(f64::from);
        let (radius, solids) = match self {
            Probe::Ground => (f64::INFINITY, Vec::new()),
            Probe::Ball(radius) => (*radius, Vec::new()),
            Probe::Solids(solids) => {
                let radius = solids.iter().map(|solid| solid.radius).fold(0.0, f64::max);
                (radius, solids.iter().map(|solid| solid.placed(q, centre)).collect())
            }
            Probe::Unknown => (0.0, Vec::new()),
        };
        Placed { probe: self, dynamic: body.is_dynamic(), centre, radius, solids }
    }
}

impl Placed<'_> {
    fn depth(&self, other: &Placed) -> f64 {
        match (self.probe, other.probe) {
            (Probe::Ground, _) => other.below_ground(),
            (_, Probe::Ground) => self.below_ground(),
            (Probe::Ball(r), Probe::Ball(s)) => {
                r + s - length([0, 1, 2].map(|k| self.centre[k] - other.centre[k]))
            }
            (Probe::Solids(_), Probe::Solids(_)) => {
                let pairs = self.solids.iter().flat_map(|a| other.solids.iter().map(move |b| a.depth(b)));
                pairs.fold(0.0, f64::max)
            }
            _ => 0.0,
        }
        .max(0.0)
    }

    fn below_ground(&self) -> f64 {
        match self.probe {
            Probe::Ball(radius) => radius - self.centre[1],
            _ => {
                let corners = self.solids.iter().flat_map(|solid| &solid.corners);
                corners.map(|corner| -corner[1]).fold(0.0, f64::max)
            }
        }
    }
}

impl Solid {
    fn cuboid(half: [f64; 3]) -> Solid {
        let sign = |bit: usize, i: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let corners = (0..8).map(|i| [0, 1, 2].map(|k| sign(k, i) * half[k])).collect();
        let axes = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Solid { corners, normals: axes.clone(), edges: axes, radius: length(half) }
    }

    fn hull(hull: &Hull) -> Solid {
        let corners: Vec<[f64; 3]> = hull.vertices.iter().map(|v| doubled(*v)).collect();
        let edges = hull.edges.iter().map(|edge| {
            let [a, b] = edge.vertices.map(|i| corners[i as usize]);
            [0, 1, 2].map(|k| b[k] - a[k])
        });
        let (edges, normals) = (different(edges), different(hull.faces.iter().map(|f| doubled(f.normal))));
        let radius = corners.iter().map(|corner| length(*corner)).fold(0.0, f64::max);
        Solid { corners, normals, edges, radius }
    }

    /// A part of a compound, in the frame of the compound; none if it is neither a box nor a hull.
    fn part((pose, shape): &(Pose, Shape)) -> Option<Solid> {
        let solid = match shape {
            Shape::Cuboid(cuboid) => Solid::cuboid(doubled(cuboid.half_extents)),
            Shape::Hull(hull) => Solid::hull(hull),
            _ => return None,
        };
        let mut placed = solid.placed(pose.rotation.to_array().map(f64::from), doubled(pose.position));
        placed.radius = placed.corners.iter().map(|corner| length(*corner)).fold(0.0, f64::max);
        Some(placed)
    }

    fn placed(&self, q: [f64; 4], centre: [f64; 3]) -> Solid {
        let turned = |vectors: &[[f64; 3]]| vectors.iter().map(|v| rotated(q, *v)).collect();
        let mut placed = Solid {
            corners: turned(&self.corners),
            normals: turned(&self.normals),
            edges: turned(&self.edges),
            radius: self.radius,
        };
        for corner in &mut placed.corners {
            *corner = [0, 1, 2].map(|k| corner[k] + centre[k]);
        }
        placed
    }

    /// How far two solids would have to be moved to part. Metres, 0 or less if they are apart.
    fn depth(&self, other: &Solid) -> f64 {
        let mut least = f64::INFINITY;
        for axis in self.normals.iter().chain(&other.normals) {
            least = least.min(self.overlap_along(other, *axis));
            if least <= 0.0 {
                return least;
            }
        }
        for a in &self.edges {
            for b in &other.edges {
                let axis = cross(*a, *b);
                if length(axis) > PARALLEL {
                    least = least.min(self.overlap_along(other, axis));
                }
                if least <= 0.0 {
                    return least;
                }
            }
        }
        least
    }

    fn overlap_along(&self, other: &Solid, axis: [f64; 3]) -> f64 {
        let ((low, high), (other_low, other_high)) = (self.shadow(axis), other.shadow(axis));
        (high - other_low).min(other_high - low) / length(axis)
    }

    fn shadow(&self, axis: [f64; 3]) -> (f64, f64) {
        let heights = self.corners.iter().map(|corner| dot(*corner, axis));
        heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)))
    }
}

/// Unit vectors along the directions, each direction once, whichever way it points.
fn different(vectors: impl Iterator<Item = [f64; 3]>) -> Vec<[f64; 3]> {
    let mut found: Vec<[f64; 3]> = Vec::new();
    for v in vectors {
        let unit = v.map(|x| x / length(v));
        if found.iter().all(|other| length(cross(*other, unit)) > PARALLEL) {
            found.push(unit);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use forerun::dynamics::{BodyDef, Environment};
    use forerun::geometry::{Quat, Vec3};

    use super::super::lab::world;
    use super::*;

    fn deepest(defs: &[BodyDef]) -> f64 {
        let world = world(Environment::default(), defs);
        Gauge::new(&world).deepest(world.states())
    }

    fn turn(axis: Vec3, degrees: f64) -> Quat {
        let (sin, cos) = (0.5 * degrees).to_radians().sin_cos();
        let axis = axis * sin as f32;
        Quat::from_xyzw(axis.x, axis.y, axis.z, cos as f32)
    }

    fn cube(half: f32) -> BodyDef {
        BodyDef::new(Shape::cuboid(Vec3::splat(half)).unwrap())
    }

    #[test]
    fn depths_are_those_of_a_ruler() {
        let near = |value: f64, expected: f64| assert!((value - expected).abs() < 1e-6, "{value}");
        let above = |y: f32| cube(0.5).at(Vec3::Y * y);
        near(deepest(&[above(0.5), above(1.4)]), 0.1);
        near(deepest(&[above(0.5), above(1.6)]), 0.0);
        near(deepest(&[BodyDef::fixed(Shape::half_space()), above(0.45)]), 0.05);
        // On its edge: the corner goes down by half of the diagonal.
        let mut tilted = above(0.5f32.sqrt() - 0.02);
        tilted.pose.rotation = turn(Vec3::Z, 45.0);
        near(deepest(&[BodyDef::fixed(Shape::half_space()), tilted]), 0.02);
        let ball = |x: f32| BodyDef::new(Shape::sphere(0.1).unwrap()).at(Vec3::new(x, 1.0, 0.0));
        near(deepest(&[ball(0.0), ball(0.19)]), 0.01);
    }

    #[test]
    fn a_hull_is_measured_as_the_box_that_it_is() {
        let points: Vec<Vec3> = Solid::cuboid([0.5; 3])
            .corners
            .iter()
            .map(|c| Vec3::new(c[0] as f32, c[1] as f32, c[2] as f32))
            .collect();
        let mut hull = BodyDef::new(Shape::hull(&points).unwrap()).at(Vec3::new(0.3, 0.95, 0.2));
        let mut cube = cube(0.5);
        for yaw in [0.0, 40.0] {
            let rotation = turn(Vec3::Y, yaw);
            (hull.pose.rotation, cube.pose.rotation) = (rotation, rotation);
            assert!((deepest(&[cube.clone(), hull.clone()]) - 0.05).abs() < 1e-6);
        }
    }

    #[test]
    fn crossed_edges_are_seen() {
        // A box on its edge above another on its edge, at right angles: only the product of the two edges tells how deep.
        let mut low = cube(0.5);
        low.pose.rotation = turn(Vec3::Z, 45.0);
        let mut high = cube(0.5).at(Vec3::Y * (2.0f32.sqrt() - 0.03));
        high.pose.rotation = turn(Vec3::X, 45.0);
        assert!((deepest(&[low, high]) - 0.03).abs() < 1e-6);
    }
}
