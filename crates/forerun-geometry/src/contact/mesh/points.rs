//! Points of primitives that are looked up in the field of a mesh: corners, and points along edges and axes.

use super::directions::Points;
use crate::sdf::ridges::{Ridge, Ridges};
use crate::sdf::{Sample, Samples};
use crate::shape::{Capsule, Cuboid, Cylinder, Hull};
use crate::{Shape, Vec3};

/// The part of space that matters: the ball around the mesh.
pub(super) struct Region {
    pub(super) centre: Vec3,
    pub(super) radius: f32,
    /// Points along edges are to be no further apart than this. Metres.
    pub(super) spacing: f32,
}

/// A ball of a rounded shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoundPoint {
    pub(super) centre: Vec3,
    pub(super) radius: f32,
}

/// Most parts that the whole of an edge is cut into.
const EDGE_PARTS_MAX: f32 = 1024.0;
/// Most points on the axis of a capsule.
const AXIS_PARTS_MAX: f32 = 32.0;
/// Points on the side line of a cylinder that faces the mesh.
const LINE_PARTS: u32 = 4;
/// Directions in which the rim of a cylinder has a fixed point: every 45 degrees.
const RIM: [(f32, f32); 8] = {
    const D: f32 = std::f32::consts::FRAC_1_SQRT_2;
    [(1.0, 0.0), (D, D), (0.0, 1.0), (-D, D), (-1.0, 0.0), (-D, -D), (0.0, -1.0), (D, -D)]
};

/// The points of a primitive in its own frame.
#[derive(Clone, Debug, Default)]
pub(super) struct PointList {
    /// Of a shape with edges.
    sharp: Sharp,
    /// The same, ready to be looked up.
    samples: Samples,
    ridges: Ridges,
    /// Of a rounded shape.
    round: Vec<RoundPoint>,
    /// For each corner of a hull the sum of the normals around.
    normal_sums: Vec<Vec3>,
}

/// Corners, points along edges, and the stretches of edges between them.
#[derive(Clone, Debug, Default)]
struct Sharp {
    points: Vec<Sample>,
    ridges: Vec<Ridge>,
}

impl PointList {
    pub(super) fn clear(&mut self) {
        self.sharp.points.clear();
        self.sharp.ridges.clear();
        self.round.clear();
    }

    /// Adds the points of a shape; half-spaces have none. `gradient` tells which way is away from the mesh.
    pub(super) fn fill(&mut self, shape: &Shape, region: &Region, gradient: impl Fn(Vec3) -> Vec3) {
        let PointList { sharp, samples, ridges, round, normal_sums } = self;
        match shape {
            Shape::Sphere(s) => round.push(RoundPoint { centre: Vec3::ZERO, radius: s.radius }),
            Shape::Capsule(c) => capsule(c, round),
            Shape::Cuboid(c) => sharp.cuboid(c, region),
            Shape::Cylinder(c) => cylinder(c, gradient, &mut sharp.points),
            Shape::Hull(hull) => sharp.hull(hull, region, normal_sums),
            Shape::HalfSpace | Shape::Compound(_) | Shape::Mesh(_) => {}
        }
        samples.fill(&sharp.points);
        ridges.fill(&sharp.ridges);
    }

    /// With the long edges; none if there are none.
    pub(super) fn points(&self) -> Option<(Points<'_>, &Ridges)> {
        if !self.sharp.points.is_empty() || !self.sharp.ridges.is_empty() {
            Some((Points::Sharp(&self.samples), &self.ridges))
        } else if !self.round.is_empty() {
            Some((Points::Round(&self.round), &self.ridges))
        } else {
            None
        }
    }
}

/// Points on the axis, no further apart than half the radius: the balls about them sag less than a thirtieth of it.
fn capsule(c: &Capsule, points: &mut Vec<RoundPoint>) {
    let parts = (4.0 * c.half_height / c.radius).ceil().clamp(1.0, AXIS_PARTS_MAX);
    points.extend((0..=parts as u32).map(|k| {
        let along = 2.0 * (k as f32 / parts) - 1.0;
        RoundPoint { centre: Vec3::new(0.0, along * c.half_height, 0.0), radius: c.radius }
    }));
}

/// Fixed points around both rims, and the line down the side that faces the mesh.
fn cylinder(c: &Cylinder, gradient: impl Fn(Vec3) -> Vec3, points: &mut Vec<Sample>) {
    for end in [-1.0, 1.0] {
        points.extend(RIM.map(|(x, z)| Sample {
            point: Vec3::new(x * c.radius, end * c.half_height, z * c.radius),
            normal: Vec3::new(x, end, z).normalize(),
            facing_max: Sample::SHARP,
        }));
    }
    for k in 0..=LINE_PARTS {
        let along = 2.0 * (k as f32 / LINE_PARTS as f32) - 1.0;
        let on_axis = Vec3::new(0.0, along * c.half_height, 0.0);
        let away = gradient(on_axis);
        let across = Vec3::new(away.x, 0.0, away.z);
        // Where the mesh is straight ahead along the axis, every side is the same and the rims have the points.
        if across.length_squared() > 1e-6 {
            let out = -across.normalize();
            // At its ends the line is on a rim.
            let end = if k == 0 {
                -Vec3::Y
            } else if k == LINE_PARTS {
                Vec3::Y
            } else {
                Vec3::ZERO
            };
            let point = on_axis + out * c.radius;
            points.push(Sample { point, normal: (out + end).normalize(), facing_max: Sample::SHARP });
        }
    }
}

impl Sharp {
    fn cuboid(&mut self, c: &Cuboid, region: &Region) {
        let sign = |signs: u32, axis: u32| if signs >> axis & 1 == 1 { 1.0 } else { -1.0 };
        let corner = |signs: u32| Vec3::new(sign(signs, 0), sign(signs, 1), sign(signs, 2));
        let spacing = region.spacing.min(2.0 * c.half_extents.min_element());
        for signs in 0..8 {
            let from = corner(signs);
            self.vertex(from * c.half_extents, from.normalize(), region);
            for axis in 0..3 {
                if signs >> axis & 1 == 0 {
                    let to = corner(signs | 1 << axis);
                    let ends = [from * c.half_extents, to * c.half_extents];
                    self.edge(ends, (from + to).normalize(), (region, spacing));
                }
            }
        }
    }

    fn hull(&mut self, hull: &Hull, region: &Region, sums: &mut Vec<Vec3>) {
        sums.clear();
        sums.resize(hull.vertices.len(), Vec3::ZERO);
        for e in &hull.edges {
            let normal = e.faces.map(|f| hull.faces[f as usize].normal).iter().sum::<Vec3>();
            for v in e.vertices {
                sums[v as usize] += normal;
            }
            let ends = e.vertices.map(|v| hull.vertices[v as usize]);
            self.edge(ends, normal.normalize_or_zero(), (region, region.spacing));
        }
        for (v, sum) in hull.vertices.iter().zip(&*sums) {
            self.vertex(*v, sum.normalize_or_zero(), region);
        }
    }

    fn vertex(&mut self, point: Vec3, normal: Vec3, region: &Region) {
        if point.distance_squared(region.centre) <= region.radius * region.radius {
            self.points.push(Sample { point, normal, facing_max: Sample::SHARP });
        }
    }

    /// The points that cut an edge into equal parts no longer than `spacing`, and the parts between them, as far as they
    /// are in the region. They stay where they are on the edge when the shape moves.
    fn edge(&mut self, [a, b]: [Vec3; 2], normal: Vec3, (region, spacing): (&Region, f32)) {
        let (along, length) = (b - a, a.distance(b));
        let parts = (length / spacing).ceil().min(EDGE_PARTS_MAX);
        // Where the edge's line enters and leaves the ball, as parts from a.
        let to_centre = region.centre - a;
        let middle = to_centre.dot(along) / length;
        let half_squared = region.radius * region.radius - (to_centre.length_squared() - middle * middle);
        // The line misses the ball, or the edge has no length.
        if half_squared < 0.0 || half_squared.is_nan() {
            return;
        }
        let half = half_squared.sqrt();
        let part = |distance: f32| (distance / length * parts).clamp(0.0, parts);
        let (enter, leave) = (part(middle - half), part(middle + half));
        let at = |k: u32| a + along * (k as f32 / parts);
        let facing_max = Sample::SHARP;
        let inner = (enter.ceil() as u32).max(1)..=(leave as u32).min((parts as u32).saturating_sub(1));
        self.points.extend(inner.map(|k| Sample { point: at(k), normal, facing_max }));
        if enter < leave {
            let stretches = enter as u32..(leave.ceil() as u32).min(parts as u32);
            self.ridges.extend(stretches.map(|k| Ridge { ends: [at(k), at(k + 1)], normal, facing_max }));
        }
    }
}
