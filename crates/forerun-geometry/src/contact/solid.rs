//! Solid: a convex shape in the world, asked for its outermost point, its faces and its edges.

use glam::{DMat3, DVec3};

use super::clip::{Boundary, Face};
use super::cylinder::{Drum, Lowest};
use crate::shape::Hull;
use crate::{Mat3, Pose, Shape, Vec3};

/// An edge belongs to what comes first in a direction if its sine with that direction's plane is below this.
const IN_PLANE: f32 = 0.02;

/// A convex core with everything within `radius` of it.
pub(super) struct Solid<'a> {
    core: Core<'a>,
    centre: Vec3,
    axes: Mat3,
    /// The same, for the searches in double precision.
    axes_exact: DMat3,
    /// Metres; 0 unless the shape is round all over.
    pub(super) radius: f32,
    /// Roughly half of its smallest thickness: what small means for this shape. Metres.
    pub(super) size: f32,
}

#[derive(Clone, Copy)]
enum Core<'a> {
    /// Along y.
    Segment {
        half_height: f32,
    },
    Cuboid {
        half_extents: Vec3,
    },
    /// Along y.
    Cylinder {
        half_height: f32,
        radius: f32,
    },
    Hull(&'a Hull),
}

impl Core<'_> {
    fn size(&self, radius: f32) -> f32 {
        match self {
            Core::Segment { .. } => radius,
            Core::Cuboid { half_extents } => half_extents.min_element(),
            Core::Cylinder { half_height, radius } => half_height.min(*radius),
            Core::Hull(hull) => hull.inner_radius,
        }
    }
}

impl<'a> Solid<'a> {
    /// A convex shape, seen from `origin`; none for others.
    pub(super) fn new(shape: &'a Shape, pose: &Pose, origin: Vec3) -> Option<Self> {
        let (core, radius) = match shape {
            Shape::Sphere(s) => (Core::Segment { half_height: 0.0 }, s.radius),
            Shape::Capsule(c) => (Core::Segment { half_height: c.half_height }, c.radius),
            Shape::Cuboid(c) => (Core::Cuboid { half_extents: c.half_extents }, 0.0),
            Shape::Cylinder(c) => (Core::Cylinder { half_height: c.half_height, radius: c.radius }, 0.0),
            Shape::Hull(hull) => (Core::Hull(hull), 0.0),
            Shape::HalfSpace | Shape::Compound(_) | Shape::Mesh(_) => return None,
        };
        Some(Solid::of_core(core, pose.position - origin, pose.axes(), radius))
    }

    fn of_core(core: Core<'a>, centre: Vec3, axes: Mat3, radius: f32) -> Self {
        let axes_exact =
            DMat3::from_cols(axes.x_axis.as_dvec3(), axes.y_axis.as_dvec3(), axes.z_axis.as_dvec3());
        Solid { core, centre, axes, axes_exact, radius, size: core.size(radius) }
    }

    /// A hull in its own frame.
    pub(super) fn of_hull(hull: &'a Hull) -> Self {
        Solid::of_core(Core::Hull(hull), Vec3::ZERO, Mat3::IDENTITY, 0.0)
    }

    /// Where its frame is.
    pub(super) fn centre(&self) -> Vec3 {
        self.centre
    }

    /// Puts its frame elsewhere.
    pub(super) fn place(&mut self, centre: Vec3) {
        self.centre = centre;
    }

    /// Polyhedra first, then cylinders, then capsules: whose faces are preferred.
    pub(super) fn rank(&self) -> u32 {
        match self.core {
            Core::Cuboid { .. } | Core::Hull(_) => 0,
            Core::Cylinder { .. } => 1,
            Core::Segment { .. } => 2,
        }
    }

    /// A cylinder as the capsule around its axis, whose side is the same; anything else as it is.
    pub(super) fn as_rod(&self) -> Solid<'a> {
        match self.core {
            Core::Cylinder { half_height, radius } => {
                Solid { core: Core::Segment { half_height }, radius, size: radius, ..*self }
            }
            _ => Solid { ..*self },
        }
    }

    /// The axis, if this is a cylinder.
    pub(super) fn cylinder_axis(&self) -> Option<Vec3> {
        matches!(self.core, Core::Cylinder { .. }).then_some(self.axes.y_axis)
    }

    /// A point well inside.
    pub(super) fn middle(&self) -> Vec3 {
        match self.core {
            Core::Hull(hull) => self.axes * hull.centre + self.centre,
            _ => self.centre,
        }
    }

    /// A ball of this radius about the middle is inside, but for a part in a thousand. Metres.
    pub(super) fn inner_radius(&self) -> f32 {
        // Less than the size by what rounding may make of it.
        match self.core {
            Core::Segment { .. } => self.radius,
            _ => self.size * 0.999,
        }
    }

    /// The outermost point of the core in a direction (any length but 0); the first of equals.
    pub(super) fn support(&self, direction: DVec3) -> DVec3 {
        let d = self.axes_exact.transpose() * direction;
        let local = match self.core {
            Core::Segment { half_height } => DVec3::new(0.0, along(d.y, half_height), 0.0),
            Core::Cuboid { half_extents: h } => DVec3::new(along(d.x, h.x), along(d.y, h.y), along(d.z, h.z)),
            Core::Cylinder { half_height, radius } => {
                let across = (d.x * d.x + d.z * d.z).sqrt();
                let scale = if across > 1.0e-300 { f64::from(radius) / across } else { 0.0 };
                DVec3::new(d.x * scale, along(d.y, half_height), d.z * scale)
            }
            Core::Hull(hull) => {
                let mut best = DVec3::ZERO;
                let mut most = f64::NEG_INFINITY;
                for vertex in &hull.vertices {
                    let vertex = vertex.as_dvec3();
                    let reach = vertex.dot(d);
                    if reach > most {
                        (best, most) = (vertex, reach);
                    }
                }
                best
            }
        };
        self.axes_exact * local + self.centre.as_dvec3()
    }

    /// How far the core reaches along a unit direction, from the origin. Metres.
    pub(super) fn reach(&self, direction: Vec3) -> f32 {
        let Vec3 { x: u, y: v, z: w } = self.axes.transpose() * direction;
        let own = match self.core {
            Core::Segment { half_height } => v.abs() * half_height,
            Core::Cuboid { half_extents: h } => u.abs() * h.x + v.abs() * h.y + w.abs() * h.z,
            Core::Cylinder { half_height, radius } => v.abs() * half_height + (u * u + w * w).sqrt() * radius,
            Core::Hull(hull) => {
                let local = Vec3::new(u, v, w);
                hull.vertices.iter().fold(f32::NEG_INFINITY, |most, vertex| most.max(vertex.dot(local)))
            }
        };
        own + self.centre.dot(direction)
    }

    /// How many flat faces it has.
    pub(super) fn face_count(&self) -> usize {
        match self.core {
            Core::Segment { .. } => 0,
            Core::Cuboid { .. } => 6,
            Core::Cylinder { .. } => 2,
            Core::Hull(hull) => hull.faces.len(),
        }
    }

    /// How high the middle of `other` is above each face. Metres; in this solid's own frame, so that no normal has to be turned.
    pub(super) fn heights_of(&self, middle: Vec3) -> impl Iterator<Item = f32> + '_ {
        let local = self.axes.transpose() * (middle - self.centre);
        (0..self.face_count()).map(move |face| {
            let (normal, offset) = self.local_plane(face);
            normal.dot(local) - offset
        })
    }

    /// Outward unit normal of a face, and how far its plane is from the origin along it.
    pub(super) fn plane(&self, face: usize) -> (Vec3, f32) {
        let (local, offset) = self.local_plane(face);
        let normal = self.axes * local;
        (normal, offset + normal.dot(self.centre))
    }

    fn local_plane(&self, face: usize) -> (Vec3, f32) {
        match self.core {
            Core::Cuboid { half_extents } => {
                let axis = face / 2;
                let outward = [Vec3::X, Vec3::Y, Vec3::Z][axis];
                let outward = if face.is_multiple_of(2) { outward } else { -outward };
                (outward, half_extents.to_array()[axis])
            }
            Core::Hull(hull) => (hull.faces[face].normal, hull.faces[face].offset),
            Core::Cylinder { half_height, .. } => (if face == 0 { Vec3::Y } else { -Vec3::Y }, half_height),
            Core::Segment { half_height } => (Vec3::Y, half_height),
        }
    }

    /// A face as a reference to clip against.
    pub(super) fn face(&self, face: usize) -> Face {
        let (normal, _) = self.plane(face);
        if let Core::Cylinder { half_height, radius } = self.core {
            let point = self.centre + normal * half_height;
            let u = self.axes.x_axis;
            return Face { point, normal, u, v: normal.cross(u), boundary: Boundary::Disc { radius } };
        }
        let corners = self.corners(face);
        let along = corners[1] - corners[0];
        let u = super::unit_or(along - normal * along.dot(normal), super::any_perpendicular(normal));
        let (point, v) = (corners[0], normal.cross(u));
        let flat = corners.iter().map(|&corner| [(corner - point).dot(u), (corner - point).dot(v)]).collect();
        Face { point, normal, u, v, boundary: Boundary::Polygon(flat) }
    }

    /// What lies over a face with the normal `-down`: a convex polygon of three or more points, or a segment of two. `hint` is
    /// a direction in that face.
    pub(super) fn lowest(&self, down: Vec3, hint: Vec3) -> Vec<Vec3> {
        match self.core {
            Core::Segment { half_height } => {
                let arm = self.axes.y_axis * half_height;
                vec![self.centre - arm, self.centre + arm]
            }
            Core::Cylinder { half_height, radius } => {
                let drum = Drum { centre: self.centre, axis: self.axes.y_axis, half_height, radius };
                match drum.lowest(down, hint) {
                    Lowest::Side(ends) => ends.to_vec(),
                    // Nearer to the lowest point than a quarter turn there are none: a coin that rolls on its rim would
                    // be stopped by the next of them, which comes down in an arc and not as straight as it seems.
                    Lowest::TiltedCap(rim) => rim.to_vec(),
                    Lowest::FlatCap(rim) => between_too(rim, drum.cap(down).0),
                }
            }
            Core::Cuboid { .. } | Core::Hull(_) => {
                let mut best = 0;
                let mut most = f32::NEG_INFINITY;
                for face in 0..self.face_count() {
                    let cosine = self.plane(face).0.dot(down);
                    if cosine > most + 1.0e-6 {
                        (best, most) = (face, cosine);
                    }
                }
                self.corners(best)
            }
        }
    }

    /// The edge (or line of a side) that comes first in a direction; none if a single point does.
    pub(super) fn edge(&self, down: Vec3) -> Option<[Vec3; 2]> {
        let ends = match self.core {
            Core::Segment { half_height } => {
                let arm = self.axes.y_axis * half_height;
                [self.centre - arm, self.centre + arm]
            }
            Core::Cylinder { half_height, radius } => {
                let axis = self.axes.y_axis;
                let across = super::unit_or(down - axis * axis.dot(down), self.axes.x_axis) * radius;
                [-half_height, half_height].map(|h| self.centre + across + axis * h)
            }
            Core::Cuboid { half_extents: h } => {
                let local = self.axes.transpose() * down;
                let corner = Vec3::new(along32(local.x, h.x), along32(local.y, h.y), along32(local.z, h.z));
                let flat = local.abs();
                let other = if flat.x <= flat.y && flat.x <= flat.z {
                    Vec3::new(-corner.x, corner.y, corner.z)
                } else if flat.y <= flat.z {
                    Vec3::new(corner.x, -corner.y, corner.z)
                } else {
                    Vec3::new(corner.x, corner.y, -corner.z)
                };
                [corner, other].map(|point| self.axes * point + self.centre)
            }
            Core::Hull(hull) => self.hull_edge(hull, down)?,
        };
        let along = ends[1] - ends[0];
        (along.dot(down).abs() <= IN_PLANE * along.length()).then_some(ends)
    }

    fn hull_edge(&self, hull: &Hull, down: Vec3) -> Option<[Vec3; 2]> {
        let local = self.axes.transpose() * down;
        let mut best = None;
        let mut most = f32::NEG_INFINITY;
        for edge in &hull.edges {
            let ends = edge.vertices.map(|vertex| hull.vertices[vertex as usize]);
            let reach = (ends[0] + ends[1]).dot(local);
            if reach > most {
                (best, most) = (Some(ends), reach);
            }
        }
        best.map(|ends| ends.map(|point| self.axes * point + self.centre))
    }

    /// Corners of a face of a polyhedron, counter-clockwise seen from outside.
    fn corners(&self, face: usize) -> Vec<Vec3> {
        match self.core {
            Core::Cuboid { half_extents } => {
                let (axis, side) = (face / 2, if face.is_multiple_of(2) { 1.0 } else { -1.0 });
                let arms = [
                    self.axes.x_axis * half_extents.x,
                    self.axes.y_axis * half_extents.y,
                    self.axes.z_axis * half_extents.z,
                ];
                let centre = self.centre + arms[axis] * side;
                let (p, q) = (arms[(axis + 1) % 3], arms[(axis + 2) % 3] * side);
                vec![centre - p - q, centre + p - q, centre + p + q, centre - p + q]
            }
            Core::Hull(hull) => {
                let face = hull.faces[face];
                hull.corners[face.first as usize..(face.first + face.count) as usize]
                    .iter()
                    .map(|&vertex| self.axes * hull.vertices[vertex as usize] + self.centre)
                    .collect()
            }
            Core::Segment { .. } | Core::Cylinder { .. } => Vec::new(),
        }
    }
}

/// Four points of a rim and the four midway between them: where the cap hangs over an edge, eight follow it better.
fn between_too(rim: [Vec3; 4], cap: Vec3) -> Vec<Vec3> {
    let half_root = std::f32::consts::FRAC_1_SQRT_2;
    let mut all = Vec::with_capacity(8);
    for k in 0..4 {
        let (here, next) = (rim[k] - cap, rim[(k + 1) % 4] - cap);
        all.extend([rim[k], cap + (here + next) * half_root]);
    }
    all
}

fn along(direction: f64, half: f32) -> f64 {
    if direction < 0.0 { -f64::from(half) } else { f64::from(half) }
}

fn along32(direction: f32, half: f32) -> f32 {
    if direction < 0.0 { -half } else { half }
}
