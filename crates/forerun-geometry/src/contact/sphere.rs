//! Sphere: against every convex shape, by the nearest point of that shape's surface.
//!
//! The nearest point is exact inside and outside, so contact at any distance and any depth is too.

use super::{ContactPoint, Manifold, any_perpendicular, unit_or};
use crate::shape::{Cylinder, Hull, Sphere};
use crate::{Pose, Shape, Vec3};

/// Below this distance from a surface the direction to it is rounding noise: the surface's own normal serves. Metres.
const ON_SURFACE: f32 = 1.0e-6;

/// A point of a surface, as seen from somewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    /// Unit direction in which the distance grows: away from the shape.
    pub(super) outward: Vec3,
    /// Distance to the surface; negative inside. Metres.
    pub(super) distance: f32,
}

/// A sphere at `centre` against a convex shape at a pose.
pub(super) fn sphere_any(
    sphere: &Sphere,
    centre: Vec3,
    (shape, pose): (&Shape, &Pose),
    margin: f32,
) -> Option<Manifold> {
    let local = pose.inverse_transform_point(centre);
    let nearest = match shape {
        Shape::Sphere(other) => nearest_on_segment(local, 0.0, other.radius),
        Shape::Capsule(capsule) => nearest_on_segment(local, capsule.half_height, capsule.radius),
        Shape::Cuboid(cuboid) => nearest_on_cuboid(local, cuboid.half_extents),
        Shape::Cylinder(cylinder) => nearest_on_cylinder(local, cylinder),
        Shape::Hull(hull) => nearest_on_hull(local, hull),
        Shape::HalfSpace => Nearest { outward: Vec3::Y, distance: local.y },
        // Their parts and triangles are met one by one elsewhere.
        Shape::Compound(_) | Shape::Mesh(_) => return None,
    };
    let separation = nearest.distance - sphere.radius;
    if separation >= margin {
        return None;
    }
    let normal = pose.rotation * -nearest.outward;
    let normal = unit_or(normal, Vec3::Y);
    let position = centre + normal * (0.5 * (nearest.distance + sphere.radius));
    Manifold::from_points(&[ContactPoint { position, normal, separation }])
}

/// All points within `radius` of the segment along y.
fn nearest_on_segment(point: Vec3, half_height: f32, radius: f32) -> Nearest {
    let arm = point - Vec3::new(0.0, point.y.clamp(-half_height, half_height), 0.0);
    let length = arm.length();
    // A point on the segment itself leaves by the side; on a segment without a length any way is as short.
    let outward = if length > ON_SURFACE {
        arm / length
    } else if half_height > 0.0 {
        Vec3::X
    } else {
        Vec3::Y
    };
    Nearest { outward, distance: length - radius }
}

fn nearest_on_cuboid(point: Vec3, half_extents: Vec3) -> Nearest {
    let arm = point - point.clamp(-half_extents, half_extents);
    let length = arm.length();
    if length > ON_SURFACE {
        return Nearest { outward: arm / length, distance: length };
    }
    let depth = point.abs() - half_extents;
    let (axis, distance) = if depth.x >= depth.y && depth.x >= depth.z {
        (Vec3::new(sign(point.x), 0.0, 0.0), depth.x)
    } else if depth.y >= depth.z {
        (Vec3::new(0.0, sign(point.y), 0.0), depth.y)
    } else {
        (Vec3::new(0.0, 0.0, sign(point.z)), depth.z)
    };
    Nearest { outward: axis, distance }
}

fn nearest_on_cylinder(point: Vec3, cylinder: &Cylinder) -> Nearest {
    let across = Vec3::new(point.x, 0.0, point.z);
    let from_axis = across.length();
    let side = if from_axis > 1.0e-12 { across / from_axis } else { Vec3::X };
    let cap = Vec3::new(0.0, sign(point.y), 0.0);
    let beyond_side = from_axis - cylinder.radius;
    let beyond_cap = point.y.abs() - cylinder.half_height;
    if beyond_side > 0.0 && beyond_cap > 0.0 {
        let distance = (beyond_side * beyond_side + beyond_cap * beyond_cap).sqrt();
        if distance > ON_SURFACE {
            return Nearest { outward: (side * beyond_side + cap * beyond_cap) / distance, distance };
        }
    }
    if beyond_cap >= beyond_side {
        Nearest { outward: cap, distance: beyond_cap }
    } else {
        Nearest { outward: side, distance: beyond_side }
    }
}

fn nearest_on_hull(point: Vec3, hull: &Hull) -> Nearest {
    let mut best = Nearest { outward: Vec3::Y, distance: f32::NEG_INFINITY };
    for face in &hull.faces {
        let distance = face.normal.dot(point) - face.offset;
        if distance > best.distance {
            best = Nearest { outward: face.normal, distance };
        }
    }
    if best.distance <= ON_SURFACE {
        return best;
    }
    // Outside: the nearest of all points of all faces that look at the point.
    let mut arm = Vec3::ZERO;
    let mut least = f32::INFINITY;
    for face in &hull.faces {
        let distance = face.normal.dot(point) - face.offset;
        if distance <= 0.0 || distance * distance >= least {
            continue;
        }
        let corners = &hull.corners[face.first as usize..(face.first + face.count) as usize];
        let candidate = point - nearest_on_polygon(point, face.normal, corners, &hull.vertices);
        if candidate.length_squared() < least {
            least = candidate.length_squared();
            arm = candidate;
        }
    }
    let distance = least.sqrt();
    let outward = unit_or(arm, any_perpendicular(best.outward));
    if distance.is_finite() { Nearest { outward, distance } } else { best }
}

/// The nearest point of a convex polygon, counter-clockwise about `normal`.
fn nearest_on_polygon(point: Vec3, normal: Vec3, corners: &[u32], vertices: &[Vec3]) -> Vec3 {
    let mut inside = true;
    let mut nearest = point;
    let mut least = f32::INFINITY;
    for (k, &corner) in corners.iter().enumerate() {
        let from = vertices[corner as usize];
        let to = vertices[corners[(k + 1) % corners.len()] as usize];
        let edge = to - from;
        if normal.cross(edge).dot(point - from) >= 0.0 {
            continue;
        }
        inside = false;
        let along = (point - from).dot(edge) / edge.length_squared().max(f32::MIN_POSITIVE);
        let candidate = from + edge * along.clamp(0.0, 1.0);
        let distance = (point - candidate).length_squared();
        if distance < least {
            least = distance;
            nearest = candidate;
        }
    }
    if inside {
        let from = vertices[corners[0] as usize];
        return point - normal * normal.dot(point - from);
    }
    nearest
}

/// -1 below 0, else 1.
fn sign(x: f32) -> f32 {
    if x < 0.0 { -1.0 } else { 1.0 }
}
