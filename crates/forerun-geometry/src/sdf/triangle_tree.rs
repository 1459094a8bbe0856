//! Triangle tree: the nearest point of a triangle surface, and the first triangle that a ray meets.
//!
//! Promise: distances are exact up to rounding in double precision. Only + - * / and square roots are used, so they
//! too have the same bits on every target.

use glam::DVec3;

use super::topology::{EdgeKind, Topology};
use crate::Vec3;

/// Triangles in a tree of boxes.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleTree {
    /// The surface, its triangles in the order of the leaves.
    topology: Topology,
    /// The root first; the first child of an inner node follows it.
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    min: Vec3,
    max: Vec3,
    /// First triangle of a leaf; second child of an inner node.
    first: u32,
    /// Number of triangles of a leaf; 0 for an inner node.
    count: u32,
}

/// The part of a triangle that a point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Feature {
    Face,
    Edge(usize),
    Corner(usize),
}

/// The nearest point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    distance_squared: f64,
    /// The point.
    pub(crate) point: DVec3,
    /// The triangle that it lies on.
    triangle: u32,
    feature: Feature,
}

/// A surface point seen from a point, with its side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Signed {
    /// Distance, negative behind the surface. Metres.
    pub(crate) distance: f64,
    /// Gradient of the distance: from the surface outwards. Unit.
    pub(crate) gradient: Vec3,
    /// Whether the surface ends at the nearest point.
    pub(crate) on_boundary: bool,
}

const LEAF_TRIANGLES: usize = 4;
/// Halving splits make a tree of 2^32 triangles 32 deep; a node leaves at most one other waiting for each level.
const STACK: usize = 64;

impl TriangleTree {
    /// The tree of a surface.
    pub(crate) fn new(mut topology: Topology) -> TriangleTree {
        let centroids: Vec<DVec3> =
            topology.triangles.iter().map(|t| topology.corners(t).iter().sum::<DVec3>() / 3.0).collect();
        let mut order: Vec<u32> = (0..topology.triangles.len() as u32).collect();
        let mut nodes = Vec::new();
        let mut splitter = Splitter { topology: &topology, centroids: &centroids, nodes: &mut nodes };
        splitter.split(&mut order, 0);
        topology.triangles = order.iter().map(|i| topology.triangles[*i as usize]).collect();
        TriangleTree { topology, nodes }
    }

    /// The surface.
    pub(crate) fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Memory that the tree and the surface take.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let t = &self.topology;
        size_of_val(&*self.nodes)
            + size_of_val(&*t.triangles)
            + size_of_val(&*t.vertices) * 2
            + size_of_val(&*t.edges)
            + size_of_val(&*t.edge_normals)
            + t.edges.len()
            + t.vertices.len()
    }

    /// The point of the surface nearest to `point`. `guess`, an earlier answer for a point close by, makes it quick.
    /// None if there are no triangles.
    pub(crate) fn nearest(&self, point: DVec3, guess: Option<&Nearest>) -> Option<Nearest> {
        let mut best = guess.map(|g| self.nearest_on(g.triangle, point));
        let mut limit = best.map_or(f64::INFINITY, |b| b.distance_squared);
        let mut stack = [(0_u32, 0.0_f64); STACK];
        let mut waiting = usize::from(!self.nodes.is_empty());
        while waiting > 0 {
            waiting -= 1;
            let (mut index, mut near) = stack[waiting];
            while near < limit {
                let node = &self.nodes[index as usize];
                if node.count > 0 {
                    for triangle in node.first..node.first + node.count {
                        let candidate = self.nearest_on(triangle, point);
                        if candidate.distance_squared < limit {
                            limit = candidate.distance_squared;
                            best = Some(candidate);
                        }
                    }
                    break;
                }
                let children =
                    [index + 1, node.first].map(|c| (c, self.nodes[c as usize].distance_squared(point)));
                let [closer, farther] =
                    if children[1].1 < children[0].1 { [children[1], children[0]] } else { children };
                stack[waiting] = farther;
                waiting += 1;
                (index, near) = closer;
            }
        }
        best
    }

    /// On which side of the surface a point is, and how far, given its nearest point.
    pub(crate) fn signed(&self, point: DVec3, nearest: &Nearest) -> Signed {
        let t = &self.topology;
        let triangle = t.triangles[nearest.triangle as usize];
        let (normal, on_boundary) = match nearest.feature {
            Feature::Face => (self.face_normal(nearest.triangle), false),
            Feature::Edge(k) => {
                let edge = triangle.edges[k] as usize;
                (t.edge_normals[edge].as_dvec3(), t.edge_kinds[edge] == EdgeKind::Boundary)
            }
            Feature::Corner(k) => {
                let corner = triangle.corners[k] as usize;
                (t.vertex_normals[corner].as_dvec3(), t.vertex_on_boundary[corner])
            }
        };
        let offset = point - nearest.point;
        let length = nearest.distance_squared.sqrt();
        let sign = if offset.dot(normal) < 0.0 { -1.0 } else { 1.0 };
        // On the surface itself the offset is rounding; the normal is what it stands for.
        let gradient = if length > 1e-7 { offset * (sign / length) } else { normal };
        Signed { distance: sign * length, gradient: gradient.as_vec3(), on_boundary }
    }

    /// Distance along a ray to the first triangle whose inner side it meets, farther than `from`. The direction is a
    /// unit vector; metres.
    pub(crate) fn first_exit(&self, origin: DVec3, direction: DVec3, from: f64) -> Option<f64> {
        let mut first = f64::INFINITY;
        let mut stack = [0_u32; STACK];
        let mut waiting = usize::from(!self.nodes.is_empty());
        while waiting > 0 {
            waiting -= 1;
            let index = stack[waiting];
            let node = &self.nodes[index as usize];
            if !node.meets_ray(origin, direction, first) {
                continue;
            }
            if node.count == 0 {
                stack[waiting] = node.first;
                stack[waiting + 1] = index + 1;
                waiting += 2;
            }
            for triangle in node.first..node.first + node.count {
                if let Some(t) = self.exit_through(triangle, origin, direction)
                    && t > from
                {
                    first = first.min(t);
                }
            }
        }
        first.is_finite().then_some(first)
    }

    /// Unit normal of a triangle.
    pub(crate) fn face_normal(&self, triangle: u32) -> DVec3 {
        let [a, b, c] = self.topology.corners(&self.topology.triangles[triangle as usize]);
        (b - a).cross(c - a).normalize()
    }

    fn nearest_on(&self, triangle: u32, point: DVec3) -> Nearest {
        let corners = self.topology.corners(&self.topology.triangles[triangle as usize]);
        let (nearest, feature) = nearest_on_triangle(point, corners);
        Nearest { distance_squared: point.distance_squared(nearest), point: nearest, triangle, feature }
    }

    /// Möller and Trumbore (1997), a little wider than the triangle so that no ray slips through an edge.
    fn exit_through(&self, triangle: u32, origin: DVec3, direction: DVec3) -> Option<f64> {
        const WIDER: f64 = 1e-9;
        let [a, b, c] = self.topology.corners(&self.topology.triangles[triangle as usize]);
        let (ab, ac) = (b - a, c - a);
        let p = direction.cross(ac);
        let determinant = ab.dot(p);
        // The determinant is negative where the ray goes the way of the normal: out of the body.
        if determinant >= 0.0 {
            return None;
        }
        let s = origin - a;
        let u = s.dot(p) / determinant;
        let q = s.cross(ab);
        let v = direction.dot(q) / determinant;
        let inside = u >= -WIDER && v >= -WIDER && u + v <= 1.0 + WIDER;
        inside.then(|| ac.dot(q) / determinant)
    }
}

impl Node {
    fn distance_squared(&self, point: DVec3) -> f64 {
        let (min, max) = (self.min.as_dvec3(), self.max.as_dvec3());
        (min - point).max(point - max).max(DVec3::ZERO).length_squared()
    }

    fn meets_ray(&self, origin: DVec3, direction: DVec3, limit: f64) -> bool {
        let (mut enter, mut leave) = (0.0_f64, limit);
        for axis in 0..3 {
            let (low, high) = (f64::from(self.min[axis]) - 1e-9, f64::from(self.max[axis]) + 1e-9);
            if direction[axis] == 0.0 {
                if origin[axis] < low || origin[axis] > high {
                    return false;
                }
                continue;
            }
            let inverse = 1.0 / direction[axis];
            let (a, b) = ((low - origin[axis]) * inverse, (high - origin[axis]) * inverse);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        enter <= leave
    }
}

/// Builds the nodes, deepest first children first.
struct Splitter<'a> {
    topology: &'a Topology,
    centroids: &'a [DVec3],
    nodes: &'a mut Vec<Node>,
}

impl Splitter<'_> {
    /// Splits `order`, whose first triangle will be triangle `first` of the tree.
    fn split(&mut self, order: &mut [u32], first: usize) {
        if order.is_empty() {
            return;
        }
        let corners = order.iter().flat_map(|t| self.topology.triangles[*t as usize].corners);
        let (min, max) = corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), v| {
            let p = self.topology.vertices[v as usize];
            (min.min(p), max.max(p))
        });
        let at = self.nodes.len();
        self.nodes.push(Node { min, max, first: first as u32, count: order.len() as u32 });
        if order.len() <= LEAF_TRIANGLES {
            return;
        }
        let centroid = |t: &u32| self.centroids[*t as usize];
        let low = order.iter().map(centroid).fold(DVec3::INFINITY, DVec3::min);
        let high = order.iter().map(centroid).fold(DVec3::NEG_INFINITY, DVec3::max);
        let axis = (high - low).max_position();
        order.sort_unstable_by(|a, b| centroid(a)[axis].total_cmp(&centroid(b)[axis]).then(a.cmp(b)));
        let half = order.len() / 2;
        let (left, right) = order.split_at_mut(half);
        self.split(left, first);
        self.nodes[at].first = self.nodes.len() as u32;
        self.nodes[at].count = 0;
        self.split(right, first + half);
    }
}

/// The nearest point of a triangle (Ericson, *Real-Time Collision Detection*, section 5.1.5) and what it lies on.
fn nearest_on_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> (DVec3, Feature) {
    let (ab, ac) = (b - a, c - a);
    let ap = p - a;
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, Feature::Corner(0));
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, Feature::Corner(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * (d1 / (d1 - d3)), Feature::Edge(0));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, Feature::Corner(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * (d2 / (d2 - d6)), Feature::Edge(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return (b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), Feature::Edge(1));
    }
    let inverse = 1.0 / (va + vb + vc);
    (a + ab * (vb * inverse) + ac * (vc * inverse), Feature::Face)
}
