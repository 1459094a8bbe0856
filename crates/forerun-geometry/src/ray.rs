//! Ray casts: the first point of a shape on a half line.
//!
//! Convex shapes clip the ray's interval; a mesh looks up its tree of triangles. Inside it is double precision, as small shapes may be
//! far away.

use glam::{DQuat, DVec3};

use crate::shape::{Capsule, Enclosure, FirstHits, Hull, Mesh};
use crate::{Pose, Quat, Shape, Vec3};

/// A half line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, in the world. Metres.
    pub origin: Vec3,
    /// Unit vector.
    pub direction: Vec3,
}

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Distance from the origin of the ray. Metres; 0 when the ray starts in the shape.
    pub distance: f32,
    /// Unit normal of the surface, against the ray; the ray turned round when it starts in the shape.
    pub normal: Vec3,
    /// The point, in the world. Metres.
    pub point: Vec3,
}

impl Ray {
    /// The ray from `origin` towards `target`; `None` when the two are one point or not finite.
    #[must_use]
    pub fn towards(origin: Vec3, target: Vec3) -> Option<Ray> {
        let direction = (target - origin).as_dvec3().try_normalize()?.as_vec3();
        origin.is_finite().then_some(Ray { origin, direction })
    }

    /// The point at a distance along the ray. Metres.
    #[must_use]
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + self.direction * distance
    }
}

impl Shape {
    /// The first point of the shape at `pose` on the ray, if it is within `max_distance` (metres, may be infinite).
    ///
    /// A ray that starts in a solid hits it at distance 0. An open mesh is hit from both sides. `None` also for rays that are not finite.
    #[must_use]
    pub fn cast_ray(&self, pose: &Pose, ray: &Ray, max_distance: f32) -> Option<RayHit> {
        let line = Line { origin: ray.origin.as_dvec3(), direction: ray.direction.as_dvec3() };
        if !line.origin.is_finite() || line.direction.try_normalize().is_none() {
            return None;
        }
        let hit = self.first_hit(&line.seen_from(pose))?;
        let distance = hit.distance as f32;
        if distance > max_distance || !distance.is_finite() {
            return None;
        }
        let outward = hit.normal.map(|n| (pose.rotation * n.as_vec3()).normalize_or(-ray.direction));
        let normal = outward.unwrap_or(-ray.direction);
        Some(RayHit { distance, normal, point: ray.at(distance) })
    }

    fn first_hit(&self, line: &Line) -> Option<Hit> {
        match self {
            Shape::Sphere(s) => {
                let mut span = Span::all();
                span.clip_ball(line, DVec3::ZERO, s.radius.into());
                span.entry()
            }
            Shape::Cuboid(c) => {
                let mut span = Span::all();
                for (axis, half_extent) in
                    [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip(c.half_extents.to_array())
                {
                    span.clip_slab(line, axis, half_extent.into());
                }
                span.entry()
            }
            Shape::Cylinder(c) => {
                let mut span = Span::all();
                span.clip_slab(line, DVec3::Y, c.half_height.into());
                span.clip_tube(line, c.radius.into());
                span.entry()
            }
            Shape::Capsule(c) => capsule_hit(c, line),
            Shape::Hull(hull) => hull_hit(hull, line),
            Shape::HalfSpace => {
                let mut span = Span::all();
                span.clip_plane(line, DVec3::Y, 0.0);
                span.entry()
            }
            Shape::Compound(compound) => {
                let hits = compound.parts.iter().filter_map(|(pose, shape)| {
                    let hit = shape.first_hit(&line.seen_from(pose))?;
                    Some(Hit { normal: hit.normal.map(|n| double(pose.rotation) * n), ..hit })
                });
                nearest(hits)
            }
            Shape::Mesh(mesh) => mesh_hit(mesh, line),
        }
    }
}

/// Where a line meets a shape, in the shape's frame.
struct Hit {
    distance: f64,
    /// Outward normal; `None` when the line starts inside.
    normal: Option<DVec3>,
}

impl Hit {
    const INSIDE: Hit = Hit { distance: 0.0, normal: None };
}

fn nearest(hits: impl Iterator<Item = Hit>) -> Option<Hit> {
    hits.reduce(|best, hit| if hit.distance < best.distance { hit } else { best })
}

fn double(q: Quat) -> DQuat {
    DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into())
}

/// A ray in a shape's frame.
struct Line {
    origin: DVec3,
    direction: DVec3,
}

impl Line {
    fn seen_from(&self, pose: &Pose) -> Line {
        let turn = double(pose.rotation.conjugate());
        Line { origin: turn * (self.origin - pose.position.as_dvec3()), direction: turn * self.direction }
    }
}

/// The part of a line that is in a convex shape, found by clipping at one surface after the other.
struct Span {
    enter: f64,
    normal: DVec3,
    exit: f64,
}

impl Span {
    fn all() -> Span {
        Span { enter: f64::NEG_INFINITY, normal: DVec3::ZERO, exit: f64::INFINITY }
    }

    fn none(&mut self) {
        self.exit = f64::NEG_INFINITY;
    }

    fn clip(&mut self, enter: f64, normal: DVec3, exit: f64) {
        if enter > self.enter {
            (self.enter, self.normal) = (enter, normal);
        }
        self.exit = self.exit.min(exit);
    }

    /// Keeps what is behind the plane with an outward normal.
    fn clip_plane(&mut self, line: &Line, normal: DVec3, offset: f64) {
        let (height, slope) = (normal.dot(line.origin) - offset, normal.dot(line.direction));
        if slope < 0.0 {
            self.clip(-height / slope, normal, f64::INFINITY);
        } else if slope > 0.0 {
            self.clip(f64::NEG_INFINITY, normal, -height / slope);
        } else if height > 0.0 {
            self.none();
        }
    }

    fn clip_slab(&mut self, line: &Line, axis: DVec3, half_width: f64) {
        self.clip_plane(line, axis, half_width);
        self.clip_plane(line, -axis, half_width);
    }

    fn clip_ball(&mut self, line: &Line, centre: DVec3, radius: f64) {
        let origin = line.origin - centre;
        self.clip_round(origin, line.direction, radius);
    }

    /// Keeps what is within a radius of the y axis.
    fn clip_tube(&mut self, line: &Line, radius: f64) {
        let flat = DVec3::new(1.0, 0.0, 1.0);
        self.clip_round(line.origin * flat, line.direction * flat, radius);
    }

    /// Keeps t with |origin + t direction| <= radius.
    fn clip_round(&mut self, origin: DVec3, direction: DVec3, radius: f64) {
        let a = direction.length_squared();
        if a == 0.0 {
            if origin.length() > radius {
                self.none();
            }
            return;
        }
        // From the point nearest to the centre, not by the quadratic formula: no cancellation when the origin is far away.
        let middle = -origin.dot(direction) / a;
        let nearest = origin + direction * middle;
        let under_root = radius * radius - nearest.length_squared();
        if under_root < 0.0 {
            return self.none();
        }
        let half = (under_root / a).sqrt();
        let enter = middle - half;
        self.clip(enter, (origin + direction * enter) / radius, middle + half);
    }

    /// Where a ray along the line hits: at 0 when it starts inside.
    fn entry(&self) -> Option<Hit> {
        if self.enter > self.exit || self.exit < 0.0 {
            None
        } else if self.enter < 0.0 {
            Some(Hit::INSIDE)
        } else {
            Some(Hit { distance: self.enter, normal: Some(self.normal) })
        }
    }
}

/// The first entry into a tube or one of the two balls at its ends. The flat ends of the tube are inside the balls.
fn capsule_hit(capsule: &Capsule, line: &Line) -> Option<Hit> {
    let (half_height, radius) = (f64::from(capsule.half_height), f64::from(capsule.radius));
    let ball = |y: f64| {
        let mut span = Span::all();
        span.clip_ball(line, DVec3::Y * y, radius);
        span.entry()
    };
    let mut tube = Span::all();
    tube.clip_slab(line, DVec3::Y, half_height);
    tube.clip_tube(line, radius);
    nearest([ball(half_height), ball(-half_height), tube.entry()].into_iter().flatten())
}

fn hull_hit(hull: &Hull, line: &Line) -> Option<Hit> {
    let mut span = Span::all();
    for face in &hull.faces {
        span.clip_plane(line, face.normal.as_dvec3(), face.offset.into());
    }
    span.entry()
}

/// Whether a ray that meets the back of a mesh first starts inside. One that comes in through a covered hole does not.
fn is_inside(mesh: &Mesh, origin: DVec3) -> bool {
    match (mesh.enclosure, &mesh.collider().field) {
        (Enclosure::Mended, Some(field)) => field.distance_and_gradient(origin.as_vec3()).0 < 0.0,
        (enclosure, _) => enclosure == Enclosure::Closed,
    }
}

/// The nearest triangle that faces the ray. If one that faces away comes first, the ray starts inside (closed mesh) or meets its back.
fn mesh_hit(mesh: &Mesh, line: &Line) -> Option<Hit> {
    // On a silhouette edge the ray meets a front and a back at the same point, in an order that rounding decides: then the front counts.
    let size = f64::from(mesh.bounds().half_extents().max_element());
    let same_point = |t: f64| t + 1e-6 * (t + size);
    let reach = |first: &FirstHits| first.front.t.min(same_point(first.back.t));
    let FirstHits { front, back } = mesh.first_hits(line.origin, line.direction, reach);
    if front.t.is_finite() && front.t <= same_point(back.t) {
        Some(Hit { distance: front.t, normal: Some(mesh.face_vector(front.triangle).normalize_or_zero()) })
    } else if back.t.is_finite() {
        let normal = -mesh.face_vector(back.triangle).normalize_or_zero();
        Some(if is_inside(mesh, line.origin) {
            Hit::INSIDE
        } else {
            Hit { distance: back.t, normal: Some(normal) }
        })
    } else {
        None
    }
}
